"""A hollow object that leans: how much it holds, how high its liquid stands, where that lies.

Model: the cavity is an upright prism (over a convex polygon or a disc), the shape without its walls
and floor; it reaches up to the object's top, in which there is one round opening. The liquid is at
rest with a horizontal surface; air gets in and out as it likes. What stands above the lowest point
of the opening's rim, the lip, runs out.

Method: the cavity is cut into upright strips across the direction in which it leans. What of a
strip is below a horizontal plane follows in closed form if the strip's width is constant, so a box
that leans along a side is exact; of other shapes the volume is right to 0.1 %.

Frame: B, at the centre of the base, z up along the object's axis. It leans by `tilt` towards
`heading`, a direction in B's x, y; the upward vertical in B is n = (−sin tilt · heading, cos tilt).
Heights are those above B's origin, along n. All methods take arrays, which are broadcast.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array, Base, Disc, Polygon
from objectmodels.geometry.support_points import is_within
from objectmodels.models.object_parts import Container, Opening

_STRIPS = 48
_EDGES = 0.5 - 0.5 * np.cos(np.pi * np.arange(_STRIPS + 1) / _STRIPS)
"""Where strips end, as shares of the cavity's length; narrow ones where a round one ends."""

_STEEP = 1e-6  # least cosine of a tilt, so that a strip does not lie along its plane
_LEAST_SLOPE = 1e-7  # least difference of depth over half a strip [m]
_NEAR = 1e-10  # precision of levels [m]
_MOST_STEPS, _HALVINGS = 60, 50


@dataclass(frozen=True)
class _Strips:
    """Upright slices of a cavity across a heading, shape (..., k).

    Attributes:
        along, across: the middle of each, along the heading and to the left of it [m].
        half: half its thickness [m].
        area: of its section [m²].
    """

    along: Array
    across: Array
    half: Array
    area: Array


@dataclass(frozen=True, eq=False)
class Vessel:
    """The cavity of a container.

    Attributes:
        section: horizontal section of the cavity, in B.
        floor, top: between which it reaches [m].
        opening: in its top.
    """

    section: Disc | Polygon
    floor: float
    top: float
    opening: Opening

    @classmethod
    def from_shape(cls, section: Base, top: float, container: Container) -> Vessel:
        """The cavity of a container of this outer section, the same at all heights, and top [m].

        Raises:
            ModelError: `bad_value` if the walls leave no cavity, the opening lies outside it, or
                the contents are more than it holds.
        """
        inner = _inset_section(section, container.wall)
        if inner is None or container.wall >= top:
            raise _container_error(
                "wall_m", f"walls of {container.wall} m leave no room inside", "give thinner walls"
            )
        opening = container.opening
        if not is_within(inner, np.array([opening.centre]), container.wall - opening.radius):
            raise _container_error(
                "opening",
                "the opening is not inside the walls",
                "give a smaller radius_m, or a centre nearer to [0, 0]",
            )
        vessel = cls(inner, container.wall, top, opening)
        if container.contents > vessel.capacity:
            litres = 1e3 * vessel.capacity
            raise _container_error(
                "contents_l",
                f"found {container.contents_l}, but it holds {litres:.3f} l",
                f"give at most {litres:.3f}",
            )
        return vessel

    @cached_property
    def capacity(self) -> float:
        """Volume that it holds standing upright [m³]."""
        return self._section_area * (self.top - self.floor)

    @property
    def _section_area(self) -> float:
        if isinstance(self.section, Disc):
            return float(np.pi * self.section.radius**2)
        return self.section.area

    # -- the lip ---------------------------------------------------------------------------------

    def lip_point(self, heading: ArrayLike) -> Array:
        """The lowest point of the opening's rim when it leans, in B, shape (..., 3) [m]."""
        u = _unit_vector(heading)
        rim = np.array(self.opening.centre) + self.opening.radius * u
        return np.concatenate([rim, np.full((*rim.shape[:-1], 1), self.top)], axis=-1)

    def lip_height(self, tilt: ArrayLike, heading: ArrayLike) -> Array:
        """Height of the lip above B's origin [m]."""
        u, tilt = _unit_vector(heading), np.asarray(tilt, float)
        along = u @ np.array(self.opening.centre) + self.opening.radius
        return np.asarray(self.top * np.cos(tilt) - along * np.sin(tilt))

    # -- volumes and levels ----------------------------------------------------------------------

    def brim(self, tilt: ArrayLike, heading: ArrayLike) -> Array:
        """Volume that it holds when it leans so [m³]."""
        tilt, heading = np.broadcast_arrays(np.asarray(tilt, float), np.asarray(heading, float))
        strips = self._section_strips(heading)
        return self._volume_below(self.lip_height(tilt, heading), tilt, strips)[0]

    def surface_level(self, volume: ArrayLike, tilt: ArrayLike, heading: ArrayLike) -> Array:
        """Height of the surface of a volume above B's origin [m].

        What does not fit into the cavity stands on top of its opening.
        """
        volume, tilt, heading = _broadcast_arrays(volume, tilt, heading)
        inside = np.clip(volume, 0.0, self.capacity)
        level = self._solve_level(inside, tilt, self._section_strips(heading))
        over = (volume - inside) / (np.pi * self.opening.radius**2)
        return np.asarray(level + over)

    def liquid_head(self, volume: ArrayLike, tilt: ArrayLike, heading: ArrayLike) -> Array:
        """Height of the surface above the lip; nothing runs out up to zero [m]."""
        return self.surface_level(volume, tilt, heading) - self.lip_height(tilt, heading)

    def centroid(self, volume: ArrayLike, tilt: ArrayLike, heading: ArrayLike) -> Array:
        """Centre of a volume that it holds, in B, shape (..., 3) [m].

        Of no volume at all: the lowest place.
        """
        volume, tilt, heading = _broadcast_arrays(volume, tilt, heading)
        strips = self._section_strips(heading)
        least = 1e-9 * self.capacity
        level = self._solve_level(np.clip(volume, least, self.capacity), tilt, strips)
        x, d, cos = self._strip_depths(level, tilt, strips)
        length = self._inner_height
        filled = strips.area * _strip_mean(_ramp_integral, x, d, length)
        total = filled.sum(axis=-1)
        s = (strips.along * filled).sum(axis=-1) / total
        t = (strips.across * filled).sum(axis=-1) / total
        # Filled from the end that is lower.
        rise = (strips.area * _strip_mean(_moment_integral, x, d, length)).sum(axis=-1) / total
        z = np.where(cos[..., 0] > 0.0, self.floor + rise, self.top - rise)
        u = _unit_vector(heading)
        return np.stack([s * u[..., 0] - t * u[..., 1], s * u[..., 1] + t * u[..., 0], z], axis=-1)

    def spill_angle(self, volume: ArrayLike, heading: ArrayLike) -> Array:
        """Tilt at which a volume begins to run out; π if there is nothing in it [rad]."""
        volume, heading = np.broadcast_arrays(np.asarray(volume, float), np.asarray(heading, float))
        return np.asarray(np.where(volume > 0.0, self.tilt_holding(volume, heading), np.pi))

    def tilt_holding(self, volume: ArrayLike, heading: ArrayLike) -> Array:
        """Least tilt at which it holds no more than a volume [rad]."""
        volume, heading = np.broadcast_arrays(np.asarray(volume, float), np.asarray(heading, float))
        strips = self._section_strips(heading)

        def holds_more(tilt: Array) -> NDArray[np.bool_]:
            brim = self._volume_below(self.lip_height(tilt, heading), tilt, strips)[0]
            return brim > volume * (1.0 + 1e-12)

        tilt = _bisect(holds_more, np.zeros(volume.shape), np.full(volume.shape, np.pi))
        return np.where(volume >= self.capacity, 0.0, tilt)

    # -- strips ----------------------------------------------------------------------------------

    @property
    def _inner_height(self) -> float:
        return self.top - self.floor

    def _section_strips(self, heading: Array) -> _Strips:
        u = _unit_vector(heading)
        ahead, behind = self.section.extent(u), self.section.extent(-u)
        edges = -behind[..., None] + (ahead + behind)[..., None] * _EDGES
        along = 0.5 * (edges[..., 1:] + edges[..., :-1])
        half = 0.5 * np.diff(edges)
        width, across = _section_chords(self.section, along, u)
        area = 2.0 * width * half
        area *= self._section_area / area.sum(axis=-1, keepdims=True)
        return _Strips(along, across, half, area)

    def _strip_depths(
        self, level: Array, tilt: Array, strips: _Strips
    ) -> tuple[Array, Array, Array]:
        """Length of each strip below a level, half its difference over the strip, and cos tilt."""
        cos = np.cos(tilt)[..., None]
        cos = np.where(cos < 0.0, np.minimum(cos, -_STEEP), np.maximum(cos, _STEEP))
        sin = np.sin(tilt)[..., None]
        lower = np.where(cos > 0.0, self.floor, self.top)
        x = (level[..., None] + strips.along * sin - lower * cos) / np.abs(cos)
        return x, np.maximum(strips.half * sin / np.abs(cos), _LEAST_SLOPE), cos

    def _volume_below(self, level: Array, tilt: Array, strips: _Strips) -> tuple[Array, Array]:
        """Volume below a level [m³], and how it grows with that: the area of the surface [m²]."""
        x, d, cos = self._strip_depths(level, tilt, strips)
        length = self._inner_height
        volume = (strips.area * _strip_mean(_ramp_integral, x, d, length)).sum(axis=-1)
        clipped = np.clip(x + d, 0.0, length) - np.clip(x - d, 0.0, length)
        return volume, (strips.area * clipped / (2.0 * d * np.abs(cos))).sum(axis=-1)

    def _solve_level(self, volume: Array, tilt: Array, strips: _Strips) -> Array:
        """Newton's method inside a bracket that shrinks with every step."""
        ends = np.stack((strips.along[..., 0] - strips.half[..., 0],
                         strips.along[..., -1] + strips.half[..., -1]))  # fmt: skip
        heights = [
            z * np.cos(tilt) - s * np.sin(tilt) for z in (self.floor, self.top) for s in ends
        ]
        low, high = np.min(heights, axis=0), np.max(heights, axis=0)
        level = low + (high - low) * volume / self.capacity
        for _ in range(_MOST_STEPS):
            below, area = self._volume_below(level, tilt, strips)
            high = np.where(below > volume, level, high)
            low = np.where(below > volume, low, level)
            with np.errstate(divide="ignore", invalid="ignore"):
                step = level + (volume - below) / area
            inside = (step >= low) & (step <= high)
            after = np.where(inside, step, 0.5 * (low + high))
            done = np.abs(after - level) < _NEAR
            level = after
            if done.all():
                break
        return np.asarray(level)


def _container_error(path: str, message: str, hint: str) -> ModelError:
    return ModelError("bad_value", message, path=f"container.{path}", suggestions=(hint,))


def _unit_vector(heading: ArrayLike) -> Array:
    heading = np.asarray(heading, dtype=np.float64)
    return np.stack([np.cos(heading), np.sin(heading)], axis=-1)


def _broadcast_arrays(*values: ArrayLike) -> tuple[Array, ...]:
    return tuple(np.broadcast_arrays(*(np.asarray(value, dtype=np.float64) for value in values)))


def _inset_section(section: Base, wall: float) -> Disc | Polygon | None:
    """A section without its walls; None if nothing is left."""
    if isinstance(section, Disc):
        return Disc(section.radius - wall) if section.radius > wall else None
    assert isinstance(section, Polygon)
    corners = section.vertices
    for normal, offset in zip(section.normals, section.offsets - wall, strict=True):
        corners = _cut_polygon(corners, corners @ normal - offset)
        if len(corners) < 3:
            return None
    return Polygon(corners)


def _cut_polygon(corners: Array, outside: Array) -> Array:
    """The part of a convex polygon at whose points `outside` is not positive."""
    kept = []
    for a, b, p, q in zip(
        corners, np.roll(corners, -1, axis=0), outside, np.roll(outside, -1), strict=True
    ):
        if p <= 0.0:
            kept.append(a)
        if p * q < 0.0:
            kept.append(a + p / (p - q) * (b - a))
    return np.array(kept).reshape(-1, 2)


def _section_chords(section: Disc | Polygon, along: Array, u: Array) -> tuple[Array, Array]:
    """Widths of a section across unit directions u (..., 2) and their middles, shape (..., k)."""
    if isinstance(section, Disc):
        half = np.sqrt(np.maximum(section.radius**2 - along * along, 0.0))
        return 2.0 * half, np.zeros_like(half)
    v = np.stack([-u[..., 1], u[..., 0]], axis=-1)
    ahead, aside = (w @ section.normals.T for w in (u, v))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        bound = (section.offsets - along[..., None] * ahead[..., None, :]) / aside[..., None, :]
    left = np.where(aside[..., None, :] > 1e-12, bound, np.inf).min(axis=-1)
    right = np.where(aside[..., None, :] < -1e-12, bound, -np.inf).max(axis=-1)
    return np.maximum(left - right, 0.0), 0.5 * (left + right)


def _strip_mean(
    integral: Callable[[Array, float], Array], x: Array, d: Array, length: float
) -> Array:
    """Mean of a function between x − d and x + d, from its integral."""
    return np.asarray((integral(x + d, length) - integral(x - d, length)) / (2.0 * d))


def _ramp_integral(x: Array, length: float) -> Array:
    """Integral of clip(x, 0, length)."""
    inside = np.clip(x, 0.0, length)
    return np.asarray(0.5 * inside * inside + length * np.maximum(x - length, 0.0))


def _moment_integral(x: Array, length: float) -> Array:
    """Integral of clip(x, 0, length)² / 2."""
    inside = np.clip(x, 0.0, length)
    return np.asarray(inside**3 / 6.0 + 0.5 * length**2 * np.maximum(x - length, 0.0))


def _bisect(beyond: Callable[[Array], NDArray[np.bool_]], low: Array, high: Array) -> Array:
    """Last value at which a condition that holds at first still holds, by halving."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        still = beyond(middle)
        low, high = np.where(still, middle, low), np.where(still, high, middle)
    return high

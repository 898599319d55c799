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
from objectmodels.models.vessel_strips import VesselStrips, section_area

_HALVINGS = 50


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
        return section_area(self.section) * (self.top - self.floor)

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
        lip = self.lip_height(tilt, heading)
        return self.strips(heading).at_tilt(tilt).volume_below(lip)[0]

    def surface_level(
        self,
        volume: ArrayLike,
        tilt: ArrayLike,
        heading: ArrayLike,
        strips: VesselStrips | None = None,
        near: Array | None = None,
    ) -> Array:
        """Height of the surface of a volume above B's origin [m].

        What does not fit into the cavity stands on top of its opening. `strips` are those of the
        headings, where they are at hand; `near` is a guess, for speed.
        """
        volume, tilt, heading = _broadcast_arrays(volume, tilt, heading)
        inside = np.clip(volume, 0.0, self.capacity)
        level = (strips or self.strips(heading)).at_tilt(tilt).level_of(inside, near)
        over = (volume - inside) / (np.pi * self.opening.radius**2)
        return np.asarray(level + over)

    def liquid_head(
        self,
        volume: ArrayLike,
        tilt: ArrayLike,
        heading: ArrayLike,
        strips: VesselStrips | None = None,
        near: Array | None = None,
    ) -> Array:
        """Height of the surface above the lip; nothing runs out up to zero [m].

        Strips and a guess of the height as of `surface_level`.
        """
        lip = self.lip_height(tilt, heading)
        return (
            self.surface_level(volume, tilt, heading, strips, None if near is None else lip + near)
            - lip
        )

    def centroid(self, volume: ArrayLike, tilt: ArrayLike, heading: ArrayLike) -> Array:
        """Centre of a volume that it holds, in B, shape (..., 3) [m].

        Of no volume at all: the lowest place.
        """
        volume, tilt, heading = _broadcast_arrays(volume, tilt, heading)
        strips = self.strips(heading).at_tilt(tilt)
        level = strips.level_of(np.clip(volume, 1e-9 * self.capacity, self.capacity))
        s, t, z = strips.centroid(level)
        u = _unit_vector(heading)
        return np.stack([s * u[..., 0] - t * u[..., 1], s * u[..., 1] + t * u[..., 0], z], axis=-1)

    def spill_angle(self, volume: ArrayLike, heading: ArrayLike) -> Array:
        """Tilt at which a volume begins to run out; π if there is nothing in it [rad]."""
        volume, heading = np.broadcast_arrays(np.asarray(volume, float), np.asarray(heading, float))
        return np.asarray(np.where(volume > 0.0, self.tilt_holding(volume, heading), np.pi))

    def tilt_holding(self, volume: ArrayLike, heading: ArrayLike) -> Array:
        """Least tilt at which it holds no more than a volume [rad]."""
        volume, heading = np.broadcast_arrays(np.asarray(volume, float), np.asarray(heading, float))
        strips = self.strips(heading)

        def holds_more(tilt: Array) -> NDArray[np.bool_]:
            brim = strips.at_tilt(tilt).volume_below(self.lip_height(tilt, heading))[0]
            return brim > volume * (1.0 + 1e-12)

        tilt = _bisect(holds_more, np.zeros(volume.shape), np.full(volume.shape, np.pi))
        return np.where(volume >= self.capacity, 0.0, tilt)

    def strips(self, heading: ArrayLike) -> VesselStrips:
        """Strips across headings, shape (...) [rad]."""
        u = _unit_vector(heading)
        return VesselStrips.across_headings(self.section, u, self.capacity, self.floor, self.top)


def _container_error(path: str, message: str, hint: str) -> ModelError:
    return ModelError("bad_value", message, path=f"container.{path}", suggestions=(hint,))


def _unit_vector(heading: ArrayLike) -> Array:
    """Directions in x, y of headings (...) [rad], shape (..., 2)."""
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


def _bisect(beyond: Callable[[Array], NDArray[np.bool_]], low: Array, high: Array) -> Array:
    """Last value at which a condition that holds at first still holds, by halving."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        still = beyond(middle)
        low, high = np.where(still, middle, low), np.where(still, high, middle)
    return high

"""Upright strips of a cavity across the direction in which it leans, and what of them is filled.

Frame and method: see `objectmodels.models.vessel`. All methods take arrays of one shape (...).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from objectmodels.geometry.base_shapes import Array, Disc, Polygon

_STRIPS = 48
_EDGES = 0.5 - 0.5 * np.cos(np.pi * np.arange(_STRIPS + 1) / _STRIPS)
"""Where strips end, as shares of the cavity's length; narrow ones where a round one ends."""

_STEEP = 1e-6  # least cosine of a tilt, so that a strip does not lie along its plane
_LEAST_SLOPE = 1e-7  # least difference of depth over half a strip [m]
_NEAR = 1e-10  # precision of levels [m]
_MOST_STEPS = 60


@dataclass(frozen=True)
class VesselStrips:
    """Upright slices of a cavity across a heading, shape (..., k).

    Attributes:
        along, across: the middle of each, along the heading and to the left of it [m].
        half: half its thickness [m].
        area: of its section [m²].
        capacity: volume of them all [m³].
        floor, top: between which the cavity reaches [m].
    """

    along: Array
    across: Array
    half: Array
    area: Array
    capacity: float
    floor: float
    top: float

    @classmethod
    def across_headings(
        cls, section: Disc | Polygon, u: Array, capacity: float, floor: float, top: float
    ) -> VesselStrips:
        """The strips of a cavity of one section all the way up, across unit vectors u (..., 2)."""
        ahead, behind = section.extent(u), section.extent(-u)
        edges = -behind[..., None] + (ahead + behind)[..., None] * _EDGES
        along = 0.5 * (edges[..., 1:] + edges[..., :-1])
        half = 0.5 * np.diff(edges)
        width, across = _section_chords(section, along, u)
        area = 2.0 * width * half
        area *= section_area(section) / area.sum(axis=-1, keepdims=True)
        return cls(along, across, half, area, capacity, floor, top)

    def at_tilt(self, tilt: Array) -> TiltedStrips:
        """The strips with the cavity at tilts (...) [rad]."""
        return TiltedStrips(self, tilt)


class TiltedStrips:
    """Strips of a cavity that is kept at a tilt, while its level changes.

    Whatever does not depend on the level is worked out once.
    """

    def __init__(self, strips: VesselStrips, tilt: Array) -> None:
        self._strips = strips
        self._length = strips.top - strips.floor
        self._cos, self._sin = np.cos(tilt), np.sin(tilt)
        cos, sin = self._cos[..., None], self._sin[..., None]
        self._axis = np.where(cos < 0.0, np.minimum(cos, -_STEEP), np.maximum(cos, _STEEP))
        self._steep = np.abs(self._axis)
        self._raised = strips.along * sin
        self._lower = np.where(self._axis > 0.0, strips.floor, strips.top) * self._axis
        self._slope = np.maximum(strips.half * sin / self._steep, _LEAST_SLOPE)
        self._span = 2.0 * self._slope

    def volume_below(self, level: Array) -> tuple[Array, Array]:
        """Volume below a level [m³], and how it grows with that: the area of the surface [m²]."""
        x, area, length = self._depths(level), self._strips.area, self._length
        deep, shallow = x + self._slope, x - self._slope
        below = np.minimum(np.maximum(deep, 0.0), length)
        above = np.minimum(np.maximum(shallow, 0.0), length)
        filled = 0.5 * below * below + length * np.maximum(deep - length, 0.0)
        empty = 0.5 * above * above + length * np.maximum(shallow - length, 0.0)
        volume = (area * ((filled - empty) / self._span)).sum(axis=-1)
        return volume, (area * (below - above) / (self._span * self._steep)).sum(axis=-1)

    def level_of(self, volume: Array, near: Array | None = None) -> Array:
        """Level below which there is a volume [m]; Newton's method in a bracket that shrinks.

        It begins at the levels `near`, if given.
        """
        s = self._strips
        ends = s.along[..., 0] - s.half[..., 0], s.along[..., -1] + s.half[..., -1]
        heights = [z * self._cos - end * self._sin for z in (s.floor, s.top) for end in ends]
        low, high = np.min(heights, axis=0), np.max(heights, axis=0)
        level = low + (high - low) * volume / s.capacity
        if near is not None:
            level = np.clip(near, low, high)
        with np.errstate(divide="ignore", invalid="ignore"):
            for _ in range(_MOST_STEPS):
                below, area = self.volume_below(level)
                high = np.where(below > volume, level, high)
                low = np.where(below > volume, low, level)
                step = level + (volume - below) / area
                inside = (step >= low) & (step <= high)
                after = np.where(inside, step, 0.5 * (low + high))
                done = np.abs(after - level) < _NEAR
                level = after
                if done.all():
                    break
        return np.asarray(level)

    def centroid(self, level: Array) -> tuple[Array, Array, Array]:
        """Centre of what is below a level: along the heading, across it, and height in B [m]."""
        s, x, d = self._strips, self._depths(level), self._slope
        filled = s.area * _strip_mean(_ramp_integral, x, d, self._length)
        total = filled.sum(axis=-1)
        # Filled from the end that is lower.
        rise = (s.area * _strip_mean(_moment_integral, x, d, self._length)).sum(axis=-1) / total
        height = np.where(self._axis[..., 0] > 0.0, s.floor + rise, s.top - rise)
        along, across = ((middle * filled).sum(axis=-1) / total for middle in (s.along, s.across))
        return along, across, height

    def _depths(self, level: Array) -> Array:
        """Length of each strip below a level, in its middle [m]."""
        return np.asarray((level[..., None] + self._raised - self._lower) / self._steep)


def section_area(section: Disc | Polygon) -> float:
    """Area of a section [m²]."""
    return float(np.pi * section.radius**2) if isinstance(section, Disc) else section.area


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

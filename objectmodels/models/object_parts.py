"""Parts of an object besides its shape: contents, a lid, places to hold it by.

Model files state them in blocks of their own (`container:`, `lid:`, `grasp:`), strictly and with
units in the keys, on whatever kind of shape. What follows from them is computed elsewhere:
`objectmodels.models.object_parts` (levels, spilling), `objectmodels.containers.pour_dynamics`,
`objectmodels.containers.lids` (forces of lids) and `objectmodels.mechanics.grasp_stability`.

Frame: B, at the centre of the base, z up.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BeforeValidator, ConfigDict, Field

from objectmodels.errors import ModelError
from objectmodels.files.yaml_documents import (
    Angle,
    Coordinate,
    Density,
    Deviation,
    Force,
    Height,
    Length,
    Mass,
    OpeningAngle,
    Squeeze,
    Torque,
    Turns,
    Volume,
)
from objectmodels.geometry.base_shapes import Array, Base, Polygon
from objectmodels.geometry.rotations import as_tuple
from objectmodels.short_repr import ShortRepr

Point2 = Annotated[tuple[Coordinate, Coordinate], BeforeValidator(as_tuple)]


class Part(ShortRepr):
    """A block of a model file: nothing unknown, nothing converted, nothing changed later."""

    model_config = ConfigDict(
        defer_build=True,
        frozen=True,
        extra="forbid",
        strict=True,
        allow_inf_nan=False,
        validate_by_name=True,
        validate_by_alias=True,
        serialize_by_alias=True,
    )


class Opening(Part):
    """A round hole in the top, at the height of the object's top; its rim is the lip.

    Attributes:
        centre: in B's x, y [m].
        radius: of the hole [m].
    """

    centre: Annotated[Point2, Field(alias="centre_m")] = (0.0, 0.0)
    radius: Annotated[Length, Field(alias="radius_m")]


class Container(Part):
    """An object that is hollow, and what is in it.

    The cavity is the object's shape without its walls; its mass includes the contents.

    Attributes:
        wall: thickness of walls and floor [m].
        opening: where contents come out.
        contents_l, contents_l_sd: volume of the liquid in it, in litres.
        density: of the liquid [kg/m³].
    """

    wall: Annotated[Length, Field(alias="wall_m")]
    opening: Opening
    contents_l: Volume = 0.0
    contents_l_sd: Deviation = 0.0
    # Density of what is not said to be anything else [kg/m³].
    density: Annotated[Density, Field(alias="density_kg_m3")] = 1000.0

    @property
    def contents(self) -> float:
        """Volume of the liquid [m³]."""
        return 1e-3 * self.contents_l

    @property
    def contents_sd(self) -> float:
        """Its standard deviation [m³]."""
        return 1e-3 * self.contents_l_sd

    @property
    def mass(self) -> float:
        """Mass of the liquid [kg]."""
        return self.density * self.contents


class Cavity(Part):
    """Inside of an open box: a cuboid in the middle of it, without a ceiling.

    Attributes:
        size: extents along B's x and y, between the walls [m].
        floor: height of its floor over the base [m].
    """

    size: Annotated[tuple[Length, Length], BeforeValidator(as_tuple), Field(alias="size_m")]
    floor: Annotated[Length, Field(alias="floor_m")]


class FlipLid(Part):
    """A lid on a hinge at the rim, with a tab at the other side that a fingertip gets under.

    The hinge resists by Coulomb friction, the catch by a torque that fades linearly with the
    opening angle.

    Attributes:
        mass: of the lid [kg]; the object's mass includes it.
        tab_heading_deg: direction from the hinge to the tab, from B's x axis [degrees].
        tab: how far the tab stands out over the rim [m].
        friction_torque, snap_torque: of hinge and closed catch [N·m].
        snap_angle_deg: opening at which the catch no longer holds [degrees].
        opens_to_deg: largest opening [degrees].
    """

    kind: Literal["flip"] = "flip"
    mass: Annotated[Mass, Field(alias="mass_kg")]
    tab_heading_deg: Angle = 0.0
    tab: Annotated[Length, Field(alias="tab_m")]
    friction_torque: Annotated[Torque, Field(alias="friction_torque_nm")]
    friction_torque_sd: Annotated[Deviation, Field(alias="friction_torque_nm_sd")] = 0.0
    snap_torque: Annotated[Torque, Field(alias="snap_torque_nm")] = 0.0
    snap_torque_sd: Annotated[Deviation, Field(alias="snap_torque_nm_sd")] = 0.0
    snap_angle_deg: OpeningAngle = 3.0
    opens_to_deg: OpeningAngle = 120.0

    @property
    def tab_heading(self) -> float:
        """Direction from the hinge to the tab, from B's x axis [rad]."""
        return math.radians(self.tab_heading_deg)

    @property
    def snap_angle(self) -> float:
        """Opening at which the catch no longer holds [rad]."""
        return math.radians(self.snap_angle_deg)

    @property
    def opens_to(self) -> float:
        """Largest opening [rad]."""
        return math.radians(self.opens_to_deg)

    def leaves_free(self, angle: float) -> bool:
        """Return True if contents get past it when it is open by an angle [rad]."""
        return angle > self.snap_angle


class LiftOffLid(Part):
    """A lid that sits on the rim and comes off straight up, against a retention force.

    It is held by its knob, a cylinder on top of it.

    Attributes:
        mass: of the lid [kg]; the object's mass includes it.
        retention: force that pulls it off the rim, besides its weight [N].
        travel: over which it is retained [m].
        radius, height: of the disc that covers the rim [m].
        knob_radius, knob_height: of the knob [m].
    """

    kind: Literal["lift_off"] = "lift_off"
    mass: Annotated[Mass, Field(alias="mass_kg")]
    retention: Annotated[Force, Field(alias="retention_n")]
    retention_sd: Annotated[Deviation, Field(alias="retention_n_sd")] = 0.0
    travel: Annotated[Length, Field(alias="travel_m")] = 0.005
    radius: Annotated[Length, Field(alias="radius_m")]
    height: Annotated[Length, Field(alias="height_m")] = 0.006
    knob_radius: Annotated[Length, Field(alias="knob_radius_m")]
    knob_height: Annotated[Length, Field(alias="knob_height_m")]

    def leaves_free(self, height: float) -> bool:
        """Return True if contents get past it when it is lifted by a height [m]."""
        return height > self.travel


class ScrewCap(Part):
    """A cap on a thread: it turns against a friction torque, and is off after some turns.

    Attributes:
        mass: of the cap [kg]; the object's mass includes it.
        friction_torque: that turns it [N·m].
        pitch: rise per turn [m].
        turns: until it is off.
        radius, height: of the cap, a cylinder on the object's top [m].
    """

    kind: Literal["screw"] = "screw"
    mass: Annotated[Mass, Field(alias="mass_kg")]
    friction_torque: Annotated[Torque, Field(alias="friction_torque_nm")]
    friction_torque_sd: Annotated[Deviation, Field(alias="friction_torque_nm_sd")] = 0.0
    pitch: Annotated[Length, Field(alias="pitch_m")] = 0.003
    turns: Turns = 1.0
    radius: Annotated[Length, Field(alias="radius_m")]
    height: Annotated[Length, Field(alias="height_m")]

    def leaves_free(self, angle: float) -> bool:
        """Return True if contents get past it, turned by an angle [rad]: once it is off."""
        return angle >= 2.0 * math.pi * self.turns


Lid = Annotated[FlipLid | LiftOffLid | ScrewCap, Field(discriminator="kind")]


class Graspable(Part):
    """Places by which a hand may hold the object, and the squeeze that it bears.

    Attributes:
        lowest, highest: heights between which it may be touched [m].
        crush: largest squeeze that it bears [N].
    """

    lowest: Annotated[Height, Field(alias="from_m")] = 0.0
    highest: Annotated[Length, Field(alias="to_m")]
    crush: Annotated[Squeeze, Field(alias="crush_n")]


# Open boxes: cuboids that are hollow from above, in which other objects may stand.
#
# Model: four walls from the base to the rim, and a floor between them. Frame: B, at the centre of
# the base, z up.

Extent = tuple[float, float, float]


def open_box_parts(size: Extent, inside: Cavity) -> tuple[tuple[Array, Array], ...]:
    """The five cuboids of which an open box consists, the floor first.

    Args:
        size: of the whole box along x, y, z [m].
        inside: its cavity.

    Returns:
        Of each the corner of least coordinates and the opposite one in B, shape (3,) [m].
    """
    (x, y), (u, v) = np.array(size[:2]) / 2.0, np.array(inside.size) / 2.0
    high = size[2]
    spans = (
        ((-u, u), (-v, v), inside.floor),
        ((-x, -u), (-y, y), high),
        ((u, x), (-y, y), high),
        ((-u, u), (-y, -v), high),
        ((-u, u), (v, y), high),
    )
    return tuple(
        (np.array([left, near, 0.0]), np.array([right, far, top]))
        for (left, right), (near, far), top in spans
    )


def inner_floor(inside: Cavity) -> Polygon:
    """The floor of a cavity, seen from above in B."""
    return Polygon.rectangle(*inside.size)


def require_open_box(size: Extent, inside: Cavity) -> None:
    """Make sure that a box so large along x, y, z [m] has walls and a floor around a cavity.

    Raises:
        ModelError: `bad_value`.
    """
    inner = (("size_m", inside.size[0]), ("size_m", inside.size[1]), ("floor_m", inside.floor))
    for (key, length), own in zip(inner, size, strict=True):
        if length >= own:
            raise cavity_error(
                f".{key}", f"{length:g} m leave no wall in {own:g} m", "give it less than the box"
            )


def cavity_error(key: str, message: str, hint: str) -> ModelError:
    """Error of a model's block `inside`, or of a key in it."""
    return ModelError("bad_value", message, path=f"inside{key}", suggestions=(hint,))


# Upright strips of a cavity across the direction in which it leans, and what of them is filled.
#
# Frame and method: see `objectmodels.models.object_parts`. All methods take arrays of one shape
# (...).

_STRIPS = 48
_EDGES = 0.5 - 0.5 * np.cos(np.pi * np.arange(_STRIPS + 1) / _STRIPS)
"""Where strips end, as shares of the cavity's length; narrow ones where a round one ends."""

_STEEP = 1e-6  # least cosine of a tilt, so that a strip does not lie along its plane
_NEAR = 1e-10  # precision of levels [m]


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
        cls, section: Base, u: Array, capacity: float, floor: float, top: float
    ) -> VesselStrips:
        """The strips of a cavity of one section all the way up, across unit vectors u (..., 2)."""
        ahead, behind = section.extent(u), section.extent(-u)
        edges = -behind[..., None] + (ahead + behind)[..., None] * _EDGES
        along = 0.5 * (edges[..., 1:] + edges[..., :-1])
        half = 0.5 * np.diff(edges)
        width, across = section.chords(along, u)
        area = 2.0 * width * half
        area *= section.area / area.sum(axis=-1, keepdims=True)
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
        # Least difference of depth over half a strip [m].
        self._slope = np.maximum(strips.half * sin / self._steep, 1e-7)
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
            for _ in range(60):
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


# A hollow object that leans: how much it holds, how high its liquid stands, where that lies.
#
# Model: the cavity is an upright prism (over a convex polygon or a disc), the shape without its
# walls and floor; it reaches up to the object's top, in which there is one round opening. The
# liquid is at rest with a horizontal surface; air gets in and out as it likes. What stands above
# the lowest point of the opening's rim, the lip, runs out.
#
# Method: the cavity is cut into upright strips across the direction in which it leans. What of a
# strip is below a horizontal plane follows in closed form if the strip's width is constant, so a
# box that leans along a side is exact; of other shapes the volume is right to 0.1 %.
#
# Frame: B, at the centre of the base, z up along the object's axis. It leans by `tilt` towards
# `heading`, a direction in B's x, y; the upward vertical in B is n = (−sin tilt · heading, cos
# tilt). Heights are those above B's origin, along n. All methods take arrays, which are
# broadcast.

_HALVINGS = 50


@dataclass(frozen=True, eq=False)
class Vessel:
    """The cavity of a container.

    Attributes:
        section: horizontal section of the cavity, in B.
        floor, top: between which it reaches [m].
        opening: in its top.
    """

    section: Base
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
        inner = section.inset(container.wall)
        if inner is None or container.wall >= top:
            raise _container_error(
                "wall_m", f"walls of {container.wall} m leave no room inside", "give thinner walls"
            )
        opening = container.opening
        if not inner.contains(np.array([opening.centre]), container.wall - opening.radius):
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
        return self.section.area * (self.top - self.floor)

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

    def brim(self, tilt: ArrayLike, heading: ArrayLike) -> Array:
        """Volume that it holds when it leans so [m³]."""
        tilt, heading = _broadcast_arrays(tilt, heading)
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
        volume, heading = _broadcast_arrays(volume, heading)
        return np.asarray(np.where(volume > 0.0, self.tilt_holding(volume, heading), np.pi))

    def tilt_holding(self, volume: ArrayLike, heading: ArrayLike) -> Array:
        """Least tilt at which it holds no more than a volume [rad]."""
        volume, heading = _broadcast_arrays(volume, heading)
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


def _bisect(beyond: Callable[[Array], NDArray[np.bool_]], low: Array, high: Array) -> Array:
    """Last value at which a condition that holds at first still holds, by halving."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        still = beyond(middle)
        low, high = np.where(still, middle, low), np.where(still, high, middle)
    return high

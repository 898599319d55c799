"""Parts of an object besides its shape: contents, a lid, places to hold it by.

Model files state them in blocks of their own (`container:`, `lid:`, `grasp:`), strictly and with
units in the keys, on whatever kind of shape. What follows from them is computed elsewhere:
`objectmodels.models.vessel` (levels, spilling), `objectmodels.containers.pour_dynamics`,
`objectmodels.containers.lid_forces` (forces of lids) and `objectmodels.mechanics.grasp_stability`.

Frame: B, at the centre of the base, z up.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from objectmodels.files.value_types import (
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
from objectmodels.geometry.vector_arrays import as_tuple

WATER = 1000.0
"""Density of what is not said to be anything else [kg/m³]."""

Point2 = Annotated[tuple[Coordinate, Coordinate], BeforeValidator(as_tuple)]


class Part(BaseModel):
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
    density: Annotated[Density, Field(alias="density_kg_m3")] = WATER

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

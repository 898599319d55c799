"""Lids as bodies of the simulated world.

Model: each lid is a body L on a joint with Coulomb friction (an actuator of hardly any stiffness,
strong damping and the friction as its largest effort; Drake ignores the friction of joints):

- a flip lid on a hinge, which ends at its largest opening;
- a lift-off lid on a seat that slides along B_z against the retention;
- a screw cap on a seat that turns on a thread.

The lid is a free body that a constraint welds to its seat until it is off
(`sim.worlds.drake.lid_mechanics`). The two share its mass while it is on, because a solver is stiff
only about what has some mass.

A lid's solid touches fingers and other objects, but not its own one; one that may lie about stands
on small spheres under its rim.

Frame: L is B moved up to the object's top, for a flip lid to its hinge, while the lid is closed.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.containers import lids
from objectmodels.geometry.base_shapes import Disc
from objectmodels.models.object_parts import FlipLid, Lid, LiftOffLid, ScrewCap
from sim.rotations import Array, rot_z
from sim.truth.scene_file import SceneObject
from sim.worlds.drake.body_contacts import surface

if TYPE_CHECKING:
    from pydrake.geometry import GeometryId, SceneGraph, Shape
    from pydrake.math import RigidTransform
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import (
        Frame,
        Joint,
        ModelInstanceIndex,
        MultibodyConstraintId,
        RigidBody,
        SpatialInertia,
    )

_CREEP = 1e-4  # speed at which the friction of a joint is reached [rad/s], [m/s]
_ROTOR = 1e-6  # keeps a light cap on its thread from being stiff to solve [kg m²]
_ON, _OFF = 0.5, 1e-3  # the seat's share of the lid's mass
_FOOT_RADIUS = 1e-3
_FEET = 8
_LID_COLOUR = np.array([0.93, 0.93, 0.90, 1.0])


@dataclass(frozen=True)
class LidBody:
    """A lid in a plant.

    Attributes:
        lid: how it is.
        body: its body.
        model: the model instance of lid and seat.
        joint: hinge, slide or thread.
        seat: on which one lies that comes off; else None.
        weld: that holds it to its seat.
        solids: what touches fingers and other objects.
        feet: what touches the table, and its own object once it is off.
        own: the solid of its object.
    """

    lid: Lid
    body: RigidBody
    model: ModelInstanceIndex
    joint: Joint
    seat: RigidBody | None
    weld: MultibodyConstraintId | None
    solids: list[GeometryId]
    feet: list[GeometryId]
    own: GeometryId


def add_lid(
    plant: MultibodyPlant, item: SceneObject, body: RigidBody, solid: GeometryId
) -> LidBody | None:
    """Adds the lid of an object with a body and a solid, closed; None if it has none."""
    from pydrake.math import RigidTransform

    lid = item.truth.lid
    if lid is None:
        return None
    name = lids.lid_name(item.name)
    model = plant.AddModelInstance(name)
    if isinstance(lid, FlipLid):
        return _add_flip_lid(plant, item, lid, body, solid, model)
    on_seat, on_lid = shared_inertia(lid, on=True)
    seat = plant.AddRigidBody(f"{name} seat", model, on_seat)
    covering = plant.AddRigidBody(name, model, on_lid)
    rim = _rim_frame(plant, name, body, (0.0, 0.0, item.truth.height))
    joint = _add_seat(plant, lid, rim, seat)
    weld = plant.AddWeldConstraint(seat, RigidTransform(), covering, RigidTransform())
    shapes = _shapes(lid)
    solids = [_add_solid(plant, covering, item, part, shape) for part, shape in shapes.items()]
    feet = _add_feet(plant, covering, item, lid.radius - _FOOT_RADIUS)
    return LidBody(lid, covering, model, joint, seat, weld, solids, feet, solid)


def _add_flip_lid(
    plant: MultibodyPlant,
    item: SceneObject,
    lid: FlipLid,
    body: RigidBody,
    solid: GeometryId,
    model: ModelInstanceIndex,
) -> LidBody:
    from pydrake.geometry import Box, Cylinder
    from pydrake.math import RigidTransform, RotationMatrix
    from pydrake.multibody.tree import RevoluteJoint

    name, rim = lids.lid_name(item.name), item.truth.rim
    hinge = lids.lid_hinge(lid, rim, item.truth.height)
    covering = plant.AddRigidBody(name, model, _disc_inertia(lid, hinge))
    axis = np.cross(hinge.out, [0.0, 0.0, 1.0])
    joint = plant.AddJoint(
        RevoluteJoint(
            f"{name} hinge",
            _rim_frame(plant, name, body, hinge.p_BH.tolist()),
            covering.body_frame(),
            axis,
            0.0,
            lid.opens_to,
        )
    )
    _add_friction(plant, joint, lid.friction_torque)
    across = rim.extent(np.array([axis[:2], -axis[:2]])).tolist()
    R_LT = rot_z(lid.tab_heading)
    plate: Shape = Box(hinge.reach, sum(across), lids.THICKNESS)
    if isinstance(rim, Disc):
        plate = Cylinder(rim.radius, lids.THICKNESS)
    tab_middle = hinge.reach + 0.5 * lid.tab
    shapes = {
        "disc": (plate, 0.5 * hinge.reach),
        "tab": (Box(lid.tab, lids.TAB_WIDTH, lids.THICKNESS), tab_middle),
    }
    solids = []
    for part, (shape, distance) in shapes.items():
        p = distance * hinge.out + [0.0, 0.0, 0.5 * lids.THICKNESS]
        X_LG = RigidTransform(RotationMatrix(R_LT), p)
        solids.append(_add_solid(plant, covering, item, part, (shape, X_LG)))
    return LidBody(lid, covering, model, joint, None, None, solids, [], solid)


def _rim_frame(plant: MultibodyPlant, name: str, body: RigidBody, p_B: Iterable[float]) -> Frame:
    from pydrake.math import RigidTransform
    from pydrake.multibody.tree import FixedOffsetFrame

    X_BF = RigidTransform(np.array(list(p_B)))
    return plant.AddFrame(FixedOffsetFrame(f"{name} rim", body.body_frame(), X_BF))


def _add_seat(
    plant: MultibodyPlant, lid: LiftOffLid | ScrewCap, rim: Frame, seat: RigidBody
) -> Joint:
    """The joint on which a lid comes off, closed at its lower end."""
    from pydrake.multibody.tree import PrismaticJoint, ScrewJoint

    up = np.array([0.0, 0.0, 1.0])
    name = f"{seat.name()} joint"
    if isinstance(lid, LiftOffLid):
        joint = plant.AddJoint(PrismaticJoint(name, rim, seat.body_frame(), up, 0.0, np.inf))
        _add_friction(plant, joint, lid.retention)
        return joint
    joint = plant.AddJoint(ScrewJoint(name, rim, seat.body_frame(), up, lid.pitch, 0.0))
    joint.set_position_limits([0.0], [np.inf])
    _add_friction(plant, joint, lid.friction_torque)
    return joint


def _add_friction(plant: MultibodyPlant, joint: Joint, friction: float) -> None:
    from pydrake.multibody.tree import PdControllerGains

    largest = max(friction, 1e-9)  # an actuator needs a limit
    actuator = plant.AddJointActuator(f"{joint.name()} friction", joint, largest)
    actuator.set_default_rotor_inertia(_ROTOR)
    actuator.set_controller_gains(PdControllerGains(p=1e-9, d=largest / _CREEP))


def _shapes(lid: LiftOffLid | ScrewCap) -> dict[str, tuple[Shape, RigidTransform]]:
    from pydrake.geometry import Cylinder
    from pydrake.math import RigidTransform

    def above(z: float) -> RigidTransform:
        return RigidTransform(np.array([0.0, 0.0, z]))

    shapes = {"disc": (Cylinder(lid.radius, lid.height), above(0.5 * lid.height))}
    if isinstance(lid, LiftOffLid):
        knob = Cylinder(lid.knob_radius, lid.knob_height)
        shapes["knob"] = knob, above(lid.height + 0.5 * lid.knob_height)
    return shapes


def _add_solid(
    plant: MultibodyPlant,
    body: RigidBody,
    item: SceneObject,
    part: str,
    shape: tuple[Shape, RigidTransform],
) -> GeometryId:
    solid, X_LG = shape
    plant.RegisterVisualGeometry(body, X_LG, solid, part, _LID_COLOUR)
    skin = surface(item.truth.friction_finger / 2)
    return plant.RegisterCollisionGeometry(body, X_LG, solid, part, skin)


def _add_feet(
    plant: MultibodyPlant, body: RigidBody, item: SceneObject, radius: float
) -> list[GeometryId]:
    from pydrake.geometry import Sphere
    from pydrake.math import RigidTransform

    skin = surface(item.truth.friction_table / 2)
    feet = []
    for k, turn in enumerate(2.0 * np.pi * np.arange(_FEET) / _FEET):
        p = np.array([radius * np.cos(turn), radius * np.sin(turn), _FOOT_RADIUS])
        foot = Sphere(_FOOT_RADIUS)
        feet.append(
            plant.RegisterCollisionGeometry(body, RigidTransform(p), foot, f"foot_{k}", skin)
        )
    return feet


def _disc_inertia(lid: FlipLid, hinge: lids.Hinge) -> SpatialInertia:
    p_LLcm = hinge.centre_of_mass(0.0) - hinge.p_BH
    return _cylinder_inertia(lid.mass, 0.5 * hinge.reach, lids.THICKNESS, p_LLcm)


def shared_inertia(
    lid: LiftOffLid | ScrewCap, *, on: bool
) -> tuple[SpatialInertia, SpatialInertia]:
    """Inertia in L of the seat and of the lid, whether it is on or off."""
    share = _ON if on else _OFF
    middle = np.array([0.0, 0.0, 0.5 * lid.height])
    seat, covering = (
        _cylinder_inertia(part * lid.mass, lid.radius, lid.height, middle)
        for part in (share, 1.0 - share)
    )
    return seat, covering


def _cylinder_inertia(mass: float, radius: float, height: float, p_cm: Array) -> SpatialInertia:
    from pydrake.multibody.tree import SpatialInertia, UnitInertia

    G_cm = UnitInertia.SolidCylinder(radius, height, np.array([0.0, 0.0, 1.0]))
    return SpatialInertia(mass, p_cm, G_cm.ShiftFromCenterOfMass(p_cm))


def filter_lids(
    scene_graph: SceneGraph,
    bodies: Iterable[LidBody],
    *,
    robot: list[GeometryId],
    table: GeometryId,
    feet: list[GeometryId],
) -> None:
    """Lids touch all but their own object, one that may lie about the table with its feet only."""
    from pydrake.geometry import CollisionFilterDeclaration, GeometrySet

    every = list(bodies)
    lid_feet = [foot for each in every for foot in each.feet]
    pairs = CollisionFilterDeclaration()
    for each in every:
        pairs.ExcludeWithin(GeometrySet([*each.solids, *each.feet, each.own]))
        pairs.ExcludeBetween(GeometrySet(each.solids), GeometrySet([*feet, *lid_feet]))
        if each.feet:
            pairs.ExcludeBetween(GeometrySet(each.solids), GeometrySet(table))
    pairs.ExcludeWithin(GeometrySet(lid_feet))
    pairs.ExcludeBetween(GeometrySet(lid_feet), GeometrySet([*robot, *feet]))
    scene_graph.collision_filter_manager().Apply(pairs)

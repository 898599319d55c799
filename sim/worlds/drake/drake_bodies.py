"""Bodies of the simulated world: contacts, lids, what stands on what, the table's edge.

Contacts: Drake combines two friction coefficients as 2ab/(a+b). Robot and table are given a huge
one, so a pair's coefficient is twice the object's own: half of the true coefficient is written to
it, and each object keeps its own friction against table and fingers.

Lids: each is a body L on a joint with Coulomb friction (an actuator of hardly any stiffness,
strong damping and the friction as its largest effort; Drake ignores the friction of joints):

- a flip lid on a hinge, which ends at its largest opening;
- a lift-off lid on a seat that slides along B_z against the retention;
- a screw cap on a seat that turns on a thread.

The lid is a free body that a constraint welds to its seat until it is off
(`sim.worlds.drake.contents`). The two share its mass while it is on, because a solver is stiff
only about what has some mass.

A lid's solid touches fingers and other objects, but not its own one; one that may lie about stands
on small spheres under its rim. Frame L is B moved up to the object's top, for a flip lid to its
hinge, while the lid is closed.

Stacks: two flat faces press on each other wherever they overlap, and Drake's point contact has
one point of two solids only. So each object has a slab besides, its solid a little drawn in at the
sides, which meets nothing but other slabs, in Drake's compliant hydroelastic contact. It stands out
at top and bottom, so that solids which are stacked do not meet. That of an open box is its floor.
Things that stand side by side touch with their solids, as if there were no slabs.

The table's edge: feet carry an object at single points, which do not tell where the table ends
between them. So the table has a rigid rim along each edge, level with its top, and each object a
sole of its own shape, which meets nothing but rims, in Drake's hydroelastic contact, with the
friction of its feet. Away from the edges nothing changes; over an edge an object stands on its feet
that the table has below them, and on the rim.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.containers import lids
from objectmodels.geometry.rotations import Array, rot_z
from objectmodels.models.object_parts import FlipLid, LiftOffLid, ScrewCap
from sim.robots.cell_description import Point3, Table
from sim.truth.object_truth import Truth
from sim.truth.scene_file import SceneObject
from sim.worlds.ports import BodyContact

if TYPE_CHECKING:
    from pydrake.geometry import GeometryId, ProximityProperties, SceneGraph, Shape
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
    from pydrake.systems.framework import Context


ROUGH = 1e9  # with this coefficient on one side, a pair has twice the other side's

APART = 1.0
"""The robot touches an object anew if it did not for so long; less is one touch that chatters [s].
"""

STANDS_OUT = 5e-5
"""How far a slab stands out at top and bottom [m]."""

_TABLE = "table"
_FOOT_RADIUS = 1e-3  # of a lid [m]
_EDGE_DISSIPATION = 200.0  # more holds fast what slides onto the rim [s/m]


def surface(friction: float) -> ProximityProperties:
    """Contact material of a body with a coefficient of friction."""
    from pydrake.geometry import AddContactMaterial, ProximityProperties
    from pydrake.multibody.plant import CoulombFriction

    properties = ProximityProperties()
    AddContactMaterial(
        dissipation=20.0,  # [s/m]
        point_stiffness=1e6,  # [N/m]
        friction=CoulombFriction(friction, friction),
        properties=properties,
    )
    return properties


class ContactWatch:
    """Touches of bodies, told when they begin.

    Bodies touch where their shapes overlap, as in the plant's own point contact. Asking for the
    shapes costs a twentieth of asking the plant for its contacts, since no forces are solved for.

    Args:
        plant: whose bodies they are; its world is the table.
        objects: names of the bodies that are objects; the others are the robot's.
        lids: names of the objects to whom bodies of other names belong. What touches a lid touches
            its object; a lid that lies on its object or on the table is not told.

    Attributes:
        begun: touches that began at the time noted last; objects standing on the table are not
            told.
    """

    def __init__(
        self,
        plant: MultibodyPlant,
        objects: Collection[str],
        lids: Mapping[str, str] | None = None,
    ) -> None:
        from pydrake.multibody.tree import BodyIndex

        self._shapes = plant.get_geometry_query_input_port()
        self._bodies = {
            geometry: plant.get_body(BodyIndex(i)).name() if i else _TABLE
            for i in range(plant.num_bodies())
            for geometry in plant.GetCollisionGeometriesForBody(plant.get_body(BodyIndex(i)))
        }
        self._objects = frozenset(objects)
        self._owner = {name: name for name in objects} | dict(lids or {})
        # What belongs together, or stands, is nothing to tell.
        self._untold = {
            pair
            for name, owner in self._owner.items()
            for pair in (
                (name, _TABLE),
                (_TABLE, name),
                *((name, other) for other, its in self._owner.items() if its == owner),
            )
        }
        self.begun: list[BodyContact] = []
        self._touching: dict[tuple[str, str], float] = {}
        self._by_robot: dict[str, float] = {}

    def note(self, time: float, context: Context) -> list[str]:
        """Takes in contacts at a time [s]; returns objects that the robot began to touch."""
        self.begun, anew = [], []
        for overlap in self._shapes.Eval(context).ComputePointPairPenetration():
            a, b = self._bodies[overlap.id_A], self._bodies[overlap.id_B]
            if (a, b) in self._untold:
                continue
            pair = (a, b) if a < b else (b, a)
            # What was apart for less is taken as having touched all the time.
            if time - self._touching.get(pair, -np.inf) > 0.1:
                self.begun.append(BodyContact(time, *pair))
            self._touching[pair] = time
            # Objects stand for their lids.
            touched = self._objects.intersection(self._owner.get(name, name) for name in pair)
            if len(touched) == 1:
                (name,) = touched
                if time - self._by_robot.get(name, -np.inf) > APART:
                    anew.append(name)
                self._by_robot[name] = time
        return anew

    def in_robot(self, context: Context) -> Iterator[tuple[str, float]]:
        """Names of the objects that are in the robot, and how deep [m]."""
        for overlap in self._shapes.Eval(context).ComputePointPairPenetration():
            pair = {self._bodies[overlap.id_A], self._bodies[overlap.id_B]} - {_TABLE}
            owners = {self._owner[name] for name in pair if name in self._owner}
            if len(pair) == 2 and len(owners) == 1 and not pair <= self._owner.keys():
                yield *owners, overlap.depth


@dataclass(frozen=True)
class LidBody:
    """A lid in a plant.

    Attributes:
        body: its body.
        model: the model instance of lid and seat.
        joint: hinge, slide or thread.
        solids: what touches fingers and other objects.
        own: the solid of its object.
        seat: on which one lies that comes off; else None.
        weld: that holds it to its seat.
        feet: what touches the table, and its own object once it is off.
        off_from: position of the joint beyond which it comes off [m], [rad].
        slides: whether it slides off along the joint.
        on: inertia in L of seat and lid while it is on.
        off: the same once it is off.
        catch_torque: of the closed catch of one that snaps shut [N·m].
        catch_angle: opening at which the catch no longer holds [rad].
    """

    body: RigidBody
    model: ModelInstanceIndex
    joint: Joint
    solids: list[GeometryId]
    own: GeometryId
    seat: RigidBody | None = None
    weld: MultibodyConstraintId | None = None
    feet: Sequence[GeometryId] = ()
    off_from: float = math.inf
    slides: bool = False
    on: Sequence[SpatialInertia] = ()
    off: Sequence[SpatialInertia] = ()
    catch_torque: float = 0.0
    catch_angle: float = math.inf


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
    on, off = (_shared_inertia(lid, on=is_on) for is_on in (True, False))
    seat = plant.AddRigidBody(f"{name} seat", model, on[0])
    covering = plant.AddRigidBody(name, model, on[1])
    rim = _rim_frame(plant, name, body, (0.0, 0.0, item.truth.shape.top))
    joint = _add_seat(plant, lid, rim, seat)
    weld = plant.AddWeldConstraint(seat, RigidTransform(), covering, RigidTransform())
    shapes = _shapes(lid)
    solids = [_add_solid(plant, covering, item, part, shape) for part, shape in shapes.items()]
    feet = _add_feet(plant, covering, item, lid.radius - _FOOT_RADIUS)
    slides = isinstance(lid, LiftOffLid)
    off_from = lid.travel if isinstance(lid, LiftOffLid) else 2.0 * np.pi * lid.turns
    body_on_seat = (covering, model, joint, solids, solid, seat, weld, feet)
    return LidBody(*body_on_seat, off_from=off_from, slides=slides, on=on, off=off)


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

    name, rim = lids.lid_name(item.name), item.truth.shape.rim
    hinge = lids.lid_hinge(lid, rim, item.truth.shape.top)
    p_LLcm = hinge.centre_of_mass(0.0) - hinge.p_BH
    disc_inertia = _cylinder_inertia(lid.mass, 0.5 * hinge.reach, lids.THICKNESS, p_LLcm)
    covering = plant.AddRigidBody(name, model, disc_inertia)
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
    if rim.is_round:
        plate = Cylinder(rim.size, lids.THICKNESS)
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
    hinged = (covering, model, joint, solids, solid)
    return LidBody(*hinged, catch_torque=lid.snap_torque, catch_angle=lid.snap_angle)


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
    # So much keeps a light cap on its thread from being stiff to solve [kg m²].
    actuator.set_default_rotor_inertia(1e-6)
    # The friction is reached at a creep of 1e-4 [rad/s], [m/s].
    actuator.set_controller_gains(PdControllerGains(p=1e-9, d=largest / 1e-4))


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
    plant.RegisterVisualGeometry(body, X_LG, solid, part, np.array([0.93, 0.93, 0.90, 1.0]))
    skin = surface(item.truth.friction_finger / 2)
    return plant.RegisterCollisionGeometry(body, X_LG, solid, part, skin)


def _add_feet(
    plant: MultibodyPlant, body: RigidBody, item: SceneObject, radius: float
) -> list[GeometryId]:
    from pydrake.geometry import Sphere
    from pydrake.math import RigidTransform

    skin = surface(item.truth.friction_table / 2)
    feet = []
    for k, turn in enumerate(2.0 * np.pi * np.arange(8) / 8):
        p = np.array([radius * np.cos(turn), radius * np.sin(turn), _FOOT_RADIUS])
        foot = Sphere(_FOOT_RADIUS)
        feet.append(
            plant.RegisterCollisionGeometry(body, RigidTransform(p), foot, f"foot_{k}", skin)
        )
    return feet


def _shared_inertia(
    lid: LiftOffLid | ScrewCap, *, on: bool
) -> tuple[SpatialInertia, SpatialInertia]:
    """Inertia in L of the seat and of the lid, whether it is on or off."""
    share = 0.5 if on else 1e-3  # the seat's
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


def add_slab(plant: MultibodyPlant, truth: Truth, body: RigidBody) -> GeometryId:
    """Adds the slab of an object to its body."""
    corners = np.array([*hull_points(truth)])
    middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    off = corners - middle
    around = np.hypot(*off[:, :2].T)
    drawn_in = 5e-4  # at the sides, more than solids ever overlap there [m]
    off[:, :2] *= np.maximum(0.0, 1.0 - drawn_in / np.maximum(around, drawn_in))[:, None]
    off[:, 2] += np.sign(off[:, 2]) * STANDS_OUT
    # What presses on an edge leans by less than a tenth of a degree; a box that rocks by a degree
    # stands still after half a second.
    return _add_compliant(
        plant,
        body,
        "slab",
        middle + off,
        friction=truth.friction_table,
        dissipation=2e3,  # [s/m]
        hydroelastic_modulus=0.5 * 5e12 * np.ptp(corners[:, 2]),  # of 5e12 Pa/m
    )


def _add_compliant(
    plant: MultibodyPlant,
    body: RigidBody,
    name: str,
    corners: Array,
    *,
    friction: float,
    dissipation: float,
    hydroelastic_modulus: float,
) -> GeometryId:
    """Adds the hull of some corners in B, whose pressure grows from its faces to its middle."""
    from pydrake.geometry import (
        AddCompliantHydroelasticProperties,
        AddContactMaterial,
        Convex,
        ProximityProperties,
    )
    from pydrake.math import RigidTransform
    from pydrake.multibody.plant import CoulombFriction

    properties = ProximityProperties()
    coulomb = CoulombFriction(friction, friction)
    AddContactMaterial(dissipation=dissipation, friction=coulomb, properties=properties)
    AddCompliantHydroelasticProperties(1.0, hydroelastic_modulus, properties)
    shape = Convex(corners.T, name)
    return plant.RegisterCollisionGeometry(body, RigidTransform(), shape, name, properties)


def hull_points(truth: Truth) -> Iterator[Point3]:
    """Corners in B of the hull of what it stands on, and of what others stand on [m]."""
    yield from ((x, y, 0.0) for x, y in truth.support)
    yield from truth.shape.bearing_points


def add_rims(plant: MultibodyPlant, table: Table) -> list[GeometryId]:
    """Adds a rim along each edge of the table, fixed to the world."""
    from pydrake.geometry import (
        AddContactMaterial,
        AddRigidHydroelasticProperties,
        Box,
        ProximityProperties,
    )
    from pydrake.math import RigidTransform
    from pydrake.multibody.plant import CoulombFriction

    (x, y), (width, depth), thick = table.centre_m, table.size_m, table.thickness_m
    properties = ProximityProperties()
    friction = CoulombFriction(ROUGH, ROUGH)
    AddContactMaterial(dissipation=_EDGE_DISSIPATION, friction=friction, properties=properties)
    AddRigidHydroelasticProperties(1.0, properties)
    rim = 0.02  # width of one [m]
    along_x, along_y = 0.5 * (width - rim), 0.5 * (depth - rim)
    strips = [
        ((x + along_x, y), (rim, depth)),
        ((x - along_x, y), (rim, depth)),
        ((x, y + along_y), (width, rim)),
        ((x, y - along_y), (width, rim)),
    ]
    return [
        plant.RegisterCollisionGeometry(
            plant.world_body(),
            RigidTransform(np.array([*middle, -0.5 * thick])),
            Box(*size, thick),
            f"rim_{k}",
            properties,
        )
        for k, (middle, size) in enumerate(strips)
    ]


def add_sole(plant: MultibodyPlant, truth: Truth, body: RigidBody) -> GeometryId:
    """Adds the sole of an object to its body."""
    corners = np.array([*hull_points(truth)])
    # What nearly falls leans by less than 0.1°, and what slides on slides.
    return _add_compliant(
        plant,
        body,
        "sole",
        corners,
        friction=truth.friction_table / 2,
        dissipation=_EDGE_DISSIPATION,
        hydroelastic_modulus=0.5 * 5e9 * np.ptp(corners[:, 2]),  # of 5e9 Pa/m
    )


def filter_slabs(
    scene_graph: SceneGraph, slabs: Iterable[GeometryId], others: Iterable[GeometryId]
) -> None:
    """Slabs meet none of the others."""
    from pydrake.geometry import CollisionFilterDeclaration, GeometrySet

    pairs = CollisionFilterDeclaration()
    pairs.ExcludeBetween(GeometrySet(list(slabs)), GeometrySet(list(others)))
    scene_graph.collision_filter_manager().Apply(pairs)


def filter_rims(
    scene_graph: SceneGraph,
    rims: list[GeometryId],
    soles: list[GeometryId],
    others: list[GeometryId],
) -> None:
    """Rims and soles meet each other alone."""
    from pydrake.geometry import CollisionFilterDeclaration, GeometrySet

    pairs = CollisionFilterDeclaration()
    pairs.ExcludeBetween(GeometrySet([*rims, *soles]), GeometrySet(others))
    pairs.ExcludeWithin(GeometrySet(soles))
    scene_graph.collision_filter_manager().Apply(pairs)

"""Worlds in Drake: an object alone on a plane, and tables with fingertips.

`DrakeWorld` rolls out pushes: discrete plant, SAP, point contact at the base corners. SAP lifts a
contact by μ × slip × (step + relaxation time), which moves load between corners that slip at
different speeds. Drake's relaxation time, 0.1 s unless stated, would make a slow slide look like
one in oil; it is set to zero, and corners sink in by more than that lift. Sinking in tilts a
slender object whose load nears an edge: of such prisms a few in a thousand move 2 to 5 % early, and
less the stiffer the contact.

A `Tabletop` has objects and contacts of the simulated world (`sim.worlds.drake`), without a robot.
`DrakeBench` rolls out strokes on one, `LidBench` opens lids.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Sequence
from typing import Any, NamedTuple

import numpy as np
from pydrake.geometry import AddContactMaterial, GeometryId, HalfSpace, ProximityProperties, Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    CoulombFriction,
    ExternallyAppliedSpatialForce,
    MultibodyPlant,
    MultibodyPlantConfig,
)
from pydrake.multibody.tree import (
    PdControllerGains,
    PrismaticJoint,
    RigidBody,
    SpatialInertia,
    UnitInertia,
)
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Context, DiagramBuilder

from benchmarks.worlds.pushes import SPHERE, STEP, Array
from benchmarks.worlds.strokes import (
    DAMPING,
    PERIOD,
    STIFFNESS,
    STRONGEST,
    TIP_MASS,
    Rolled,
    Stroke,
    offsets,
)
from objectmodels.containers.lids import THICKNESS, grip_distance, lid_hinge
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.object_parts import FlipLid
from sim.robots.robots import HAND
from sim.truth.scene_file import Scene, SceneObject
from sim.worlds.drake.contents import Lids
from sim.worlds.drake.drake_bodies import ROUGH, ContactWatch, add_lid, filter_lids, surface
from sim.worlds.drake.drake_plant import (
    Feet,
    Standing,
    add_empty_plant,
    add_object,
    add_table,
    filter_collisions,
    initial_pose,
)

SINKS = 3e-6
"""Depth to which the corners sink in under the weight [m]; they are springs of one stiffness."""
STICTION = 1e-4
"""Slip up to which friction sticks, as in the simulated world [m/s]."""

_UP = np.array([0.0, 0.0, 1.0])
_AWAY = 2.0 * _UP  # where fingertips wait [m]
_SETTLING = 0.1  # in which feet sink in [s]
_SHORTEST_REST, _LONGEST_REST = 0.25, 1.5  # after a stroke, until nothing moves [s]
_STILL = 2e-3  # largest speed of what is still [m/s]
_ARM = 0.1  # at which turning counts as speed [m]

_LID_SETTLING = 0.2  # [s]
_LID_SPEED = 0.03  # of the fingertip that moves a lid [m/s]
_BELOW = 0.004  # how far under the tab it starts [m]
_PULL, _TURN = 1.0, 0.02  # how fast a pull and a torque grow [N/s], [N·m/s]
_FAR, _MUCH = 0.002, np.radians(3.0)  # movement of an object that has come along [m], [rad]


class BodyInDrake:
    """A body of a plant that is complete; a `benchmarks.worlds.pushes.World`."""

    def __init__(self, builder: DiagramBuilder, plant: MultibodyPlant, body: RigidBody) -> None:
        plant.Finalize()
        self.plant, self.body = plant, body
        self.simulator = Simulator(builder.Build())
        self.context = plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        self.push = ExternallyAppliedSpatialForce()
        self.push.body_index = body.index()
        self.applied = plant.get_applied_spatial_force_input_port()
        self.steps = 0

    def step(self, point: Array, force: Array) -> tuple[Array, Array]:
        """See `benchmarks.worlds.pushes.World`."""
        self.push.p_BoBq_B = point
        self.push.F_Bq_W = SpatialForce(np.zeros(3), force)
        self.applied.FixValue(self.context, [self.push])
        self.steps += 1
        self.simulator.AdvanceTo(self.steps * STEP, interruptible=False)
        velocity = self.plant.EvalBodySpatialVelocityInWorld(self.context, self.body)
        return velocity.rotational(), velocity.translational()


class DrakeWorld(BodyInDrake):
    """An object on its base corners in Drake."""

    def __init__(self, model: ObjectModel) -> None:
        builder = DiagramBuilder()
        config = MultibodyPlantConfig(time_step=STEP, discrete_contact_approximation="sap")
        plant, _ = AddMultibodyPlant(config, builder)
        corners = model.footprint.corners
        contact = ProximityProperties()
        # Two in a row have half the stiffness of each, and the coefficient 2ab/(a + b).
        AddContactMaterial(
            point_stiffness=2.0 * model.weight / (len(corners) * SINKS),
            friction=CoulombFriction(model.friction, model.friction),
            properties=contact,
        )
        contact.AddProperty("material", "relaxation_time", 0.0)
        com = np.array(model.com)
        inertia = UnitInertia(*model.gyration).ShiftFromCenterOfMass(com)
        body = plant.AddRigidBody("object", SpatialInertia(model.mass, com, inertia))
        for i, (x, y) in enumerate(corners):
            centre = RigidTransform(np.array([x, y, SPHERE]))
            plant.RegisterCollisionGeometry(body, centre, Sphere(SPHERE), f"corner{i}", contact)
        plant.RegisterCollisionGeometry(
            plant.world_body(), RigidTransform(), HalfSpace(), "table", contact
        )
        super().__init__(builder, plant, body)


class Springs(NamedTuple):
    """What leads a fingertip: its mass [kg], and stiffness, damping and limit of the springs."""

    mass: float
    stiffness: float
    damping: float
    strongest: float = np.inf


STROKING = Springs(TIP_MASS, STIFFNESS, DAMPING, STRONGEST)


class Fingertip:
    """A sphere without a hand that springs lead along axes of W.

    Args:
        plant: to which it is added.
        name: of it, and of its last body.
        springs: along each axis that is led.
        led: axes along which springs lead it; along the others it is free.
    """

    def __init__(
        self, plant: MultibodyPlant, name: str, springs: Springs = STROKING, led: str = "xyz"
    ) -> None:
        self._plant, self._instance = plant, plant.AddModelInstance(name)
        self._axes = ["xyz".index(axis) for axis in led]
        solid = UnitInertia.SolidSphere(HAND.tip_radius)
        share = SpatialInertia(springs.mass / 3.0, np.zeros(3), solid)
        frame = plant.world_frame()
        for direction, axis in zip(np.eye(3), "xyz", strict=True):
            self.body = plant.AddRigidBody(
                name if axis == "z" else f"{name} {axis}", self._instance, share
            )
            slide = PrismaticJoint(f"{name} {axis}", frame, self.body.body_frame(), direction)
            joint = plant.AddJoint(slide)
            if axis in led:
                actuator = plant.AddJointActuator(f"{name} {axis}", joint, springs.strongest)
                gains = PdControllerGains(p=springs.stiffness, d=springs.damping)
                actuator.set_controller_gains(gains)
            frame = self.body.body_frame()
        self.solid = plant.RegisterCollisionGeometry(
            self.body, RigidTransform(), Sphere(HAND.tip_radius), "tip", surface(ROUGH)
        )
        plant.set_gravity_enabled(self._instance, False)

    def put(self, context: Context, place: Array) -> None:
        """Puts its centre somewhere in W, shape (3,) [m], at rest."""
        self._plant.SetPositions(context, self._instance, place)
        self._plant.SetVelocities(context, self._instance, np.zeros(3))
        self.command(context, place, np.zeros(3))

    def command(self, context: Context, place: Array, velocity: Array) -> None:
        """Leads it to a place in W, shape (3,) [m], with a velocity."""
        if self._axes:
            port = self._plant.get_desired_state_input_port(self._instance)
            port.FixValue(context, np.concatenate([place[self._axes], velocity[self._axes]]))

    def place(self, context: Context) -> Array:
        """Its centre in W, shape (3,) [m]."""
        return np.array(self._plant.GetPositions(context, self._instance))

    def force(self, context: Context) -> Array:
        """Force of its springs in W [N]; all axes are led."""
        port = self._plant.get_net_actuation_output_port(self._instance)
        return np.array(port.Eval(context))


class Tabletop:
    """A table with objects in Drake; what else is there is added before `finish`.

    Args:
        scene: with the table.
        items: on it; those of the scene if not given.
        step: of time; the scene's if not given [s].
        stiction: slip up to which friction sticks [m/s].
    """

    def __init__(
        self,
        scene: Scene,
        items: Sequence[SceneObject] | None = None,
        *,
        step: float | None = None,
        stiction: float = STICTION,
    ) -> None:
        self._items = scene.objects if items is None else items
        self._builder = DiagramBuilder()
        self.plant, self.scene_graph = add_empty_plant(
            self._builder, step or scene.time_step_s, stiction
        )
        self.table = add_table(self.plant, scene)
        self.bodies: dict[str, RigidBody] = {}
        self.feet: dict[str, Feet] = {}
        self.solids: list[GeometryId] = []
        for item in self._items:
            self.bodies[item.name], solids, self.feet[item.name] = add_object(
                self.plant, item.name, item.truth
            )
            self.solids += solids

    @property
    def standing(self) -> list[GeometryId]:
        """The feet of all objects."""
        return [foot for feet in self.feet.values() for foot in feet.geometries]

    def finish(
        self,
        robot: Sequence[GeometryId] = (),
        *,
        welded: Collection[str] = (),
        stacked: bool = False,
    ) -> None:
        """Finalises the plant.

        Args:
            robot: what is not part of an object and touches them.
            welded: objects that stand as if they were glued to the table.
            stacked: whether each object stands on the slab of the one before.
        """
        plant = self.plant
        for item in self._items:
            if item.name in welded:
                frame = self.bodies[item.name].body_frame()
                plant.WeldFrames(plant.world_frame(), frame, initial_pose(item))
        plant.Finalize()
        for level, item in enumerate(self._items):
            if item.name not in welded:
                X_WB = initial_pose(item, level if stacked else 0)
                plant.SetDefaultFloatingBaseBodyPose(self.bodies[item.name], X_WB)
        filter_collisions(
            self.scene_graph,
            robot=list(robot),
            table=self.table,
            solids=self.solids,
            feet=self.standing,
        )
        self.simulator = Simulator(self._builder.Build())
        self.root = self.simulator.get_mutable_context()
        self.context = plant.GetMyMutableContextFromRoot(self.root)

    def wait(self, seconds: float) -> None:
        """Lets time pass [s]."""
        self.simulator.AdvanceTo(self.root.get_time() + seconds, interruptible=False)

    def pose(self, name: str) -> RigidTransform:
        """Where an object is now, X_WB."""
        return self.plant.EvalBodyPoseInWorld(self.context, self.bodies[name])

    def apply(self, body: RigidBody, force: Array, torque: Array | None = None) -> None:
        """Lets a force [N] and a torque [N·m] act on a body in W from now on, and no other."""
        applied = ExternallyAppliedSpatialForce()
        applied.body_index = body.index()
        applied.F_Bq_W = SpatialForce(np.zeros(3) if torque is None else torque, force)
        self.plant.get_applied_spatial_force_input_port().FixValue(self.context, [applied])


class DrakeBench(Tabletop):
    """The objects of a scene and one or two fingertips; a `benchmarks.worlds.strokes.Bench`.

    All objects except the one that is pushed stand as if they were glued to the table, which costs
    a third of the time.

    Args:
        scene: what is true.
        pushed: name of the object that may move.
        fingers: how many fingertips.
    """

    def __init__(self, scene: Scene, pushed: str, fingers: int = 1) -> None:
        super().__init__(scene)
        self._tips = {f"tip {k}": Fingertip(self.plant, f"tip {k}") for k in range(fingers)}
        others = [item.name for item in scene.objects if item.name != pushed]
        self.finish([tip.solid for tip in self._tips.values()], welded=others)
        self._pushed = self.bodies[pushed]
        self._put(_AWAY + offsets(fingers, 0.0))
        self.wait(_SETTLING)

    def keep(self) -> object:
        """See `benchmarks.worlds.strokes.Bench`."""
        return self.root.Clone()

    def back(self, state: Any) -> None:
        """See `benchmarks.worlds.strokes.Bench`."""
        self.root.SetTimeStateAndParametersFrom(state)
        self.simulator.Initialize()

    def poses(self) -> dict[str, Array]:
        """See `benchmarks.worlds.strokes.Bench`."""
        poses = {name: self.pose(name) for name in self.bodies}
        return {
            name: np.array([*X_WB.rotation().ToQuaternion().wxyz(), *X_WB.translation()])
            for name, X_WB in poses.items()
        }

    def roll(self, stroke: Stroke, speed: float) -> Rolled:
        """See `benchmarks.worlds.strokes.Bench`."""
        beside = offsets(len(self._tips), stroke.heading)
        path, there = stroke.path(speed)
        watch = ContactWatch(self.plant, self.bodies)
        self._put(path[0] + beside)
        samples: list[tuple[Array, Array, Array]] = []
        touched: set[frozenset[str]] = set()
        for before, now in itertools.pairwise(path):
            for tip, off in zip(self._tips.values(), beside, strict=True):
                tip.command(self.context, now + off, (now - before) / PERIOD)
            samples.append(self._sampled(watch, touched))
        self._put(_AWAY + beside)
        for rests in range(1, 1 + round(_LONGEST_REST / PERIOD)):
            samples.append(self._sampled(watch, touched))
            if rests >= round(_SHORTEST_REST / PERIOD) and self._is_still():
                break
        poses, tips, felt = (np.array(column) for column in zip(*samples, strict=True))
        return Rolled(
            poses={name: poses[:, k] for k, name in enumerate(self.bodies)},
            tips={name: tips[:, k] for k, name in enumerate(self._tips)},
            felt={name: felt[:, k] for k, name in enumerate(self._tips)},
            pushing=np.arange(len(poses)) < there.sum(),
            touched=frozenset(touched),
        )

    def _sampled(
        self, watch: ContactWatch, touched: set[frozenset[str]]
    ) -> tuple[Array, Array, Array]:
        self.wait(PERIOD)
        watch.note(self.root.get_time(), self.context)
        touched |= {frozenset((e.body_a, e.body_b)) for e in watch.begun}
        tips = self._tips.values()
        return (
            np.array(list(self.poses().values())),
            np.array([tip.place(self.context) for tip in tips]),
            np.array([tip.force(self.context) for tip in tips]),
        )

    def _is_still(self) -> bool:
        V_WB = self.plant.EvalBodySpatialVelocityInWorld(self.context, self._pushed)
        turning = np.linalg.norm(V_WB.rotational()) < _STILL / _ARM
        return bool(turning and np.linalg.norm(V_WB.translational()) < _STILL)

    def _put(self, places: Array) -> None:
        """Fingertips at places, at rest."""
        for tip, place in zip(self._tips.values(), places, strict=True):
            tip.put(self.context, place)
        self.simulator.Initialize()


class Opened(NamedTuple):
    """What became of a lid and its object.

    Attributes:
        lid: how far it was opened, as in `sim.traces.trace.Trace.lids`.
        tilt: largest tilt of the object [rad].
        shift: largest displacement of it [m].
        turn: of it about the vertical [rad].
        force: largest force or torque that was applied [N], [N·m].
    """

    lid: float
    tilt: float
    shift: float
    turn: float
    force: float

    @property
    def came_along(self) -> bool:
        """Whether the object moved."""
        return bool(self.shift > _FAR or self.tilt > _MUCH or abs(self.turn) > _MUCH)


class LidBench(Tabletop):
    """A scene with one object that has a lid, and what opens it: a fingertip, a pull, a turn.

    Pulls and turns are forces on the lid itself. The lids are those of the simulated world
    (`sim.worlds.drake.contents`).

    Args:
        scene: with the object.
    """

    def __init__(self, scene: Scene) -> None:
        (item,) = scene.objects
        bare = item.model_copy(update={"truth": item.truth.without_lid})
        super().__init__(scene, [bare])
        self._item = item
        lid = add_lid(self.plant, item, self.bodies[item.name], self.solids[0])
        assert lid is not None
        self._lid = lid
        self._tip = Fingertip(self.plant, "tip")
        robot = [self._tip.solid]
        self.finish(robot, welded=[item.name] if item.fixed else ())
        filter_lids(self.scene_graph, [lid], robot=robot, table=self.table, feet=self.standing)
        lids = {item.name: lid}
        model = Standing(self.plant, self.scene_graph, self.bodies, self.feet, lids)
        self._lids = Lids(model, self.root)
        self._tip.put(self.context, _UP)
        self.wait(_LID_SETTLING)
        self._start = self.pose(item.name)

    @property
    def lid(self) -> float:
        """How far the lid is open now."""
        return self._lids.lid_openings()[self._item.name]

    def wait(self, seconds: float) -> None:
        """Lets time pass [s]; the lid's catch and seat follow by control steps."""
        for _ in range(round(seconds / PERIOD)):
            self._lids.prepare([], {})
            super().wait(PERIOD)

    def flip(self, end: float, start: float = 0.0) -> Opened:
        """Moves a flip lid by its tab from one angle to another [rad]."""
        lid = self._item.truth.lid
        assert isinstance(lid, FlipLid)
        hinge = lid_hinge(lid, self._item.truth.shape.rim, self._item.truth.shape.top)
        lever = grip_distance(lid, hinge)
        opens = end > start
        above = -HAND.tip_radius if opens else HAND.tip_radius + THICKNESS
        off = -_BELOW if opens else _BELOW
        angles = np.linspace(start, end, int(abs(end - start) * lever / (_LID_SPEED * PERIOD)))
        way = [hinge.lid_point(start, lever, above + off * s) for s in np.linspace(1.0, 0.0, 20)]
        way += list(hinge.lid_point(angles, lever, above))
        way_W = [self._start @ p for p in way]
        self._tip.put(self.context, way_W[0])
        moved, forces = [], []
        for before, now in itertools.pairwise(way_W):
            self._tip.command(self.context, now, (now - before) / PERIOD)
            self.wait(PERIOD)
            moved.append(self._moved())
            forces.append(float(np.linalg.norm(self._tip.force(self.context))))
        self._tip.put(self.context, _UP)
        return self._opened(moved, max(forces))

    def push_lid(self, torque: float, seconds: float = 1.0) -> float:
        """How far a constant torque about a flip lid's hinge opens it in some time [rad]."""
        axis = self._lid.joint.revolute_axis()
        for _ in range(round(seconds / PERIOD)):
            R_WB = self.pose(self._item.name).rotation().matrix()
            self.apply(self._lid.body, np.zeros(3), torque * (R_WB @ axis))
            self.wait(PERIOD)
        self.apply(self._lid.body, np.zeros(3))
        return self.lid

    def raise_lid(self, force: float, height: float) -> None:
        """Pulls the lid up by a constant force [N] until it is so far from its seat [m]."""
        self.apply(self._lid.body, force * _UP)
        while self.lid < height:
            self.wait(PERIOD)
        self.apply(self._lid.body, np.zeros(3))

    def pull(self, most: float) -> Opened:
        """Pulls the lid up by a force that grows until it is off or the object comes along [N]."""
        return self._grown(_UP, np.zeros(3), _PULL, most, _FAR)

    def turn(self, most: float) -> Opened:
        """Turns the cap by a torque that grows until it or the object gives way [N·m]."""
        return self._grown(np.zeros(3), _UP, _TURN, most, _MUCH)

    def _grown(
        self, force: Array, torque: Array, rate: float, most: float, open_at: float
    ) -> Opened:
        """Lets a force or torque grow to the most, until the lid is open or the object moves."""
        moved, size = [], 0.0
        while size < most:
            size += rate * PERIOD
            self.apply(self._lid.body, size * force, size * torque)
            self.wait(PERIOD)
            moved.append(self._moved())
            if self.lid > open_at or self._opened(moved, size).came_along:
                break
        self.apply(self._lid.body, np.zeros(3))
        return self._opened(moved, size)

    def _moved(self) -> tuple[float, float]:
        """Tilt [rad] and displacement [m] of the object."""
        X_WB = self.pose(self._item.name)
        tilt = float(np.arccos(np.clip(X_WB.rotation().matrix()[2, 2], -1.0, 1.0)))
        return tilt, float(np.linalg.norm(X_WB.translation() - self._start.translation()))

    def _opened(self, moved: list[tuple[float, float]], force: float) -> Opened:
        tilts, shifts = zip(*moved, strict=True)
        R = self._start.rotation().matrix().T @ self.pose(self._item.name).rotation().matrix()
        turn = float(np.arctan2(R[1, 0], R[0, 0]))
        return Opened(self.lid, max(tilts), max(shifts), turn, force)

"""What a whole hand does, without an arm: lids are opened, boxes squeezed and lifted, jugs tilted.

`LidCase`: cups with flip lids are opened by a fingertip that follows the lid's arc, jars with
lift-off lids by a pull that grows, bottles with screw caps by a torque that grows. The limit is
where the object bears what the lid needs (`objectmodels.containers.lids`).

`Grasp`: the hand hangs on a vertical slide, takes hold of a box from its side, squeezes it as much
as it is told and lifts it. The limit is the friction that just holds it. The box is as the model
believes; it has slipped when a fingertip has moved on it.

`Pour`: a box, a cylinder or a prism with a round opening somewhere in its top is tilted by a
prescribed motion over a cylinder that stands on the table: speeding up and slowing down within a
fifth of a second, its lip shaking by a millimetre, and back upright at the end. The simulated
liquid runs out step by step, into the cylinder or beside it (`sim.worlds.drake.contents`). The
prediction knows shapes, contents and aim, and takes the tilting as steady and the lip as still
(`objectmodels.containers.pour_dynamics`). A share of the contents is asked for, by which the
prediction picks the tilt.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.multibody.tree import PdControllerGains, PrismaticJoint, SpatialInertia
from pydrake.systems.framework import DiagramBuilder

from benchmarks.engines.agreement import Outcome
from benchmarks.worlds.drake import LidBench, Tabletop
from nlcontrol.batches.drawn_scenes import scene_of
from objectmodels import CylinderModel
from objectmodels.containers import lids
from objectmodels.containers.pour_dynamics import Catch, angle_for, caught_volume, pour
from objectmodels.geometry.base_shapes import Polygon
from objectmodels.geometry.rotations import Array, axis_rotation
from objectmodels.mechanics.grasp_stability import Contacts, GraspLoads
from objectmodels.mechanics.push_thresholds import GRAVITY
from objectmodels.models.object_parts import (
    Container,
    FlipLid,
    Lid,
    LiftOffLid,
    Opening,
    ScrewCap,
    Vessel,
)
from objectmodels.models.shapes import Box, Cylinder
from sim.robots.cell_description import RobotMount, Vision
from sim.robots.hand import Angles, GraspPosture
from sim.robots.robots import HAND
from sim.truth.object_truth import Truth
from sim.truth.scene_file import Pose, Scene, SceneObject, load_scene
from sim.worlds.drake.contents import Liquid
from sim.worlds.drake.drake_plant import Standing, add_object

Generator = np.random.Generator
LidKind = Literal["flip", "lift_off", "screw"]

_END = np.radians(100.0)
_OPEN = 0.9  # share of the way at which a lid counts as open
_MORE = 1.5  # largest pull or torque as a share of what lid or object needs
_SHARES: dict[LidKind, float] = {"flip": 0.6, "lift_off": 0.2, "screw": 0.2}


@dataclass(frozen=True)
class LidCase:
    """An object with a lid.

    Attributes:
        group: kind of its lid.
        truth: how it is.
        yaw: how it is turned [degrees].
    """

    group: LidKind
    truth: Truth
    yaw: float

    @cached_property
    def belief(self) -> CylinderModel:
        """A belief that is exactly right."""
        truth = self.truth
        return CylinderModel(
            name="object",
            radius=truth.shape.rim.size,
            base_radius=truth.shape.footprint.size,
            height=truth.shape.top,
            mass=truth.mass_kg,
            friction=truth.friction_table,
            finger_friction=truth.friction_finger,
            com=truth.centre_of_mass,
            support="corners",
            lid=truth.lid,
        )

    def prediction(self) -> tuple[str, float]:
        """`opens`, or `gives way` if the object slides, tips or comes along."""
        lid = self.truth.lid
        if isinstance(lid, FlipLid):
            margin = lids.flip(self.belief, lid, end=_END).least_margin
        else:
            margin = self._opening(lid).margin
        return "opens" if margin > 1.0 else "gives way", margin - 1.0

    def _opening(self, lid: Lid | None) -> lids.Loosening:
        if isinstance(lid, LiftOffLid):
            return lids.lift_off(self.belief, lid)
        assert isinstance(lid, ScrewCap)
        return lids.unscrew(self.belief, lid)

    def roll_out(self) -> Outcome:
        """See `benchmarks.engines.agreement.Case`."""
        pose, lid = Pose(x_m=0.5, y_m=0.0, yaw_deg=self.yaw), self.truth.lid
        item = SceneObject(name="object", model="object", pose=pose, truth=self.truth)
        bench = LidBench(scene_of("lids", [item], Vision()))
        if isinstance(lid, FlipLid):
            done = bench.flip(_END)
            opens = done.lid > _OPEN * _END and not done.came_along
        else:
            expected = self._opening(lid)
            most = _MORE * min(expected.needed, expected.held)
            done = bench.pull(most) if isinstance(lid, LiftOffLid) else bench.turn(most)
            opens = not done.came_along
        return Outcome("opens" if opens else "gives way")


def lid_cases(cases: int, seed: int) -> list[LidCase]:
    """Round objects of any size that a hand could open, the kinds of their lids by `_SHARES`."""
    rng = np.random.default_rng(seed)
    counts = {kind: round(share * cases) for kind, share in _SHARES.items()}
    return [random_lid(kind, rng) for kind, number in counts.items() for _ in range(number)]


def random_lid(kind: LidKind, rng: Generator) -> LidCase:
    """A round object with a lid of a kind."""
    radius, height = rng.uniform(0.025, 0.045), rng.uniform(0.07, 0.16)
    mass = rng.uniform(0.08, 0.60)
    truth = Truth(
        shape=Cylinder(radius=radius, base_radius=radius * rng.uniform(0.85, 1.0), height=height),
        mass_kg=mass,
        friction_table=rng.uniform(0.15, 0.6),
        friction_finger=rng.uniform(0.3, 0.9),
        centre_of_mass_m=(0.0, 0.0, height * rng.uniform(0.3, 0.5)),
        lid=_random_lid(kind, radius, mass, rng),
    )
    return LidCase(kind, truth, rng.uniform(-180.0, 180.0))


def _random_lid(kind: LidKind, radius: float, mass: float, rng: Generator) -> Lid:
    if kind == "flip":
        return FlipLid(
            mass=rng.uniform(0.008, 0.03),
            tab=rng.uniform(0.018, 0.025),
            tab_heading_deg=rng.uniform(-180.0, 180.0),
            friction_torque=rng.uniform(0.005, 0.05),
            snap_torque=rng.uniform(0.0, 0.08),
            snap_angle_deg=rng.uniform(2.0, 6.0),
        )
    if kind == "lift_off":
        return LiftOffLid(
            mass=rng.uniform(0.1, 0.3) * mass,
            retention=rng.uniform(0.2, 1.6) * 0.8 * mass * 9.81,
            radius=radius,
            knob_radius=0.01,
            knob_height=0.02,
        )
    return ScrewCap(
        mass=rng.uniform(0.002, 0.006),
        friction_torque=rng.uniform(0.01, 0.08),
        pitch=rng.uniform(0.002, 0.004),
        radius=0.6 * radius,
        height=0.018,
    )


# Motion of a fingertip on the box in a second in which the hand is still, and altogether, that
# counts as slip [m]; below its limit, simulated friction creeps by a tenth of a millimetre.
_SLIPPED, _DROPPED = 0.001, 0.012
_DEPTH, _HEIGHT = 0.08, 0.16
_TIME_STEP, _PERIOD = 0.002, 0.01
_LIFT, _LIFTING, _HOLDING, _WATCHED = 0.06, 1.5, 1.0, 1.0  # [m], [s]
_WINDING, _SETTLING = 10.0, 0.3  # rate of the squeeze [N/s], and time to come to rest [s]
_R_WP = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # hand along x, y upright


@dataclass(frozen=True)
class Grasp:
    """One grasp: com is the centre of mass against the middle of the grasp, along z and y of G."""

    width: float
    mass: float
    friction: float
    com: tuple[float, float]
    squeeze: float
    group = "grasps"

    @property
    def posture(self) -> GraspPosture:
        """Of the hand."""
        grip = HAND.grasp_posture(self.width)
        assert grip is not None, "the cases are drawn among the hand's widths"
        return grip

    @property
    def multiplier(self) -> float:
        """Friction it has by friction it needs."""
        grip = self.posture.grip
        contacts = Contacts.from_arrays(grip.contacts, grip.shares)
        force = np.array([[0.0, -self.mass * GRAVITY, 0.0]])
        place = np.array([[0.0, self.com[1], self.com[0]]])
        loads = GraspLoads.on_contacts(contacts, force, place)
        return float(loads.slip_multiplier(self.squeeze, self.friction)[0])

    def prediction(self) -> tuple[str, float]:
        """See `benchmarks.engines.agreement.Case`."""
        multiplier = self.multiplier
        return "held" if multiplier > 1.0 else "slipped", multiplier - 1.0

    def roll_out(self) -> Outcome:
        """See `benchmarks.engines.agreement.Case`."""
        lifted, still = _Gantry(self).slip()
        held = lifted < _DROPPED and still < _SLIPPED
        details = f"a fingertip moved by {1e3 * lifted:.1f} mm, and by {1e3 * still:.2f} mm at rest"
        return Outcome("held" if held else "slipped", details=details)


def grasps(cases: int, seed: int) -> list[Grasp]:
    """Random grasps, about as many that hold as slip."""
    rng = np.random.default_rng(seed)
    made: list[Grasp] = []
    while len(made) < cases:
        case = Grasp(
            width=float(rng.uniform(0.02, 0.09)),
            mass=float(rng.uniform(0.1, 0.7)),
            friction=float(rng.uniform(0.3, 0.9)),
            com=(float(rng.uniform(-0.02, 0.02)), float(rng.uniform(-0.03, 0.03))),
            squeeze=float(rng.uniform(2.0, 10.0)),
        )
        # Far from the limit there is nothing to tell.
        if 0.4 < case.multiplier < 2.5:
            made.append(case)
    return made


class _Gantry(Tabletop):
    """The hand on its slide, about a box."""

    def __init__(self, case: Grasp) -> None:
        self._case, self._grip = case, case.posture
        along, up = case.com
        # The box's x is the closing direction's line, W's y; its depth lies along W's x.
        truth = Truth(
            shape=Box(size=(_DEPTH, case.width, _HEIGHT)),
            mass_kg=case.mass,
            friction_table=0.3,
            friction_finger=case.friction,
            centre_of_mass_m=(along, 0.0, _HEIGHT / 2.0 + up),
        )
        box = SceneObject(name="box", model="box", pose=Pose(x_m=0.0, y_m=0.0), truth=truth)
        super().__init__(load_scene("kitchen"), [box], step=_TIME_STEP)
        plant = self.plant
        text = HAND.model_file.read_text("utf-8")
        (self._hand,) = Parser(plant).AddModelsFromString(text, "urdf")
        self._slide = plant.AddModelInstance("slide")
        mass = SpatialInertia.SolidSphereWithMass(1.0, 0.03)
        carriage = plant.AddRigidBody("carriage", self._slide, mass).body_frame()
        joint = PrismaticJoint("lift", plant.world_frame(), carriage, [0, 0, 1])
        actuator = plant.AddJointActuator("lift", plant.AddJoint(joint), 1e5)
        actuator.set_controller_gains(PdControllerGains(p=2e4, d=800.0))
        # B stands at W's origin; the middle of the grasp is at half the box's height.
        p_WP = np.array([0.0, 0.0, _HEIGHT / 2.0]) - _R_WP @ self._grip.middle
        X_WP = RigidTransform(RotationMatrix(_R_WP), p_WP)
        plant.WeldFrames(carriage, plant.GetFrameByName("palm"), X_WP)
        for instance in (self._hand, self._slide):
            plant.set_gravity_enabled(instance, False)
        self.finish(
            [
                geometry
                for index in plant.GetBodyIndices(self._hand)
                for geometry in plant.GetCollisionGeometriesForBody(plant.get_body(index))
            ]
        )
        opened = self._grip.posture_at(self._grip.opening)
        self._q, self._height = opened.joint_angles, 0.0
        for finger, driven in opened.angles.items():
            names = HAND.model_joints(finger)
            for name, angle in zip(names, HAND.model_angles(driven), strict=True):
                plant.GetJointByName(name).set_angle(self.context, angle)

    def slip(self) -> tuple[float, float]:
        """How far a fingertip moves on the box, the most of the four [m].

        Returns:
            While it is lifted, and in the last second, in which the hand is still.
        """
        grip, wound = self._grip, 0.0
        for opening in np.arange(grip.opening, 0.0, -0.02 * _PERIOD):
            self._step(grip.posture_at(float(opening)).joint_angles)
        closed = grip.posture_at().joint_angles
        while self._pressed() < self._case.squeeze and wound < 2.0 * self._case.squeeze:
            wound += _WINDING * _PERIOD
            self._step(closed + wound * grip.squeeze_offsets)
        q = closed + wound * grip.squeeze_offsets
        for _ in range(round(_SETTLING / _PERIOD)):
            self._step(q)
        places = [self._tips()]
        for seconds in (_LIFTING, _HOLDING, _WATCHED):
            for t in np.arange(0.0, seconds, _PERIOD):
                u = min(1.0, float(t) / _LIFTING) if len(places) == 1 else 1.0
                self._step(q, _LIFT * u * u * (3.0 - 2.0 * u))
            places.append(self._tips())
        moved = np.linalg.norm(np.diff(places, axis=0), axis=2).max(axis=1)
        return float(moved[:2].sum()), float(moved[2])

    def _step(self, q: Array, height: float = 0.0) -> None:
        """Commands finger angles and the slide's height for a control period."""
        rate = (q - self._q) / _PERIOD, (height - self._height) / _PERIOD
        fix = self.plant.get_desired_state_input_port
        fix(self._hand).FixValue(self.context, np.concatenate([q, rate[0]]))
        fix(self._slide).FixValue(self.context, np.array([height, rate[1]]))
        self._q, self._height = q, height
        self.wait(_PERIOD)

    def _tips(self) -> Array:
        """Where the fingertips are on the box, in B, shape (4, 3) [m]."""
        X_WP = self.plant.GetFrameByName("palm").CalcPoseInWorld(self.context)
        X_BW = self.pose("box").inverse()
        tips = (HAND.tip_centre(finger, self._angles(finger)) for finger in HAND.grasp_fingers)
        return np.array([X_BW.multiply(X_WP.multiply(tip)) for tip in tips])

    def _angles(self, finger: str) -> Angles:
        names = HAND.model_joints(finger)[: len(HAND.resting.angles[finger])]
        return tuple(self.plant.GetJointByName(n).get_angle(self.context) for n in names)

    def _pressed(self) -> float:
        """Mean of what both sides press [N]."""
        torques = self.plant.get_net_actuation_output_port(self._hand).Eval(self.context)
        presses = []
        for finger in HAND.grasp_fingers:
            angles = self._angles(finger)
            inward = HAND.closing_direction(finger)
            p_PC = HAND.tip_centre(finger, angles) + HAND.tip_radius * inward
            first = len(angles) * HAND.fingers.index(finger)
            felt = torques[first : first + len(angles)]
            presses.append(HAND.tip_force(finger, angles, p_PC, felt) @ inward)
        return float(0.5 * np.sum(presses))


PROMISED = 3.0
"""Share of the contents by which a prediction of a pour may be wrong [%]."""
RAMP = 0.2
"""Time in which a pour comes up to the rate, and back to rest [s]."""

_SHAKING = 1e-3  # of the lip while it pours, along each axis [m]
_AIM = 0.008  # standard deviation of the aim [m]
_WALL, _SHELL = 0.002, 0.06  # [m], [kg]
_SOURCE, _TARGET = "jug", "glass"
_HOME = RobotMount(home_deg=(41.0, -95.0, 75.0, -87.0, 110.0, -90.0, 42.0))
_FRICTION: dict[str, Any] = {"friction_table": 0.4, "friction_finger": 0.6}
_AT = Pose(x_m=0.5, y_m=0.0)
_BESIDE = Pose(x_m=0.5, y_m=0.4)  # of what is poured from, until it is held


class Prescribed:
    """A scene whose objects are put where they are wanted, in a plant that keeps their masses.

    Args:
        scene: what is true.

    Attributes:
        poses: of its objects, R_WB and p_WB [m].
        liquid: in its containers.
    """

    def __init__(self, scene: Scene) -> None:
        builder = DiagramBuilder()
        plant, graph = AddMultibodyPlantSceneGraph(builder, scene.time_step_s)
        objects = {item.name: add_object(plant, item.name, item.truth) for item in scene.objects}
        plant.Finalize()
        self.scene = scene
        self.root = builder.Build().CreateDefaultContext()
        self.context = plant.GetMyContextFromRoot(self.root)
        bodies = {name: body for name, (body, _, _) in objects.items()}
        feet = {name: feet for name, (_, _, feet) in objects.items()}
        self.model = Standing(plant, graph, bodies, feet, {})
        self.liquid = Liquid(self.model, self.root, scene)
        self.poses = {
            item.name: (np.eye(3), np.array([item.pose.x_m, item.pose.y_m, 0.0]))
            for item in scene.objects
        }

    def lean(self, name: str, tilt: float, heading: float, lip_W: Array) -> None:
        """Lets an object lean for a control step, its lip at a place; its yaw is 0."""
        axis = np.array([-math.sin(heading), math.cos(heading), 0.0])
        R_WB = axis_rotation(axis, tilt)
        vessel = self.scene.object(name).truth.vessel
        assert vessel is not None
        self.poses[name] = (R_WB, lip_W - R_WB @ vessel.lip_point(heading))
        self.liquid.prepare((), self.poses)


@dataclass(frozen=True)
class Pour:
    """A pour: what stands there, and how it is tilted.

    Attributes:
        group: shape of what is poured from.
        scene: with both containers.
        heading: direction in which it leans [rad].
        angle: largest tilt [rad].
        rate: of tilting [rad/s].
        wait: at that tilt [s].
        lip_W: where its lip is kept [m].
        phase: of the lip's shaking along each axis [rad].
    """

    group: str
    scene: Scene = field(repr=False)
    heading: float
    angle: float
    rate: float
    wait: float
    lip_W: Array
    phase: Array

    @property
    def source(self) -> tuple[Vessel, float]:
        """The cavity that is poured from, and its contents [m³]."""
        return _contents(self.scene.object(_SOURCE).truth)

    def prediction(self) -> tuple[str, float]:
        """That volumes are as close as promised; there is no limit."""
        return f"within {PROMISED:g} %", math.inf

    def roll_out(self) -> Outcome:
        """See `benchmarks.engines.agreement.Case`."""
        said, ran = self.said_volumes(), self.run_volumes()
        errors = {f"{name}, %": 100.0 * (said[name] - ran[name]) / self.source[1] for name in ran}
        kept = max(map(abs, errors.values())) <= PROMISED
        return Outcome(f"within {PROMISED:g} %" if kept else "farther off", errors)

    def said_volumes(self) -> dict[str, float]:
        """Volumes that the model says [m³]."""
        vessel, contents = self.source
        target = self.scene.object(_TARGET).truth
        cavity, level = _contents(target)
        assert target.container is not None
        running = pour(
            vessel,
            contents,
            heading=self.heading,
            angle=self.angle,
            rate=self.rate,
            wait=self.wait,
        )
        off = np.array([_AT.x_m, _AT.y_m]) - self.lip_W[:2]
        c, s = math.cos(self.heading), math.sin(self.heading)
        catch = Catch(
            along=c * off[0] + s * off[1],
            across=c * off[1] - s * off[0],
            fall=self.lip_W[2] - target.shape.top,
            radius=target.container.opening.radius,
            free=cavity.capacity - level,
        )
        result = caught_volume(running, contents, catch)
        return {name: float(volume) for name, volume in result.mean_volumes().items()}

    def run_volumes(self) -> dict[str, float]:
        """Volumes that ran in the simulation [m³]."""
        world = Prescribed(self.scene)
        before = dict(world.liquid.contents)
        period = 1.0 / self.scene.control_rate_hz
        times = np.arange(0.0, 2.0 * self.angle / self.rate + self.wait + 2.0 * RAMP, period)
        for t, tilt in zip(times, self.tilts(times), strict=True):
            shaken = _SHAKING * np.sin(2.0 * np.pi * 2.0 * t + self.phase)
            world.lean(_SOURCE, float(tilt), self.heading, self.lip_W + shaken)
        after = world.liquid.contents
        return {
            "poured": before[_SOURCE] - after[_SOURCE],
            "received": after[_TARGET] - before[_TARGET],
            "spilled": world.liquid.spilled,
        }

    def tilts(self, times: Array) -> Array:
        """Tilts there, waiting, and back, each corner of the way rounded [rad]."""
        there = self.angle / self.rate
        back = there + self.wait
        # Rounded by the mean over the ramp, which makes the rate rise and fall linearly.
        shifted = times[:, None] - RAMP / 2.0 + np.linspace(-RAMP / 2.0, RAMP / 2.0, 21)
        way = np.clip(shifted, 0.0, there) - np.clip(shifted - back, 0.0, there)
        return np.asarray(self.rate * way.mean(axis=1))


def _contents(truth: Truth) -> tuple[Vessel, float]:
    """The cavity of a container, and its contents [m³]."""
    vessel, container = truth.vessel, truth.container
    assert vessel is not None
    assert container is not None
    return vessel, container.contents


def pours(cases: int, seed: int) -> list[Pour]:
    """Pours that would fill the other vessel by any share, more or less well aimed."""
    return [random_pour(np.random.default_rng((seed, number))) for number in range(cases)]


def random_pour(rng: Generator) -> Pour:
    """A jug of some shape, and how it is tilted over a glass."""
    kind = str(rng.choice(("box", "cylinder", "prism")))
    heading = rng.uniform(-np.pi, np.pi)
    truth = _random_jug(kind, rng, heading + rng.uniform(-0.4, 0.4))
    vessel, contents = _contents(truth)
    rate, wait = rng.uniform(0.2, 0.8), rng.uniform(1.0, 4.0)
    wanted = rng.uniform(0.2, 1.0) * contents
    motion = {"heading": heading, "rate": rate, "wait": wait}
    angle = angle_for(vessel, contents, wanted, **motion)
    radius, height = rng.uniform(0.033, 0.05), rng.uniform(0.07, 0.12)
    glass = Container(
        wall=_WALL,
        opening=Opening(radius=radius - _WALL),
        contents_l=rng.uniform(0.0, 300.0) * np.pi * (radius - _WALL) ** 2 * (height - _WALL),
    )
    target = Truth(
        shape=Cylinder(radius=radius, height=height),
        mass_kg=_SHELL + glass.mass,
        container=glass,
        **_FRICTION,
    )
    running = pour(vessel, contents, angle=angle, **motion)
    fall = rng.uniform(0.02, 0.08)
    ahead = float(running.landing(fall)[0])
    aim = rng.normal(0.0, _AIM, 2) - ahead * np.array([math.cos(heading), math.sin(heading)])
    lip_W = np.array([_AT.x_m + aim[0], _AT.y_m + aim[1], height + fall])
    objects = tuple(
        SceneObject(name=name, model="mug", pose=at, truth=true)
        for name, at, true in ((_SOURCE, _BESIDE, truth), (_TARGET, _AT, target))
    )
    scene = Scene(version=1, name="pouring", robot=_HOME, objects=objects)
    phase = rng.uniform(0.0, 2.0 * np.pi, 3)
    return Pour(kind, scene, heading, angle, rate, wait, lip_W, phase)


def _random_jug(kind: str, rng: Generator, spout: float) -> Truth:
    """A container whose opening lies in some direction."""
    height = rng.uniform(0.10, 0.22)
    if kind == "box":
        size = rng.uniform(0.05, 0.10, 2)
        shape: dict[str, Any] = {"size_m": (size[0], size[1], height)}
        inside = size.min() / 2.0
    elif kind == "cylinder":
        inside = rng.uniform(0.028, 0.045)
        shape = {"radius_m": inside, "height_m": height}
    else:
        turns = 2.0 * np.pi * (np.arange(5) + rng.uniform(-0.3, 0.3, 5)) / 5.0
        corners = rng.uniform(0.04, 0.06) * np.column_stack([np.cos(turns), np.sin(turns)])
        shape = {"corners_m": tuple(map(tuple, corners.tolist())), "height_m": height}
        inside = float(Polygon.convex(corners).offsets.min())
    room = inside - _WALL
    radius = rng.uniform(0.3, 1.0) * room
    middle = (room - radius) * np.array([math.cos(spout), math.sin(spout)])
    container = Container(wall=_WALL, opening=Opening(centre=tuple(middle.tolist()), radius=radius))
    empty = Truth(mass_kg=_SHELL, container=container, **_FRICTION, **shape)
    assert empty.vessel is not None
    litres = 1e3 * rng.uniform(0.2, 0.8) * empty.vessel.capacity
    full = container.model_copy(update={"contents_l": litres})
    return Truth(mass_kg=_SHELL + full.mass, container=full, **_FRICTION, **shape)

"""Grasps that hold or slip: what the model says against the simulated hand, over random cases.

    python -m benchmarks.grasps --cases 120

The hand has no arm: it hangs on a vertical slide, takes hold of a box from its side, squeezes it as
much as it is told and lifts it. The box is as the model believes; mass, friction, width, centre of
mass and squeeze differ from case to case. It has slipped when a fingertip has moved on it.
"""

from __future__ import annotations

import argparse
import itertools
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nlcontrol.parallel_tasks import run_all
from objectmodels.geometry.rotations import Array
from objectmodels.mechanics.grasp_stability import Contacts, GraspLoads
from objectmodels.mechanics.push_thresholds import GRAVITY
from sim.robots.hand import Angles, GraspPosture
from sim.robots.robots import HAND
from sim.truth.object_truth import Truth
from sim.truth.scene_file import Pose, Scene, SceneObject, load_scene
from sim.worlds.drake.drake_plant import add_object, add_table, filter_collisions, initial_pose

BAND = 0.10
"""Relative distance of the multiplier from 1 within which either answer is right."""

SLIPPED, DROPPED = 0.001, 0.012
"""Motion of a fingertip on the box in a second in which the hand is still, and altogether, that
counts as slip [m]; below its limit, simulated friction creeps by a tenth of a millimetre."""

_DEPTH, _HEIGHT = 0.08, 0.16
_TIME_STEP, _PERIOD = 0.002, 0.01
_LIFT, _LIFTING, _HOLDING, _WATCHED = 0.06, 1.5, 1.0, 1.0  # [m], [s]
_WINDING, _SETTLING = 10.0, 0.3  # rate of the squeeze [N/s], and time to come to rest [s]
_R_WP = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # hand along x, y upright


@dataclass(frozen=True)
class Case:
    """One grasp: com is the centre of mass against the middle of the grasp, along z and y of G."""

    width: float
    mass: float
    friction: float
    com: tuple[float, float]
    squeeze: float

    @property
    def multiplier(self) -> float:
        """Friction it has by friction it needs."""
        grip = _grip(self.width)
        contacts = Contacts.from_arrays(grip.grip.contacts, grip.grip.shares)
        force = np.array([[0.0, -self.mass * GRAVITY, 0.0]])
        place = np.array([[0.0, self.com[1], self.com[0]]])
        loads = GraspLoads.on_contacts(contacts, force, place)
        return float(loads.slip_multiplier(self.squeeze, self.friction)[0])


def drawn(cases: int, seed: int) -> list[Case]:
    """Random cases, about as many that hold as slip."""
    rng = np.random.default_rng(seed)
    made: list[Case] = []
    while len(made) < cases:
        case = Case(
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


def _grip(width: float) -> GraspPosture:
    grip = HAND.grasp_posture(width)
    assert grip is not None, "the cases are drawn among the hand's widths"
    return grip


class Gantry:
    """The hand on its slide, about a box.

    Args:
        case: what it holds.
    """

    def __init__(self, case: Case) -> None:
        from pydrake.math import RigidTransform, RotationMatrix
        from pydrake.multibody.parsing import Parser
        from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlantConfig
        from pydrake.multibody.tree import PdControllerGains, PrismaticJoint, SpatialInertia
        from pydrake.systems.analysis import Simulator
        from pydrake.systems.framework import DiagramBuilder

        self.grip = _grip(case.width)
        builder = DiagramBuilder()
        config = MultibodyPlantConfig(
            time_step=_TIME_STEP,
            contact_model="point",
            discrete_contact_approximation="lagged",
            stiction_tolerance=1e-4,
            use_sampled_output_ports=False,
        )
        self.plant, scene_graph = AddMultibodyPlant(config, builder)
        plant = self.plant
        text = HAND.model_file.read_text("utf-8")
        (self.hand,) = Parser(plant).AddModelsFromString(text, "urdf")
        self.slide = plant.AddModelInstance("slide")
        carriage = plant.AddRigidBody(
            "carriage", self.slide, SpatialInertia.SolidSphereWithMass(1.0, 0.03)
        )
        joint = PrismaticJoint("lift", plant.world_frame(), carriage.body_frame(), [0, 0, 1])
        actuator = plant.AddJointActuator("lift", plant.AddJoint(joint), 1e5)
        actuator.set_controller_gains(PdControllerGains(p=2e4, d=800.0))
        # B stands at W's origin; the middle of the grasp is at half the box's height.
        p_WP = np.array([0.0, 0.0, _HEIGHT / 2.0]) - _R_WP @ self.grip.middle
        plant.WeldFrames(
            carriage.body_frame(),
            plant.GetFrameByName("palm"),
            RigidTransform(RotationMatrix(_R_WP), p_WP),
        )
        for instance in (self.hand, self.slide):
            plant.set_gravity_enabled(instance, False)
        scene = _scene(case)
        table = add_table(plant, scene)
        self.box, solids, feet = add_object(plant, scene.objects[0])
        plant.Finalize()
        plant.SetDefaultFloatingBaseBodyPose(self.box, initial_pose(scene.objects[0]))
        robot = [
            geometry
            for index in plant.GetBodyIndices(self.hand)
            for geometry in plant.GetCollisionGeometriesForBody(plant.get_body(index))
        ]
        filter_collisions(
            scene_graph, robot=robot, table=table, solids=solids, feet=feet.geometries
        )
        self._simulator = Simulator(builder.Build())
        self.context = plant.GetMyMutableContextFromRoot(self._simulator.get_mutable_context())
        self._time, self._height, self._q = (
            0.0,
            0.0,
            self.grip.posture_at(self.grip.opening).joint_angles,
        )
        for finger, driven in self.grip.posture_at(self.grip.opening).angles.items():
            angles = HAND.model_angles(driven)
            for name, angle in zip(HAND.model_joints(finger), angles, strict=True):
                plant.GetJointByName(name).set_angle(self.context, angle)

    def step(self, q: Array, height: float = 0.0) -> None:
        """Commands finger angles and the slide's height for a control period."""
        rate = (q - self._q) / _PERIOD, (height - self._height) / _PERIOD
        fix = self.plant.get_desired_state_input_port
        fix(self.hand).FixValue(self.context, np.concatenate([q, rate[0]]))
        fix(self.slide).FixValue(self.context, np.array([height, rate[1]]))
        self._q, self._height = q, height
        self._time += _PERIOD
        self._simulator.AdvanceTo(self._time, interruptible=False)

    def tips(self) -> Array:
        """Where the fingertips are on the box, in B, shape (4, 3) [m]."""
        X_BW = self.plant.EvalBodyPoseInWorld(self.context, self.box).inverse()
        return np.array([X_BW.multiply(self._tip(finger)) for finger in HAND.grasp_fingers])

    def _tip(self, finger: str) -> Array:
        X_WP = self.plant.GetFrameByName("palm").CalcPoseInWorld(self.context)
        return np.asarray(X_WP.multiply(HAND.tip_centre(finger, self._angles(finger))))

    def _angles(self, finger: str) -> Angles:
        names = HAND.model_joints(finger)[: len(HAND.resting.angles[finger])]
        return tuple(self.plant.GetJointByName(n).get_angle(self.context) for n in names)

    def pressed(self) -> float:
        """Mean of what both sides press [N]."""
        torques = self.plant.get_net_actuation_output_port(self.hand).Eval(self.context)
        presses = []
        for finger in HAND.grasp_fingers:
            angles = self._angles(finger)
            inward = HAND.closing_direction(finger)
            p_PC = HAND.tip_centre(finger, angles) + HAND.tip_radius * inward
            first = len(angles) * HAND.fingers.index(finger)
            felt = torques[first : first + len(angles)]
            presses.append(HAND.tip_force(finger, angles, p_PC, felt) @ inward)
        return float(0.5 * np.sum(presses))


def _scene(case: Case) -> Scene:
    """A box whose x is the closing direction's line, W's y; its depth lies along W's x."""
    along, up = case.com
    truth = Truth(
        size_m=(_DEPTH, case.width, _HEIGHT),
        mass_kg=case.mass,
        friction_table=0.3,
        friction_finger=case.friction,
        centre_of_mass_m=(along, 0.0, _HEIGHT / 2.0 + up),
    )
    box = SceneObject(name="box", model="box", pose=Pose(x_m=0.0, y_m=0.0), truth=truth)
    return load_scene("kitchen").model_copy(update={"objects": (box,)})


def slip(case: Case) -> tuple[float, float]:
    """How far a fingertip moves on the box, the most of the four [m].

    Returns:
        While it is lifted, and in the last second, in which the hand is still.
    """
    gantry = Gantry(case)
    grip = gantry.grip
    for opening in np.arange(grip.opening, 0.0, -0.02 * _PERIOD):
        gantry.step(grip.posture_at(float(opening)).joint_angles)
    closed, wound = grip.posture_at().joint_angles, 0.0
    while gantry.pressed() < case.squeeze and wound < 2.0 * case.squeeze:
        wound += _WINDING * _PERIOD
        gantry.step(closed + wound * grip.squeeze_offsets)
    q = closed + wound * grip.squeeze_offsets
    for _ in range(round(_SETTLING / _PERIOD)):
        gantry.step(q)
    before = gantry.tips()
    places = [before]
    for seconds in (_LIFTING, _HOLDING, _WATCHED):
        for t in np.arange(0.0, seconds, _PERIOD):
            u = min(1.0, float(t) / _LIFTING) if len(places) == 1 else 1.0
            gantry.step(q, _LIFT * u * u * (3.0 - 2.0 * u))
        places.append(gantry.tips())
    moved = np.linalg.norm(np.diff(places, axis=0), axis=2).max(axis=1)
    return float(moved[:2].sum()), float(moved[2])


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--cases", type=int, default=120)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--each", action="store_true", help="print every case")
    options = parser.parse_args(arguments)
    cases = drawn(options.cases, options.seed)
    started = time.perf_counter()
    slips = list(run_all(slip, cases, workers=options.workers))
    wall = time.perf_counter() - started
    multipliers = np.array([case.multiplier for case in cases])
    total, creep = np.array(slips).T
    held = (total < DROPPED) & (creep < SLIPPED)
    if options.each:
        for case, multiplier, far in sorted(zip(cases, multipliers, slips, strict=True),
                                            key=lambda row: row[1]):  # fmt: skip
            print(f"{multiplier:6.2f} {1e3 * far[0]:7.1f} {1e3 * far[1]:7.2f} mm  {case}")
    print("| multiplier | cases | held | slipped |\n|---|---|---|---|")
    edges = [0.0, 0.7, 1.0 - BAND, 1.0, 1.0 + BAND, 1.4, np.inf]
    for low, high in itertools.pairwise(edges):
        some = (multipliers >= low) & (multipliers < high)
        print(f"| {low:.1f} to {high:.1f} | {some.sum()} | {held[some].sum()} "
              f"| {(~held[some]).sum()} |")  # fmt: skip
    outside = np.abs(multipliers - 1.0) > BAND
    right = (held == (multipliers > 1.0))[outside]
    print(f"\nright outside the band: {right.sum()} of {outside.sum()}; {wall:.0f} s")


if __name__ == "__main__":
    main()

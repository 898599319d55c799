"""A flip lid under a fingertip: its way, the hands and arms that go it, and what comes of it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from objectmodels import Registry
from objectmodels.containers.lids import THICKNESS
from objectmodels.models.shapes import Cylinder
from planner.types.actions import FlipOver
from planner.types.plan import Plan
from planner.types.robot import ReachAnswer
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim.control.grasp_control import FlipControl
from sim.control.held_object_sensing import LidEstimator
from sim.control.plan_execution import execute
from sim.motion.robot_reach import ArmHandReach
from sim.robots.cell_description import Vision
from sim.robots.finger_kinematics import TIP_RADIUS
from sim.robots.lid_path import LidPath, LidShape
from sim.robots.lwr_arm import LIMITS
from sim.robots.robots import ARM, HAND
from sim.traces.trace import Trace
from sim.truth.object_truth import Truth
from sim.truth.scene_file import Pose, Scene, SceneObject, load_scene
from sim.worlds.drake.drake_world import DrakeWorld
from sim.worlds.ports import Frame, SeenPose
from tests.fakes.robots import robot_in
from tests.plans import EASY_FLIP, hand_plan

OPEN = math.radians(100.0)
CUP = "ice tea cup"


def _lid(start: float, end: float) -> LidShape:
    return LidShape(0.07, 0.035, 0.02, 0.12, start, end, TIP_RADIUS)


def state_of(
    x: float, y: float, yaw: float, *others: SeenObject, opened: float = 0.0
) -> WorldState:
    cup = SeenObject(CUP, PlanarPose(x, y, yaw), Registry.built_in().get(CUP), lid=opened)
    return WorldState({CUP: cup} | {each.name: each for each in others})


def plan_of(start: float, end: float, *, heading: float = 0.0, limit: float = 1.5) -> Plan:
    step = FlipOver(
        start=start, end=end, speed=0.05, force_limit=limit, heading=heading, prediction=EASY_FLIP
    )
    return hand_plan(CUP, None, step, task="open" if end > start else "close")


@given(st.floats(0.0, 1.9), st.booleans())
def test_a_fingertip_on_its_way_touches_the_lid_where_it_is(angle: float, opens: bool) -> None:
    lid = _lid(0.0, 1.9) if opens else _lid(1.9, 0.0)
    (tip,), (into,) = lid.tip_centres(np.array([angle])), lid.lid_normals(np.array([angle]))
    sphere = np.append(tip, TIP_RADIUS)
    # Tangent to the plate: rounding only.
    assert lid.distance_to_lid(sphere[None], np.array(angle)) == pytest.approx(0.0, abs=1e-9)
    # A little further in the lid would be pushed.
    sphere[:3] += 1e-3 * into
    assert lid.distance_to_lid(sphere[None], np.array(angle)) == pytest.approx(-1e-3, abs=1e-6)
    assert lid.angle_at_tip(tip) == pytest.approx(angle, abs=1e-9)


def test_a_lid_is_a_plate_with_a_tab() -> None:
    lid = _lid(0.0, 1.9)
    above = np.array([[0.035, 0.0, THICKNESS + 0.02, 0.01], [0.08, 0.0, THICKNESS + 0.02, 0.01]])
    beside = np.array([[0.085, 0.03, 0.0, 0.01]])
    assert lid.distance_to_lid(above, np.array(0.0)) == pytest.approx([0.01, 0.01])
    assert (
        lid.distance_to_lid(beside, np.array(0.0))[0] > 0.0
    )  # beside the tab and beyond the plate
    # Opened upright it stands at the hinge.
    upright = np.array([[-0.02, 0.0, 0.05, 0.005]])
    assert lid.distance_to_lid(upright, np.array(math.pi / 2)) == pytest.approx(
        0.02 - THICKNESS - 0.005
    )


@pytest.mark.parametrize("way", [(0.0, OPEN), (OPEN, 0.0)])
def test_hands_touch_with_nothing_but_a_fingertip(way: tuple[float, float]) -> None:
    lid = _lid(*way)
    hands = HAND.flip_postures(lid)
    assert len(hands) > 100
    rest = hands.path_spheres[:, :, :-1]  # the fingertip comes last
    angles = np.broadcast_to(hands.path.angles, rest.shape[:2])
    assert lid.distance_to_lid(rest, angles).min() > 0.0
    assert (rest[..., 2] - rest[..., 3]).min() > -lid.height


def test_the_way_begins_and_ends_off_the_lid() -> None:
    for lid in (_lid(0.0, OPEN), _lid(OPEN, 0.0)):
        way = LidPath.from_lid(lid)
        tips = np.column_stack([way.points, np.full(len(way.points), TIP_RADIUS)])
        gaps = lid.distance_to_lid(tips[:, None], way.angles)[:, 0]
        assert gaps[way.touching] == pytest.approx(0.0, abs=1e-9)
        assert gaps[[0, -3, -1]].min() > 0.02
        assert way.points[-1] == pytest.approx(way.points[0])


@pytest.mark.parametrize("heading", np.radians(np.arange(-180.0, 180.0, 60.0)).tolist())
@pytest.mark.parametrize("way", [(0.0, OPEN), (OPEN, 0.0)])
def test_a_cup_beside_the_arm_is_opened_and_closed_whichever_way_it_faces(
    heading: float, way: tuple[float, float]
) -> None:
    reach = ArmHandReach(load_scene("kitchen").cell, ARM, HAND)
    plan, state = plan_of(*way), state_of(0.24, 0.20, heading, opened=way[0])
    answer = reach.reach_plan(plan, state)
    assert answer.ok
    assert answer.margin > 0.08
    found = reach.flip_configuration(plan.steps[0], CUP, state)  # type: ignore[arg-type]
    assert not isinstance(found, ReachAnswer)
    stance, _ = found
    fingertip = []
    for point, share in zip(stance.hands.path.points, stance.hands.path.shares, strict=True):
        q = stance.joint_angles(point, float(share))
        assert (np.abs(q) < LIMITS).all()
        R_WP, p_WP = reach.mount.palm_poses(q)
        fingertip.append(p_WP + R_WP @ stance.stance.posture.tips[0])
    wanted = stance.hands.path.points @ stance.R_WE.T + stance.p_WE
    assert np.array(fingertip) == pytest.approx(wanted, abs=1e-9)


def test_what_stands_where_the_hand_must_be_is_named() -> None:
    reach = ArmHandReach(load_scene("kitchen").cell, ARM, HAND)
    cereal = Registry.built_in().get("cereal box")
    walls = [
        SeenObject(
            f"box {k}", PlanarPose(0.24 + 0.14 * np.cos(a), 0.2 + 0.14 * np.sin(a), a), cereal
        )
        for k, a in enumerate(np.radians([0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0]))
    ]
    answer = reach.reach_plan(plan_of(0.0, OPEN), state_of(0.24, 0.20, 0.0, *walls))
    assert not answer.ok
    assert answer.reason == "obstacle"
    assert answer.blocker in {each.name for each in walls}


def test_out_of_reach_is_told() -> None:
    reach = ArmHandReach(load_scene("kitchen").cell, ARM, HAND)
    answer = reach.reach_plan(plan_of(0.0, OPEN), state_of(2.0, 0.0, 0.0))
    assert not answer.ok
    assert answer.reason == "kinematics"


def test_the_view_follows_what_is_seen() -> None:
    cup = state_of(0.24, 0.2, 0.1).objects[CUP]
    view = LidEstimator(cup, 0.0, Vision())
    lean = np.array(
        [[math.cos(0.1), 0.0, math.sin(0.1)], [0, 1, 0], [-math.sin(0.1), 0, math.cos(0.1)]]
    )
    pose = SeenPose(lean @ cup.pose.R_WB, cup.pose.p_WB + np.array([0.003, 0.004, 0.0]))
    view.update_from_camera([Frame(0.0, 0.0, {CUP: pose}, {CUP: 1.0})] * 60)
    # After 60 frames an exponential mean has forgotten all but a millionth of the start.
    assert view.lid == pytest.approx(1.0, abs=1e-5)
    assert view.tilt == pytest.approx(0.1, abs=1e-5)
    assert view.displacement == pytest.approx(0.005, abs=1e-5)


def test_noise_is_not_taken_for_motion() -> None:
    vision, rng = Vision(position_noise_m=0.005, angle_noise_deg=2.0), np.random.default_rng(0)
    cup = state_of(0.24, 0.2, 0.1).objects[CUP]
    view, shown, leans = LidEstimator(cup, 0.0, vision), [], []
    off = rng.normal(0.0, vision.position_noise_m, (3000, 3))
    turns = rng.normal(0.0, np.radians(vision.angle_noise_deg), (3000, 3))
    for noise, turn in zip(off, turns, strict=True):
        R = Rotation.from_rotvec(turn).as_matrix()
        pose = SeenPose(R @ cup.pose.R_WB, cup.pose.p_WB + noise)
        view.update_from_camera([Frame(0.0, 0.0, {CUP: pose}, {CUP: 0.0})])
        shown.append(view.displacement)
        leans.append(view.tilt)
    # Single frames are farther off than what ends the work; filtered ones must not be.
    tuning = FlipControl.tuning
    assert tuning.largest_displacement < max(shown) < view.unsure
    assert max(leans) < max(tuning.largest_tilt, view.unsure_angle)
    quiet = LidEstimator(cup, 0.0, Vision())
    assert quiet.unsure < tuning.largest_displacement
    assert quiet.unsure_angle < tuning.largest_tilt


# -- in the simulated world ----------------------------------------------------------------------


def _scene(*, yaw_deg: float, mass: float = 0.3, snap: float = 0.03) -> Scene:
    """The cup alone in the kitchen."""
    lid = Registry.built_in().get(CUP).lid
    assert lid is not None
    truth = Truth(
        shape=Cylinder(radius=0.035, base_radius=0.033, height=0.12),
        mass_kg=mass,
        friction_table=0.36,
        friction_finger=0.6,
        centre_of_mass_m=(0.0, 0.0, 0.045),
        lid=lid.model_copy(update={"snap_torque": snap}),
    )
    cup = SceneObject(
        name=CUP, model=CUP, pose=Pose(x_m=0.245, y_m=0.195, yaw_deg=yaw_deg), truth=truth
    )
    return load_scene("kitchen").model_copy(update={"objects": (cup,)})


def _done(plan: Plan, world: DrakeWorld) -> Trace:
    return execute(plan, robot_in(world), {CUP: Registry.built_in().get(CUP)})


def _motion(trace: Trace) -> tuple[float, float]:
    """Largest displacement [m] and tilt [rad] of the cup."""
    poses = trace.poses[CUP]
    up = 1.0 - 2.0 * (poses[:, 1] ** 2 + poses[:, 2] ** 2)
    far = np.linalg.norm(poses[:, 4:6] - poses[0, 4:6], axis=1).max()
    return float(far), float(np.arccos(np.clip(up, -1.0, 1.0)).max())


@pytest.mark.slow
def test_a_lid_is_opened_and_closed_on_a_cup_that_stays_where_it_is() -> None:
    world = DrakeWorld(_scene(yaw_deg=25.0), seed=3)
    opened = _done(plan_of(0.0, OPEN, heading=math.radians(25.0)), world)
    assert opened.end == "handled"
    assert math.degrees(opened.lids[CUP][-1]) == pytest.approx(100.0, abs=4.0)  # seen to 2°
    closed = _done(plan_of(OPEN, 0.0, heading=math.radians(25.0)), world)
    assert closed.end == "handled"
    assert math.degrees(closed.lids[CUP][-1]) == pytest.approx(0.0, abs=0.5)
    for trace in (opened, closed):
        moved, tilt = _motion(trace)
        assert moved < 0.001
        assert tilt < math.radians(0.5)


@pytest.mark.slow
def test_a_cup_too_light_for_its_lid_is_let_go_at_once() -> None:
    world = DrakeWorld(_scene(yaw_deg=0.0, mass=0.07, snap=0.06), seed=0)
    trace = _done(plan_of(0.0, OPEN), world)
    assert trace.end in {"tilted", "slid"}
    assert _motion(trace)[1] < math.radians(10.0)  # far from 30°, where it would fall
    poses = trace.poses[CUP][-1]
    assert 1.0 - 2.0 * (poses[1] ** 2 + poses[2] ** 2) > math.cos(math.radians(0.5))


@pytest.mark.slow
def test_a_catch_that_does_not_give_way_is_told_with_its_force() -> None:
    world = DrakeWorld(_scene(yaw_deg=0.0, mass=0.9, snap=0.3), seed=0)
    trace = _done(plan_of(0.0, OPEN, limit=1.2), world)
    assert trace.end == "force"
    assert "does not move with 1." in trace.detail
    assert trace.lids[CUP][-1] == pytest.approx(0.0, abs=0.01)


@pytest.mark.slow
def test_a_lid_that_does_not_follow_is_missed(monkeypatch: pytest.MonkeyPatch) -> None:
    world = DrakeWorld(_scene(yaw_deg=0.0), seed=0)
    frames = world.robot.frames

    def stays_shut() -> list[Frame]:
        return [replace(frame, lids={CUP: 0.0}) for frame in frames()]

    monkeypatch.setattr(world.robot, "frames", stays_shut)
    trace = _done(plan_of(0.0, OPEN), world)
    assert trace.end == "missed"
    assert "does not follow" in trace.detail

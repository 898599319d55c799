"""The searches know arm and hand by their protocols alone: they serve quite another robot."""

from __future__ import annotations

import numpy as np
import pytest

from planner.types.actions import LiftUp, Push
from planner.types.robot import ReachAnswer
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim.errors import SceneError
from sim.motion.motion_planner import GraspMotion
from sim.motion.robot_reach import ArmHandReach
from sim.robots.arm import ArmKinematics
from sim.robots.cell_description import CellDescription
from sim.robots.hand import Hand, Mount
from sim.robots.robots import ARM, HAND
from sim.truth.scene_file import load_scene
from tests.unit.sim.grasp_table import CARTON, grasp, plan, scene, state
from tests.unit.sim.motion.other_robots import SixJointArm, TwoFingerGripper

GRIPPER: Hand = TwoFingerGripper()
SIX: ArmKinematics = SixJointArm()
ROBOTS = {"gripper": (ARM, GRIPPER), "six joints": (SIX, HAND), "both": (SIX, GRIPPER)}
HOME = {7: (41.0, -95.0, 75.0, -87.0, 110.0, -90.0, 42.0), 6: (0.0, -60.0, -90.0, 0.0, 60.0, 0.0)}


def _reach(arm: ArmKinematics, hand: Hand, cell: CellDescription) -> ArmHandReach:
    home = HOME[len(arm.joint_names)]
    robot = cell.robot.model_copy(update={"home_deg": home})
    return ArmHandReach(cell.model_copy(update={"robot": robot}), arm, hand)


def _push(fingers: int) -> Push:
    return Push(
        object="carton",
        face="front",
        p_BC=(-0.03, 0.0, 0.08),
        normal_W=(-1.0, 0.0, 0.0),
        direction_W=(1.0, 0.0, 0.0),
        force_limit=3.0,
        speed=0.05,
        stroke=0.05,
        fingers=fingers,
        spread=0.05 if fingers == 2 else 0.0,
        ends_on="stroke",
    )


def test_an_arm_waits_with_as_many_angles_as_it_has_joints() -> None:
    robot = load_scene("kitchen").robot.model_copy(update={"home_deg": HOME[6]})
    with pytest.raises(SceneError, match="home_deg") as raised:
        Mount.from_cell(robot, ARM, HAND)
    assert raised.value.code == "bad_scene"


@pytest.fixture(params=ROBOTS)
def reach(request: pytest.FixtureRequest) -> ArmHandReach:
    return _reach(*ROBOTS[request.param], load_scene("kitchen").cell)


def test_what_the_planner_asks_of_a_robot_is_that_of_its_hand() -> None:
    reach = _reach(SIX, GRIPPER, load_scene("kitchen").cell)
    assert reach.limits.fingertip_radius == 0.006
    assert reach.limits.finger_spreads == (0.05,)
    assert reach.limits.grasp_widths == (0.01, 0.07)
    assert reach.limits.max_force == 20.0
    assert reach.limits.lowest_grasp == pytest.approx(0.08 + 0.005)
    assert reach.grasp(0.09) is None


@pytest.mark.parametrize("fingers", [1, 2])
def test_the_tips_of_any_hand_follow_the_path_of_a_push(reach: ArmHandReach, fingers: int) -> None:
    there = WorldState({"carton": SeenObject("carton", PlanarPose(0.5, 0.2), CARTON)})
    push = _push(fingers)
    if fingers == 2 and reach.mount.hand is HAND:
        push = push.model_copy(update={"spread": HAND.finger_spreads[0]})
    found = reach.push_configuration(push, there)
    assert not isinstance(found, ReachAnswer), found
    stance, path = found[0], reach.fingertip_path(push, there)
    assert path.touch[0] == pytest.approx(0.5 - 0.03 - reach.mount.hand.tip_radius)
    for point in path.points_at():
        q = stance.joint_angles(point)
        assert q.shape == (len(reach.mount.arm.joint_names),)
        R_WP, p_WP = reach.mount.palm_poses(q)
        tips = p_WP + stance.posture.tips @ R_WP.T
        # arccos of a direction cosine near ±1 halves the digits.
        np.testing.assert_allclose(tips.mean(axis=0), point, atol=1e-7)
    assert reach.estimate_reach(push, there) > 0.0


def test_any_hand_closes_about_the_middle_of_a_grasp(reach: ArmHandReach) -> None:
    reach = _reach(reach.mount.arm, reach.mount.hand, scene().cell)
    made = plan(LiftUp(height=0.03), of=grasp(squeeze=8.0))
    there = state(PlanarPose(0.85, 0.2, -np.pi / 2.0), PlanarPose(0.85, 0.6))
    found = reach.grasp_motion(made, there)
    assert isinstance(found, GraspMotion), found
    carton = there.objects["carton"].pose
    q, valid = found.joint_angles(carton.R_WB[None], carton.p_WB[None])
    assert valid.all()
    R_WP, p_WP = reach.mount.palm_poses(q[0])
    touching = found.grip.posture_at()
    tips = dict(zip(touching.pushing, p_WP + touching.tips @ R_WP.T, strict=True))
    opposed, *others = (tips[finger] for finger in found.grip.touching_fingers)
    middle = carton.p_WB + np.array([0.0, 0.0, 0.08])
    half = np.array([0.0, 0.03 + reach.mount.hand.tip_radius, 0.0])
    np.testing.assert_allclose(opposed, middle + half, atol=1e-6)
    np.testing.assert_allclose(np.mean(others, axis=0), middle - half, atol=1e-6)


def test_a_squeeze_beyond_the_hand_is_refused_with_its_own_strength() -> None:
    reach = _reach(ARM, GRIPPER, scene().cell)
    answer = reach.reach_plan(plan(LiftUp(height=0.03), of=grasp(squeeze=16.0)), state())
    assert answer.reason == "torque"
    assert answer.numbers["strength"] == 15.0

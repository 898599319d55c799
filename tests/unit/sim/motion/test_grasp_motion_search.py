"""Whether arm and hand get through a plan, all of its way free."""

from dataclasses import replace

import numpy as np
import pytest

from objectmodels.models.kinds import BoxModel
from planner.types.actions import Aim, Carry, Grasp, LiftUp, PourOut, SetDown
from planner.types.plan import Plan
from planner.types.robot import ReachAnswer
from planner.types.world_state import Held, PlanarPose, SeenObject, WorldState
from sim.motion import motion_planner
from sim.motion.motion_planner import GraspMotion
from sim.motion.robot_reach import ArmHandReach
from sim.robots import lwr_arm as arm
from sim.robots.robots import ARM, HAND
from tests.plans import NOTHING_POURED
from tests.unit.sim.grasp_table import CARTON, grasp, plan, scene, state

REACH = ArmHandReach(scene().cell, ARM, HAND)
LIFT, DOWN = LiftUp(height=0.12), SetDown()
POUR = PourOut(
    into="mug",
    heading=np.pi / 2.0,
    lip_W=(0.75, 0.238, 0.112),
    angle=2.2,
    rate=0.35,
    wait=1.0,
    prediction=NOTHING_POURED,
)


def _way(made: Plan, seen: WorldState) -> GraspMotion:
    way = REACH.grasp_motion(made, seen)
    assert isinstance(way, GraspMotion), way
    return way


def _refused(made: Plan, seen: WorldState) -> ReachAnswer:
    answer = REACH.reach_plan(made, seen)
    assert not answer.ok
    return answer


def test_the_carton_is_lifted_and_set_down() -> None:
    answer = REACH.reach_plan(plan(LIFT, DOWN), state())
    assert answer.ok
    assert answer.margin > 0.3


def test_the_carton_is_poured_from() -> None:
    turned = state(PlanarPose(0.75, 0.0, np.pi / 2.0))
    assert REACH.reach_plan(plan(LIFT, POUR, DOWN), turned).ok


def test_the_palm_is_where_the_legs_want_it() -> None:
    way = _way(plan(LIFT, DOWN), state())
    for leg in (leg for some in way.legs for leg in some):
        R_WB, p_WB = leg.poses_at(np.linspace(0.0, 1.0, 4))
        q, valid = way.joint_angles(R_WB, p_WB)
        assert valid.all()
        R_WP, p_WP = way.mount.palm_poses(q)
        np.testing.assert_allclose(R_WP, R_WB @ way.R_BP, atol=1e-9)
        np.testing.assert_allclose(p_WP, p_WB + R_WB @ way.p_BP, atol=1e-9)
        assert (np.abs(q) < arm.LIMITS).all()


def test_a_grasp_too_low_brings_the_hand_to_the_table() -> None:
    low = REACH.limits.lowest_grasp - 0.02
    assert _refused(plan(LIFT, DOWN, of=grasp(height=low)), state()).reason == "table"
    least = plan(LIFT, DOWN, of=grasp(height=REACH.limits.lowest_grasp))
    assert REACH.reach_plan(least, state()).ok


def test_what_stands_where_the_knuckles_go_is_named() -> None:
    beside = state(mug=PlanarPose(0.75, -0.09))
    answer = _refused(plan(LIFT, DOWN), beside)
    assert (answer.reason, answer.blocker) == ("obstacle", "mug")


def test_what_is_carried_hits_nothing() -> None:
    carry = Carry(to=Aim(x=0.75, y=0.25))
    low, high = (plan(LiftUp(height=h), carry) for h in (0.02, 0.16))
    assert _refused(low, state()).blocker == "mug"
    assert REACH.reach_plan(high, state()).ok


def test_a_distance_that_is_asked_for_is_kept() -> None:
    carry = Carry(to=Aim(x=0.75, y=0.12))
    made = plan(LiftUp(height=0.02), carry)
    assert REACH.reach_plan(made, state()).ok
    limits = made.limits.model_copy(update={"clear_of": (("mug", 0.10),)})
    asked = made.model_copy(update={"limits": limits})
    assert _refused(asked, state()).blocker == "mug"


def test_too_wide_and_too_hard_are_said_with_numbers() -> None:
    wide = _refused(plan(LIFT, of=grasp(width=0.12)), state())
    assert wide.reason == "width"
    assert wide.numbers["widest"] == HAND.grasp_widths[1]
    hard = _refused(plan(LIFT, of=grasp(squeeze=30.0)), state())
    assert hard.reason == "torque"
    assert hard.numbers["force"] == 30.0


def test_an_object_deeper_than_the_fingers_are_long_is_not_held_in_its_middle() -> None:
    deep = BoxModel(
        name="carton", size=(0.06, 0.24, 0.16), mass=0.3, friction=0.3, finger_friction=0.6
    )
    seen = state()
    there = {**seen.objects, "carton": replace(seen.objects["carton"], model=deep)}
    assert _refused(plan(LIFT), WorldState(there)).reason == "object"


def test_far_away_is_out_of_reach() -> None:
    assert _refused(plan(LIFT), state(PlanarPose(1.15, 0.7, -np.pi / 2.0))).reason == "kinematics"


def test_where_the_arm_does_not_get_the_way_is_not_looked_at(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def looked(*_: object) -> None:
        raise AssertionError("nothing beyond the place where it is taken is needed")

    monkeypatch.setattr(motion_planner, "step_segments", looked)
    monkeypatch.setattr(motion_planner, "HoldClearance", looked)
    assert _refused(plan(LIFT), state(PlanarPose(0.9, 0.9))).reason == "kinematics"


def test_the_elbow_swings_before_it_goes_on_with_what_it_holds() -> None:
    lifted = _way(plan(LIFT), state())
    last = lifted.legs[1][-1]
    q, _ = lifted.joint_angles(*(end[None] for end in last.end_pose))
    held = Held("carton", grasp(), LIFT.height, tuple(q[0].tolist()))
    for y in (-0.2, 0.1):
        made = plan(Carry(to=Aim(x=0.72, y=y)), DOWN, held=True)
        way = _way(made, state(held=held))
        first, _ = way.joint_angles(*way.legs[1][0].poses_at(np.zeros(1)))
        np.testing.assert_allclose(way.there[0], q[0], atol=0.15)  # a grid of elbow angles
        np.testing.assert_allclose(way.there[-1], first[0], atol=1e-9)
        # The hand stays where it is.
        palms = lifted.mount.palm_poses(np.array(way.there))[1]
        np.testing.assert_allclose(palms, palms[:1].repeat(len(palms), axis=0), atol=1e-9)


@pytest.mark.parametrize("heading", [-60.0, 0.0, 60.0])
def test_near_the_arm_any_heading_does(heading: float) -> None:
    yaw = np.radians(heading - 90.0)
    c, s = np.cos(yaw), np.sin(yaw)
    turned = Grasp(
        p_BG=(0.0, 0.0, 0.08),
        closing_W=(c, s, 0.0),
        approach_W=(-s, c, 0.0),
        width=0.06,
        squeeze=8.0,
        needed=4.0,
        strongest=12.0,
    )
    alone = WorldState({"carton": SeenObject("carton", PlanarPose(0.6, 0.0, yaw), CARTON)})
    assert REACH.reach_plan(plan(LIFT, DOWN, of=turned), alone).ok

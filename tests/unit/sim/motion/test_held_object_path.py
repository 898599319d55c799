"""The way of what is held, leg after leg."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from objectmodels.geometry.rotations import axis_rotation
from planner.types.actions import Aim, Carry, LiftUp, PourOut, SetDown
from sim.motion.held_object_path import (
    HeldObject,
    HeldSegment,
    grasp_frame,
    lip_point,
    upright_again,
    withdrawal_vectors,
)
from tests.plans import NOTHING_POURED
from tests.unit.sim.grasp_table import grasp, held_segments, plan, state

LIFT, DOWN = LiftUp(height=0.12), SetDown()
POUR = PourOut(
    into="mug",
    heading=np.pi / 2.0,
    lip_W=(0.75, 0.24, 0.11),
    angle=2.0,
    rate=0.35,
    wait=1.0,
    prediction=NOTHING_POURED,
)
CARTON = state().objects["carton"]
OFF = np.array([-0.07, 0.0, 0.0])


def _pour() -> tuple[HeldSegment, ...]:
    return held_segments(HeldObject.from_plan(plan(LIFT, POUR, DOWN), state()), OFF)[2]


def test_each_leg_begins_where_the_one_before_ends() -> None:
    carry = Carry(to=Aim(x=0.7, y=-0.1, yaw=-1.2))
    legs = [
        leg
        for some in held_segments(HeldObject.from_plan(plan(LIFT, carry, POUR, DOWN), state()), OFF)
        for leg in some
    ]
    for before, after in itertools.pairwise(legs):
        R_WB, p_WB = after.poses_at(np.zeros(1))
        np.testing.assert_allclose(R_WB[0], before.end_pose[0], atol=1e-12)
        np.testing.assert_allclose(p_WB[0], before.end_pose[1], atol=1e-12)


def test_it_is_set_down_where_it_was_carried() -> None:
    steps = (LIFT, Carry(to=Aim(x=0.7, y=-0.1, yaw=-1.2)), DOWN)
    _, _, _, down, _ = held_segments(HeldObject.from_plan(plan(*steps), state()), OFF)
    R_WB, p_WB = down[-1].end_pose
    np.testing.assert_allclose(p_WB, (0.7, -0.1, 0.0), atol=1e-12)
    assert np.arctan2(R_WB[1, 0], R_WB[0, 0]) == pytest.approx(-1.2)


def test_the_hand_leaves_as_the_object_was_turned() -> None:
    *_, back = held_segments(
        HeldObject.from_plan(plan(LIFT, Carry(to=Aim(x=0.7, y=0.0, yaw=0.0)), DOWN), state()), OFF
    )
    # A quarter turn counter-clockwise: what was −x is −y.
    np.testing.assert_allclose(back[0].end - back[0].start, (0.0, -0.07, 0.0), atol=1e-12)


def test_the_lip_stays_over_the_mug_while_it_leans() -> None:
    lean = CARTON.pose.R_WB.T @ np.array([0.0, 1.0, 0.0])
    p_BC = lip_point(CARTON, lean)
    for leg in _pour()[1:4]:
        R_WB, p_WB = leg.poses_at(np.linspace(0.0, 1.0, 5))
        place = p_WB + R_WB @ p_BC
        np.testing.assert_allclose(place[:, :2] - POUR.lip_W[:2], 0.0, atol=1e-12)
    np.testing.assert_allclose(place[-1], POUR.lip_W, atol=1e-12)


def test_it_leans_as_far_and_where_it_is_told() -> None:
    R_WB, _ = _pour()[3].end_pose
    up = R_WB[:, 2]
    assert np.arctan2(up[1], up[2]) == pytest.approx(POUR.angle)
    assert up[0] == pytest.approx(0.0, abs=1e-12)


def test_after_pouring_it_hangs_where_it_hung() -> None:
    legs = _pour()
    start, end = legs[0].poses_at(np.zeros(1)), legs[-1].end_pose
    np.testing.assert_allclose(end[0], start[0][0], atol=1e-12)
    np.testing.assert_allclose(end[1], start[1][0], atol=1e-12)


def test_a_pour_that_is_stopped_goes_back_the_way_it_came() -> None:
    first, *tilting = _pour()[:4]
    back = upright_again([first, tilting[0]], tilting[1], 0.4)
    stopped = tilting[1].poses_at(np.array([0.4]))
    np.testing.assert_allclose(back[0].poses_at(np.zeros(1))[1], stopped[1], atol=1e-12)
    np.testing.assert_allclose(back[-1].end_pose[1], first.poses_at(np.zeros(1))[1][0], atol=1e-12)


def test_a_leg_is_no_faster_than_the_plan() -> None:
    slow = plan(LIFT, DOWN).model_copy(update={"speed": 0.01})
    (lift,) = held_segments(HeldObject.from_plan(slow, state()), OFF)[1]
    assert lift.share_rate == pytest.approx(0.01 / LIFT.height)


def test_the_open_hand_withdraws_until_it_is_off() -> None:
    back, up = withdrawal_vectors(grasp(), CARTON)
    # Half the depth along the approach, and something beyond.
    assert back[0] < -0.04
    assert back[1] == back[2] == 0.0
    assert up[2] > 0.08


def test_the_axes_of_a_grasp_are_those_of_the_palm() -> None:
    turned = axis_rotation([0.0, 0.0, 1.0], 0.3)
    R_BG, p_BG = grasp_frame(grasp(), turned)
    np.testing.assert_allclose(turned @ R_BG[:, 0], (0.0, 1.0, 0.0), atol=1e-12)
    np.testing.assert_allclose(turned @ R_BG[:, 2], (1.0, 0.0, 0.0), atol=1e-12)
    assert np.linalg.det(R_BG) == pytest.approx(1.0)
    np.testing.assert_allclose(p_BG, (0.0, 0.0, 0.08))


def test_a_leg_back_is_the_same_leg() -> None:
    leg = replace(_pour()[2], end=np.array([0.7, 0.2, 0.3]))
    R_there, p_there = leg.poses_at(np.array([0.3]))
    R_back, p_back = leg.way_back().poses_at(np.array([0.7]))
    np.testing.assert_allclose(R_back, R_there, atol=1e-12)
    np.testing.assert_allclose(p_back, p_there, atol=1e-12)

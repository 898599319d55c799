"""Places that only just count as the one asked, and when an object is brought there."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import plan
from planner.problem.directions import angle_between, heading_of
from planner.problem.footprints import footprint, free_travel, gap
from planner.pushing.strategies import nearly_goal_poses
from planner.types.defaults import DEFAULTS
from planner.types.plan import Plan
from planner.types.world_state import PlanarPose, WorldState
from tests.unit.planner.conftest import RuledReach, frame_of, planned, problem_of, refused, world

EXACT = 1e-9  # sums of a few floats of order one

AHEAD = np.array([1.0, 0.0])


def _before_a_mug(room: float) -> WorldState:
    """A soup can with so much room ahead until it is too near to a fragile mug [m]."""
    state = world(soup_can=PlanarPose(0.45, 0.0), mug=PlanarPose(0.80, 0.0))
    own, mug = footprint(state.objects["soup can"]), state.objects["mug"]
    free = free_travel(own, footprint(mug), AHEAD, DEFAULTS.clearance_fragile)
    there = replace(mug, pose=replace(mug.pose, x=mug.pose.x + room - free), fragile=True)
    return replace(state, objects={**state.objects, "mug": there})


def test_what_is_in_the_way_a_little_is_come_before() -> None:
    made = planned("push the soup can 11 cm away", _before_a_mug(0.104))
    assert len(made.pushes) == 1
    assert 0.10 + DEFAULTS.aim_position - EXACT <= made.push.stroke <= 0.104
    assert "the mug stands in the way of the soup can after 104 mm" in made.notes[0]
    assert "8 mm too early" in made.notes[1]


def test_on_the_way_the_clearance_is_kept() -> None:
    state = _before_a_mug(0.104)
    made = planned("push the soup can 11 cm away", state)
    assert made.aim is not None
    can = state.objects["soup can"]
    there = replace(can, pose=replace(can.pose, x=made.aim.x, y=made.aim.y))
    apart = gap(footprint(there), footprint(state.objects["mug"]))
    assert apart >= DEFAULTS.clearance_fragile - EXACT


def test_farther_off_than_the_tolerance_it_is_refused() -> None:
    refusal = refused("push the soup can 11 cm away", _before_a_mug(0.06))
    assert refusal.reason == "blocked"
    assert refusal.numbers["free"] == pytest.approx(0.06, abs=EXACT)


def test_where_the_table_ends_it_is_alike() -> None:
    # The box is 90 mm long and stays 10 mm from the edge at 1.2 m: 108 mm are left.
    state = world(ice_tea_box=PlanarPose(1.2 - 0.01 - 0.045 - 0.108, 0.0))
    made = planned("push the ice tea box 11 cm away", state)
    assert made.push.stroke == pytest.approx(0.106, abs=EXACT)
    assert "the table ends" in made.notes[0]


def test_what_was_begun_keeps_its_aim() -> None:
    begun = planned("push the soup can 11 cm away", _before_a_mug(0.3))
    state = _before_a_mug(0.104)
    after = plan(frame_of("push the soup can 11 cm away"), state, RuledReach(), previous=begun)
    assert not isinstance(after, Plan)


def test_the_aim_of_a_place_near_by_is_kept_by_the_next_plan() -> None:
    state = _before_a_mug(0.104)
    begun = planned("push the soup can 11 cm away", state)
    can = state.objects["soup can"]
    on = replace(can, pose=replace(can.pose, x=can.pose.x + 0.05))
    state = replace(state, objects={**state.objects, "soup can": on})
    after = plan(frame_of("push the soup can 11 cm away"), state, RuledReach(), previous=begun)
    assert isinstance(after, Plan)
    assert after.aim == begun.aim


@pytest.mark.parametrize(
    "text",
    [
        "put the soup can next to the mug",
        "push the soup can away until it touches the mug",
        "turn the ice tea box 30 degrees",
        "push the soup can at least 16 mm away",
    ],
)
def test_only_a_displacement_has_places_near_by(text: str) -> None:
    state = world(
        soup_can=PlanarPose(0.45, 0.0),
        mug=PlanarPose(0.7, 0.0),
        ice_tea_box=PlanarPose(0.5, 0.3),
    )
    frame = frame_of(text)
    assert not list(nearly_goal_poses(problem_of(frame, state, DEFAULTS)))


@pytest.mark.parametrize(("millimetres", "places"), [(29, 0), (31, 14)])
def test_a_way_of_less_than_three_tolerances_has_no_places_near_by(
    millimetres: int, places: int
) -> None:
    frame = frame_of(f"push the ice tea box away by {millimetres} mm")
    problem = problem_of(frame, world(ice_tea_box=PlanarPose(0.45, 0.0)), DEFAULTS)
    assert len(list(nearly_goal_poses(problem))) == places


@given(
    st.integers(5, 60),
    st.floats(-math.pi, math.pi),
    st.sampled_from(["", "at least ", "at most "]),
    st.sampled_from(["away", "to the left", "away and to the right"]),
)
@pytest.mark.slow
def test_places_near_by_are_within_the_tolerances(
    centimetres: int, yaw: float, bound: str, words: str
) -> None:
    state = world(ice_tea_box=PlanarPose(0.45, 0.0, yaw))
    target, d = state.objects["ice tea box"], DEFAULTS
    frame = frame_of(f"push the ice tea box {words} by {bound}{centimetres} cm")
    problem = problem_of(frame, state, d)
    assert problem.goal.heading is not None
    found = list(nearly_goal_poses(problem))
    assert len(found) == 14
    for aim, _ in found:
        way = np.array([aim.x, aim.y, 0.0]) - target.pose.p_WB
        off = angle_between(heading_of(way), problem.goal.heading)
        along = float(np.linalg.norm(way)) * math.cos(off)
        # The way there ends as exactly as a look is trusted: so much is left of the tolerances.
        length, spare = 0.01 * centimetres, d.distance_tolerance - d.aim_position
        low, high = {
            "": (length - spare, length + spare),
            "at least ": (length + d.aim_position, math.inf),
            "at most ": (0.0, length - d.aim_position),
        }[bound]
        assert low - EXACT <= along <= high + EXACT
        assert along * (math.tan(d.direction_tolerance) - math.tan(abs(off))) >= (
            d.aim_position - EXACT
        )
        assert aim.yaw == target.pose.yaw

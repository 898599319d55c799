"""Where to and how far, from where things stand."""

from __future__ import annotations

import math

import pytest

from grammar.frames import command as g
from planner.problem.directions import angle_between
from planner.problem.goal_poses import goal_distance, goal_heading
from planner.types.defaults import DEFAULTS
from planner.types.world_state import PlanarPose
from tests.unit.planner.conftest import world

CEREAL = g.ObjectRef(text="cereal", id="cereal box")
STATE = world(ice_tea_box=PlanarPose(0.40, 0.0), cereal_box=PlanarPose(0.40, 0.40))
TEA = STATE.objects["ice tea box"]


@pytest.mark.parametrize(
    ("goal", "heading"),
    [
        (g.Displace(direction="toward"), math.pi),
        (g.Displace(direction=("away", "left")), math.pi / 4),
        (g.Displace(heading=1.0), 1.0),
        (g.Displace(toward=CEREAL), math.pi / 2),
        (g.Displace(away_from=CEREAL), -math.pi / 2),
        (g.Displace(toward="right_edge"), -math.pi / 2),
        (g.Displace(away_from="back_edge"), math.pi),
        (g.Displace(toward="center"), 0.0),
        (g.Displace(), None),
    ],
)
def test_where_to(goal: g.Displace, heading: float | None) -> None:
    found = goal_heading(goal, TEA, STATE, DEFAULTS)
    if found is None or heading is None:
        assert found is heading
    else:
        assert angle_between(found, heading) == pytest.approx(0.0, abs=1e-9)  # rounding


def test_towards_an_edge_that_is_close_already() -> None:
    near = world(ice_tea_box=PlanarPose(0.40, 0.74))
    tea = near.objects["ice tea box"]
    # 15 mm are left, less than "at the edge" leaves; the way still leads to it.
    assert goal_heading(g.Displace(toward="left_edge"), tea, near, DEFAULTS) == pytest.approx(
        math.pi / 2
    )


def test_shares_of_the_way_to_an_object() -> None:
    half_depth = STATE.objects["cereal box"].model.extents[1] / 2
    free = 0.40 - 0.045 - half_depth - DEFAULTS.place_gap
    for share in (0.5, 1.0):
        goal = g.Displace(toward=CEREAL, fraction=share)
        distance, reason = goal_distance(goal, TEA, STATE, DEFAULTS)
        assert reason is None
        assert distance == pytest.approx(share * free, abs=1e-9)


@pytest.mark.parametrize(
    ("goal", "distance"),
    [
        (g.Displace(direction="away"), DEFAULTS.distance),
        (g.Displace(amount="little"), DEFAULTS.distance_little),
        (g.Displace(amount="lot"), DEFAULTS.distance_lot),
    ],
)
def test_how_far_by_default(goal: g.Displace, distance: float) -> None:
    found, reason = goal_distance(goal, TEA, STATE, DEFAULTS)
    assert (found, bool(reason)) == (distance, True)


def test_a_default_stops_at_what_it_leads_to_and_at_what_is_allowed() -> None:
    near = world(ice_tea_box=PlanarPose(0.40, 0.0), cereal_box=PlanarPose(0.40, 0.18))
    tea = near.objects["ice tea box"]
    half_depth = near.objects["cereal box"].model.extents[1] / 2
    found, _ = goal_distance(g.Displace(toward=CEREAL), tea, near, DEFAULTS)
    assert found == pytest.approx(0.18 - 0.045 - half_depth - DEFAULTS.place_gap, abs=1e-9)
    most = (g.MaxDistance(value=0.05),)
    found, _ = goal_distance(g.Displace(direction="away"), tea, near, DEFAULTS, most)
    assert found == pytest.approx(0.04)


def test_a_distance_that_is_said_stands() -> None:
    goal = g.Displace(toward=CEREAL, distance=0.33)
    assert goal_distance(goal, TEA, STATE, DEFAULTS) == (0.33, None)

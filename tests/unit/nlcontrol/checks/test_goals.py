"""Checks of goals against traces made by hand, whose truth is known."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from grammar.frames import command as g
from nlcontrol.checks import frame_checks as clause_checks
from objectmodels import BoxModel
from planner.types.defaults import DEFAULTS
from tests.unit.nlcontrol.checks.conftest import (
    AWAY,
    MUG,
    ROUND,
    TABLE,
    TraceMaker,
    check,
    frame_of,
    one,
)


def test_a_good_push_holds_every_clause(make_trace: TraceMaker, box: BoxModel) -> None:
    checks = check(frame_of(AWAY, g.NoTopple(), g.NoTurn()), make_trace(), box)
    assert all(c.ok for c in checks)
    assert [c.clause for c in checks] == [
        "displace", "displace", "no_topple", "no_topple", "no_turn", "others",
    ]  # fmt: skip
    assert checks[0].spans == AWAY.spans


@pytest.mark.parametrize(("travelled", "ok"), [(0.0905, True), (0.1095, True), (0.0895, False)])
def test_default_distance_within_its_tolerance(
    make_trace: TraceMaker, box: BoxModel, travelled: float, ok: bool
) -> None:
    found = one(check(frame_of(), make_trace(travel=(travelled, 0.0)), box), "moved")
    assert found.ok is ok
    assert found.expected == DEFAULTS.distance
    # The trace is exact; only rounding stands between it and the measured value.
    assert found.measured == pytest.approx(travelled, abs=1e-12)


@pytest.mark.parametrize(
    ("goal", "expected"),
    [
        (g.Displace(direction="away", amount="little"), DEFAULTS.distance_little),
        (g.Displace(direction="away", amount="lot"), DEFAULTS.distance_lot),
        (g.Displace(direction="away", distance=0.15), 0.15),
    ],
)
def test_expected_distance(
    make_trace: TraceMaker, box: BoxModel, goal: g.Displace, expected: float
) -> None:
    checks = check(frame_of(goal), make_trace(travel=(expected, 0.0)), box)
    assert one(checks, "moved").expected == expected
    assert one(checks, "moved").ok


@pytest.mark.parametrize(
    ("bound", "travelled", "ok"),
    [("at_least", 0.2, True), ("at_least", 0.09, False), ("at_most", 0.09, True),
     ("at_most", 0.11, False)],
)  # fmt: skip
def test_distances_as_bounds(
    make_trace: TraceMaker, box: BoxModel, bound: g.Bound, travelled: float, ok: bool
) -> None:
    goal = g.Displace(direction="away", distance=0.1, bound=bound)
    checks = check(frame_of(goal), make_trace(travel=(travelled, 0.0)), box)
    assert one(checks, "moved in").ok is ok


@pytest.mark.parametrize(
    ("goal", "nothing"),
    [
        (g.Displace(direction="away", distance=0.001), "moved in"),
        (g.Displace(direction="away", distance=0.1, bound="at_most"), "moved at all"),
        (g.Rotate(angle=math.radians(1.0)), "turned"),
        (g.Rotate(angle=math.radians(0.5), sense="ccw"), "turned"),
        (g.Rotate(angle=math.radians(30.0), bound="at_most"), "turned at all"),
        (g.Tilt(angle=math.radians(2.0)), "largest tilt"),
        (g.Tilt(angle=math.radians(8.0), bound="at_most"), "tilted at all"),
        (g.Lift(height=0.015), "held higher"),
        (g.Lift(height=0.1, bound="at_most"), "lifted at all"),
    ],
)
def test_nothing_done_is_no_amount(
    make_trace: TraceMaker, box: BoxModel, goal: g.Goal, nothing: str
) -> None:
    trace = make_trace(travel=(0.0, 0.0))
    found = [c for c in check(frame_of(goal), trace, box) if c.quantity.startswith(nothing)]
    assert [c.verdict for c in found] == ["not_held"]


@pytest.mark.parametrize(("asked", "tolerance"), [(0.3, 0.01), (0.03, 0.01), (0.012, 0.004)])
def test_a_tolerance_is_at_most_a_third_of_what_is_asked(
    make_trace: TraceMaker, box: BoxModel, asked: float, tolerance: float
) -> None:
    goal = g.Displace(direction="away", distance=asked)
    checks = check(frame_of(goal), make_trace(travel=(asked, 0.0)), box)
    assert one(checks, "moved").tolerance == pytest.approx(tolerance)


@pytest.mark.parametrize(
    ("goal", "travel"),
    [
        (g.Displace(direction="left"), (0.0, 0.1)),
        (g.Displace(direction="right"), (0.0, -0.1)),
        (g.Displace(direction="toward"), (-0.1, 0.0)),
        (g.Displace(direction=("away", "left")), (0.0707, 0.0707)),
        (g.Displace(heading=math.radians(30)), (0.0866, 0.05)),
        (g.Displace(toward=MUG), (0.0, 0.085)),
        (g.Displace(away_from=MUG), (0.0, -0.1)),
    ],
)
def test_every_way_to_name_a_direction(
    make_trace: TraceMaker, box: BoxModel, goal: g.Displace, travel: tuple[float, float]
) -> None:
    right = check(frame_of(goal), make_trace(travel=travel), box)
    assert all(c.ok for c in right)
    wrong = check(frame_of(goal), make_trace(travel=(-travel[0], -travel[1])), box)
    assert not one(wrong, "off the asked direction").ok
    assert not one(wrong, "moved").ok


def test_a_box_that_hardly_moved_has_no_direction(make_trace: TraceMaker, box: BoxModel) -> None:
    checks = check(frame_of(), make_trace(travel=(0.0, 0.005)), box)
    assert one(checks, "off the asked direction").ok
    assert not one(checks, "moved").ok


def test_a_push_with_no_direction_may_go_anywhere(make_trace: TraceMaker, box: BoxModel) -> None:
    checks = check(frame_of(g.Displace()), make_trace(travel=(0.06, -0.08)), box)
    assert all(c.ok for c in checks)
    assert not any("direction" in c.quantity and "off" in c.quantity for c in checks)


def test_a_box_that_falls_while_pushed_is_a_failure(make_trace: TraceMaker, box: BoxModel) -> None:
    fallen = make_trace(tilt=math.radians(90))
    assert not one(check(frame_of(), fallen, box), "tilt at the end").ok


def test_slide_stays_on_its_base(make_trace: TraceMaker, box: BoxModel) -> None:
    rocked = make_trace(tilt=math.radians(7), tilt_at_end=0.0)
    assert not one(check(frame_of(action="slide"), rocked, box), "largest tilt").ok
    assert all(c.ok for c in check(frame_of(action="push"), rocked, box))


@pytest.mark.parametrize(
    ("direction", "heading", "ok"),
    [
        (None, 0.0, True),
        ("left", math.pi / 2, True),
        ("left", -math.pi / 2, False),
        ("left", math.radians(130), True),
        ("left", math.radians(140), False),
    ],
)
def test_topple_and_its_side(
    make_trace: TraceMaker,
    box: BoxModel,
    direction: g.Direction | None,
    heading: float,
    ok: bool,
) -> None:
    goal = g.Topple(direction=direction)
    trace = make_trace(tilt=math.radians(90), tilt_heading=heading, end="toppled")
    checks = check(frame_of(goal, action="topple"), trace, box)
    assert all(c.ok for c in checks) is ok
    assert one(checks, "tilt at the end").ok


def test_a_box_that_rocks_back_has_not_toppled(make_trace: TraceMaker, box: BoxModel) -> None:
    trace = make_trace(tilt=math.radians(65), tilt_at_end=0.0)
    assert not check(frame_of(g.Topple(), action="topple"), trace, box)[0].ok


def test_what_rocks_at_the_end_neither_stands_nor_lies(
    make_trace: TraceMaker, box: BoxModel
) -> None:
    trace = make_trace(tilt=math.radians(90))
    upright = trace.poses["ice tea box"][0, :4]
    trace.poses["ice tea box"][-5:, :4] = upright
    assert not check(frame_of(g.Topple(), action="topple"), trace, box)[0].ok
    assert not one(check(frame_of(AWAY, g.NoTopple()), trace, box), "tilt at the end").ok


@pytest.mark.parametrize(
    ("goal", "travel", "ok"),
    [
        # The box is 90 mm wide, the mug 80 mm, 200 mm to its left: 115 mm lie between them.
        (g.Place(relation="next_to", reference=(MUG,)), (0.0, 0.085), True),
        (g.Place(relation="next_to", reference=(MUG,)), (0.0, 0.06), False),
        (g.Place(relation="next_to", reference=(MUG,), distance=0.05), (0.0, 0.065), True),
        (g.Place(relation="next_to", reference=(MUG,), distance=0.05), (0.0, 0.080), False),
        (g.Place(relation="right_of", reference=(MUG,)), (0.0, 0.085), True),
        (g.Place(relation="left_of", reference=(MUG,)), (0.0, 0.085), False),
        (g.Place(relation="left_of", reference=(MUG,)), (0.0, 0.315), True),
        (g.Place(relation="behind", reference=(MUG,)), (0.115, 0.2), True),
        (g.Place(relation="in_front_of", reference=(MUG,)), (0.115, 0.2), False),
        (g.Place(relation="touching", reference=(MUG,)), (0.0, 0.1135), True),
        (g.Place(relation="touching", reference=(MUG,)), (0.0, 0.1), False),
        (g.Place(relation="at", reference=g.Point(x=0.6, y=0.0)), (0.095, 0.0), True),
        (g.Place(relation="at", reference=g.Point(x=0.6, y=0.0)), (0.085, 0.0), False),
        (g.Place(relation="at", reference="center"), (0.04, 0.0), True),
        (g.Place(relation="at", reference="left_edge"), (0.0, 0.70), True),
        (g.Place(relation="at", reference="right_edge"), (0.0, 0.70), False),
        # From y = 0 to y = 0.705, and half of that.
        (g.Place(relation="at", reference="left_edge", fraction=0.5), (0.0, 0.3525), True),
        (g.Place(relation="at", reference="left_edge", fraction=0.5), (0.0, 0.30), False),
    ],
)
def test_places(
    make_trace: TraceMaker, box: BoxModel, goal: g.Place, travel: tuple[float, float], ok: bool
) -> None:
    checks = check(frame_of(goal), make_trace(travel=travel), box)
    assert all(c.ok for c in checks if c.clause == "place") is ok
    assert [c.clause for c in checks][-2:] == ["place", "others"]
    assert one(checks, "tilt at the end").ok


def test_between_two_objects(make_trace: TraceMaker, box: BoxModel) -> None:
    other = g.ObjectRef(text="can", id="can")
    goal = g.Place(relation="between", reference=(MUG, other))
    for travel, ok in (((0.1, 0.0), True), ((0.1, 0.04), False)):
        trace = make_trace(travel=travel)
        # Mugs at (0.6, 0.2) and (0.6, -0.2).
        trace.poses["mug"][:, 4] = 0.6
        trace.poses["can"] = trace.poses["mug"] * [1, 1, 1, 1, 1, -1, 1]
        models = {"ice tea box": box, "mug": ROUND, "can": ROUND}
        checks = clause_checks.check(frame_of(goal), trace, models, TABLE)
        assert one(checks, "middle").ok is ok


def test_a_fallen_object_is_in_no_place(make_trace: TraceMaker, box: BoxModel) -> None:
    goal = g.Place(relation="at", reference=g.Point(x=0.6, y=0.0))
    checks = check(frame_of(goal), make_trace(tilt=math.radians(90)), box)
    assert not one(checks, "tilt at the end").ok


def test_a_place_is_relative_to_where_the_other_is_at_the_end(
    make_trace: TraceMaker, box: BoxModel
) -> None:
    trace = make_trace(travel=(0.0, 0.085))
    trace.poses["mug"][-50:, 5] += 0.1
    goal = g.Place(relation="next_to", reference=(MUG,))
    assert not one(check(frame_of(goal), trace, box), "gap").ok


@pytest.mark.parametrize(
    ("goal", "travelled"),
    [
        # 115 mm are free, 30 mm are left: next to the mug after 85 mm.
        (g.Displace(toward=MUG, fraction=1.0), 0.085),
        (g.Displace(toward=MUG, fraction=0.5), 0.0425),
        (g.Displace(toward=MUG), 0.085),
        (g.Displace(toward=MUG, distance=0.03), 0.03),
        (g.Displace(toward="left_edge", distance=0.2), 0.2),
    ],
)
def test_ways_towards_something(
    make_trace: TraceMaker, box: BoxModel, goal: g.Displace, travelled: float
) -> None:
    found = one(check(frame_of(goal), make_trace(travel=(0.0, travelled)), box), "moved")
    # A round mug is a polygon of equal area, whose corners stand out by less than 0.5 mm.
    assert found.expected == pytest.approx(travelled, abs=5e-4)
    assert found.ok


@pytest.mark.parametrize(
    ("goal", "degrees", "ok"),
    [
        (g.Rotate(angle=0.5), 28.6, True),
        (g.Rotate(angle=0.5), -28.6, True),
        (g.Rotate(angle=0.5), 32.0, False),
        (g.Rotate(angle=0.5, sense="ccw"), 28.6, True),
        (g.Rotate(angle=0.5, sense="cw"), 28.6, False),
        (g.Rotate(angle=0.5, sense="cw"), -28.6, True),
        (g.Rotate(), 92.0, True),
        (g.Rotate(amount="little"), 15.0, True),
        (g.Rotate(amount="lot"), 180.0, True),
        (g.Rotate(angle=math.tau), 359.0, True),
        (g.Rotate(angle=0.5, bound="at_least"), 60.0, True),
        (g.Rotate(angle=0.5, bound="at_most"), 60.0, False),
    ],
)
def test_turns(
    make_trace: TraceMaker, box: BoxModel, goal: g.Rotate, degrees: float, ok: bool
) -> None:
    trace = make_trace(travel=(0.0, 0.0), turned=math.radians(degrees))
    checks = check(frame_of(goal, action="turn"), trace, box)
    assert all(c.ok for c in checks) is ok
    assert one(checks, "moved while turning").ok


def test_what_is_turned_stays_where_it_is(make_trace: TraceMaker, box: BoxModel) -> None:
    trace = make_trace(travel=(0.03, 0.0), turned=math.radians(90))
    assert not one(check(frame_of(g.Rotate()), trace, box), "moved while turning").ok


@pytest.mark.parametrize(
    ("goal", "degrees", "heading", "ok"),
    [
        (g.Tilt(), 10.0, 0.0, True),
        (g.Tilt(), 13.0, 0.0, False),
        (g.Tilt(amount="little"), 5.0, 0.0, True),
        # 55 % of the angle of no return, 21.4 degrees.
        (g.Tilt(amount="lot"), 11.8, 0.0, True),
        (g.Tilt(angle=math.radians(8), direction="left"), 8.0, math.pi / 2, True),
        (g.Tilt(angle=math.radians(8), direction="left"), 8.0, 0.0, False),
        (g.Tilt(angle=math.radians(8), bound="at_least"), 12.0, 0.0, True),
    ],
)
def test_tilts(
    make_trace: TraceMaker, box: BoxModel, goal: g.Tilt, degrees: float, heading: float, ok: bool
) -> None:
    trace = make_trace(
        travel=(0.0, 0.0), tilt=math.radians(degrees), tilt_at_end=0.0, tilt_heading=heading
    )
    checks = check(frame_of(goal, g.NoTopple(), action="tilt"), trace, box)
    assert all(c.ok for c in checks) is ok


def test_a_tilt_ends_on_the_base(make_trace: TraceMaker, box: BoxModel) -> None:
    fallen = make_trace(tilt=math.radians(10))
    assert not one(check(frame_of(g.Tilt(), action="tilt"), fallen, box), "tilt at the end").ok


def test_a_touch_of_nothing_in_particular(make_trace: TraceMaker, box: BoxModel) -> None:
    touched = check(frame_of(g.NoGoal()), make_trace(travel=(0.0, 0.0)), box)
    assert all(c.ok for c in touched)
    trace = make_trace()
    trace.phase[:] = "look"
    assert not check(frame_of(g.NoGoal()), trace, box)[0].ok


def test_what_is_there_already_needs_no_push(make_trace: TraceMaker, box: BoxModel) -> None:
    trace = replace(make_trace(travel=(0.0, 0.0)), end="reached", tips={}, felt={})
    trace.phase[:] = "look"
    goal = g.Place(relation="at", reference=g.Point(x=0.5, y=0.0))
    manner = (g.Effector(tool="finger", count=2), g.ContactRegion(face="front"), g.Hard())
    checks = check(frame_of(goal, *manner, g.Gentle(), g.NoTurn()), trace, box)
    assert all(c.ok for c in checks)
    assert {c.clause for c in checks} >= {"effector", "contact", "hard", "gentle", "no_turn"}

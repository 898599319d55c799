"""Clause checks against traces made by hand, whose truth is known."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, get_args

import numpy as np
import pytest

from grammar import frames as g
from nlcontrol import checks as clause_checks
from nlcontrol.checks import Check, not_held, require_checkable
from nlcontrol.errors import ControlError
from objectmodels import BoxModel, CylinderModel
from planner.defaults import DEFAULTS
from planner.state import TableState
from sim.trace import ContactEvent, Trace, joined
from tests.unit.nlcontrol.pushes import seen

TraceMaker = Callable[..., Trace]
BOX = g.ObjectRef(text="ice tea box", id="ice tea box")
MUG = g.ObjectRef(text="mug", id="mug")
TABLE = TableState(-0.2, 1.2, -0.8, 0.8)
ROUND = CylinderModel(name="mug", radius=0.04, height=0.1, mass=0.3, friction=0.4)
AWAY = g.Displace(direction="away", spans=((21, 25),))


def _frame(goal: Any = AWAY, *constraints: Any, action: g.Action = "push") -> g.Frame:
    return g.Frame(action=action, object=BOX, goal=goal, constraints=constraints)


def check(frame: g.Frame, trace: Trace, box: BoxModel) -> tuple[Check, ...]:
    """The checks of a box that a mug, 80 mm wide, stands 200 mm to the left of."""
    return clause_checks.check(frame, trace, {"ice tea box": box, "mug": ROUND}, TABLE)


def _one(checks: tuple[Check, ...], quantity: str) -> Check:
    (found,) = [c for c in checks if quantity in c.quantity]
    return found


def test_a_good_push_holds_every_clause(make_trace: TraceMaker, box: BoxModel) -> None:
    checks = check(_frame(AWAY, g.NoTopple(), g.NoTurn()), make_trace(), box)
    assert all(c.ok for c in checks)
    assert [c.clause for c in checks] == [
        "displace", "displace", "no_topple", "no_topple", "no_turn", "others",
    ]  # fmt: skip
    assert checks[0].spans == AWAY.spans


@pytest.mark.parametrize(("travelled", "ok"), [(0.0905, True), (0.1095, True), (0.0895, False)])
def test_default_distance_within_its_tolerance(
    make_trace: TraceMaker, box: BoxModel, travelled: float, ok: bool
) -> None:
    found = _one(check(_frame(), make_trace(travel=(travelled, 0.0)), box), "moved")
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
    checks = check(_frame(goal), make_trace(travel=(expected, 0.0)), box)
    assert _one(checks, "moved").expected == expected
    assert _one(checks, "moved").ok


@pytest.mark.parametrize(
    ("bound", "travelled", "ok"),
    [("at_least", 0.2, True), ("at_least", 0.09, False), ("at_most", 0.09, True),
     ("at_most", 0.11, False)],
)  # fmt: skip
def test_distances_as_bounds(
    make_trace: TraceMaker, box: BoxModel, bound: g.Bound, travelled: float, ok: bool
) -> None:
    goal = g.Displace(direction="away", distance=0.1, bound=bound)
    checks = check(_frame(goal), make_trace(travel=(travelled, 0.0)), box)
    assert _one(checks, "moved").ok is ok


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
    right = check(_frame(goal), make_trace(travel=travel), box)
    assert all(c.ok for c in right)
    wrong = check(_frame(goal), make_trace(travel=(-travel[0], -travel[1])), box)
    assert not _one(wrong, "off the asked direction").ok
    assert not _one(wrong, "moved").ok


def test_a_box_that_hardly_moved_has_no_direction(make_trace: TraceMaker, box: BoxModel) -> None:
    checks = check(_frame(), make_trace(travel=(0.0, 0.005)), box)
    assert _one(checks, "off the asked direction").ok
    assert not _one(checks, "moved").ok


def test_a_push_with_no_direction_may_go_anywhere(make_trace: TraceMaker, box: BoxModel) -> None:
    checks = check(_frame(g.Displace()), make_trace(travel=(0.06, -0.08)), box)
    assert all(c.ok for c in checks)
    assert not any("direction" in c.quantity and "off" in c.quantity for c in checks)


def test_a_box_that_falls_while_pushed_is_a_failure(make_trace: TraceMaker, box: BoxModel) -> None:
    fallen = make_trace(tilt=math.radians(90))
    assert not _one(check(_frame(), fallen, box), "tilt at the end").ok


def test_slide_stays_on_its_base(make_trace: TraceMaker, box: BoxModel) -> None:
    rocked = make_trace(tilt=math.radians(7), tilt_at_end=0.0)
    assert not _one(check(_frame(action="slide"), rocked, box), "largest tilt").ok
    assert all(c.ok for c in check(_frame(action="push"), rocked, box))


def test_no_topple_is_half_the_angle_of_no_return(make_trace: TraceMaker, box: BoxModel) -> None:
    # atan(0.045 / 0.115) = 21.4°, half of it 10.7°.
    for degrees, ok in ((10.5, True), (10.9, False)):
        rocked = make_trace(tilt=math.radians(degrees), tilt_at_end=0.0)
        found = _one(check(_frame(AWAY, g.NoTopple()), rocked, box), "largest tilt")
        assert found.ok is ok
        assert found.expected == pytest.approx(0.5 * math.atan(0.045 / 0.115))


def test_no_topple_wants_it_on_its_base_at_the_end(make_trace: TraceMaker, box: BoxModel) -> None:
    leaning = make_trace(tilt=math.radians(4))
    checks = check(_frame(AWAY, g.NoTopple()), leaning, box)
    assert _one(checks, "largest tilt").ok
    assert not _one(checks, "tilt at the end").ok


@pytest.mark.parametrize(("degrees", "ok"), [(9.5, True), (-9.5, True), (-11, False), (11, False)])
def test_no_turn(make_trace: TraceMaker, box: BoxModel, degrees: float, ok: bool) -> None:
    turned = make_trace(turned=math.radians(degrees))
    assert _one(check(_frame(AWAY, g.NoTurn()), turned, box), "turned").ok is ok


@pytest.mark.parametrize(("degrees", "ok"), [(4.5, True), (5.5, False)])
def test_no_tilt(make_trace: TraceMaker, box: BoxModel, degrees: float, ok: bool) -> None:
    trace = make_trace(tilt=math.radians(degrees), tilt_at_end=0.0)
    assert _one(check(_frame(AWAY, g.NoTilt()), trace, box), "largest tilt").ok is ok


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
    checks = check(_frame(goal, action="topple"), trace, box)
    assert all(c.ok for c in checks) is ok
    assert _one(checks, "tilt at the end").ok


def test_a_box_that_rocks_back_has_not_toppled(make_trace: TraceMaker, box: BoxModel) -> None:
    trace = make_trace(tilt=math.radians(65), tilt_at_end=0.0)
    assert not check(_frame(g.Topple(), action="topple"), trace, box)[0].ok


def test_what_rocks_at_the_end_neither_stands_nor_lies(
    make_trace: TraceMaker, box: BoxModel
) -> None:
    trace = make_trace(tilt=math.radians(90))
    upright = trace.poses["ice tea box"][0, :4]
    trace.poses["ice tea box"][-5:, :4] = upright
    assert not check(_frame(g.Topple(), action="topple"), trace, box)[0].ok
    assert not _one(check(_frame(AWAY, g.NoTopple()), trace, box), "tilt at the end").ok


def test_max_force_is_averaged_against_noise(make_trace: TraceMaker, box: BoxModel) -> None:
    # 0.4 N per finger and sample, averaged over 15 samples and two fingers: 0.15 N, against a
    # reserve of 0.5 N and a tolerance of 0.3 N.
    trace = make_trace(force=4.5, noise=0.4)
    found = _one(check(_frame(AWAY, g.MaxForce(value=5.0)), trace, box), "force")
    assert found.ok
    assert found.measured == pytest.approx(4.5, abs=0.5)
    assert not _one(check(_frame(AWAY, g.MaxForce(value=4.0)), trace, box), "force").ok


@pytest.mark.parametrize(
    ("clause", "speed", "ok"),
    [
        (g.MaxSpeed(value=0.05), 0.05, True),
        (g.MaxSpeed(value=0.04), 0.05, False),
        (g.Gentle(), 0.02, True),
        (g.Gentle(), 0.05, False),
        (g.Slow(), 0.02, True),
    ],
)
def test_speed(make_trace: TraceMaker, box: BoxModel, clause: Any, speed: float, ok: bool) -> None:
    assert _one(check(_frame(AWAY, clause), make_trace(speed=speed), box), "speed").ok is ok


@pytest.mark.parametrize(
    ("region", "height", "ok"),
    [
        ("bottom", 0.03, True),
        ("bottom", 0.09, False),
        ("middle", 0.115, True),
        ("middle", 0.03, False),
        ("middle", 0.20, False),
        ("top", 0.16, True),
        ("top", 0.14, False),
    ],
)
def test_contact_region_is_a_third_of_the_height(
    make_trace: TraceMaker, box: BoxModel, region: Any, height: float, ok: bool
) -> None:
    checks = check(_frame(AWAY, g.ContactRegion(region=region)), make_trace(height=height), box)
    assert all(c.ok for c in checks) is ok


def test_contact_height_from_the_table_and_from_the_top(
    make_trace: TraceMaker, box: BoxModel
) -> None:
    for origin, value in (("table", 0.05), ("top", 0.18)):
        asked = g.ContactHeight.model_validate({"value": value, "from": origin})
        clause = g.ContactRegion(height=asked)
        assert all(c.ok for c in check(_frame(AWAY, clause), make_trace(height=0.05), box))
        assert not all(c.ok for c in check(_frame(AWAY, clause), make_trace(height=0.06), box))


def test_contact_face_is_named_by_where_it_looks(make_trace: TraceMaker, box: BoxModel) -> None:
    trace = make_trace(travel=(0.0, -0.1), side=(0.0, 1.0))
    goal = g.Displace(direction="right")
    for face, ok in (("left", True), ("front", False), ("right", False)):
        clause = g.ContactRegion.model_validate({"face": face})
        assert _one(check(_frame(goal, clause), trace, box), "face").ok is ok


@pytest.mark.parametrize(
    ("clause", "ok"),
    [
        (g.Effector(tool="finger", count=2), True),
        (g.Effector(tool="finger", count=1), False),
        (g.Effector(tool="hand", side="right"), True),
        (g.Effector(tool="hand", side="left"), False),
        (g.Effector(tool="finger"), True),
    ],
)
def test_effector(make_trace: TraceMaker, box: BoxModel, clause: g.Effector, ok: bool) -> None:
    checks = check(_frame(AWAY, clause), make_trace(fingers=2), box)
    (found,) = [c for c in checks if c.clause == "effector"]
    assert found.ok is ok


def test_no_touch_looks_at_the_contacts(make_trace: TraceMaker, box: BoxModel) -> None:
    clause = g.NoTouch(object=MUG)
    for touches, ok in (((), True), (("mug",), False)):
        checks = check(_frame(AWAY, clause), make_trace(touches=touches), box)
        assert _one(checks, "contact with").ok is ok


def test_other_objects_may_touch_each_other(make_trace: TraceMaker, box: BoxModel) -> None:
    clause = g.NoTouch(object=g.ObjectRef(text="plate", id="plate"))
    checks = check(_frame(AWAY, clause), make_trace(touches=("mug",)), box)
    assert _one(checks, "contact with").ok


def test_max_distance(make_trace: TraceMaker, box: BoxModel) -> None:
    clause = g.MaxDistance(value=0.12)
    assert _one(check(_frame(AWAY, clause), make_trace(), box), "moved in all").ok
    far = make_trace(travel=(0.13, 0.0))
    assert not _one(check(_frame(AWAY, clause), far, box), "moved in all").ok


# --- places ----------------------------------------------------------------------------------


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
    checks = check(_frame(goal), make_trace(travel=travel), box)
    assert all(c.ok for c in checks if c.clause == "place") is ok
    assert [c.clause for c in checks][-2:] == ["place", "others"]
    assert _one(checks, "tilt at the end").ok


def test_between_two_objects(make_trace: TraceMaker, box: BoxModel) -> None:
    other = g.ObjectRef(text="can", id="can")
    goal = g.Place(relation="between", reference=(MUG, other))
    for travel, ok in (((0.1, 0.0), True), ((0.1, 0.04), False)):
        trace = make_trace(travel=travel)
        # Mugs at (0.6, 0.2) and (0.6, -0.2).
        trace.poses["mug"][:, 4] = 0.6
        trace.poses["can"] = trace.poses["mug"] * [1, 1, 1, 1, 1, -1, 1]
        models = {"ice tea box": box, "mug": ROUND, "can": ROUND}
        checks = clause_checks.check(_frame(goal), trace, models, TABLE)
        assert _one(checks, "middle").ok is ok


def test_a_fallen_object_is_in_no_place(make_trace: TraceMaker, box: BoxModel) -> None:
    goal = g.Place(relation="at", reference=g.Point(x=0.6, y=0.0))
    checks = check(_frame(goal), make_trace(tilt=math.radians(90)), box)
    assert not _one(checks, "tilt at the end").ok


def test_a_place_is_relative_to_where_the_other_is_at_the_end(
    make_trace: TraceMaker, box: BoxModel
) -> None:
    trace = make_trace(travel=(0.0, 0.085))
    trace.poses["mug"][-50:, 5] += 0.1
    goal = g.Place(relation="next_to", reference=(MUG,))
    assert not _one(check(_frame(goal), trace, box), "gap").ok


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
    found = _one(check(_frame(goal), make_trace(travel=(0.0, travelled)), box), "moved")
    # A round mug is a polygon of equal area, whose corners stand out by less than 0.5 mm.
    assert found.expected == pytest.approx(travelled, abs=5e-4)
    assert found.ok


# --- turning and tilting ---------------------------------------------------------------------


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
    checks = check(_frame(goal, action="turn"), trace, box)
    assert all(c.ok for c in checks) is ok
    assert _one(checks, "moved while turning").ok


def test_what_is_turned_stays_where_it_is(make_trace: TraceMaker, box: BoxModel) -> None:
    trace = make_trace(travel=(0.03, 0.0), turned=math.radians(90))
    assert not _one(check(_frame(g.Rotate()), trace, box), "moved while turning").ok


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
    checks = check(_frame(goal, g.NoTopple(), action="tilt"), trace, box)
    assert all(c.ok for c in checks) is ok


def test_a_tilt_ends_on_the_base(make_trace: TraceMaker, box: BoxModel) -> None:
    fallen = make_trace(tilt=math.radians(10))
    assert not _one(check(_frame(g.Tilt(), action="tilt"), fallen, box), "tilt at the end").ok


def test_a_fallen_box_is_pushed_on_the_face_that_it_lies_on(
    make_trace: TraceMaker, box: BoxModel
) -> None:
    trace = make_trace()
    poses = trace.poses["ice tea box"]
    # Lying on its back since the start: tilted by 90 degrees, its origin 45 mm up.
    poses[:, :4] = [math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0]
    poses[:, 6] = 0.045
    checks = check(_frame(AWAY, g.NoTopple(), g.NoTilt(), g.NoLift()), trace, box)
    assert all(c.ok for c in checks)


# --- what else must hold ---------------------------------------------------------------------


@pytest.mark.parametrize(
    ("clause", "changes", "ok"),
    [
        (g.MaxTilt(value=math.radians(6)), {"tilt": math.radians(5), "tilt_at_end": 0.0}, True),
        (g.MaxTilt(value=math.radians(6)), {"tilt": math.radians(7), "tilt_at_end": 0.0}, False),
        (g.MaxTurn(value=math.radians(20)), {"turned": math.radians(-19)}, True),
        (g.MaxTurn(value=math.radians(20)), {"turned": math.radians(-21)}, False),
        (g.NoSlide(), {"travel": (0.005, 0.0)}, True),
        (g.NoSlide(), {"travel": (0.02, 0.0)}, False),
        (g.NoLift(), {}, True),
        (g.MinForce(value=4.0), {"force": 3.8}, True),
        (g.MinForce(value=4.0), {"force": 3.6}, False),
        (g.Force(value=4.0), {"force": 4.2}, True),
        (g.Force(value=4.0), {"force": 4.4}, False),
        (g.MinSpeed(value=0.05), {"speed": 0.05}, True),
        (g.MinSpeed(value=0.05), {"speed": 0.04}, False),
        (g.Speed(value=0.05), {"speed": 0.05}, True),
        (g.Speed(value=0.05), {"speed": 0.06}, False),
        (g.Fast(), {"speed": 0.10}, True),
        (g.Fast(), {"speed": 0.05}, False),
        # 100 mm at 50 mm/s take 2 s.
        (g.MaxDuration(value=2.0), {}, True),
        (g.MaxDuration(value=1.9), {}, False),
        (g.Duration(value=2.0), {}, True),
        (g.Duration(value=2.5), {}, False),
        (g.NoTouch(object=None), {}, True),
        (g.NoTouch(object=None), {"touches": ("mug",)}, False),
        # The mug is 115 mm to the left of the box.
        (g.NoTouch(object=MUG, clearance=0.11), {}, True),
        (g.NoTouch(object=MUG, clearance=0.12), {}, False),
        (g.NoTouch(object=MUG, clearance=0.05), {"travel": (0.0, 0.06)}, True),
        (g.NoTouch(object=MUG, clearance=0.05), {"travel": (0.0, 0.07)}, False),
        # A box 230 mm high that falls to the left comes close; it need not land on the mug.
        (
            g.NoTouch(object=MUG, clearance=0.05),
            {"travel": (0.0, 0.0), "tilt": 1.2, "tilt_heading": math.pi / 2},
            False,
        ),
    ],
)  # fmt: skip
def test_constraints(
    make_trace: TraceMaker, box: BoxModel, clause: Any, changes: dict[str, Any], ok: bool
) -> None:
    checks = check(_frame(AWAY, clause), make_trace(**changes), box)
    found = [c for c in checks if c.clause == clause.kind]
    assert found
    assert all(c.ok for c in found) is ok


def test_no_lift(make_trace: TraceMaker, box: BoxModel) -> None:
    trace = make_trace()
    trace.poses["ice tea box"][50:90, 6] = 0.01
    assert not _one(check(_frame(AWAY, g.NoLift()), trace, box), "rose").ok


def test_a_hard_push_is_ready_to_press(make_trace: TraceMaker, box: BoxModel) -> None:
    trace = make_trace()
    assert not _one(check(_frame(AWAY, g.Hard()), trace, box), "ready").ok
    trace.force_limit[:] = DEFAULTS.force_hard
    assert _one(check(_frame(AWAY, g.Hard()), trace, box), "ready").ok


def test_every_push_touches_it_where_it_was_said(make_trace: TraceMaker, box: BoxModel) -> None:
    low, high = seen(make_trace(height=0.03)), seen(make_trace(height=0.2))
    later = replace(high, time=high.time + low.time[-1] + 0.01)
    both = joined([low, later])
    found = _one(check(_frame(AWAY, g.ContactRegion(region="bottom")), both, box), "height")
    assert not found.ok
    assert found.measured == pytest.approx(0.2)


# --- events ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("event", "changes", "ok"),
    [
        ("touching", {"travel": (0.0, 0.115), "touches": ("mug",)}, True),
        ("touching", {"travel": (0.0, 0.1135)}, True),
        ("touching", {"travel": (0.0, 0.1)}, False),
        ("next_to", {"travel": (0.0, 0.085)}, True),
        ("next_to", {"travel": (0.0, 0.04)}, False),
        ("in_line", {"travel": (0.0, 0.195)}, True),
        ("in_line", {"travel": (0.0, 0.185)}, False),
        ("edge", {"travel": (0.0, 0.705)}, True),
        ("edge", {"travel": (0.0, 0.6)}, False),
        ("moves", {"travel": (0.0, 0.006)}, True),
        ("moves", {"travel": (0.0, 0.001)}, False),
        ("moves", {"travel": (0.0, 0.02)}, False),
        ("about_to_tip", {"tilt": math.radians(4), "tilt_at_end": 0.0}, True),
        ("about_to_tip", {"tilt": math.radians(1), "tilt_at_end": 0.0}, False),
        ("about_to_tip", {"tilt": math.radians(90)}, False),
        ("tips", {"tilt": math.radians(90)}, True),
        ("tips", {"tilt": math.radians(10), "tilt_at_end": 0.0}, False),
    ],
)
def test_stops_at_an_event(
    make_trace: TraceMaker, box: BoxModel, event: Any, changes: dict[str, Any], ok: bool
) -> None:
    goal, until = g.Displace(), g.Until(event=event, object=MUG)
    checks = check(_frame(goal, until), make_trace(**changes), box)
    found = [c for c in checks if c.clause == "until"]
    assert found
    assert all(c.ok for c in found) is ok
    # How far is said by the event, and what is to fall need not stand.
    assert not any("direction" in c.quantity for c in checks)
    if ok:
        assert all(c.ok for c in checks)


def test_what_is_met_is_not_shoved_along(make_trace: TraceMaker, box: BoxModel) -> None:
    trace = make_trace(travel=(0.0, 0.14), touches=("mug",))
    trace.poses["mug"][-60:, 5] += 0.025
    checks = check(_frame(g.Displace(), g.Until(event="touching", object=MUG)), trace, box)
    assert not _one(checks, "moved along").ok


def test_a_distance_that_is_said_counts_beside_an_event(
    make_trace: TraceMaker, box: BoxModel
) -> None:
    goal = g.Displace(direction="away", distance=0.2, bound="at_most")
    checks = check(_frame(goal, g.Until(event="moves")), make_trace(), box)
    assert _one(checks, "moved in the asked direction").ok


# --- what is implied -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("pair", "time", "found"),
    [
        (("ice tea box", "mug"), 1.0, "mug"),
        (("index_tip", "mug"), 1.0, "mug"),
        (("index_tip", "mug"), 0.1, "mug"),  # on the way to the box
        (("index_tip", "ice tea box"), 1.0, "none"),
        (("ice tea box", "mug"), 0.1, "none"),  # they stood against each other
        (("arm_link_3", "table"), 1.0, "none"),
    ],
)
def test_nothing_else_is_touched(
    make_trace: TraceMaker, box: BoxModel, pair: tuple[str, str], time: float, found: str
) -> None:
    trace = replace(make_trace(), contacts=(ContactEvent(time, *pair),))
    verdict = _one(check(_frame(), trace, box), "touched on the way")
    assert (verdict.clause, verdict.measured, verdict.ok) == ("others", found, found == "none")


@pytest.mark.parametrize(
    "frame",
    [
        _frame(g.Place(relation="touching", reference=(MUG,))),
        _frame(g.Displace(), g.Until(event="touching", object=MUG)),
    ],
)
def test_what_is_to_be_touched_may_be(
    make_trace: TraceMaker, box: BoxModel, frame: g.Frame
) -> None:
    assert _one(check(frame, make_trace(touches=("mug",)), box), "on the way").ok
    by_hand = replace(make_trace(), contacts=(ContactEvent(1.0, "index_tip", "mug"),))
    assert not _one(check(frame, by_hand, box), "on the way").ok


def test_a_touch_of_nothing_in_particular(make_trace: TraceMaker, box: BoxModel) -> None:
    touched = check(_frame(g.NoGoal()), make_trace(travel=(0.0, 0.0)), box)
    assert all(c.ok for c in touched)
    trace = make_trace()
    trace.phase[:] = "look"
    assert not check(_frame(g.NoGoal()), trace, box)[0].ok


def test_what_is_there_already_needs_no_push(make_trace: TraceMaker, box: BoxModel) -> None:
    trace = replace(make_trace(travel=(0.0, 0.0)), end="reached", tips={}, felt={})
    trace.phase[:] = "look"
    goal = g.Place(relation="at", reference=g.Point(x=0.5, y=0.0))
    manner = (g.Effector(tool="finger", count=2), g.ContactRegion(face="front"), g.Hard())
    checks = check(_frame(goal, *manner, g.Gentle(), g.NoTurn()), trace, box)
    assert all(c.ok for c in checks)
    assert {c.clause for c in checks} >= {"effector", "contact", "hard", "gentle", "no_turn"}


@pytest.mark.parametrize("end", ["stroke", "turned", "returned", "event", "reached", "toppled"])
def test_ends_that_were_meant_are_not_early(
    make_trace: TraceMaker, box: BoxModel, end: Any
) -> None:
    trace = make_trace(travel=(0.02, 0.0), end=end)
    missed = [c for c in check(_frame(), trace, box) if not c.ok]
    assert "early" not in not_held(missed, trace).message
    early = not_held(missed, replace(trace, end="too_close", detail="the mug is near"))
    assert "the push ended early: the mug is near" in early.message


@pytest.mark.parametrize(
    "frame",
    [
        _frame(g.Upright()),
        _frame(g.HandOver()),
        _frame(g.Place(relation="on", reference=(MUG,))),
    ],
)
def test_what_cannot_be_checked_is_an_error(frame: g.Frame) -> None:
    with pytest.raises(ControlError) as raised:
        require_checkable(frame)
    assert raised.value.code == "uncheckable"


def test_the_words_of_an_uncheckable_clause_are_named() -> None:
    with pytest.raises(ControlError) as raised:
        require_checkable(_frame(g.Upright(spans=((3, 9),))))
    assert raised.value.info.span == (3, 9)


@pytest.mark.parametrize(("spilled", "ok"), [(2e-6, True), (4e-6, False)])
def test_no_spill(make_trace: TraceMaker, box: BoxModel, spilled: float, ok: bool) -> None:
    """What was spilled before does not count."""
    trace = make_trace()
    n = len(trace.time)
    before = 50e-6
    lost = before + np.linspace(0.0, spilled, n)
    contents = {"mug": np.full(n, 1e-6), "ice tea box": np.full(n, 0.3e-3)}
    trace = replace(trace, contents=contents, spilled=lost)
    (found,) = [c for c in check(_frame(AWAY, g.NoSpill()), trace, box) if c.clause == "no_spill"]
    assert found.ok is ok
    assert found.measured == pytest.approx(spilled / 0.3e-3)
    assert found.expected == DEFAULTS.no_spill


def test_what_holds_nothing_spills_nothing_but_of_others(
    make_trace: TraceMaker, box: BoxModel
) -> None:
    frame, trace = _frame(AWAY, g.NoSpill()), make_trace()
    assert _one(check(frame, trace, box), "spilled").ok
    n = len(trace.time)
    contents = {"ice tea box": np.zeros(n), "mug": np.full(n, 0.2e-3)}
    upset = replace(trace, contents=contents, spilled=np.linspace(0.0, 0.1e-3, n))
    found = _one(check(frame, upset, box), "spilled")
    assert not found.ok
    assert found.measured == pytest.approx(0.5)


def test_no_clause_of_the_contract_is_passed_over(make_trace: TraceMaker, box: BoxModel) -> None:
    """Each kind of constraint either has a check that yields something, or is refused."""
    kinds = get_args(get_args(g.Constraint)[0])
    values = {"value": 1.0, "object": MUG, "tool": "finger", "event": "tips", "region": "bottom"}
    for kind in kinds:
        clause = kind(**{k: v for k, v in values.items() if k in kind.model_fields})
        frame = _frame(AWAY, clause)
        try:
            checks = check(frame, make_trace(), box)
        except ControlError as raised:
            assert raised.code == "uncheckable"  # noqa: PT017
        else:
            assert any(c.clause == clause.kind for c in checks), clause.kind

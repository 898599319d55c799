"""Clause checks against traces made by hand, whose truth is known."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, get_args

import pytest

from grammar import frames as g
from nlcontrol.checks import Check, check, require_checkable
from nlcontrol.errors import ControlError
from objectmodels import BoxModel
from planner.defaults import DEFAULTS
from sim.trace import Trace

TraceMaker = Callable[..., Trace]
BOX = g.ObjectRef(text="ice tea box", id="ice tea box")
AWAY = g.Displace(direction="away", spans=((21, 25),))


def _frame(goal: Any = AWAY, *constraints: Any, action: g.Action = "push") -> g.Frame:
    return g.Frame(action=action, object=BOX, goal=goal, constraints=constraints)


def _one(checks: tuple[Check, ...], quantity: str) -> Check:
    (found,) = [c for c in checks if quantity in c.quantity]
    return found


def test_a_good_push_holds_every_clause(make_trace: TraceMaker, box: BoxModel) -> None:
    checks = check(_frame(AWAY, g.NoTopple(), g.NoTurn()), make_trace(), box)
    assert all(c.ok for c in checks)
    assert [c.clause for c in checks] == [
        "displace", "displace", "no_topple", "no_topple", "no_turn",
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
        (g.Displace(toward=g.ObjectRef(text="mug", id="mug")), (0.0, 0.1)),
        (g.Displace(away_from=g.ObjectRef(text="mug", id="mug")), (0.0, -0.1)),
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
    clause = g.NoTouch(object=g.ObjectRef(text="mug", id="mug"))
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


@pytest.mark.parametrize(
    "frame",
    [
        _frame(g.Rotate(angle=0.5)),
        _frame(g.Displace(fraction=0.5)),
        _frame(g.Displace(distance=g.RelativeLength(value=2.0, of=BOX))),
        _frame(AWAY, g.Until(event="tips", spans=((3, 9),))),
        _frame(AWAY, g.NoSpill()),
        _frame(AWAY, g.NoTouch(object=BOX, clearance=0.1)),
    ],
)
def test_what_cannot_be_checked_is_an_error(frame: g.Frame) -> None:
    with pytest.raises(ControlError) as raised:
        require_checkable(frame)
    assert raised.value.code == "uncheckable"


def test_the_words_of_an_uncheckable_clause_are_named() -> None:
    with pytest.raises(ControlError) as raised:
        require_checkable(_frame(AWAY, g.Until(event="tips", spans=((3, 9),))))
    assert raised.value.info.span == (3, 9)


def test_no_clause_of_the_contract_is_passed_over(make_trace: TraceMaker, box: BoxModel) -> None:
    """Each kind of constraint either has a check that yields something, or is refused."""
    kinds = get_args(get_args(g.Constraint)[0])
    values = {"value": 1.0, "object": BOX, "tool": "finger", "event": "tips", "region": "bottom"}
    for kind in kinds:
        clause = kind(**{k: v for k, v in values.items() if k in kind.model_fields})
        frame = _frame(AWAY, clause)
        try:
            checks = check(frame, make_trace(), box)
        except ControlError as raised:
            assert raised.code == "uncheckable"  # noqa: PT017
        else:
            assert any(c.clause == clause.kind for c in checks), clause.kind

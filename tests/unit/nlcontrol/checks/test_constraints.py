"""Checks of constraints against traces made by hand, whose truth is known."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from grammar.frames import command as g
from objectmodels import BoxModel
from planner.types.defaults import DEFAULTS
from sim.traces.trace import join_traces
from tests.unit.nlcontrol.checks.conftest import (
    AWAY,
    MUG,
    TraceMaker,
    check,
    frame_of,
    one,
)
from tests.unit.nlcontrol.pushes import seen


def test_no_topple_is_half_the_angle_of_no_return(make_trace: TraceMaker, box: BoxModel) -> None:
    # atan(0.045 / 0.115) = 21.4°, half of it 10.7°.
    for degrees, ok in ((10.5, True), (10.9, False)):
        rocked = make_trace(tilt=math.radians(degrees), tilt_at_end=0.0)
        found = one(check(frame_of(AWAY, g.NoTopple()), rocked, box), "largest tilt")
        assert found.ok is ok
        assert found.expected == pytest.approx(0.5 * math.atan(0.045 / 0.115))


def test_no_topple_wants_it_on_its_base_at_the_end(make_trace: TraceMaker, box: BoxModel) -> None:
    leaning = make_trace(tilt=math.radians(4))
    checks = check(frame_of(AWAY, g.NoTopple()), leaning, box)
    assert one(checks, "largest tilt").ok
    assert not one(checks, "tilt at the end").ok


@pytest.mark.parametrize(("degrees", "ok"), [(9.5, True), (-9.5, True), (-11, False), (11, False)])
def test_no_turn(make_trace: TraceMaker, box: BoxModel, degrees: float, ok: bool) -> None:
    turned = make_trace(turned=math.radians(degrees))
    assert one(check(frame_of(AWAY, g.NoTurn()), turned, box), "turned").ok is ok


@pytest.mark.parametrize(("degrees", "ok"), [(4.5, True), (5.5, False)])
def test_no_tilt(make_trace: TraceMaker, box: BoxModel, degrees: float, ok: bool) -> None:
    trace = make_trace(tilt=math.radians(degrees), tilt_at_end=0.0)
    assert one(check(frame_of(AWAY, g.NoTilt()), trace, box), "largest tilt").ok is ok


def test_max_force_is_averaged_against_noise(make_trace: TraceMaker, box: BoxModel) -> None:
    # 0.4 N per finger and sample, averaged over 15 samples and two fingers: 0.15 N, against a
    # reserve of 0.5 N and a tolerance of 0.3 N.
    trace = make_trace(force=4.5, noise=0.4)
    found = one(check(frame_of(AWAY, g.MaxForce(value=5.0)), trace, box), "force")
    assert found.ok
    assert found.measured == pytest.approx(4.5, abs=0.5)
    assert not one(check(frame_of(AWAY, g.MaxForce(value=4.0)), trace, box), "force").ok


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
    assert one(check(frame_of(AWAY, clause), make_trace(speed=speed), box), "speed").ok is ok


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
    checks = check(frame_of(AWAY, g.ContactRegion(region=region)), make_trace(height=height), box)
    assert all(c.ok for c in checks) is ok


def test_contact_height_from_the_table_and_from_the_top(
    make_trace: TraceMaker, box: BoxModel
) -> None:
    for origin, value in (("table", 0.05), ("top", 0.18)):
        asked = g.ContactHeight.model_validate({"value": value, "from": origin})
        clause = g.ContactRegion(height=asked)
        assert all(c.ok for c in check(frame_of(AWAY, clause), make_trace(height=0.05), box))
        assert not all(c.ok for c in check(frame_of(AWAY, clause), make_trace(height=0.06), box))


def test_contact_face_is_named_by_where_it_looks(make_trace: TraceMaker, box: BoxModel) -> None:
    trace = make_trace(travel=(0.0, -0.1), side=(0.0, 1.0))
    goal = g.Displace(direction="right")
    for face, ok in (("left", True), ("front", False), ("right", False)):
        clause = g.ContactRegion.model_validate({"face": face})
        assert one(check(frame_of(goal, clause), trace, box), "face").ok is ok


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
    checks = check(frame_of(AWAY, clause), make_trace(fingers=2), box)
    (found,) = [c for c in checks if c.clause == "effector"]
    assert found.ok is ok


def test_max_distance(make_trace: TraceMaker, box: BoxModel) -> None:
    clause = g.MaxDistance(value=0.12)
    assert one(check(frame_of(AWAY, clause), make_trace(), box), "moved in all").ok
    far = make_trace(travel=(0.13, 0.0))
    assert not one(check(frame_of(AWAY, clause), far, box), "moved in all").ok


def test_a_fallen_box_is_pushed_on_the_face_that_it_lies_on(
    make_trace: TraceMaker, box: BoxModel
) -> None:
    trace = make_trace()
    poses = trace.poses["ice tea box"]
    # Lying on its back since the start: tilted by 90 degrees, its origin 45 mm up.
    poses[:, :4] = [math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0]
    poses[:, 6] = 0.045
    checks = check(frame_of(AWAY, g.NoTopple(), g.NoTilt(), g.NoLift()), trace, box)
    assert all(c.ok for c in checks)


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
    checks = check(frame_of(AWAY, clause), make_trace(**changes), box)
    found = [c for c in checks if c.clause == clause.kind]
    assert found
    assert all(c.ok for c in found) is ok


def test_no_lift(make_trace: TraceMaker, box: BoxModel) -> None:
    trace = make_trace()
    trace.poses["ice tea box"][50:90, 6] = 0.01
    assert not one(check(frame_of(AWAY, g.NoLift()), trace, box), "rose").ok


def test_a_hard_push_is_ready_to_press(make_trace: TraceMaker, box: BoxModel) -> None:
    trace = make_trace()
    assert not one(check(frame_of(AWAY, g.Hard()), trace, box), "ready").ok
    trace.force_limit[:] = DEFAULTS.force_hard
    assert one(check(frame_of(AWAY, g.Hard()), trace, box), "ready").ok


def test_every_push_touches_it_where_it_was_said(make_trace: TraceMaker, box: BoxModel) -> None:
    low, high = seen(make_trace(height=0.03)), seen(make_trace(height=0.2))
    later = replace(high, time=high.time + low.time[-1] + 0.01)
    both = join_traces([low, later])
    found = one(check(frame_of(AWAY, g.ContactRegion(region="bottom")), both, box), "height")
    assert not found.ok
    assert found.measured == pytest.approx(0.2)


@pytest.mark.parametrize(("spilled", "ok"), [(2e-6, True), (4e-6, False)])
def test_no_spill(make_trace: TraceMaker, box: BoxModel, spilled: float, ok: bool) -> None:
    """What was spilled before does not count."""
    trace = make_trace()
    n = len(trace.time)
    before = 50e-6
    lost = before + np.linspace(0.0, spilled, n)
    contents = {"mug": np.full(n, 1e-6), "ice tea box": np.full(n, 0.3e-3)}
    trace = replace(trace, contents=contents, spilled=lost)
    (found,) = [c for c in check(frame_of(AWAY, g.NoSpill()), trace, box) if c.clause == "no_spill"]
    assert found.ok is ok
    assert found.measured == pytest.approx(spilled / 0.3e-3)
    assert found.expected == DEFAULTS.no_spill


def test_what_holds_nothing_spills_nothing_but_of_others(
    make_trace: TraceMaker, box: BoxModel
) -> None:
    frame, trace = frame_of(AWAY, g.NoSpill()), make_trace()
    assert one(check(frame, trace, box), "spilled").ok
    n = len(trace.time)
    contents = {"ice tea box": np.zeros(n), "mug": np.full(n, 0.2e-3)}
    upset = replace(trace, contents=contents, spilled=np.linspace(0.0, 0.1e-3, n))
    found = one(check(frame, upset, box), "spilled")
    assert not found.ok
    assert found.measured == pytest.approx(0.5)

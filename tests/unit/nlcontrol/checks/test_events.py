"""Checks of events that end a push against traces made by hand, whose truth is known."""

from __future__ import annotations

import math
from typing import Any

import pytest

from grammar.frames import command as g
from objectmodels import BoxModel
from tests.unit.nlcontrol.checks.conftest import (
    MUG,
    TraceMaker,
    check,
    frame_of,
    one,
)


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
    checks = check(frame_of(goal, until), make_trace(**changes), box)
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
    checks = check(frame_of(g.Displace(), g.Until(event="touching", object=MUG)), trace, box)
    assert not one(checks, "moved along").ok


def test_a_distance_that_is_said_counts_beside_an_event(
    make_trace: TraceMaker, box: BoxModel
) -> None:
    goal = g.Displace(direction="away", distance=0.2, bound="at_most")
    checks = check(frame_of(goal, g.Until(event="moves")), make_trace(), box)
    assert one(checks, "moved in the asked direction").ok

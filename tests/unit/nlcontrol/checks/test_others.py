"""Checks of what else was touched, against traces made by hand, whose truth is known."""

from __future__ import annotations

from dataclasses import replace

import pytest

from grammar.frames import command as g
from objectmodels import BoxModel
from sim.traces.trace import ContactEvent
from tests.unit.nlcontrol.checks.conftest import (
    AWAY,
    MUG,
    TraceMaker,
    check,
    frame_of,
    one,
)


def test_no_touch_looks_at_the_contacts(make_trace: TraceMaker, box: BoxModel) -> None:
    clause = g.NoTouch(object=MUG)
    for touches, ok in (((), True), (("mug",), False)):
        checks = check(frame_of(AWAY, clause), make_trace(touches=touches), box)
        assert one(checks, "contact with").ok is ok


def test_other_objects_may_touch_each_other(make_trace: TraceMaker, box: BoxModel) -> None:
    clause = g.NoTouch(object=g.ObjectRef(text="plate", id="plate"))
    checks = check(frame_of(AWAY, clause), make_trace(touches=("mug",)), box)
    assert one(checks, "contact with").ok


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
    verdict = one(check(frame_of(), trace, box), "touched on the way")
    assert (verdict.clause, verdict.measured, verdict.ok) == ("others", found, found == "none")


@pytest.mark.parametrize(
    "frame",
    [
        frame_of(g.Place(relation="touching", reference=(MUG,))),
        frame_of(g.Displace(), g.Until(event="touching", object=MUG)),
    ],
)
def test_what_is_to_be_touched_may_be(
    make_trace: TraceMaker, box: BoxModel, frame: g.Frame
) -> None:
    assert one(check(frame, make_trace(touches=("mug",)), box), "on the way").ok
    by_hand = replace(make_trace(), contacts=(ContactEvent(1.0, "index_tip", "mug"),))
    assert not one(check(frame, by_hand, box), "on the way").ok

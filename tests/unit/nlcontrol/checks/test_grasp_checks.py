"""Checks of what a whole hand did, against traces made by hand, whose truth is known."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from grammar.frames import command as g
from nlcontrol.checks.frame_checks import check, not_held, require_checkable
from nlcontrol.checks.verdicts import Check
from nlcontrol.session.controller import Controller
from planner.types.defaults import DEFAULTS
from sim.traces.trace import ContactEvent, Trace
from tests.unit.nlcontrol.hands import hand_trace, over_time

CARTON, MUG, CUP = (g.ObjectRef(text=n, id=n) for n in ("ice tea", "mug", "ice tea cup"))
ML = 1e-6


@pytest.fixture(scope="module")
def kitchen() -> Controller:
    return Controller("kitchen")


def _truth(kitchen: Controller, frame: g.Frame, trace: Trace) -> tuple[Check, ...]:
    """The checks of an account that is known to be true."""
    return check(frame, trace, kitchen.models, kitchen.table, defaults=kitchen.defaults)


def _checks(
    kitchen: Controller, goal: Any, trace: Trace, *constraints: Any, of: g.ObjectRef = CARTON
) -> dict[str, Check]:
    action = {"set_down": "place", "upright": "place"}.get(goal.kind, goal.kind)
    frame = g.Frame(action=action, object=of, goal=goal, constraints=constraints)
    require_checkable(frame)
    return {f"{c.clause}: {c.quantity}": c for c in _truth(kitchen, frame, trace)}


# -- lifted and set down ------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("goal", "up", "ok"),
    [
        (g.Lift(), 0.10, True),
        (g.Lift(height=0.05), 0.10, False),
        (g.Lift(height=0.05), 0.065, True),  # within the 20 mm of the table of defaults
        (g.Lift(height=0.05, bound="at_least"), 0.10, True),
        (g.Lift(height=0.12, bound="at_least"), 0.119, False),
        (g.Lift(height=0.05, bound="at_most"), 0.06, False),
        (g.Lift(amount="little"), DEFAULTS.lift_little, True),
        (g.Lift(amount="lot"), DEFAULTS.lift_little, False),
    ],
)
def test_height_of_a_lift(kitchen: Controller, goal: g.Lift, up: float, ok: bool) -> None:
    found = _checks(kitchen, goal, hand_trace("ice tea", up=up))["lift: held higher at the end"]
    assert found.ok is ok
    # The trace is exact; only rounding stands between it and the measured value.
    assert found.measured == pytest.approx(up)


@pytest.mark.parametrize(("asked", "ok"), [(0.2, True), (0.1, False)])
def test_a_height_over_the_table_is_no_matter_of_where_it_was(
    kitchen: Controller, asked: float, ok: bool
) -> None:
    trace = hand_trace("ice tea", up=0.1)
    before = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1])
    trace = replace(trace, poses={**trace.poses, "ice tea": trace.poses["ice tea"] + before})
    found = _checks(kitchen, g.Lift(height=asked, above="table"), trace)
    assert found["lift: held over the table at the end"].ok is ok


def test_what_fell_out_of_the_hand_was_not_lifted(kitchen: Controller) -> None:
    found = _checks(kitchen, g.Lift(), hand_trace("ice tea", up=0.1, at_end=0.0))
    assert not found["lift: held higher at the end"].ok


@pytest.mark.parametrize(("lay", "ends", "ok"), [(90, 0, True), (90, 90, False), (0, 4, False)])
def test_what_stands_up_does_so_on_its_own_bottom(
    kitchen: Controller, lay: float, ends: float, ok: bool
) -> None:
    trace = hand_trace("ice tea")
    pose = trace.poses["ice tea"].copy()
    half = np.radians(np.where(trace.phase == "settle", ends, lay)) / 2.0
    pose[:, :4] = np.column_stack([np.cos(half), np.sin(half), 0.0 * half, 0.0 * half])
    # On its side B's origin, in the middle of its bottom, is half of the depth of 44 mm up.
    pose[:, 6] = 0.022 * np.sin(2.0 * half)
    found = _checks(kitchen, g.Upright(), replace(trace, poses={**trace.poses, "ice tea": pose}))
    assert found["upright: tilt at the end"].ok is ok
    # It was only turned, so that rounding alone is between this and the truth.
    assert found["upright: tilt at the end"].measured == pytest.approx(np.radians(ends), abs=1e-6)


def test_what_is_held_is_upright(kitchen: Controller) -> None:
    trace = hand_trace("ice tea", up=0.1, tilt_at_end=math.radians(20))
    assert not _checks(kitchen, g.Lift(), trace)["lift: tilt at the end"].ok
    assert not _checks(kitchen, g.Lift(), trace, g.NoTilt())["no_tilt: largest tilt"].ok
    little = hand_trace("ice tea", up=0.1, tilt_at_end=math.radians(8))
    assert _checks(kitchen, g.Lift(), little, g.NoTilt())["no_tilt: largest tilt"].ok


@pytest.mark.parametrize(
    ("change", "missed"),
    [
        ({}, set()),
        ({"at_end": 0.01}, {"height over the table"}),
        ({"moved": (0.02, 0.0)}, {"moved while it was set down"}),
        ({"tilt_at_end": 1.5}, {"tilt at the end"}),
    ],
)
def test_set_down(kitchen: Controller, change: dict[str, Any], missed: set[str]) -> None:
    trace = hand_trace("ice tea", **{"up": 0.0, "at_end": 0.0, **change})
    found = _checks(kitchen, g.SetDown(), trace)
    assert {c.quantity for c in found.values() if not c.ok} == missed


def test_what_is_brought_to_a_place_stands_on_the_table(kitchen: Controller) -> None:
    goal = g.Place(relation="at", reference=g.Point(x=0.6, y=0.1))
    there = hand_trace("ice tea", up=0.1, at_end=0.0, moved=(0.1, 0.1))
    assert all(c.ok for c in _checks(kitchen, goal, there).values())
    in_the_air = hand_trace("ice tea", up=0.1, moved=(0.1, 0.1))
    assert not _checks(kitchen, goal, in_the_air)["place: height over the table"].ok


# -- lids ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(("degrees", "opened", "closed"), [(91, True, False), (79, False, False),
                                                           (3, False, True)])  # fmt: skip
def test_a_flip_lid(kitchen: Controller, degrees: float, opened: bool, closed: bool) -> None:
    lids = {"ice tea cup": over_time(0.5, math.radians(degrees))}
    trace = hand_trace("ice tea cup", lids=lids)
    assert _checks(kitchen, g.Open(), trace, of=CUP)["open: angle of its lid"].ok is opened
    assert _checks(kitchen, g.Close(), trace, of=CUP)["close: angle of its lid"].ok is closed


def test_a_cup_that_was_opened_stands_where_it_stood(kitchen: Controller) -> None:
    lids = {"ice tea cup": over_time(0.0, 1.6)}
    shoved = hand_trace("ice tea cup", lids=lids, moved=(0.012, 0.0))
    assert not _checks(kitchen, g.Open(), shoved, of=CUP)["open: moved"].ok
    fell = hand_trace("ice tea cup", lids=lids, tilt_at_end=1.5)
    assert not _checks(kitchen, g.Open(), fell, of=CUP)["open: tilt at the end"].ok


# -- poured -------------------------------------------------------------------------------------


def _poured(received: float, spilled: float = 0.0, **more: Any) -> Trace:
    """300 ml, of which so much went into an empty mug, and so much beside it [ml]."""
    contents = {
        "ice tea": over_time(300 * ML, (300 - received - spilled) * ML),
        "mug": over_time(0.0, received * ML),
    }
    return hand_trace(
        "ice tea",
        **{
            "up": 0.2, "at_end": 0.0, "others": {"mug": (0.0, 0.0)}, "contents": contents,
            "spilled": over_time(0.0, spilled * ML), **more,
        },
    )  # fmt: skip


@pytest.mark.parametrize(
    ("said", "received", "ok"),
    [
        ({}, 271, True), ({}, 269, False),
        ({"fraction": 1.0}, 271, True),
        ({"fraction": 0.5}, 164, True), ({"fraction": 0.5}, 166, False),
        ({"volume": 200 * ML}, 219, True), ({"volume": 200 * ML}, 179, False),
        ({"volume": 50 * ML}, 59, True), ({"volume": 50 * ML}, 61, False),  # 10 ml, not 10 %
        ({"amount": "little"}, 50, True), ({"amount": "lot"}, 225, True),
        ({"amount": "lot"}, 100, False),
    ],
)  # fmt: skip
def test_what_arrived(kitchen: Controller, said: dict[str, Any], received: float, ok: bool) -> None:
    found = _checks(kitchen, g.Pour(into=MUG, **said), _poured(received))
    assert found["pour: arrived in the mug"].ok is ok


def test_filled_up_to_a_share(kitchen: Controller) -> None:
    vessel = kitchen.models["mug"].vessel
    assert vessel is not None
    half = 0.5 * vessel.capacity / ML
    goal = g.Pour(into=MUG, fill=0.5)
    assert _checks(kitchen, goal, _poured(half))["pour: arrived in the mug"].ok
    assert not _checks(kitchen, goal, _poured(0.85 * half))["pour: arrived in the mug"].ok
    full = _checks(kitchen, g.Pour(into=MUG, fill=1.0), _poured(0.9 * vessel.capacity / ML))
    assert full["pour: arrived in the mug"].ok


def test_what_was_spilled_and_shoved_and_not_set_down(kitchen: Controller) -> None:
    goal = g.Pour(into=MUG)
    wet = _checks(kitchen, goal, _poured(280, spilled=7))
    assert [k for k, c in wet.items() if not c.ok] == ["pour: spilled"]
    asked = _checks(kitchen, goal, _poured(280, spilled=7), g.NoSpill())
    assert [k for k, c in asked.items() if not c.ok] == [
        "no_spill: share of the contents that was spilled"
    ]
    shoved = _checks(kitchen, goal, _poured(280, others={"mug": (0.02, 0.0)}))
    assert [k for k, c in shoved.items() if not c.ok] == ["pour: mug was moved by"]
    held = _checks(kitchen, goal, _poured(280, at_end=0.2))
    assert [k for k, c in held.items() if not c.ok] == ["pour: height over the table"]


def test_carton_and_mug_may_touch_but_nothing_else(kitchen: Controller) -> None:
    trace = _poured(280)
    both = replace(trace, contacts=(ContactEvent(2.0, "ice tea", "mug"),))
    assert all(c.ok for c in _checks(kitchen, g.Pour(into=MUG), both).values())
    hand = replace(trace, contacts=(ContactEvent(2.0, "thumb_tip", "mug"),))
    assert not _checks(kitchen, g.Pour(into=MUG), hand)["others: touched on the way"].ok


def test_why_the_hand_stopped() -> None:
    trace = replace(hand_trace("ice tea"), end="slipped", detail="it slipped by 9 mm")
    missed = Check(
        clause="lift",
        quantity="height",
        relation="about",
        expected=0.1,
        measured=0.0,
        verdict="not_held",
        ok=False,
    )
    told = not_held([missed], trace, "this may take 3 tries at most").message
    assert "(the hand stopped: it slipped by 9 mm)" in told
    assert "(nothing more was done: this may take 3 tries at most)" in told

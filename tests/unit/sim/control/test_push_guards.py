"""Ends of a push, from what is felt and seen step by step; no world is needed for them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from planner.types.actions import Limits
from planner.types.end_reasons import Ended, EndReason
from planner.types.plan import Plan
from planner.types.world_state import PlanarPose
from sim.control.guards import Sample, Watch, planned_ends, push_guards
from sim.control.object_estimate import ObjectEstimate, TiltEstimator, TravelSpeed
from sim.robots.cell_description import Vision
from tests.unit.planner.conftest import RuledReach, planned, world

PERIOD = 0.01


STATE = world(ice_tea_box=PlanarPose(0.45, 0.0))


def _plan(text: str) -> Plan:
    return planned(text, STATE)


class _Guards:
    """Guards of a push, and its stroke, watched from its start."""

    def __init__(self, plan: Plan) -> None:
        push = plan.push
        self._watch = Watch((*planned_ends(push), *push_guards(push)), PERIOD)
        self._speed = TravelSpeed(PERIOD)
        self._estimate = ObjectEstimate(push, STATE, Vision(), np.zeros(3), PERIOD)

    def end(self, elapsed: float, travel: float, felt: float, tilt: float) -> Ended | None:
        speed = self._speed.update(travel)
        sample = Sample(elapsed, travel, speed, felt, tilt, self._estimate)
        return self._watch.first_tripped(sample)


def _tilt_end(plan: Plan, view: TiltEstimator) -> EndReason | None:
    """Reason for an end of a tilt that is seen so, if its planned end does not count."""
    push = plan.push
    estimate = ObjectEstimate(push, STATE, Vision(), np.zeros(3), PERIOD)
    sample = Sample(
        elapsed=1.0,
        travel=1e-4,
        speed=0.0,
        felt=push.prediction.onset,
        tilt=view.tilt,
        estimate=estimate,
        tip_tilt=view.own,
        tilt_sd=view.unsure,
    )
    ended = Watch(push_guards(push), PERIOD).first_tripped(sample)
    return ended and ended.end


@pytest.fixture(scope="module")
def straight() -> Plan:
    """10 cm at 50 mm/s, so that it may take 16 s."""
    made = _plan("push the ice tea box 10 cm at 5 cm/s")
    assert (made.push.stroke, made.push.speed) == pytest.approx((0.1, 0.05))
    return made


@pytest.fixture(scope="module")
def topple() -> Plan:
    return _plan("topple the ice tea box")


def _ends(
    plan: Plan, *, speed: float, felt: float, tilt: float = 0.0, seconds: float = 20.0
) -> tuple[str, Any] | None:
    """Reason and time of the end of a push that goes on evenly [s]."""
    guards = _Guards(plan)
    for time in np.arange(PERIOD, seconds, PERIOD):
        end = guards.end(float(time), speed * float(time), felt, tilt)
        if end is not None:
            return end[0], float(time)
    return None


def _there(plan: Plan, travel: float, *, felt: float, tilt: float) -> EndReason | None:
    """Reason for an end after so much travel at 50 mm/s [m]."""
    guards, end = _Guards(plan), None
    for way in np.arange(0.0, travel + 1e-9, 0.05 * PERIOD):
        end = guards.end(1.0, float(way), felt, tilt)
    return end and end[0]


def test_what_stands_gets_the_whole_force_for_a_while(straight: Plan) -> None:
    end = _ends(straight, speed=0.0, felt=straight.push.force_limit)
    # The force rises for 2 s, and for 0.8 s more nothing moves.
    assert end == ("force", pytest.approx(2.8, abs=0.1))


@pytest.mark.parametrize(("mm_per_s", "stands"), [(0.8, True), (1.3, False)])
def test_a_millimetre_a_second_is_standing(straight: Plan, mm_per_s: float, stands: bool) -> None:
    full = straight.push.force_limit
    end = _ends(straight, speed=1e-3 * mm_per_s, felt=full, seconds=4.0)
    assert (end is not None) == stands


@pytest.mark.parametrize(
    ("limit", "felt", "stands"),
    [(6.0, 0.85 * 6.0, True), (6.0, 0.70 * 6.0, False), (0.2, 0.12, True), (0.2, 0.08, False)],
)
def test_the_whole_force_is_felt_a_fifth_or_a_tenth_of_a_newton_below_the_limit(
    straight: Plan, limit: float, felt: float, stands: bool
) -> None:
    push = straight.push.model_copy(update={"force_limit": limit})
    made = straight.model_copy(update={"actions": (push,)})
    end = _ends(made, speed=0.0, felt=felt, seconds=4.0)
    assert (end is not None and end[0] == "force") == stands


@pytest.mark.parametrize(("mm_per_s", "gets_on"), [(0.5, False), (0.8, True)])
def test_what_creeps_is_given_up_after_eight_seconds(
    straight: Plan, mm_per_s: float, gets_on: bool
) -> None:
    half = 0.5 * straight.push.force_limit
    end = _ends(straight, speed=1e-3 * mm_per_s, felt=half, seconds=15.0)
    assert end == (None if gets_on else ("force", pytest.approx(8.0, abs=0.05)))


def test_nothing_takes_longer_than_the_push_and_ten_seconds(straight: Plan) -> None:
    half = 0.5 * straight.push.force_limit
    end = _ends(straight, speed=0.002, felt=half)
    assert end == ("duration", pytest.approx(10.0 + 3.0 * 2.0, abs=0.05))


@pytest.mark.parametrize(("share", "lost"), [(0.07, True), (0.15, False)])
def test_a_tenth_of_the_onset_is_contact(straight: Plan, share: float, lost: bool) -> None:
    felt = share * straight.push.prediction.onset
    # The first millimetre does not count, then there are 0.6 s to find it again.
    expected = ("lost", pytest.approx(0.05 + 0.6, abs=0.03)) if lost else None
    assert _ends(straight, speed=0.02, felt=felt, seconds=4.0) == expected


@pytest.mark.parametrize(("speed", "too_fast"), [(0.12, False), (0.14, True)])
def test_fingertips_that_run_away_are_stopped(straight: Plan, speed: float, too_fast: bool) -> None:
    end = _ends(straight, speed=speed, felt=straight.push.prediction.onset)
    assert end is not None
    assert end[0] == ("speed" if too_fast else "stroke")


@pytest.mark.parametrize(("share", "end"), [(0.30, None), (0.40, "tilted")])
def test_a_push_that_slides_may_tilt_a_third_of_the_way(
    straight: Plan, share: float, end: EndReason | None
) -> None:
    tilt = share * straight.push.prediction.stay_on_base_angle
    assert _there(straight, 0.01, felt=straight.push.prediction.onset, tilt=tilt) == end


@pytest.mark.parametrize(("beyond", "end"), [(9.0, None), (13.0, "toppled")])
def test_it_is_let_fall_well_beyond_the_angle_of_no_return(
    topple: Plan, beyond: float, end: EndReason | None
) -> None:
    tilt = topple.push.prediction.stay_on_base_angle + np.radians(beyond)
    assert _there(topple, 0.02, felt=1.0, tilt=tilt) == end


@pytest.mark.parametrize(
    ("travel", "share", "end"),
    [(0.025, 0.0, None), (0.035, 0.0, "slid"), (0.04, 0.45, None), (0.04, 0.25, "slid")],
)
def test_a_topple_that_does_not_tilt_slides(
    topple: Plan, travel: float, share: float, end: EndReason | None
) -> None:
    # The tilt that turning about the far edge would show.
    tilt = share * float(np.arctan2(travel, topple.push.p_BC[2]))
    assert topple.push.stroke > travel
    assert _there(topple, travel, felt=1.0, tilt=tilt) == end


@pytest.mark.parametrize(("share", "end"), [(0.85, None), (0.95, "tilted")])
def test_a_tilt_is_let_back_before_the_angle_of_no_return(
    share: float, end: EndReason | None
) -> None:
    made = _plan("tilt the ice tea box by 10 degrees")
    # Without the limit of its sentence, which is nearer.
    push = made.push.model_copy(update={"limits": Limits()})
    plan = made.model_copy(update={"actions": (push,)})
    view = TiltEstimator(np.radians(1.0))
    view.update_from_tip(0.0, share * plan.push.prediction.stay_on_base_angle)
    assert _tilt_end(plan, view) == end


@pytest.mark.parametrize(
    ("own", "deviations", "end"),
    [(0.001, 3.0, None), (0.001, 5.0, "slid"), (0.04, 5.0, None)],
)
def test_a_tilt_that_the_camera_surely_does_not_show_slides(
    own: float, deviations: float, end: EndReason | None
) -> None:
    plan, view = _plan("tilt the ice tea box by 10 degrees"), TiltEstimator(np.radians(0.3))
    view.own, view.correction = own, -deviations * view.unsure
    assert _tilt_end(plan, view) == end


@pytest.mark.parametrize(("behind", "end"), [(0.007, None), (0.009, "slipped")])  # 8 mm are told
def test_a_drag_ends_once_the_fingertip_slips_over_the_object(
    behind: float, end: EndReason | None
) -> None:
    state = world(book=PlanarPose(0.45, -0.1))
    push = planned("push the book 10 cm to the left", state, RuledReach(max_press=30.0)).push
    estimate = ObjectEstimate(push, state, Vision(), np.zeros(3), PERIOD)
    estimate.slipped = -behind * np.array(push.direction_W[:2])
    sample = Sample(1.0, 0.03, push.speed, push.press, 0.0, estimate)
    tripped = Watch(push_guards(push), PERIOD).first_tripped(sample)
    assert (tripped and tripped.end) == end

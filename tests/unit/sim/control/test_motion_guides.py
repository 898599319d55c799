"""Guides for other controllers say what the executor does."""

from __future__ import annotations

import math

import numpy as np
import pytest

from nlcontrol import Result
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from planner.types.plan import FlipGuide, GraspGuide, MotionGuide, PushGuide
from sim.traces.trace import Trace

TIP_ERROR = 0.003
"""Of a fingertip: what the camera does not know of the object, and springs that give way [m]."""


def done(said: str) -> tuple[MotionGuide, Trace]:
    """The guide of a sentence, and what happened when it was carried out."""
    controller = Controller("kitchen", seed=3)
    guide = Conversation(controller).say(said, plan_only=True).guide
    result: Result = Conversation(controller).say(said)
    assert guide is not None
    assert result.trace is not None
    assert result.guide is None
    assert result.status == "done"
    return guide, result.trace


def during(trace: Trace, phase: str) -> slice:
    """Samples of the first time of a phase."""
    first = int(np.argmax(trace.phase == phase))
    ends = np.flatnonzero(trace.phase[first:] != phase)
    return slice(first, first + int(ends[0]))


def test_a_push_goes_as_its_guide_says() -> None:
    guide, trace = done("push the ice tea box 3 cm away")
    assert isinstance(guide, PushGuide)
    touch, push = during(trace, "touch"), during(trace, "push")
    tips = np.array([trace.tips[name] for name in trace.tips if "thumb" not in name])
    pushing = [
        min(tips, key=lambda tip: float(np.linalg.norm(tip[push.start] - p)))
        for p in guide.fingertips_W
    ]
    for tip, wanted in zip(pushing, guide.fingertips_W, strict=True):
        assert tip[push.start] == pytest.approx(np.array(wanted), abs=TIP_ERROR)
    middle = np.mean(pushing, axis=0)
    assert middle[touch.start] == pytest.approx(np.array(guide.start_W), abs=TIP_ERROR)
    assert middle[push.stop - 1] == pytest.approx(np.array(guide.end_W), abs=2 * TIP_ERROR)
    travel = (middle[push.stop - 1] - middle[push.start]) @ np.array(guide.direction_W)
    assert travel == pytest.approx(guide.stroke, abs=0.002)
    assert trace.force_limit[push].max() == pytest.approx(guide.force_limit, rel=1e-6)
    period = float(np.diff(trace.time).mean())
    speeds = np.linalg.norm(np.diff(middle[push], axis=0), axis=1) / period
    (fastest,) = (each.limit for each in guide.stop if each.when == "speed")
    assert fastest is not None
    assert speeds.max() < fastest
    contact = np.array(guide.contact_W)
    assert np.mean(guide.fingertips_W, axis=0) == pytest.approx(
        contact - guide.tip_radius * np.array(guide.inward_W), abs=1e-6
    )
    assert np.linalg.norm(guide.fingers_W or ()) == pytest.approx(1.0)


@pytest.mark.slow
def test_a_hand_goes_as_its_guide_says() -> None:
    guide, trace = done("lift the mug")
    assert isinstance(guide, GraspGuide)
    held = during(trace, "grasp").stop - 1
    contacts = np.array([guide.thumb_W, *guide.fingers_W])
    off = [
        min(float(np.linalg.norm(tip[held] - p)) for tip in trace.tips.values()) for p in contacts
    ]
    assert off == pytest.approx([0.01] * len(off), abs=1.5 * TIP_ERROR)
    (lift,) = guide.legs
    assert lift.end_W[2] - lift.start_W[2] == pytest.approx(
        float(trace.displacement("mug")[2]), abs=0.004
    )


def test_pours_and_flips_have_guides() -> None:
    controller = Controller("kitchen")
    pour = Conversation(controller).say("pour the ice tea into the mug", plan_only=True)
    assert isinstance(pour.guide, GraspGuide)
    assert pour.plan is not None
    assert pour.guide.squeeze == pour.plan.grasp.squeeze if pour.plan.grasp else False
    # What is held ends where it began, upright: turns and ways of the legs sum to nothing.
    assert sum(leg.turn for leg in pour.guide.legs) == pytest.approx(0.0, abs=1e-9)
    steepest = max(np.cumsum([leg.turn for leg in pour.guide.legs]))
    (tilted,) = (each for each in pour.guide.stop if each.when == "tilted")
    assert steepest == pytest.approx(tilted.limit)
    last = pour.guide.legs[-1]
    assert last.end_W[2] == pytest.approx(0.0, abs=1e-9)
    sides = np.array(pour.guide.thumb_W) - np.mean(pour.guide.fingers_W, axis=0)
    assert sides @ np.array(pour.guide.closing_W) == pytest.approx(
        pour.plan.grasp.width if pour.plan.grasp else 0.0, abs=1e-6
    )
    flip = Conversation(controller).say("open the ice tea cup", plan_only=True).guide
    assert isinstance(flip, FlipGuide)
    levers = np.linalg.norm(np.array(flip.path_W) - flip.hinge_W, axis=1)
    assert levers == pytest.approx(np.full(len(levers), levers[0]))
    assert levers[0] > flip.tip_radius


def test_limits_of_the_sentence_are_among_the_ends() -> None:
    guide = (
        Conversation(Controller("kitchen"))
        .say(
            "push the coffee box until it moves, in at most 6 s without tilting it by more than 5°",
            plan_only=True,
        )
        .guide
    )
    assert isinstance(guide, PushGuide)
    ends = [(each.when, round(each.limit or 0.0, 6)) for each in guide.stop]
    assert ("duration", 6.0) in ends
    assert ("tilted", round(math.radians(5.0), 6)) in ends
    assert "event" in dict(ends)

"""The story of a replay: the whole sentence in its parts, contacts and end poses as predicted."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from nlcontrol.checks.verdicts import Check
from nlcontrol.reports.replay_story import replay_story
from nlcontrol.results.result import Result
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from objectmodels.geometry.rotations import from_quaternion
from sim import load_scene
from sim.views.run_story import RunStory
from tests.fakes.pushed_trace import pushed_trace

BOX = "ice tea box"


def _carried_out(result: Result, **changes: Any) -> Result:
    """A planned result as if it had been carried out in one push."""
    trace = pushed_trace(load_scene("kitchen"), BOX)
    return result.model_copy(update={"trace": trace, "status": "done", "ok": True, **changes})


@pytest.fixture(scope="module")
def push() -> Result:
    return _carried_out(
        Conversation(Controller(seed=0)).say(
            f"push the {BOX} away without toppling it", plan_only=True
        )
    )


@pytest.fixture(scope="module")
def story(push: Result) -> RunStory:
    return replay_story(push)


def test_the_words_together_are_the_sentence(push: Result, story: RunStory) -> None:
    assert "".join(word.text for word in story.words) == push.text == story.title
    assert all(push.text[word.start : word.end] == word.text for word in story.words)
    parts = {word.text: word.part for word in story.words}
    assert parts["push"] == "push controller"
    assert parts["tea"] == "object model"
    assert parts["away"] == "wanted outcome"
    assert parts["toppling"] == "constraint"
    assert parts["the"] == parts[" "] == ""


def test_the_plan_is_told_under_headings(story: RunStory) -> None:
    headings = [line.heading for line in story.prediction]
    assert headings[:3] == ["Plan:", "Predicted:", "Why that is safe:"]
    assert {row.parameter for row in story.rows} > {"contact height", "direction"}


def test_the_box_is_predicted_to_end_where_the_plan_says(push: Result, story: RunStory) -> None:
    assert push.plan is not None
    assert push.plan.aim is not None
    (ghost,) = story.ghosts
    assert ghost.name == BOX
    assert ghost.pose[4:] == pytest.approx([push.plan.aim.x, push.plan.aim.y, 0.0], abs=1e-6)


def test_contacts_lie_where_the_fingers_push(push: Result, story: RunStory) -> None:
    assert push.plan is not None
    planned = push.plan.push
    assert len(story.contacts) == planned.fingers == 2
    places = np.array([mark.place for mark in story.contacts])
    assert places.mean(axis=0) == pytest.approx(planned.p_BC, abs=1e-4)
    assert np.linalg.norm(places[1] - places[0]) == pytest.approx(planned.spread, abs=1e-4)
    for mark in story.contacts:
        # The camera's yaw, of about a degree, is between the plan and what was seen at the touch.
        assert mark.normal == pytest.approx((-1.0, 0.0, 0.0), abs=0.05)
        assert mark.since == 0.0


def test_a_toppled_box_is_predicted_to_lie_behind_its_edge() -> None:
    result = _carried_out(Conversation(Controller(seed=0)).say(f"topple the {BOX}", plan_only=True))
    assert result.plan is not None
    before = result.steps[0].before
    assert before is not None
    (ghost,) = replay_story(result).ghosts
    R, p = from_quaternion(np.array(ghost.pose[:4])), np.array(ghost.pose[4:])
    away = np.array(result.plan.push.direction_W)
    assert R[:, 2] == pytest.approx(away, abs=1e-5)  # its top points away
    half = 0.045
    assert p[2] == pytest.approx(half, abs=2e-3)
    assert (p - [before.x, before.y, 0.0]) @ away == pytest.approx(half, abs=2e-3)


def test_verdicts_have_what_was_measured_and_asked(push: Result) -> None:
    checks = (
        Check(clause="displace", spans=((5, 8),), quantity="moved", relation="about",
              expected=0.1, measured=0.102, tolerance=0.01, unit="m", verdict="held",
              ok=True),
        Check(clause="others", quantity="touched on the way", relation="is", expected="none",
              measured="mug", verdict="not_held", ok=False),
    )  # fmt: skip
    steps = (push.steps[0].model_copy(update={"checks": checks}),)
    first, second = replay_story(_carried_out(push, steps=steps)).clauses
    assert (first.verdict, first.said, first.measured) == ("held", "the", "102 mm")
    assert "10 mm" in first.asked
    assert (second.verdict, second.said, second.measured) == ("not_held", "", "mug")


def test_without_a_trace_there_is_no_contact(push: Result) -> None:
    assert replay_story(push.model_copy(update={"trace": None})).contacts == ()

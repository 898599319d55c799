"""A robot that believes half of the true friction gets there by its own updates."""

from __future__ import annotations

import json

import pytest

from benchmarks.goals.fixed import OBJECT, Job, robot_of, wrongly_believed
from nlcontrol.results.result import Result
from nlcontrol.session.conversation import Conversation
from sim.truth.scene_file import load_scene

SEED = 0


def test_what_is_believed_is_wrong() -> None:
    truth = load_scene("kitchen").object(OBJECT).truth
    model = wrongly_believed(SEED)
    assert (model.friction, model.mass) == (0.5 * truth.friction_table, 0.6 * truth.mass_kg)
    # As sure of it, relative to the value, as of the right ones.
    assert model.friction_sd / model.friction == pytest.approx(0.0689 / 0.378)


@pytest.mark.slow
def test_satisfied_by_its_own_updates() -> None:
    truth = load_scene("kitchen").object(OBJECT).truth
    job = Job("wrong_beliefs", "push", SEED)
    result = Conversation(robot_of(job)).say(job.text)
    assert (result.ok, result.status) == (True, "done")
    assert [check for check in result.checks if not check.ok] == []
    lessons = result.steps[0].lessons
    assert len(lessons) >= 2
    first, last = lessons[0], lessons[-1]
    assert first.contradicts
    assert not last.contradicts
    # What it slides with in the end is friction times weight, whichever of the two was wrong.
    needed = truth.friction_table * truth.mass_kg * 9.81
    assert last.force == pytest.approx(needed, rel=0.1)
    model = wrongly_believed(SEED)
    product = {"mass": model.mass, "friction": model.friction}
    for lesson in lessons:
        product |= {c.parameter: c.after for c in lesson.changes if c.parameter in product}
    # 5 % by which friction is taken to differ from push to push, what the last force is off, and
    # the fingers' pressing down: under it, too little mass and too much friction feel the same.
    assert product["mass"] * product["friction"] * 9.81 == pytest.approx(needed, rel=0.15)
    # Told in words and as data.
    told = str(result)
    assert "What the pushes taught:" in told
    assert all(lesson.text in told for lesson in lessons)
    data = json.loads(result.to_json())
    assert [row["force"] for row in data["steps"][0]["lessons"]] == [x.force for x in lessons]
    assert Result.model_validate_json(result.to_json()).steps[0].lessons == lessons

"""Refused turns are judged in the world as it is then, and the talk does not notice."""

from __future__ import annotations

import os
from functools import partial

import numpy as np
import pytest

from benchmarks.goals import talks
from benchmarks.goals.cases import Watched
from benchmarks.goals.drawn_turns import Job, Turn, draw_scene
from benchmarks.goals.judge import moved, true_places
from benchmarks.goals.refusal_judge import Finding, judge_refusal, patient
from benchmarks.goals.talks import Said, refusal_finding, result_in_copy, wait_for_rest
from nlcontrol.session.conversation import Conversation
from planner.types.defaults import DEFAULTS
from planner.types.refusal import Refusal as Refused
from sim import Scene, load_scene
from sim.truth.scene_file import Pose

JOB = Job(7, 0, tries=1)

# A copy shares nothing that a thread of the test runner could hold.
pytestmark = pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")


def kitchen(name: str, **changed: object) -> Scene:
    """The kitchen with something changed about one of its objects."""
    scene = load_scene("kitchen")
    objects = [
        item.model_copy(update=changed) if item.name == name else item for item in scene.objects
    ]
    return scene.model_copy(update={"objects": tuple(objects)})


def slippery_mug() -> Scene:
    """The kitchen with a mug that slips out of the hand."""
    truth = load_scene("kitchen").object("mug").truth
    less = {"friction_finger": 0.5 * truth.friction_finger}
    return kitchen("mug", truth=truth.model_copy(update=less))


def no(*_: object, **__: object) -> Refused:
    """A planner that refuses everything."""
    return Refused(code="blocked", reason="blocked", message="no")


def finding(robot: Watched, text: str) -> Finding:
    result = Conversation(robot).say(text, plan_only=True)
    return refusal_finding(JOB, 0, "mug", robot, result)


def test_a_copy_gives_its_result_and_changes_nothing_here() -> None:
    here = [1]

    def work() -> list[int]:
        here.append(2)
        return here

    assert result_in_copy(work) == [1, 2]
    assert here == [1]


def test_a_copy_that_fails_is_told() -> None:
    with pytest.raises(RuntimeError, match="ZeroDivisionError"):
        result_in_copy(lambda: 1 // 0)
    with pytest.raises(RuntimeError, match="ended"):
        result_in_copy(lambda: os._exit(3))


def test_the_talk_does_not_notice_that_a_refusal_is_judged() -> None:
    robot, unjudged = (Watched(load_scene("kitchen"), seed=1, planner=no) for _ in range(2))
    for each in (robot, unjudged):
        true_places(each.executor)
        result = Conversation(each).say("lift the mug 10 cm")
    time, models, defaults = robot.executor.time, dict(robot.models), robot.defaults
    seen, watches = robot.last_look.state, list(robot.watches)
    assert refusal_finding(JOB, 0, "mug", robot, result).verdict == "confirmed"
    assert (robot.executor.time, robot.models, robot.defaults) == (time, models, defaults)
    assert (robot.last_look.state, robot.watches) == (seen, watches)
    # The next look is the same, to the last bit of the camera's noise.
    assert robot.look() == unjudged.look()


@pytest.mark.slow
def test_a_refusal_is_wrong_only_if_the_true_world_carries_the_plan() -> None:
    assert finding(Watched(load_scene("kitchen"), seed=1), "lift the mug 10 cm").verdict == (
        "unconfirmed"
    )
    assert finding(Watched(slippery_mug(), seed=1), "lift the mug 10 cm").verdict == "unlikely"


def test_what_cannot_be_judged_is_not_looked_for() -> None:
    robot = Watched(load_scene("kitchen"), seed=1)
    result = Conversation(robot).say("lift the spoon 10 cm")
    assert refusal_finding(JOB, 0, "mug", robot, result).verdict == "not looked for"


@pytest.mark.parametrize(("roll", "second"), [(0.0, False), (90.0, True)])
def test_strokes_are_not_searched_for_to_what_lies(roll: float, second: bool) -> None:
    pose = load_scene("kitchen").object("coffee box").pose
    lying = Pose(**(pose.model_dump() | {"roll_deg": roll}))
    robot = Watched(kitchen("coffee box", pose=lying), seed=1, planner=no)
    Conversation(robot).say("push the ice tea box until it touches the coffee box", plan_only=True)
    planned, rng = Finding("confirmed", "by a plan"), np.random.default_rng(0)
    found = judge_refusal(robot, "ice tea box", "impossible", 1, rng, lambda: planned)
    assert (found == planned) is second


def test_a_second_search_works_ten_times_as_long() -> None:
    assert patient(DEFAULTS).most_work == 10 * DEFAULTS.most_work


def test_a_talk_begins_once_everything_rests() -> None:
    # This tin is laid on a side on which it does not stay.
    robot = Watched(draw_scene(Job(502, 17)), seed=502)
    drawn = true_places(robot.executor)
    wait_for_rest(robot)
    begun = true_places(robot.executor)
    assert moved(drawn, begun) == ["tea tin"]
    robot.look()
    assert not moved(begun, true_places(robot.executor))


def said_in_talk(monkeypatch: pytest.MonkeyPatch, job: Job, *, feasible: bool = True) -> Said:
    """The only turn of a talk, which is refused."""
    name = draw_scene(job).objects[0].name
    turn = Turn("displace", f"push the {name} 5 cm to the left", name, feasible)
    monkeypatch.setattr(talks, "TURNS", 1)
    monkeypatch.setattr(talks, "Watched", partial(Watched, planner=no))
    monkeypatch.setattr(talks, "draw_turn", lambda *_: turn)
    monkeypatch.setattr(talks, "refusal_finding", lambda *_: Finding("confirmed", "by a search"))
    return talks.talk(job).turns[0]


def test_a_talk_judges_what_is_feasible_if_it_is_asked_to(monkeypatch: pytest.MonkeyPatch) -> None:
    told = said_in_talk(monkeypatch, Job(7, 0, tries=1))
    assert (told.verdict, told.judged, told.found) == (
        "rightly refused",
        "confirmed",
        "by a search",
    )
    told = said_in_talk(monkeypatch, Job(7, 0))
    assert (told.verdict, told.judged) == ("refused", None)
    told = said_in_talk(monkeypatch, Job(7, 0, tries=1), feasible=False)
    assert (told.verdict, told.judged) == ("rightly refused", None)


def test_what_is_refused_after_something_moved_is_not_rightly_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    job = Job(7, 0, tries=1)
    stirred = [draw_scene(job).objects[0].name]
    monkeypatch.setattr(talks, "moved", lambda *_: stirred)
    told = said_in_talk(monkeypatch, job)
    assert (told.verdict, told.judged) == ("refused", "not looked for")

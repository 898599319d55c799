"""Commands taken back: played by traces made by hand, and in the simulation."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import replace

import pytest

from grammar.frames import command as g
from nlcontrol.results.result import Result
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.remarks.undo_frames import UndoEntry, undo_frames
from objectmodels import Registry
from planner.problem.directions import angle_between
from planner.types.defaults import DEFAULTS
from planner.types.plan import Plan
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim import load_scene
from sim.traces.trace import Trace
from tests.fakes.played_executor import PlayedExecutor, played
from tests.lone_objects import with_only
from tests.unit.nlcontrol.pushes import BOX, FORWARDS, Happens

PUSH = "push the ice tea box away"
AWAY = "push the coffee box away"


def plan(conversation: Conversation, *sentences: str) -> Result:
    """What comes of the last of some sentences, none of which is executed."""
    return [conversation.say(text, plan_only=True) for text in sentences][-1]


def test_undo_pushes_it_back(conversation: Conversation, stage: PlayedExecutor) -> None:
    before = conversation.controller.look().objects[BOX].pose
    assert conversation.say(PUSH).steps[0].before == before
    result = conversation.say("undo that")
    assert (result.status, result.notes) == ("done", (f"undone: “{PUSH}”",))
    assert result.paraphrase == f"to undo “{PUSH}”, push the ice tea box by 100 mm toward the robot"
    assert stage.moved == pytest.approx((0.0, 0.0), abs=1e-6)
    assert conversation.past == []
    # What was undone may be asked for otherwise, and is not told as done any more.
    assert conversation.say("no, to the right", plan_only=True).notes == ()
    assert conversation.say("undo that").error is not None


def test_undo_turns_it_back(conversation: Conversation, stage: PlayedExecutor) -> None:
    before = stage.poses[BOX]
    assert conversation.say("turn the ice tea box by 40 degrees to the left").ok
    assert angle_between(stage.poses[BOX].yaw, before.yaw) == pytest.approx(
        math.radians(40.0), abs=DEFAULTS.aim_angle
    )
    result = conversation.say("undo that")
    assert result.status == "done"
    assert result.paraphrase is not None
    assert re.search(r"turn the ice tea box by (39|40)\.\d° to the right", result.paraphrase)
    assert stage.poses[BOX].yaw == pytest.approx(before.yaw, abs=2 * DEFAULTS.aim_angle)
    assert math.hypot(*stage.moved) < 2 * DEFAULTS.aim_drift  # of the turn, and of the way back
    assert conversation.past == []


def test_what_turned_and_moved_is_turned_and_pushed_back(
    conversation: Conversation, stage: PlayedExecutor
) -> None:
    before = stage.poses[BOX]
    conversation.say(PUSH)
    stage.move(0.0, 0.0, math.radians(15))
    result = conversation.say("undo that")
    assert (result.status, [f.action for f in result.frames]) == ("done", ["turn", "push"])
    assert stage.poses[BOX].yaw == pytest.approx(before.yaw, abs=2 * DEFAULTS.aim_angle)
    # What the turn back displaced was not known when the way back was said.
    assert math.hypot(*stage.moved) < DEFAULTS.aim_drift + DEFAULTS.aim_position
    assert conversation.past == []


def test_half_a_way_back_can_be_gone_on_with(
    conversation: Conversation,
    goes: Callable[..., Happens],
    stands: Callable[..., Happens],
    stage: PlayedExecutor,
) -> None:
    conversation.say(PUSH)
    stage.move(0.0, 0.0, math.radians(15))

    def turns_only(plan: Plan) -> Trace:
        turned = plan.push.ends_on == "turned" or len(stage.executed) < 2
        return (goes() if turned else stands(force=60.0))(plan)

    stage.happens = [turns_only]
    assert conversation.say("undo that").status == "failed"
    again = conversation.say("undo that", plan_only=True)
    assert [frame.action for frame in again.frames] == ["push"]


def test_an_undo_that_fails_can_be_said_again(
    conversation: Conversation,
    goes: Callable[..., Happens],
    stands: Callable[..., Happens],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    short = (goes(), goes(share=0.3), stands(force=60.0))
    played(conversation.controller, *short)
    conversation.say(PUSH)
    assert conversation.say("undo that").status == "failed"
    again = conversation.say("undo that", plan_only=True)
    assert again.paraphrase is not None
    assert "push the ice tea box by 70 mm toward the robot" in again.paraphrase


def test_what_was_left_halfway_is_brought_back(
    conversation: Conversation,
    goes: Callable[..., Happens],
    stands: Callable[..., Happens],
) -> None:
    stage = played(conversation.controller, goes(share=0.5), stands("no_touch"))
    result = conversation.say(PUSH)
    assert result.status == "failed"
    assert [BOX in note and "undo that" in note for note in result.notes] == [True]
    assert math.hypot(*stage.moved) == pytest.approx(0.05, abs=1e-6)
    stage.happens = [goes()]
    assert conversation.say("undo that").status == "done"
    assert math.hypot(*stage.moved) < DEFAULTS.aim_position
    assert conversation.past == []


def test_what_fell_over_would_be_stood_up(
    conversation: Conversation, stage: PlayedExecutor
) -> None:
    conversation.say(PUSH)
    stage.poses[BOX] = replace(stage.poses[BOX], attitude=FORWARDS)
    result = conversation.say("undo that")
    assert (result.status, result.exit_status) == ("refused", 4)
    assert result.error is not None
    # 1 kg takes 14 N of squeeze, and the hand has 11 N at its width.
    assert result.error.numbers["strongest"] < result.error.numbers["needed_force"]
    assert len(conversation.past) == 1


def test_undo_of_an_object_that_was_not_pushed(conversation: Conversation) -> None:
    result = plan(conversation, AWAY, "undo the push of the cereal box")
    assert result.error is not None
    assert "the cereal box was not pushed" in result.error.message


@pytest.mark.slow
def test_each_step_is_told_and_undone_the_last_first(
    conversation: Conversation, stage: PlayedExecutor
) -> None:
    result = conversation.say("push the ice tea box away, then to the left")
    assert len(stage.executed) == 2
    first, second = (step.before for step in result.steps)
    assert first is not None
    assert second is not None
    assert second.x - first.x == pytest.approx(0.1, abs=1e-6)
    assert [(step.frame, step.status) for step in result.steps] == [(0, "done"), (1, "done")]
    assert len(result.checks) == sum(len(step.checks) for step in result.steps)
    assert "Step 2 of 2: done" in str(result)
    back = conversation.say("undo that", plan_only=True)
    headings = [f.goal.heading for f in back.frames if isinstance(f.goal, g.Displace)]
    assert headings == pytest.approx([-math.pi / 2, math.pi], abs=1e-6)


def test_a_way_back_ends_where_it_began() -> None:
    model = Controller("kitchen").models["ice tea box"]
    seen = {"ice tea box": SeenObject("ice tea box", PlanarPose(0.5, 0.2), model)}
    of = Result(ok=True, status="done", text="", scene="kitchen", seed=0)
    start, middle = PlanarPose(0.3, 0.0), PlanarPose(0.5, 0.0)
    pushed = [UndoEntry(of, "ice tea box", start), UndoEntry(of, "ice tea box", middle)]
    back = undo_frames(pushed, WorldState(seen), DEFAULTS)
    assert back.undoes == (pushed[1], pushed[0])
    x, y = 0.5, 0.2
    for step in back.frames:
        assert isinstance(step.goal, g.Displace)
        assert isinstance(step.goal.distance, float)
        assert step.goal.heading is not None
        x += step.goal.distance * math.cos(step.goal.heading)
        y += step.goal.distance * math.sin(step.goal.heading)
    assert (x, y) == pytest.approx((0.3, 0.0))


@pytest.mark.parametrize("asked", [True, False])
def test_what_is_round_is_turned_back_only_if_it_was_to_turn(asked: bool) -> None:
    mug = g.ObjectRef(text="mug", id="mug")
    meant = g.Rotate(angle=0.7, sense="ccw") if asked else g.Displace(direction="away")
    of = Result(
        ok=True, status="done", text="", scene="counter", seed=0,
        frames=(g.Frame(action="turn" if asked else "push", object=mug, goal=meant),),
    )  # fmt: skip
    model = Registry.built_in().get("mug")
    seen = {"mug": SeenObject("mug", PlanarPose(0.5, 0.0, 0.7), model)}
    back = undo_frames([UndoEntry(of, "mug", PlanarPose(0.5, 0.0))], WorldState(seen), DEFAULTS)
    if asked:
        (frame,) = back.frames
        assert frame.goal == g.Rotate(angle=0.7, sense="cw")
        assert back.notes == ()
    else:
        assert back.frames == ()
        assert back.notes == ("that the mug turned by 40.1° is not undone",)


@pytest.fixture
def simulated() -> Conversation:
    """With the ice tea box of the kitchen."""
    return Conversation(Controller(with_only(load_scene("kitchen"), BOX), seed=1))


@pytest.mark.slow
def test_turned_and_turned_back(simulated: Conversation) -> None:
    start = simulated.controller.look().objects[BOX].pose
    # Far beyond what may be left of it, and two pushes each way.
    assert simulated.say("turn the ice tea box by 15 degrees to the left").ok
    assert simulated.say("undo that").ok
    end = simulated.controller.look().objects[BOX].pose
    assert abs(angle_between(end.yaw, start.yaw)) < 2 * DEFAULTS.turn_tolerance
    assert math.hypot(end.x - start.x, end.y - start.y) < 2 * DEFAULTS.turn_drift


@pytest.mark.slow
def test_pushed_and_pushed_back(simulated: Conversation) -> None:
    start = simulated.controller.look().objects["ice tea box"].pose
    done = simulated.say(f"{PUSH} without toppling it")
    assert [c for c in done.checks if not c.ok] == []
    result = simulated.say("undo that")
    assert (result.status, [c for c in result.checks if not c.ok]) == ("done", [])
    end = simulated.controller.look().objects["ice tea box"].pose
    # Each way holds its distance within the 1 cm that a bare distance is checked with.
    assert math.hypot(end.x - start.x, end.y - start.y) < 0.01


def test_an_undo_is_a_sentence_of_its_own(conversation: Conversation) -> None:
    result = plan(conversation, "push the coffee box away, then undo that")
    assert result.error is not None
    assert result.error.code == "not_alone"


def test_what_stands_there_is_left(conversation: Conversation, stage: PlayedExecutor) -> None:
    conversation.say(PUSH)
    stage.move(-0.1, 0.0)
    result = conversation.say("undo that")
    assert (result.status, result.plan) == ("done", None)
    assert result.answer is not None
    assert result.answer.text == f"The ice tea box is where it was before “{PUSH}”."


@pytest.mark.parametrize(("before", "after"), [("storage bin", None), (None, "storage bin")])
def test_what_went_in_or_out_of_a_box_goes_back(before: str | None, after: str | None) -> None:
    of = Result(ok=True, status="done", text="", scene="counter", seed=0)
    known = Registry.built_in()
    bin_ = SeenObject("storage bin", PlanarPose(0.5, 0.0), known.get("storage bin"))
    mug = SeenObject("mug", PlanarPose(0.5, 0.3), known.get("mug"), on=after)
    state = WorldState({"storage bin": bin_, "mug": mug})
    there = PlanarPose(0.45, 0.02, z=0.0 if before is None else 0.004)
    (frame,) = undo_frames(
        [UndoEntry(of, "mug", there, "place", on=before)], state, DEFAULTS
    ).frames
    assert isinstance(frame.goal, g.Place)
    if before is None:
        assert frame.goal.reference == g.Point(x=0.45, y=0.02)
    else:
        assert frame.goal.relation == "in"
        assert isinstance(frame.goal.reference, tuple)
        assert [ref.text for ref in frame.goal.reference] == [before]

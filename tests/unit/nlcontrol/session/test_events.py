"""Events of a sentence, and a stop on its way, with a robot whose pushes are made up."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

from nlcontrol.errors import ControlError
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.events import KINDS, Event, EventKind, Supervisor
from objectmodels import ObjectModel
from planner.touch_experiments import Experiment
from planner.types.actions import Grasp, Push
from planner.types.robot import ReachAnswer, ReachEffort
from planner.types.world_state import Held, WorldState
from sim.exploration.trial_extraction import Recording
from sim.supervision import Stopped, StopToken
from sim.traces.trace import Trace
from tests.fakes.played_executor import PlayedExecutor, played
from tests.unit.nlcontrol.pushes import Happens

SENTENCE = "push the ice tea box away without toppling it"


@pytest.fixture
def controller() -> Controller:
    return Controller(seed=1)


def kinds(events: list[Event]) -> list[EventKind]:
    return [event.kind for event in events]


def test_events_of_a_push(controller: Controller, goes: Callable[..., Happens]) -> None:
    played(controller, goes())
    events: list[Event] = []
    result = Conversation(controller).say(SENTENCE, on_event=events.append)
    assert kinds(events)[:3] == ["understood", "planned", "phase"]
    assert kinds(events)[-1] == "ended"
    assert set(kinds(events)) <= set(KINDS)
    assert [event.plan for event in events if event.plan] == list(result.steps[0].plans)
    assert tuple(event.check for event in events if event.check) == result.checks
    assert tuple(event.lesson for event in events if event.lesson) == result.steps[0].lessons
    (push,) = (event for event in events if event.phase == "push")
    assert (push.time, push.frame, events[-1].status) == (1.0, 0, "done")
    times = [event.wall_time for event in events]
    assert times == sorted(times)
    assert times[0] >= 0.0
    assert Event.model_validate_json(events[1].model_dump_json()) == events[1]


def test_planned_again(controller: Controller, goes: Callable[..., Happens]) -> None:
    played(controller, goes(0.5), goes())
    events: list[Event] = []
    Conversation(controller).say(SENTENCE, on_event=events.append)
    assert kinds(events).count("planned") == 1
    assert kinds(events).count("replanned") >= 1


@pytest.mark.parametrize("kind", ["understood", "planned", "phase"])
def test_a_stop_ends_it_where_it_is(
    controller: Controller, goes: Callable[..., Happens], kind: str
) -> None:
    stage, stop = played(controller, goes()), StopToken()

    def ask(event: Event) -> None:
        if event.kind == kind:
            stop.request()

    conversation = Conversation(controller)
    result = conversation.say(SENTENCE, on_event=ask, stop=stop)
    moved = kind != "understood"  # this robot knows no stop: a push that has begun is made
    assert (result.ok, result.status, result.exit_status) == (False, "cancelled", 130)
    assert result.error is not None
    assert (result.error.code, result.checks) == ("interrupted", ())
    assert (len(stage.executed), result.trace is not None) == (int(moved), moved)
    assert (result.steps[-1].execution is not None) == moved
    assert conversation.say(SENTENCE).status in ("done", "failed")


def test_what_is_held_is_told(controller: Controller, goes: Callable[..., Happens]) -> None:
    stage, stop = played(controller, goes()), StopToken()
    stop.request()
    stage.held = _held()
    result = Conversation(controller).say("set the mug down", stop=stop)
    assert result.status == "cancelled"
    assert result.error is not None
    assert "holds the mug" in result.error.message


def _held() -> Held:
    grasp = Grasp(
        p_BG=(0.0, 0.0, 0.05), closing_W=(1.0, 0.0, 0.0), approach_W=(0.0, 0.0, -1.0),
        width=0.08, squeeze=5.0, needed=3.0, strongest=20.0,
    )  # fmt: skip
    return Held("mug", grasp, 0.1, (0.0,) * 7)


def test_an_exploration_stops_before_the_next_touch(controller: Controller) -> None:
    stage, stop = played(controller), StopToken()
    touch = stage.touch

    def touch_and_stop(experiment: Experiment, *rest: Any) -> Recording:
        stop.request()
        return touch(experiment, *rest)

    stage.touch = touch_and_stop  # type: ignore[assignment,method-assign]
    result = Conversation(controller).say("find out how heavy the ice tea box is", stop=stop)
    assert (result.status, len(stage.touched)) == ("cancelled", 1)


def test_a_question_is_not_answered_any_more(controller: Controller) -> None:
    stop = StopToken()
    stop.request()
    assert (
        Conversation(controller).say("can you push the ice tea box?", stop=stop).status
        == "cancelled"
    )


def test_planning_stops_at_the_next_question_to_the_robot(controller: Controller) -> None:
    stop, asked = StopToken(), list[Push]()
    robot = controller.robot

    class Impatient:
        limits, grasp, reach_plan = robot.limits, robot.grasp, robot.reach_plan
        estimate_reach = robot.estimate_reach

        def reach(
            self, push: Push, state: WorldState, effort: ReachEffort = "usual"
        ) -> ReachAnswer:
            asked.append(push)
            stop.request()
            return ReachAnswer(
                ok=False, reason="kinematics", code="told", words={"text": "it does not get there"}
            )

    played(controller).robot = Impatient()
    frame = controller.resolve(controller.parse(SENTENCE)).frames[0]
    with pytest.raises(Stopped):
        controller.plan(frame, stop=stop)
    assert len(asked) == 1


@pytest.mark.parametrize("named", ["progress", "on_event"])
def test_a_callback_that_fails_stops_the_robot_and_is_raised(
    controller: Controller, goes: Callable[..., Happens], named: str
) -> None:
    stage = played(controller, goes(0.5))

    def fail(*told: Any) -> None:
        if told[0] == "push" or getattr(told[0], "kind", "") == "phase":
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        Conversation(controller).say(SENTENCE, **{named: fail})  # type: ignore[arg-type]
    assert len(stage.executed) == 1


class Broken(PlayedExecutor):
    """A robot whose driver fails."""

    def execute(self, plan: Any, models: Mapping[str, ObjectModel], progress: Any = None) -> Trace:
        raise ConnectionError("the cable is out")


def test_a_robot_that_fails_gives_a_result(controller: Controller) -> None:
    broken = played(controller)
    broken.__class__ = Broken
    result = Conversation(controller).say(SENTENCE)
    assert (result.status, result.exit_status, result.plan is not None) == ("failed", 1, True)
    assert result.error is not None
    assert result.error.code == "executor_failed"
    assert "ConnectionError: the cable is out" in result.error.message
    assert result.error.suggestions
    with pytest.raises(ControlError, match="the cable is out"):
        controller.execute(result.plan)  # type: ignore[arg-type]


def test_diagnostics_go_through_logging(
    controller: Controller, goes: Callable[..., Happens], caplog: pytest.LogCaptureFixture
) -> None:
    played(controller, goes())
    assert logging.getLogger("nlcontrol").handlers
    with caplog.at_level(logging.DEBUG, logger="nlcontrol"):
        Conversation(controller).say(SENTENCE)
    assert {record.args[0] for record in caplog.records if record.args} >= {"planned", "ended"}  # type: ignore[index]


@pytest.mark.parametrize(("rate", "told"), [(4.0, [0.0, 0.25, 0.5, 0.75]), (0.0, [])])
def test_forces_are_told_at_the_rate_asked_for(rate: float, told: list[float]) -> None:
    events: list[Event] = []
    supervisor = Supervisor(on_event=events.append, force_rate=rate)
    for k in range(64):
        supervisor.feel(k / 64.0, ("thumb", "index"), np.array([[3.0, 0.0, 4.0], [0.0, 1.0, 0.0]]))
    assert [event.time for event in events] == told
    assert all(event.forces == {"thumb": 5.0, "index": 1.0} for event in events)

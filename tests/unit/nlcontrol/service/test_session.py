"""A session in this process, with a robot whose pushes are made up."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from nlcontrol import Session
from nlcontrol.errors import ControlError, ErrorInfo
from nlcontrol.results.result import Result
from nlcontrol.service import offers
from nlcontrol.service.methods import PlanningSession
from nlcontrol.service.offers import LIFE
from nlcontrol.session.controller import Controller
from nlcontrol.session.events import Event
from planner.types.plan import Plan
from sim.exploration.trial_extraction import Recording
from sim.traces.trace import Trace
from tests.fakes.played_executor import PlayedExecutor, played
from tests.patience import PATIENCE
from tests.unit.nlcontrol.pushes import BOX, Happens

AWAY = "push the ice tea box 5 cm away"


class Clock:
    """A clock that is set by hand."""

    time = 100.0

    def __call__(self) -> float:
        return self.time


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def robot(goes: Callable[..., Happens]) -> PlayedExecutor:
    return played(Controller("kitchen"), goes())


@pytest.fixture
def session(robot: PlayedExecutor, clock: Clock) -> Iterator[Session]:
    with Session(executor=robot, clock=clock) as opened:
        yield opened


def planned(session: Session, said: str) -> str:
    """Identifier of the plan of a sentence."""
    offer = session.plan(said)
    assert offer.plan_id is not None, offer.result.report()
    return offer.plan_id


def do(session: Session, said: str) -> str:
    """Paraphrase of a sentence that is planned, approved and done."""
    result = session.start(plan_id=planned(session, said)).result(PATIENCE)
    assert result.status == "done", result.report()
    return result.paraphrase or ""


def error_of(call: Callable[[], object]) -> ErrorInfo:
    with pytest.raises(ControlError) as raised:
        call()
    assert raised.value.info.suggestions
    return raised.value.info


def test_a_session_is_a_planning_session(session: Session) -> None:
    kept: PlanningSession = session
    assert kept.look().source == "camera"


def test_what_was_approved_is_done(session: Session, robot: PlayedExecutor) -> None:
    offer = session.plan(AWAY)
    assert offer.plan_id is not None
    assert (offer.ok, offer.result.status, offer.expires_in) == (True, "planned", LIFE)
    assert robot.executed == []
    told: list[Event] = []
    run = session.start(plan_id=offer.plan_id, on_event=told.append)
    result = run.result(PATIENCE)
    assert robot.executed[0] == offer.result.plan
    assert (result.status, result.plan, result.planned) == ("done", offer.result.plan, 1)
    numbered = list(run.events())
    assert [each.number for each in numbered] == list(range(1, len(numbered) + 1))
    assert [each.event for each in numbered] == told
    assert list(run.events(after=len(numbered) - 1)) == numbered[-1:]
    kinds = [event.kind for event in told]
    assert kinds[:2] == ["understood", "planned"]
    assert kinds[-1] == "ended"
    info = run.info()
    assert (info.kind, info.state, info.text, info.plan_id) == (
        "execute",
        "ended",
        AWAY,
        offer.plan_id,
    )
    assert info.events == len(numbered)
    assert run.trace() is result.trace


def test_the_run_plans_anew_after_the_approved_push(
    session: Session, robot: PlayedExecutor, goes: Callable[..., Happens]
) -> None:
    robot.happens = [goes(share=0.5), goes()]
    result = session.start(plan_id=planned(session, AWAY)).result(PATIENCE)
    assert (result.status, len(robot.executed)) == ("done", 2)
    assert robot.moved == pytest.approx((0.05, 0.0), abs=1e-3)


def test_a_plan_is_carried_out_once_and_only_where_it_was_made(session: Session) -> None:
    plan_id = planned(session, AWAY)
    session.start(plan_id=plan_id).result(PATIENCE)
    assert error_of(lambda: session.start(plan_id=plan_id)).code == "used_plan"
    assert error_of(lambda: session.start(plan_id="plan-0000000000000000")).code == "unknown_plan"
    with Session("kitchen") as other:
        foreign = planned(other, AWAY)
    assert error_of(lambda: session.start(plan_id=foreign)).code == "unknown_plan"


def test_a_plan_is_approved_by_the_text_that_was_planned_alone(
    session: Session, robot: PlayedExecutor
) -> None:
    plan_id = planned(session, AWAY)
    for other in (f"{AWAY} ", "topple the ice tea box", ""):
        refused = error_of(lambda text=other: session.start(plan_id=plan_id, text=text))  # type: ignore[misc]
        assert (refused.code, refused.status.http) == ("other_sentence", 409)
        assert AWAY in refused.suggestions[-1]
    assert robot.executed == []
    assert session.start(plan_id=plan_id, text=AWAY).result(PATIENCE).status == "done"


def test_the_text_that_approves_is_the_one_that_was_said(session: Session) -> None:
    session.start(plan_id=planned(session, AWAY)).result(PATIENCE)
    again = planned(session, "again")
    assert session.start(plan_id=again, text="again").result(PATIENCE).status == "done"


def test_a_plan_expires(session: Session, clock: Clock, monkeypatch: pytest.MonkeyPatch) -> None:
    early, late = planned(session, AWAY), planned(session, AWAY)
    clock.time += LIFE - 1.0
    session.start(plan_id=early).result(PATIENCE)
    clock.time += 1.0
    assert error_of(lambda: session.start(plan_id=late)).code == "expired_plan"
    assert error_of(lambda: session.start(plan_id=late)).status.http == 410
    dropped = planned(session, AWAY)
    session.stop()
    assert error_of(lambda: session.start(plan_id=dropped)).code == "expired_plan"
    monkeypatch.setattr(offers, "MOST_OFFERED", 2)
    oldest = planned(session, AWAY)
    kept = [planned(session, AWAY) for _ in range(2)]
    assert error_of(lambda: session.start(plan_id=oldest)).code == "expired_plan"
    assert session.start(plan_id=kept[0]).result(PATIENCE).status == "done"


@pytest.mark.parametrize("name", [BOX, "mug"])
def test_a_plan_is_stale_once_anything_moved(
    session: Session, robot: PlayedExecutor, name: str
) -> None:
    plan_id = planned(session, AWAY)
    there = robot.poses[name]
    robot.poses[name] = replace(there, x=there.x + 0.012, yaw=there.yaw + math.radians(5.0))
    info = error_of(lambda: session.start(plan_id=plan_id))
    assert (info.code, info.status.http) == ("stale_plan", 409)
    assert info.numbers[f"{name}: moved"] == pytest.approx(0.012)
    assert info.numbers[f"{name}: turned"] == pytest.approx(math.radians(5.0))
    assert f"the {name} moved 12 mm" in info.message
    assert f"the {name} turned 5.0°" in info.message
    assert robot.executed == []
    # The suggestion works: what is planned now goes by what the refusal saw.
    assert session.start(plan_id=planned(session, AWAY)).result(PATIENCE).status == "done"


def test_noise_of_the_camera_changes_nothing_of_a_plan(
    session: Session, robot: PlayedExecutor
) -> None:
    offer = session.plan(AWAY)
    there = robot.poses[BOX]
    robot.poses[BOX] = replace(there, y=there.y + 0.002, yaw=there.yaw + math.radians(1.0))
    session.look()
    assert session.plan(AWAY).result.plan != offer.result.plan
    assert session.start(plan_id=offer.plan_id or "").result(PATIENCE).status == "done"
    assert robot.executed[0] == offer.result.plan


def test_a_plan_is_stale_once_something_was_learned(session: Session) -> None:
    plan_id = planned(session, AWAY)
    models = session.controller.models
    models["mug"] = models["mug"].model_copy(update={"mass": 2.0})
    assert "the mug" in error_of(lambda: session.start(plan_id=plan_id)).message


def test_what_was_only_planned_does_not_count_as_done(session: Session) -> None:
    assert session.plan("undo that").result.error is not None
    planned(session, AWAY)
    assert error_of_result(session, "undo that") == "nothing_before"
    assert error_of_result(session, "a bit more") == "nothing_before"
    do(session, AWAY)
    planned(session, "push it 3 cm to the left")
    assert session.plan("undo that").result.paraphrase == (
        f"to undo “{AWAY}”, push the ice tea box by 50 mm toward the robot"
    )


def error_of_result(session: Session, said: str) -> str | None:
    found = session.plan(said).result.error
    return None if found is None else found.code


def test_remarks_work_from_plan_to_plan_and_from_deed_to_deed(
    session: Session, robot: PlayedExecutor
) -> None:
    planned(session, AWAY)
    assert session.plan("no, 3 cm").result.paraphrase == "push the ice tea box away by 3 cm"
    assert do(session, "push it 3 cm to the left") == "push it to the left by 3 cm"
    assert do(session, "again") == "push the ice tea box to the left by 3 cm"
    assert robot.moved == pytest.approx((0.0, 0.06), abs=1e-3)
    assert do(session, "undo that").startswith("to undo “again”")
    assert robot.moved == pytest.approx((0.0, 0.03), abs=1e-3)
    assert do(session, "undo that").startswith("to undo “push it 3 cm to the left”")
    assert robot.moved == pytest.approx((0.0, 0.0), abs=1e-3)


def test_frames_are_planned_as_sentences_are(session: Session, robot: PlayedExecutor) -> None:
    frames = session.parse(AWAY)
    offer = session.plan(frames)
    assert offer.plan_id is not None
    assert session.start(plan_id=offer.plan_id).result(PATIENCE).status == "done"
    assert robot.executed == [offer.result.plan]


def test_what_is_there_already_is_watched(session: Session, robot: PlayedExecutor) -> None:
    here = robot.poses[BOX]
    plan_id = planned(session, f"push the ice tea box to x {here.x:.4f} m, y {here.y:.4f} m")
    watched: list[str] = []

    def watch(name: str, duration: float = 1.0) -> Trace:
        watched.append(name)
        raise ZeroDivisionError

    robot.watch = watch  # type: ignore[method-assign]
    assert session.start(plan_id=plan_id).result(PATIENCE).status == "failed"
    assert (watched, robot.executed) == ([BOX], [])


def test_refusals_answers_and_nonsense_are_results(session: Session) -> None:
    for said, status in (
        ("push the ice tea box 3 m away", "refused"),
        ("how heavy is the mug?", "answered"),
        ("fnord", "not_understood"),
    ):
        offer = session.plan(said)
        assert (offer.plan_id, offer.result.status) == (None, status)
        assert offer.ok == (status == "answered")
    assert session.ask("how heavy is the mug?").answer is not None
    assert session.ask(AWAY).status == "planned"
    assert error_of(lambda: session.parse("fnord")).status.http == 422


def test_one_thing_at_a_time(
    session: Session, robot: PlayedExecutor, goes: Callable[..., Happens]
) -> None:
    let_go, begun = threading.Event(), threading.Event()

    def waits(plan: Plan) -> Trace:
        begun.set()
        assert let_go.wait(PATIENCE)
        return goes()(plan)

    robot.happens = [waits, goes()]
    waiting = planned(session, AWAY)
    run = session.start(AWAY)
    assert begun.wait(PATIENCE)
    try:
        with pytest.raises(TimeoutError):
            run.result(0.01)
        calls: list[Callable[[], object]] = [
            session.look,
            session.reset,
            lambda: session.start(AWAY),
            lambda: session.plan(AWAY),
            lambda: session.ask("where is the mug?"),
            lambda: session.start(plan_id=waiting),
            lambda: session.affordances("mug"),
        ]
        assert [error_of(call).code for call in calls] == ["busy"] * len(calls)
        assert session.parse(AWAY).frames
        assert run.info().state == "running"
    finally:
        let_go.set()
    assert run.result(PATIENCE).status == "done"


def test_a_stop_cancels_the_run(
    session: Session, robot: PlayedExecutor, goes: Callable[..., Happens]
) -> None:
    def stops(plan: Plan) -> Trace:
        session.stop()
        return goes()(plan)

    robot.happens = [stops]
    result = session.start(AWAY).result(PATIENCE)
    assert (result.status, len(robot.executed)) == ("cancelled", 1)


def test_an_answer_that_is_given_up_moves_nothing_further(
    session: Session, robot: PlayedExecutor, monkeypatch: pytest.MonkeyPatch
) -> None:
    def asks() -> Result:
        return session.ask("how slippery is the ice tea box?", motion="simulate")

    assert asks().status != "cancelled"
    assert len(robot.touched) > 1
    touch = robot.touch

    def gives_up(*arguments: Any) -> Recording:
        session.give_up_answer()
        return touch(*arguments)

    monkeypatch.setattr(robot, "touch", gives_up)
    robot.touched.clear()
    assert asks().status == "cancelled"
    assert len(robot.touched) == 1
    assert session.start(AWAY).result(PATIENCE).status == "done"


def test_approval_may_be_required(robot: PlayedExecutor) -> None:
    with Session(executor=robot, approval="plan") as session:
        assert error_of(lambda: session.start(AWAY)).code == "approval_required"
        asked = lambda: session.ask("how heavy is the ice tea box?", motion="simulate")  # noqa: E731
        assert error_of(asked).code == "approval_required"
        assert session.ask("how heavy is the ice tea box?").status == "answered"
        assert robot.executed == robot.touched == []
        do(session, AWAY)
        assert error_of(session.reset).code == "no_reset"


def test_a_reset_begins_anew() -> None:
    with Session("kitchen", seed=3) as session:
        first = session.look()
        plan_id = planned(session, AWAY)
        session.controller.models["mug"] = session.controller.models["ice tea"]
        assert session.look().digest != first.digest
        session.reset()
        assert session.look() == first
        assert error_of(lambda: session.start(plan_id=plan_id)).code == "expired_plan"
        assert error_of_result(session, "push it away") == "no_antecedent"


def test_what_callbacks_raise_is_told(session: Session) -> None:
    def fails(event: Event) -> None:
        raise ZeroDivisionError

    run = session.start(plan_id=planned(session, AWAY), on_event=fails)
    with pytest.raises(ZeroDivisionError):
        run.result(PATIENCE)
    assert run.info().state == "ended"


def test_predictions_go_by_the_table(session: Session, robot: PlayedExecutor) -> None:
    straight = session.predict(BOX, height=0.1)
    # A quarter turn to the left: what was the right face looks at the robot now.
    robot.poses[BOX] = replace(robot.poses[BOX], yaw=math.pi / 2)
    session.look()
    turned = session.predict(BOX, height=0.1)
    assert turned.push.direction == pytest.approx((0.0, -1.0, 0.0), abs=1e-6)
    pushed = session.predict(BOX, height=0.1, direction=(1.0, 0.0, 0.0))
    assert pushed.push.direction == pytest.approx(turned.push.direction, abs=1e-6)
    assert turned.onset == pytest.approx(straight.onset)  # it is square, and its weight central
    assert error_of(lambda: session.predict("ghost", height=0.1)).code == "unknown_object"
    chart = session.map(BOX, spacing=0.02)
    assert {contact.outcome for contact in chart.contacts} >= {"slide", "topple"}
    assert error_of(lambda: session.map(BOX, spacing=1e-6)).code == "bad_value"
    assert session.affordances("mug").affordances


def test_an_offer_is_drawn_where_it_is_believed_to_be(session: Session) -> None:
    offer = session.plan(AWAY)
    drawing, plan = offer.drawing, offer.result.plan
    assert drawing is not None
    assert plan is not None
    (ghost,) = drawing.ghosts
    assert ghost.name == drawing.object == BOX
    assert plan.aim is not None
    assert ghost.pose[4:6] == pytest.approx((plan.aim.x, plan.aim.y), abs=1e-6)
    middle = np.mean([mark.place for mark in drawing.contacts], axis=0)
    assert len(drawing.contacts) == plan.push.fingers
    assert middle == pytest.approx(plan.push.p_BC, abs=1e-5)  # they are told in 10 µm
    assert drawing.marks == ()
    assert session.map(drawing.object, face=drawing.faces[0], spacing=0.05).normal == (
        -1.0,
        0.0,
        0.0,
    )
    assert [line.heading for line in drawing.lines][:2] == ["Plan:", "Predicted:"]


def test_what_names_no_object_on_the_table_is_not_drawn(session: Session) -> None:
    assert session.plan("push the unicorn away").drawing is None


def test_a_stop_does_not_wait_for_a_plan_and_drops_it(
    session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is being planned when the stop comes was asked for before it."""
    begun, stopped = threading.Event(), threading.Event()
    plan = session.conversation.plan

    def slow(said: object) -> object:
        begun.set()
        assert stopped.wait(PATIENCE)
        return plan(said)  # type: ignore[arg-type]

    monkeypatch.setattr(session.conversation, "plan", slow)
    found: list[str] = []
    planner = threading.Thread(target=lambda: found.append(planned(session, AWAY)))
    planner.start()
    begun.wait(PATIENCE)
    session.stop()  # here it would wait for ever
    stopped.set()
    planner.join(PATIENCE)
    with pytest.raises(ControlError) as raised:
        session.start(plan_id=found[0])
    assert raised.value.code == "expired_plan"


def test_a_run_that_is_being_begun_as_the_stop_comes_is_stopped(
    session: Session, robot: PlayedExecutor, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan_id = planned(session, AWAY)
    look = session.controller.look

    def stopped_meanwhile() -> object:
        session.stop()
        return look()

    waiting = session._plans.approved(plan_id, None)
    monkeypatch.setattr(session._plans, "approved", lambda *_: waiting)
    monkeypatch.setattr(session.controller, "look", stopped_meanwhile)
    run = session.start(plan_id=plan_id)
    assert run.result(PATIENCE).status == "cancelled"

"""The client that is awaited: the same calls, over connections that fail."""

from __future__ import annotations

import asyncio
import inspect
import json
from collections.abc import Awaitable, Callable
from typing import Any

import httpx
import pytest

from nlcontrol import AsyncClient, Client
from nlcontrol.errors import ControlError
from nlcontrol.service import connection
from nlcontrol.service.async_session import AsyncRun, AsyncSession
from nlcontrol.service.methods import PlanningSession
from nlcontrol.service.remote_session import RemoteRun
from nlcontrol.session.events import Event
from tests.fakes.service_wire import ENDED, RESULT, RUN, URL, Stream, Wire, problem

UNDERSTOOD = {"ok": True, "text": "push the mug", "frames": []}
TABLE = {
    "source": "camera", "time": 0.0, "scene": "kitchen", "objects": [], "held": None, "digest": "d",
}  # fmt: skip


@pytest.fixture(autouse=True)
def _no_waiting(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connection, "PAUSES", (0.0, 0.0, 0.0))


def awaited(wire: Wire, use: Callable[[AsyncSession], Awaitable[Any]]) -> Any:
    """What a program that awaits gets from a session on a wire."""

    async def program() -> Any:
        async with AsyncClient(URL, transport=wire) as client:
            return await use(await client.sessions.open())

    return asyncio.run(program())


def public(kind: type) -> set[str]:
    return {name for name in dir(kind) if not name.startswith("_")}


@pytest.mark.parametrize(
    ("awaiting", "waiting"),
    [
        (AsyncSession, PlanningSession),
        (AsyncRun, RemoteRun),
        (AsyncClient, Client),
    ],
)
def test_who_awaits_has_the_same_calls(awaiting: type, waiting: type) -> None:
    # An attribute in one and a property in the other.
    assert public(waiting) - public(awaiting) <= {"has_robot"}


def test_making_a_client_calls_nothing() -> None:
    wire = Wire()
    AsyncClient(URL, transport=wire)
    assert wire.requests == []


def test_questions_take_the_same_arguments() -> None:
    for name in ("look", "parse", "predict", "map", "affordances", "plan"):
        assert getattr(AsyncSession, name).__doc__ == getattr(PlanningSession, name).__doc__
    wire = Wire(look=[httpx.ReadError, TABLE])
    assert awaited(wire, lambda session: session.look()).scene == "kitchen"
    assert len(wire.sent("look")) == 2


@pytest.mark.parametrize(
    "use",
    [
        lambda session: session.plan(5),
        lambda session: session.say(5),
        lambda session: session.start(b"push the mug"),
        lambda session: session.start(),
        lambda session: session.execute(5),
        lambda session: session.ask("how heavy is it?", motion="maybe"),
    ],
)
def test_a_wrong_argument_is_refused_before_anything_is_sent(
    use: Callable[[AsyncSession], Awaitable[Any]],
) -> None:
    wire = Wire()
    with pytest.raises(ControlError) as raised:
        awaited(wire, use)
    assert raised.value.code == "bad_arguments"
    assert [request.url.path for request in wire.requests] == ["/v1/sessions"]


def test_a_sentence_is_said_once_and_its_result_awaited() -> None:
    wire = Wire(say=[httpx.ReadError, RUN], r1=[RUN, RUN, ENDED])
    assert awaited(wire, lambda session: session.say("push the mug")).status == "done"
    keys = {request.headers["Idempotency-Key"] for request in wire.sent("say")}
    assert (len(wire.sent("say")), len(keys)) == (2, 1)


def test_a_plan_is_carried_out_by_its_id() -> None:
    wire = Wire(runs=[RUN], r1=[ENDED])
    assert awaited(wire, lambda session: session.execute("p1")).status == "done"
    assert json.loads(wire.sent("runs")[0].content)["plan_id"] == "p1"


def test_a_question_that_may_move_is_a_run() -> None:
    asked = {"query": "value", "object": {"text": "mug"}, "goal": {"kind": "parameters"}}
    wire = Wire(parse=[{**UNDERSTOOD, "frames": [asked]}], say=[RUN], r1=[ENDED], ask=[RESULT])
    awaited(wire, lambda session: session.ask("how heavy is the mug?", motion="simulate"))
    assert (len(wire.sent("say")), len(wire.sent("ask"))) == (1, 0)
    awaited(wire, lambda session: session.ask("how heavy is the mug?"))
    assert (len(wire.sent("say")), len(wire.sent("ask"))) == (1, 1)


def test_what_is_not_understood_is_a_result_even_where_it_might_move() -> None:
    told = {"code": "unknown_verb", "message": "it knows no such verb", "family": "sentence"}
    refused = {**RESULT, "ok": False, "status": "not_understood", "error": told}
    wire = Wire(parse=[{**UNDERSTOOD, "ok": False, "error": told}], ask=[refused])
    result = awaited(wire, lambda session: session.ask("frobnicate", motion="simulate"))
    assert result.status == "not_understood"


def test_events_go_on_where_the_stream_was_lost() -> None:
    streams = [Stream(1, lost=True), httpx.ConnectError, Stream(1, 2, lost=True), Stream(3)]
    wire = Wire(say=[RUN], events=streams, r1=[RUN])

    async def numbers(session: AsyncSession) -> list[int]:
        run = await session.start("push the mug")
        return [told.number async for told in run.events()]

    assert awaited(wire, numbers) == [1, 2, 3]
    asked = [request.headers["Last-Event-ID"] for request in wire.sent("events")]
    assert asked == ["0", "1", "1", "2"]


@pytest.mark.parametrize("is_awaited", [False, True])
def test_a_callback_that_fails_stops_the_run_and_its_failure_is_raised(is_awaited: bool) -> None:
    def fail(event: Event) -> None:
        raise ZeroDivisionError(event.text)

    async def fail_later(event: Event) -> None:
        fail(event)

    wire = Wire(say=[RUN], events=[Stream(1, 2, 3)], r1=[ENDED], stop=[{}])
    told = fail_later if is_awaited else fail
    assert inspect.iscoroutinefunction(told) == is_awaited
    with pytest.raises(ZeroDivisionError, match="1"):
        awaited(wire, lambda session: session.say("push the mug", on_event=told))
    assert len(wire.sent("stop")) == 1


def test_a_wait_that_is_cancelled_stops_the_run() -> None:
    wire = Wire(say=[RUN], r1=[RUN], stop=[{}])

    async def give_up(session: AsyncSession) -> None:
        async with asyncio.timeout(0.2):
            await session.say("push the mug")

    with pytest.raises(TimeoutError):
        awaited(wire, give_up)
    assert len(wire.sent("stop")) == 1


def test_what_the_service_refuses_is_raised() -> None:
    wire = Wire(runs=[problem(409, code="stale_plan", detail="the mug has moved")])
    with pytest.raises(ControlError) as raised:
        awaited(wire, lambda session: session.execute("p1"))
    assert raised.value.code == "stale_plan"

"""A client over connections that fail: nothing is done twice, nothing is missed."""

from __future__ import annotations

import json
import sys
import threading
from collections.abc import Iterator
from typing import Any

import httpx
import pytest

from grammar.parser import default_parser
from nlcontrol import Client
from nlcontrol.errors import ControlError
from nlcontrol.service import connection
from nlcontrol.service.documents import NumberedEvent
from nlcontrol.service.methods import PlanningSession, Run
from nlcontrol.session.events import Event
from tests.fakes.service_wire import ENDED, RESULT, RUN, URL, Stream, Wire, problem
from tests.patience import PATIENCE


@pytest.fixture(autouse=True)
def _no_waiting(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connection, "PAUSES", (0.0, 0.0, 0.0))


def client(wire: Wire) -> PlanningSession:
    return Client(URL, transport=wire).sessions.open()


def test_a_client_is_a_planning_session() -> None:
    wire = Wire(say=[RUN])
    session: PlanningSession = client(wire)
    run: Run = session.start("push the mug")
    assert run.run_id == "r1"


def test_what_is_lost_is_sent_again_with_the_same_key() -> None:
    wire = Wire(say=[httpx.ReadError, httpx.ConnectError, RUN], runs=[httpx.ReadError, RUN])
    session = client(wire)
    session.start("push the mug")
    session.start(plan_id="p1")
    keys = [request.headers["Idempotency-Key"] for request in wire.sent("say") + wire.sent("runs")]
    assert len(keys) == 5
    assert len(set(keys)) == 2


def test_a_session_is_opened_once() -> None:
    with pytest.raises(ControlError) as raised:
        client(wire := Wire(sessions=[httpx.ReadError]))
    assert raised.value.code == "no_service"
    assert raised.value.info.suggestions
    assert len(wire.requests) == 1


def test_a_question_that_moves_is_a_run() -> None:
    question = default_parser().parse("how heavy is the mug?")
    understood = {
        "ok": True,
        "text": question.text,
        "frames": [frame.model_dump(mode="json") for frame in question.frames],
    }
    wire = Wire(parse=[understood], say=[httpx.ReadError, RUN], r1=[ENDED], ask=[RESULT])
    session = client(wire)
    session.ask("how heavy is the mug?", motion="simulate")
    assert [json.loads(each.content)["motion"] for each in wire.sent("say")] == ["simulate"] * 2
    assert len({each.headers["Idempotency-Key"] for each in wire.sent("say")}) == 1
    session.ask("how heavy is the mug?")
    assert len(wire.sent("ask")) == 1


def test_a_service_that_is_slow_is_not_asked_again() -> None:
    wire = Wire(look=[httpx.ReadTimeout])
    with pytest.raises(ControlError) as raised:
        client(wire).look()
    assert raised.value.code == "no_service"
    assert len(wire.sent("look")) == 1


def test_a_problem_document_becomes_an_error() -> None:
    told = {
        "code": "stale_plan", "detail": "the mug has moved", "suggestions": ["plan again"],
        "numbers": {"moved": 0.012}, "span": [9, 12], "instance": "/v1/sessions/s1/runs",
    }  # fmt: skip
    with pytest.raises(ControlError) as raised:
        client(Wire(runs=[problem(409, **told)])).start(plan_id="p1")
    info = raised.value.info
    assert (info.code, info.message) == ("stale_plan", "the mug has moved")
    assert (info.suggestions, info.numbers) == (("plan again",), {"moved": 0.012})
    assert info.span == (9, 12)


@pytest.mark.parametrize(
    "answer",
    [
        httpx.Response(502, text="<html>"),
        httpx.Response(404, json=["no problem document"]),
        httpx.Response(400, json={"detail": "without a code"}),
        httpx.Response(200, text="<html>"),
        httpx.Response(307, headers={"Location": "http://elsewhere/"}),
        {"half": "a document"},
    ],
)
def test_what_is_no_planning_service_is_told_so(answer: Any) -> None:
    with pytest.raises(ControlError) as raised:
        client(Wire(look=[answer])).look()
    assert raised.value.code == "bad_answer"


@pytest.mark.parametrize("url", ["127.0.0.1:8000", "ftp://host", "http://", ""])
def test_a_url_that_is_none(url: str) -> None:
    with pytest.raises(ControlError) as raised:
        Client(url)
    assert raised.value.code == "usage"


def test_the_token_is_sent() -> None:
    wire = Wire()
    service = Client(URL, token="secret", transport=wire)
    assert not wire.requests  # nothing is called by making it
    service.sessions.open()
    assert wire.requests[0].headers["Authorization"] == "Bearer secret"


def test_without_httpx_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "httpx", None)
    with pytest.raises(ControlError) as raised:
        Client(URL)
    assert raised.value.code == "missing_extra"
    assert "'.[serve]'" in raised.value.info.suggestions[0]


def test_events_go_on_where_the_stream_was_lost() -> None:
    streams = [Stream(1, lost=True), httpx.ConnectError, Stream(1, 2, lost=True), Stream(3)]
    wire = Wire(say=[RUN], events=streams, r1=[RUN])
    events = list(client(wire).start("push the mug").events())
    assert [told.number for told in events] == [1, 2, 3]
    asked = [request.headers["Last-Event-ID"] for request in wire.sent("events")]
    assert asked == ["0", "1", "1", "2"]


def test_newlines_alone_end_the_lines_of_a_stream() -> None:
    class Split(Stream):
        def __iter__(self) -> Iterator[bytes]:
            event = {"kind": "phase", "time": 0.0, "wall_time": 0.0, "text": "a\u2028b"}
            data = json.dumps({"number": 1, "event": event}, ensure_ascii=False)
            yield b"id: 1\r\nda"
            yield f"ta: {data}\r\n\r\nid: 2\ndata: cut off".encode()

    wire = Wire(say=[RUN], events=[Split(), Stream(2, 3)], r1=[RUN])
    events = client(wire).start("push the mug").events()
    assert [told.event.text for told in events] == ["a\u2028b", "2", "3"]


def test_events_of_a_run_that_was_cut_off_come_to_an_end() -> None:
    cut = {**RUN, "state": "cut_off", "events": 2}
    wire = Wire(say=[RUN], events=[Stream(1), Stream(2)], r1=[RUN, cut])
    assert [told.number for told in client(wire).start("push the mug").events()] == [1, 2]


def test_the_last_events_are_had_although_the_run_has_ended() -> None:
    wire = Wire(say=[RUN], events=[Stream(1, lost=True), Stream(2, 3)], r1=[ENDED])
    assert [told.number for told in client(wire).start("push the mug").events()] == [1, 2, 3]


def test_a_service_that_stays_away_ends_the_events() -> None:
    wire = Wire(say=[RUN], events=[Stream(1, lost=True), httpx.ConnectError], r1=[RUN])
    heard: list[NumberedEvent] = []
    with pytest.raises(ControlError) as raised:
        heard.extend(client(wire).start("push the mug").events())
    assert raised.value.code == "no_service"


def test_a_callback_is_told_every_event_before_the_result_comes() -> None:
    wire = Wire(say=[RUN], events=[Stream(1, lost=True), Stream(2, 3)], r1=[RUN, ENDED])
    heard: list[tuple[str, threading.Thread]] = []
    run = client(wire).start(
        "push the mug", on_event=lambda e: heard.append((e.text, threading.current_thread()))
    )
    assert run.result(PATIENCE).status == "done"
    assert [text for text, _ in heard] == ["1", "2", "3"]
    assert all(thread is not threading.current_thread() for _, thread in heard)


def test_a_callback_that_fails_stops_the_run_and_its_failure_is_raised() -> None:
    def fail(event: Event) -> None:
        raise ZeroDivisionError(event.text)

    wire = Wire(say=[RUN], events=[Stream(1, 2, 3)], r1=[ENDED], stop=[{}])
    run = client(wire).start("push the mug", on_event=fail)
    with pytest.raises(ZeroDivisionError, match="1"):
        run.result(PATIENCE)
    assert len(wire.sent("stop")) == 1


def test_a_result_is_waited_for_so_long_and_no_longer() -> None:
    wire = Wire(say=[RUN], r1=[RUN])
    run = client(wire).start("push the mug")
    with pytest.raises(TimeoutError):
        run.result(0.1)
    wire.answers["r1"] = [RUN, ENDED]
    assert run.result(PATIENCE).ok


def test_a_run_that_was_cut_off_raises_what_the_service_says() -> None:
    error = {"code": "worker_lost", "message": "the service has ended", "suggestions": ["again"]}
    wire = Wire(say=[RUN], r1=[{**RUN, "state": "cut_off", "error": error}])
    with pytest.raises(ControlError) as raised:
        client(wire).start("push the mug").result()
    assert raised.value.code == "worker_lost"


def test_nothing_moved_and_there_is_no_trace() -> None:
    missing = problem(404, code="no_file", detail="nothing moved")
    wire = Wire(say=[RUN], r1=[ENDED], trace=[missing])
    assert client(wire).start("push the mug").trace() is None


def test_a_session_that_is_gone_closes_quietly() -> None:
    gone = problem(404, code="unknown_session", detail="it has ended")
    for answer in (gone, httpx.ConnectError):
        with client(Wire(s1=[answer])):
            pass
    with (
        pytest.raises(ControlError, match="busy"),
        client(Wire(s1=[problem(409, code="busy", detail="busy")])),
    ):
        pass


def test_a_sentence_that_is_not_understood_raises_its_error() -> None:
    told = {"code": "unknown_verb", "message": "it knows no such verb", "family": "sentence"}
    wire = Wire(parse=[{"ok": False, "text": "frobnicate", "error": told}])
    with pytest.raises(ControlError) as raised:
        client(wire).parse("frobnicate")
    assert raised.value.info.status.exit == 3
    frames = [{"action": "push", "object": {"text": "mug"}}]
    wire = Wire(parse=[{"ok": True, "text": "push it", "frames": frames, "paraphrase": "push it"}])
    assert client(wire).parse("push it").frames[0].action == "push"

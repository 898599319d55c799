"""Inside a worker, in this process: what is refused changes nothing for the run under way."""

from __future__ import annotations

import threading
from collections.abc import Callable

import pytest

from nlcontrol import Session
from nlcontrol.errors import ControlError
from nlcontrol.service.workers import session_host
from nlcontrol.service.workers.session_host import SessionHost
from nlcontrol.session.controller import Controller
from tests.fakes.played_executor import PlayedExecutor, played
from tests.patience import PATIENCE
from tests.unit.nlcontrol.pushes import Happens

RUN = {"plan_id": None, "said": "push the ice tea box 5 cm away", "motion": None}


class Heard:
    """Topics that were told, and the end among them."""

    def __init__(self) -> None:
        self.topics: list[str] = []
        self.ended = threading.Event()

    def __call__(self, topic: str, _: bytes) -> None:
        self.topics.append(topic)
        if topic == "ended":
            self.ended.set()


@pytest.fixture
def heard() -> Heard:
    return Heard()


@pytest.fixture
def host(
    heard: Heard, goes: Callable[..., Happens], monkeypatch: pytest.MonkeyPatch
) -> SessionHost:
    """A host whose session has a robot whose pushes are made up."""
    monkeypatch.setattr(session_host, "warm_up", lambda: None)
    monkeypatch.setattr(session_host, "lower_priority", lambda: None)
    robot: PlayedExecutor = played(Controller("kitchen"), goes())
    host = SessionHost(heard)
    monkeypatch.setattr(session_host, "named_executor", lambda _: robot)
    host.answer("open", {"spec": "{}", "executor": "played", "time_limit": 5.0})
    return host


def refused(host: SessionHost) -> str:
    with pytest.raises(ControlError) as raised:
        host.answer("begin_run", RUN)
    return raised.value.code


@pytest.mark.parametrize("said", ["take_turn", "stop_run", "stop"])
def test_a_run_that_is_refused_takes_no_turn_from_the_one_under_way(
    host: SessionHost, heard: Heard, said: str
) -> None:
    host.answer("begin_run", RUN)
    host.answer(said, {})
    assert refused(host) == "busy"
    assert heard.ended.wait(PATIENCE)
    assert host.session.start(RUN["said"] or "").result(PATIENCE).status == "done"


def test_a_run_that_is_refused_gives_the_one_under_way_no_time_limit(
    host: SessionHost, heard: Heard
) -> None:
    host.answer("begin_run", RUN)
    assert refused(host) == "busy"
    assert host.session.controller.time_limit is None
    host.answer("take_turn", {})
    assert heard.ended.wait(PATIENCE)
    assert host.session.controller.time_limit == 5.0


def test_a_run_that_was_stopped_before_its_turn_was_known_ends(
    host: SessionHost, heard: Heard, monkeypatch: pytest.MonkeyPatch
) -> None:
    start = Session.start

    def start_and_stop(*arguments: object, **options: object) -> object:
        run = start(*arguments, **options)  # type: ignore[arg-type]
        host.answer("stop", {})
        return run

    monkeypatch.setattr(Session, "start", start_and_stop)
    host.answer("begin_run", RUN)
    assert heard.ended.wait(PATIENCE)

"""A service that outlives its kills, and the page that goes on with it."""

from __future__ import annotations

import socket
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import httpx

from nlcontrol.service.run_store import STORE_VARIABLE
from tests.browser.open_page import OpenPage
from tests.patience import PATIENCE
from tests.service_process import serving

STATE = "page.state.get"
PLANNED = f"{STATE}('offer')?.result.status === 'planned'"
RESTING = f"!{STATE}('asking') && {STATE}('connection') === 'open'"
PHASE = f"{STATE}('events').findLast(({{ event }}) => event.phase)?.event.phase"
MOST_SESSIONS = 3


class LastingServer:
    """A service that is killed and started again, at one address and with one store.

    Args:
        store: its folder.
        options: of `nlcontrol serve`.
        environment: of it, beside ours.
    """

    def __init__(
        self,
        store: Path,
        options: Sequence[str] = ("--sessions", str(MOST_SESSIONS)),
        environment: Mapping[str, str] | None = None,
    ) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.url = f"http://127.0.0.1:{self.port}"
        self.store = store
        self._options, self._environment = options, dict(environment or {})
        self._running = ExitStack()

    def start(self) -> None:
        options = ("--port", str(self.port), *self._options)
        environment = {STORE_VARIABLE: str(self.store), **self._environment}
        self._server = self._running.enter_context(serving(*options, environment=environment))

    @property
    def pid(self) -> int:
        return self._server.process.pid

    def log(self) -> str:
        return self._server.log.read_text()

    def kill(self) -> None:
        self._server.process.kill()
        self._running.close()

    def close(self) -> None:
        self._running.close()

    def get(self, path: str) -> Any:
        return httpx.get(f"{self.url}/v1/{path}", timeout=PATIENCE).json()

    def session_ids(self) -> set[str]:
        return {each["session_id"] for each in self.get("sessions")["sessions"]}


def session_of(opened: OpenPage) -> str | None:
    found: str | None = opened.ask(f"{STATE}('session')?.session_id ?? null")
    return found


def plan(opened: OpenPage, text: str) -> None:
    opened.say(text)
    opened.wait(f"{STATE}('said') === {text!r} && {PLANNED}")

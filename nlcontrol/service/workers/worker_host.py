"""Inside a worker process: calls are read from the pipe and answered, each in a thread of its own.

The process ends when its pipe closes or its parent is gone, whatever it is doing.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Mapping
from multiprocessing.connection import Connection
from typing import Any, Protocol

from nlcontrol.errors import exception_info
from nlcontrol.parallel_tasks import end_with_parent
from nlcontrol.service.workers.worker_messages import Answer, Call, Ready, Told

Tell = Callable[[str, bytes], None]
"""Tells the parent something, by topic."""


class Host(Protocol):
    """Object that answers the calls of a worker, several at a time.

    Attributes:
        urgent: methods that wait for nothing, and that are done in the order of all calls.
    """

    urgent: frozenset[str]

    def answer(self, method: str, arguments: Mapping[str, Any]) -> bytes:
        """The answer to a call, as JSON.

        Args:
            method: that is called.
            arguments: of it.

        Raises:
            Exception: anything; the caller gets it as `ErrorInfo`.
        """


def run_host(
    connection: Connection[Any, Any],
    make_host: Callable[[Tell], Host],
    environment: Mapping[str, str],
) -> None:
    """Answers calls until the pipe closes, and ends this process.

    Args:
        connection: this process's end of the pipe.
        make_host: makes the host, given a way to tell the parent something by itself.
        environment: of the parent; what this process was forked from may have begun in another.
    """
    os.environ.clear()
    os.environ.update(environment)
    end_with_parent()
    try:
        _Worker(connection, make_host).answer_calls()
    except (EOFError, OSError):
        os._exit(0)


class _Worker:
    """The pipe, the host and the calls that are being answered."""

    def __init__(self, connection: Connection[Any, Any], make_host: Callable[[Tell], Host]) -> None:
        self._connection = connection
        self._writing = threading.Lock()
        self._host = make_host(lambda topic, content: self._send(Told(topic, content)))
        self._send(Ready())

    def answer_calls(self) -> None:
        """Reads calls for ever; raises what closes the pipe."""
        while True:
            call: Call = self._connection.recv()
            # What is urgent is done here; its answer may have to wait until others are written.
            done = self._answer(call) if call.method in self._host.urgent else None
            threading.Thread(target=self._send_answer, args=(call, done), daemon=True).start()

    def _send_answer(self, call: Call, done: Answer | None) -> None:
        self._send(done or self._answer(call))

    def _answer(self, call: Call) -> Answer:
        try:
            return Answer(call.number, self._host.answer(call.method, call.arguments), ok=True)
        except Exception as raised:
            info = exception_info(raised).model_dump_json().encode()
            return Answer(call.number, info, ok=False)

    def _send(self, message: Ready | Answer | Told) -> None:
        try:
            with self._writing:
                self._connection.send(message)
        except OSError:
            os._exit(0)  # nobody listens any more

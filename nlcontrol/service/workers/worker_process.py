"""A worker process as the service holds it: calls with futures, what it tells, its end.

On Linux all workers are forked from one process that has loaded and planned before and has a single
thread (`nlcontrol.service.workers.warm_process`), so that each begins warm and shares its memory.
Elsewhere, where that is not safe, each is a fresh process that warms up by itself.
"""

from __future__ import annotations

import atexit
import itertools
import logging
import multiprocessing
import os
import queue
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Future, InvalidStateError
from contextlib import contextmanager, suppress
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from threading import Timer
from typing import Any

from nlcontrol.errors import ControlError, ErrorInfo, error
from nlcontrol.service.workers.worker_host import Host, Tell, run_host
from nlcontrol.service.workers.worker_messages import Answer, Call, Ready, Told

LOGGER = logging.getLogger("nlcontrol.service")

_CONTEXT = (
    multiprocessing.get_context("forkserver")
    if sys.platform == "linux"
    else multiprocessing.get_context("spawn")
)
_CONTEXT.set_forkserver_preload(["nlcontrol.service.workers.warm_process"])
_LONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
_STARTING = threading.Lock()

DEAF_TO = (signal.SIGINT, signal.SIGTERM)
"""Signals that a worker does not hear: Control-C at a terminal reaches all processes, and what a
robot does is to be stopped by the service, in order."""


MOST_UNSENT = 64
"""Calls that wait to be written to one worker; one that does not read delays nobody else."""


class WorkerProcess:
    """A process of its own, with a host that answers calls. It may be called while it starts.

    No method but `wait` and `pid` waits for anything: calls are written by a thread of the worker's
    own, so that one that hangs holds up none but its own callers.

    Args:
        make_host: a function of a module, or a class, that makes the host in the process.
        on_ready: called once when the process has loaded what it needs.
        on_told: called with topic and content of what the process tells by itself.
        on_end: called once the process has ended, in whichever way.

    All three are called in the thread that reads the pipe, so that they must not wait.
    """

    def __init__(
        self,
        make_host: Callable[[Tell], Host],
        *,
        on_ready: Callable[[], object] = lambda: None,
        on_told: Callable[[str, bytes], object] = lambda topic, content: None,
        on_end: Callable[[], object] = lambda: None,
    ) -> None:
        self.on_ready, self.on_told, self.on_end = on_ready, on_told, on_end
        self._numbers = itertools.count(1)
        self._lock = threading.Lock()
        self._calls: dict[int, Future[bytes]] = {}
        self._unsent: queue.SimpleQueue[Call | None] = queue.SimpleQueue()
        self._ended = self._is_unwanted = False
        self._pid: int | None = None
        self._connection, there = _CONTEXT.Pipe()
        environment = dict(os.environ) | dict.fromkeys(_LONE_THREAD, "1")
        self._process: BaseProcess = _CONTEXT.Process(
            target=run_host, args=(there, make_host, environment), daemon=True
        )
        self._is_started = threading.Event()
        self._reader = threading.Thread(target=self._run, args=(there,), daemon=True)
        self._reader.start()

    @property
    def pid(self) -> int:
        """Number of the process; waits until it is started."""
        self._is_started.wait()
        assert self._pid is not None, "it could not be started"
        return self._pid

    def call(self, method: str, **arguments: Any) -> Future[bytes]:
        """Calls a method of the host; the answer is a JSON document.

        The future raises `ControlError`: what the host raised, or `worker_lost`.
        """
        return self._asked(method, arguments, MOST_UNSENT)

    def command(self, method: str) -> Future[bytes]:
        """The same of what may not be turned away, such as a stop; in the order of all calls."""
        return self._asked(method, {}, sys.maxsize)

    def _asked(self, method: str, arguments: Mapping[str, Any], most: int) -> Future[bytes]:
        future: Future[bytes] = Future()
        future.set_running_or_notify_cancel()
        number = next(self._numbers)
        failure = lost_error()
        with self._lock:
            if not self._ended and self._unsent.qsize() < most:
                self._unsent.put(Call(number, method, arguments))
                self._calls[number] = future
                return future
            if not self._ended:
                failure = _deaf_error()
        future.set_exception(failure)
        return future

    def kill(self) -> None:
        """Ends the process at once; one that is about to start, as soon as it has."""
        with self._lock:
            self._is_unwanted = True
            if self._pid is not None and not self._ended:
                # By its number: `Process.kill` takes it for ended where what forked it has.
                with suppress(ProcessLookupError):
                    os.kill(self._pid, signal.SIGKILL)

    def wait(self, timeout: float | None = None) -> bool:
        """Waits [s] until the process has ended and that was told; returns True if so."""
        self._reader.join(timeout)
        return not self._reader.is_alive()

    def _run(self, there: Connection[Any, Any]) -> None:
        """Starts the process and takes what it sends, until it has ended."""
        with suppress(EOFError, OSError):  # what it is forked from has ended: as if it had itself
            with _surroundings():
                self._process.start()
            atexit.register(self.kill)  # it does not end by SIGTERM
        with self._lock:
            self._pid = self._process.pid
        self._is_started.set()
        there.close()
        if self._is_unwanted:
            self.kill()
        writer = threading.Thread(target=self._write, daemon=True)
        writer.start()
        with suppress(EOFError, OSError):
            while True:
                self._take(self._connection.recv())
        self.kill()
        if self._pid is not None:
            self._process.join()
        self._process.close()  # its descriptors with it
        atexit.unregister(self.kill)
        with self._lock:
            self._ended = True
            calls, self._calls = self._calls, {}
        while not self._unsent.empty():
            self._unsent.get_nowait()
        self._unsent.put(None)
        writer.join()
        self._connection.close()
        for future in calls.values():
            _settle(future, lost_error())
        _log_failures(self.on_end)

    def _write(self) -> None:
        """Writes calls to the pipe, which blocks while the process does not read."""
        with suppress(OSError):  # it has just ended, which its reader will notice
            while (call := self._unsent.get()) is not None:
                self._connection.send(call)

    def _take(self, message: object) -> None:
        match message:
            case Ready():
                _log_failures(self.on_ready)
            case Told(topic, content):
                _log_failures(self.on_told, topic, content)
            case Answer(number, content, ok):
                with self._lock:
                    future = self._calls.pop(number)
                info = None if ok else ErrorInfo.model_validate_json(content)
                _settle(future, content if info is None else ControlError(info))


def _settle(future: Future[bytes], outcome: bytes | ControlError) -> None:
    with suppress(InvalidStateError):  # whoever waited was told otherwise already
        if isinstance(outcome, bytes):
            future.set_result(outcome)
        else:
            future.set_exception(outcome)


def _log_failures(told: Callable[..., object], *arguments: object) -> None:
    """Calls back; a defect there must not end the reading of the pipe."""
    try:
        told(*arguments)
    except Exception:
        LOGGER.exception("a callback of a worker failed")


def lost_error() -> ControlError:
    """The error of a call whose process has ended."""
    return error(
        "worker_lost",
        "the process that worked on this has ended unexpectedly",
        suggestions=("ask again; a session that is lost is to be opened anew",),
    )


def _deaf_error() -> ControlError:
    return error(
        "queue_full",
        f"the process that works on this takes no calls, and {MOST_UNSENT} wait for it already",
        suggestions=("ask again in a few seconds", "close its session"),
        numbers={"waiting": float(MOST_UNSENT), "retry_after": 2.0},
    )


def time_limit_error(limit: float) -> ControlError:
    """The error of a call that was not answered in time.

    Args:
        limit: the time [s].
    """
    return error(
        "time_limit",
        f"no answer was found within {limit:g} s",
        suggestions=("say less at once", "ask again when the service has less to do"),
        numbers={"time_limit": limit},
    )


def daemon_timer(delay: float, action: Callable[..., object], *arguments: object) -> Timer:
    """A timer that has begun to run, and that keeps no program from ending.

    Args:
        delay: after which the action is done [s].
        action: called in a thread of its own.
        arguments: of the action.
    """
    timer = Timer(delay, action, arguments)
    timer.daemon = True
    timer.start()
    return timer


@contextmanager
def _surroundings() -> Iterator[None]:
    """Context in which a process starts: its libraries take one thread each, it hears no signal."""
    with _STARTING:
        resource_tracker.ensure_running()  # which may let its starter hear signals again
        before = {name: os.environ.get(name) for name in _LONE_THREAD}
        os.environ.update(dict.fromkeys(_LONE_THREAD, "1"))
        heard = signal.pthread_sigmask(signal.SIG_BLOCK, DEAF_TO)
        try:
            yield
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, heard)
            for name, value in before.items():
                if value is None:
                    del os.environ[name]
                else:
                    os.environ[name] = value

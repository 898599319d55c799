"""A worker process as the service holds it: calls with futures, what it tells, its end.

On Linux all workers are forked from one process that has loaded and planned before and has a single
thread (`nlcontrol.service.workers.warm_process`), so that each begins warm and shares its memory.
Elsewhere, where that is not safe, each is a fresh process that warms up by itself.
"""

from __future__ import annotations

import asyncio
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
from typing import Any, NamedTuple, Protocol

from nlcontrol.errors import ControlError, ErrorInfo, error, exception_info
from nlcontrol.parallel_tasks import end_with_parent

# Messages between the service and its worker processes: plain data, answers as JSON in bytes.


class Call(NamedTuple):
    """A method to be called in the worker.

    Attributes:
        number: number of the call, repeated in its answer.
        method: name of it.
        arguments: arguments by name, as JSON has them.
    """

    number: int
    method: str
    arguments: Mapping[str, Any]


class Ready(NamedTuple):
    """The worker has loaded what it needs."""


class Answer(NamedTuple):
    """Answer to a call.

    Attributes:
        number: number of the call.
        content: a JSON document, or the `ErrorInfo` of what was raised.
        ok: nothing was raised.
    """

    number: int
    content: bytes
    ok: bool


class WorkerEvent(NamedTuple):
    """Something that the worker tells without being asked.

    Attributes:
        topic: one of its host's.
        content: content as JSON.
    """

    topic: str
    content: bytes


# Inside a worker process: calls are read from the pipe and answered, each in a thread of its own.
#
# The process ends when its pipe closes or its parent is gone, whatever it is doing.


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
            method: method that is called.
            arguments: arguments of the method.

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
        environment: environment of the parent, since a forked process may have begun in another.
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
        self._host = make_host(lambda topic, content: self._send(WorkerEvent(topic, content)))
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

    def _send(self, message: Ready | Answer | WorkerEvent) -> None:
        try:
            with self._writing:
                self._connection.send(message)
        except OSError:
            os._exit(0)  # nobody listens any more


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
                failure = queue_full(
                    f"the process that works on this takes no calls, and {MOST_UNSENT} wait for it "
                    "already",
                    MOST_UNSENT,
                    "ask again in a few seconds",
                    "close its session",
                    retry_after=2.0,
                )
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

    def _end_at_exit(self) -> None:
        """Ends the process before `multiprocessing` looks for those that are left."""
        self.kill()
        # A process that was killed has surely ended within 5 s.
        self.wait(5.0)

    def wait(self, timeout: float | None = None) -> bool:
        """Waits [s] until the process has ended and that was told; returns True if so."""
        self._reader.join(timeout)
        return not self._reader.is_alive()

    def _run(self, there: Connection[Any, Any]) -> None:
        """Starts the process and takes what it sends, until it has ended."""
        with suppress(EOFError, OSError):  # what it is forked from has ended: as if it had itself
            with _surroundings():
                self._process.start()
            atexit.register(self._end_at_exit)  # it does not end by SIGTERM
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
        atexit.unregister(self._end_at_exit)
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
            case WorkerEvent(topic, content):
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


def queue_full(message: str, waiting: int, *suggestions: str, retry_after: float) -> ControlError:
    """The error of a caller for whom there is no room.

    Args:
        message: which queue is full.
        waiting: how many wait in it.
        suggestions: what to do instead.
        retry_after: time after which to ask again [s].
    """
    numbers = {"waiting": float(waiting), "retry_after": retry_after}
    return error("queue_full", message, suggestions=suggestions, numbers=numbers)


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
        delay: time after which the action is done [s].
        action: called in a thread of its own.
        arguments: arguments of the action.
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


# LoopNotifier that wakes tasks of event loops, rung from any thread.


class LoopNotifier:
    """Those who listen, and a way to wake them all."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._listeners: dict[asyncio.Event, asyncio.AbstractEventLoop] = {}

    @property
    def listeners(self) -> int:
        """Number of those who listen."""
        return len(self._listeners)

    def notify(self) -> None:
        """Wakes all that listen."""
        with self._lock:
            listeners = dict(self._listeners)
        for heard, loop in listeners.items():
            with suppress(RuntimeError):  # its loop is closed, so that nobody waits there
                loop.call_soon_threadsafe(heard.set)

    @contextmanager
    def subscription(self) -> Iterator[asyncio.Event]:
        """Context of one who listens, in a task; the event is set by every ring."""
        heard = asyncio.Event()
        with self._lock:
            self._listeners[heard] = asyncio.get_running_loop()
        try:
            yield heard
        finally:
            with self._lock:
                del self._listeners[heard]

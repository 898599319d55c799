"""Inside a worker: one session with its run, or calls that get a session each.

Topics that are told: `event` (JSON of an `Event`), `request` (a `RunRequest`), `trace` (a file in
bytes), `ended` (a `RunEnd`) and `pose_frame` (a `PoseFrame`).
"""

from __future__ import annotations

import math
import os
import sys
import threading
from collections import OrderedDict
from collections.abc import Mapping
from functools import cache, cached_property, partial
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from nlcontrol.errors import ErrorInfo, error, exception_info
from nlcontrol.json_document import DocumentPart
from nlcontrol.results.result import Result
from nlcontrol.service.documents import SessionSpec, TableSpec
from nlcontrol.service.session import Session
from nlcontrol.service.workers.pose_stream import PoseStream
from nlcontrol.service.workers.replay_files import write_view
from nlcontrol.service.workers.session_answers import ASKED, session_answer
from objectmodels import Registry

if TYPE_CHECKING:
    from nlcontrol.service.session_runs import SessionRun
    from nlcontrol.service.workers.worker_host import Tell
    from nlcontrol.session.events import Event
    from nlcontrol.session.executor import Executor, Motion
    from sim.traces.trace import Trace

NICE = 5
"""Niceness of the thread that simulates: plans come first, and other work does not starve a run."""

MOST_TABLES = 4
"""Tables that a worker keeps open for calls without a session."""

_FIRST_SENTENCES = (
    "push the coffee box 5 cm away without toppling it",
    "push the mug 3 cm to the left",
    "push the ice tea box 4 cm to the right with one finger",
    "pour 50 ml of the ice tea into the mug",
)
"""Two fingers, a rim, one finger and a grasp, at the built-in table *kitchen*."""


class RunEnd(DocumentPart):
    """The end of a run: its result, or the error for which there is none, or not all files."""

    result: Result | None = None
    error: ErrorInfo | None = None


class SessionHost:
    """One session, and the run that is under way in it; or a session for each call.

    Args:
        tell: tells the service something by topic.
    """

    urgent = frozenset({"stop", "stop_run", "give_up_answer", "take_turn"})

    def __init__(self, tell: Tell) -> None:
        self._tell = tell
        self._session: Session | None = None
        self._run: SessionRun | None = None
        self._time_limit = math.inf
        self._turn = threading.Event()
        self._registry = Registry.default()  # to look for plug-ins takes longer than to read
        self._opening = threading.Lock()
        self._executors: OrderedDict[str, Executor] = OrderedDict()
        warm_up()

    @property
    def session(self) -> Session:
        """The session, which is open."""
        assert self._session is not None, "it is opened first"
        return self._session

    @cached_property
    def poses(self) -> PoseStream:
        """Poses of all bodies, for viewers of the session."""
        return PoseStream(self.session, partial(self._tell, "pose_frame"))

    def answer(self, method: str, arguments: Mapping[str, Any]) -> bytes:
        """The answer of the session, or of its run; see `Host`."""
        match method:
            case "answer_alone":
                return self._answer_alone(**arguments)
            case "replay" | "recording":
                write_view(method, **arguments)
                return b"{}"
            case "open":
                return self._open(**arguments)
            case "begin_run":
                return self._begin_run(**arguments)
            case "take_turn":
                self._turn.set()
                return b"{}"
            case "stop" | "stop_run":
                return self._stop(session=method == "stop")
            case "give_up_answer":
                self.session.give_up_answer()
                return b"{}"
            case "drop_run":
                return self._drop_run()
            case "geometry":
                return self.poses.geometry().model_dump_json().encode()
            case "tell_poses":
                self.poses.tell_frames(**arguments)
                return b"{}"
            case _:
                return session_answer(self.session, method, arguments)

    def _answer_alone(
        self, asked: str, table: str, time_limit: float, arguments: Mapping[str, Any]
    ) -> bytes:
        """The answer to a question, in a session of its own that ends with it.

        Args:
            asked: one of `ASKED`.
            table: as JSON; it may be open already.
            time_limit: of the answer [s].
            arguments: of the method.
        """
        if asked not in ASKED:
            raise ValueError(f"{asked} needs a session")
        with self._opening:
            executor = self._executors.pop(table, None)
        spec = SessionSpec(**TableSpec.model_validate_json(table).model_dump())
        session = Session(spec, executor=executor, registry=self._registry, time_limit=time_limit)
        with self._opening:
            self._executors[table] = session.controller.executor
            while len(self._executors) > MOST_TABLES:
                self._executors.popitem(last=False)
        return session_answer(session, asked, arguments, ends=True)

    def _open(self, spec: str, executor: str | None, time_limit: float) -> bytes:
        """Opens the session, with the robot of a class `module:Class` or with the simulated one."""
        robot = None if executor is None else named_executor(executor)
        self._time_limit = time_limit
        self._session = Session(
            SessionSpec.model_validate_json(spec), executor=robot, time_limit=time_limit
        )
        return b"{}"

    def _begin_run(self, plan_id: str | None, said: Any, motion: Motion | None) -> bytes:
        """Begins a run, which waits for its turn before anything moves.

        Its plans take what they take, so that what it does does not depend on the machine.
        """
        turn = threading.Event()  # its own: a run that is refused changes nothing for another one
        tell = partial(self._tell_event, turn)
        self.session.controller.time_limit = None
        try:
            if plan_id is None:
                run = self.session.say(said, motion=motion, on_event=tell)
            else:
                run = self.session.execute(plan_id, text=said, on_event=tell)
            self._run, self._turn = run, turn
            if run.is_stopped:  # before its turn was known
                turn.set()
        except BaseException:
            if self._run is None or self._run.is_over:
                self.session.controller.time_limit = self._time_limit
            raise
        threading.Thread(target=self._follow, args=(run,), daemon=True).start()
        return run.info().model_dump_json().encode()

    def _stop(self, *, session: bool) -> bytes:
        """Asks the run to come to rest, be it before its turn; with the session, plans go too."""
        if session and self._session is not None:
            self.session.stop()
        elif self._run is not None:
            self._run.stop()
        self._turn.set()
        return b"{}"

    def _drop_run(self) -> bytes:
        """Ends a run that is not to begin, before anything has moved."""
        self._stop(session=False)
        if self._run is not None:
            self._run.join()
        return b"{}"

    def _tell_event(self, turn: threading.Event, event: Event) -> None:
        """Tells an event; before the first one the run waits for its turn, in its own thread."""
        if not turn.is_set():
            lower_priority()
            turn.wait()
        self._tell("event", event.model_dump_json().encode())

    def _follow(self, run: SessionRun) -> None:
        """Waits for the end of a run, and tells it after all that belongs to the run."""
        try:
            end = RunEnd(result=run.result())
        except Exception as raised:
            end = RunEnd(error=exception_info(raised))
        self.session.controller.time_limit = self._time_limit
        try:
            if run.request is not None:
                self._tell("request", run.request.model_dump_json().encode())
            trace = run.trace()
            if trace is not None:
                self._tell("trace", trace_bytes(trace))
        except Exception as raised:  # such as a disk that is full: the run has ended all the same
            end = RunEnd(result=end.result, error=end.error or exception_info(raised))
        self._tell("ended", end.model_dump_json().encode())


@cache
def warm_up() -> None:
    """Loads and computes what the first plans would otherwise wait for; once in a process."""
    session = Session(SessionSpec())
    for sentence in _FIRST_SENTENCES:
        session.plan(sentence)


def lower_priority() -> None:
    """Lets this thread give way to others, in all processes."""
    if sys.platform == "linux":
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), NICE)


def trace_bytes(trace: Trace) -> bytes:
    """A trace as its file has it."""
    with TemporaryDirectory(prefix="nlcontrol-") as folder:
        path = Path(folder) / "trace.npz"
        trace.save(path)
        return path.read_bytes()


def named_executor(name: str) -> Executor:
    """The robot of a class, made without arguments.

    Args:
        name: of the class, as `module:Class`.

    Raises:
        ControlError: `bad_executor`.
    """
    module, _, of_class = name.partition(":")
    try:
        robot: Executor = getattr(import_module(module), of_class)()
    except Exception as raised:
        raise error(
            "bad_executor",
            f"the robot of {name} cannot be made: {type(raised).__name__}: {raised}",
            suggestions=("name a class as module:Class, to be made without arguments",),
        ) from raised
    return robot

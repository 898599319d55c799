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
from collections.abc import Callable, Mapping
from functools import cache, cached_property, partial
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel

from nlcontrol.errors import NOT_UNDERSTOOD, ControlError, ErrorInfo, error, exception_info
from nlcontrol.json_document import Document, DocumentPart, document_text
from nlcontrol.reports.replay_story import replay_story
from nlcontrol.reports.word_explanation import reading_explanation
from nlcontrol.results.result import Result, result_with
from nlcontrol.service.documents import (
    Offer,
    PoseFrame,
    SceneGeometry,
    SessionSpec,
    StatedObject,
    TableSpec,
    Understanding,
)
from nlcontrol.service.methods import QUESTIONS, PlanningSession
from nlcontrol.service.session import Session, SessionRun
from nlcontrol.session.corrected_sentences import error_with_corrections
from nlcontrol.session.frame_documents import Frames, text_of
from objectmodels import Registry
from objectmodels.geometry.rotations import quaternion
from sim.simulated_executor import SimulatedExecutor
from sim.traces.trace import Trace
from sim.truth.scene_file import load_scene
from sim.views.viewer_recording import SceneBodies, believed_scene, save_recording, save_replay

if TYPE_CHECKING:
    from nlcontrol.service.workers.worker_process import Tell
    from nlcontrol.session.controller import Controller
    from nlcontrol.session.events import Event
    from nlcontrol.session.executor import Executor, Motion
    from sim.worlds.ports import Sample


# Inside the process of a session: poses for viewers while somebody looks, and nothing otherwise.
#
# Of a simulated world these are what its observer sees. The world leaves a sample of itself after
# every control step; a thread of its own takes the newest one now and then, so that nothing is
# asked of the world, and what happens in it does not depend on who looks; it only takes no less
# than real time then. Of another robot it is what is believed since the last look.


RATE = 30.0
"""Frames per second of the robot's time, at most."""


class ObservedWorld:
    """A simulated world as its observer sees it.

    Args:
        executor: executor whose world is shown.
    """

    def __init__(self, executor: SimulatedExecutor) -> None:
        self._executor = executor
        # A viewer's own world shows how things are before anything moves: the executor's is built
        # then, and no sooner because somebody looks.
        if not executor.is_built:
            executor = SimulatedExecutor(executor.scene, seed=executor.seed)
        world = executor.world
        self._first, self._joint_names = world.sample, world.robot.joint_names
        self._bodies = SceneBodies(world.scene)

    def _sample(self) -> Sample:
        return self._executor.world.sample if self._executor.is_built else self._first

    @property
    def time(self) -> float:
        """Time of the newest sample [s]."""
        return self._sample().time

    def geometry(self) -> SceneGeometry:
        """All that is drawn."""
        return SceneGeometry(source="observer", **self._bodies.document())

    def frame(self) -> PoseFrame:
        """Places of all bodies in the newest sample."""
        sample = self._sample()
        poses = self._bodies.poses(sample, self._joint_names)
        return PoseFrame(time=sample.time, source="observer", poses=poses)

    def keep_real_time(self, wanted: bool) -> None:
        """Lets the simulation run no faster than the clock, or ends that."""
        if self._executor.is_built:
            self._executor.world.clock.runs = wanted


class BelievedTable:
    """The table of a robot that is not simulated, as it was seen last: a box for each object.

    Args:
        controller: controller of the robot.
    """

    def __init__(self, controller: Controller) -> None:
        self._controller = controller

    @property
    def time(self) -> float:
        """Time of the robot [s]."""
        return self._controller.executor.time

    def geometry(self) -> SceneGeometry:
        """Each object in the shape of its model."""
        name, models = self._controller.cell.name, self._controller.models
        return SceneGeometry(source="belief", **believed_scene(name, models))

    def frame(self) -> PoseFrame:
        """Places of the objects as they are believed."""
        state = self._controller.last_look.state
        objects = {} if state is None else state.objects
        poses = {
            name: (*quaternion(seen.pose.R_WB).tolist(), *seen.pose.p_WB.tolist())
            for name, seen in objects.items()
        }
        return PoseFrame(time=self.time, source="belief", poses=poses)

    def keep_real_time(self, wanted: bool) -> None:
        """Changes nothing: another robot has a time of its own."""


View = ObservedWorld | BelievedTable
"""Ways to see a robot and its table."""


class PoseStream:
    """Frames of a session, told while they are wanted.

    Args:
        session: session of the robot that is shown.
        tell: tells a frame, as JSON.
    """

    def __init__(self, session: Session, tell: Callable[[bytes], None]) -> None:
        self._session, self._tell = session, tell
        self._unwanted = threading.Event()
        self._unwanted.set()
        self._lock = threading.Lock()
        self._seen: tuple[Executor, View] | None = None

    def geometry(self) -> SceneGeometry:
        """All that is drawn of the session."""
        return self._view().geometry()

    def tell_frames(self, wanted: bool) -> None:
        """Begins to tell frames, or ends it."""
        if not wanted:
            self._unwanted.set()
        elif self._unwanted.is_set():
            self._unwanted = threading.Event()
            threading.Thread(target=self._tell_until, args=(self._unwanted,), daemon=True).start()

    def _view(self) -> View:
        """The view of the robot, which is another one after a reset."""
        with self._lock:
            controller = self._session.controller
            executor = controller.executor
            if self._seen is None or self._seen[0] is not executor:
                if isinstance(executor, SimulatedExecutor):
                    self._seen = executor, ObservedWorld(executor)
                else:
                    self._seen = executor, BelievedTable(controller)
            return self._seen[1]

    def _tell_until(self, unwanted: threading.Event) -> None:
        shown, due = None, -math.inf
        # A simulation may run several times faster than the clock.
        while not unwanted.wait(0.008):
            view = self._view()
            view.keep_real_time(True)
            if view is not shown:
                shown, due = view, -math.inf
            if view.time >= due:
                frame = view.frame()
                due = max(due + 1.0 / RATE, frame.time + 0.5 / RATE)
                self._tell(frame.model_dump_json().encode())
        if shown is not None:
            shown.keep_real_time(False)


# Replays and recordings of runs, which a worker writes: they take the engine.


def write_view(kind: str, trace: str, scene: str, path: str, result: str | None) -> None:
    """Writes the replay of a trace, or its recording.

    Args:
        kind: `replay` or `recording`.
        trace: path of its file.
        scene: name of it.
        path: path of the file that is written.
        result: result of the run as JSON, or None.
    """
    shown, story = Trace.load(Path(trace)), None
    if result is not None:
        known = Result.model_validate_json(result)
        story = replay_story(result_with(known, trace=shown))
    save = save_replay if kind == "replay" else save_recording
    save(shown, load_scene(scene), Path(path), story=story)


# Answers of a planning session as JSON documents.


ASKED = frozenset(question.name for question in QUESTIONS)
"""Methods that any caller may call: nothing moves."""

METHODS = ASKED | {"reset"}
"""Those of one's own session."""


def session_answer(
    session: PlanningSession, method: str, arguments: Mapping[str, Any], *, ends: bool = False
) -> bytes:
    """The answer of a session to one of `METHODS`, as JSON.

    Args:
        session: session that answers.
        method: name of its method.
        arguments: of the method, as JSON has them; with `explain` the result says which words
            became which parameters.
        ends: the session ends with this answer, so that a plan id would be good for nothing.

    Raises:
        ControlError: what the session raises.
    """
    if method not in METHODS:
        raise ValueError(f"{method} is no method of a session")
    if method == "ask":
        arguments = {**arguments, "motion": "never"}  # what moves waits for its turn, as a run
    stated = arguments.get("objects") if method == "look" else None
    if stated is not None:
        objects = tuple(StatedObject.model_validate(item) for item in stated)
        arguments = {**arguments, "objects": objects}
    if method == "parse":
        return _understanding(session, arguments["said"]).model_dump_json().encode()
    explains = arguments.get("explain", False)
    rest = {key: value for key, value in arguments.items() if key != "explain"}
    answer: BaseModel | None = getattr(session, method)(**rest)
    if answer is None:
        return b"{}"
    if isinstance(answer, Offer):
        offered = {"plan_id": None, "expires_in": None} if ends else {}
        answer = answer.model_copy(
            update={**offered, "result": _explained(answer.result) if explains else answer.result}
        )
    elif isinstance(answer, Result) and explains:
        answer = _explained(answer)
    if isinstance(answer, Document):
        return answer.model_dump_json().encode()
    return document_text(answer.model_dump(mode="json"), None).encode()


def _understanding(session: PlanningSession, said: str | Frames) -> Understanding:
    """The reading of a sentence; that it is not understood is one too.

    Raises:
        ControlError: anything else went wrong.
    """
    text = text_of(said)
    try:
        read = session.parse(said)
    except ControlError as raised:
        if raised.info.status.exit != NOT_UNDERSTOOD:
            raise
        info = error_with_corrections(raised.info, text, session.parse)
        return Understanding(ok=False, text=text, error=info)
    return Understanding(
        ok=True,
        text=read.text,
        frames=read.frames,
        paraphrase=read.paraphrase,
        asides=read.asides,
        left_out=read.left_out,
        explanation=reading_explanation(read),
    )


def _explained(result: Result) -> Result:
    """The result with the way of its words to parameters."""
    return result_with(result, explanation=result.explanation_rows())


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
                self._stop(session=False)
                if self._run is not None:
                    self._run.join()
                return b"{}"
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
            table: table as JSON; it may be open already.
            time_limit: longest time for the answer [s].
            arguments: arguments of the method.
        """
        if asked not in ASKED:
            raise ValueError(f"{asked} needs a session")
        with self._opening:
            executor = self._executors.pop(table, None)
        spec = SessionSpec(**TableSpec.model_validate_json(table).model_dump())
        session = Session(spec, executor=executor, registry=self._registry, time_limit=time_limit)
        with self._opening:
            self._executors[table] = session.controller.executor
            # A worker keeps four tables open for calls without a session.
            while len(self._executors) > 4:
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
                run = self.session.start(said, motion=motion, on_event=tell)
            else:
                run = self.session.start(plan_id=plan_id, text=said, on_event=tell)
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
        # Plans come before the thread that simulates, and other work does not starve a run.
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), 5)


def trace_bytes(trace: Trace) -> bytes:
    """A trace as its file has it."""
    with TemporaryDirectory(prefix="nlcontrol-") as folder:
        path = Path(folder) / "trace.npz"
        trace.save(path)
        return path.read_bytes()


def named_executor(name: str) -> Executor:
    """The robot of a class, made without arguments.

    Args:
        name: name of the class, as `module:Class`.

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

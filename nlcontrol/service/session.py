"""A planning session in this process: look, plan, approve, do, verify.

    from nlcontrol import Session

    with Session("kitchen") as session:
        offer = session.plan("push the ice tea box away without toppling it")
        print(offer.result.text)
        result = session.execute(offer)

A plan is carried out as it was approved, from a table that is as it was then: `execute` looks
again first. After the first plan the robot looks, learns and plans anew as in every sentence.
"""

from __future__ import annotations

import secrets
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import combinations
from pathlib import Path
from threading import Condition, RLock, Thread
from typing import TYPE_CHECKING, Literal

from grammar.frames.command import Command
from nlcontrol.argument_types import checked_arguments
from nlcontrol.errors import ControlError, ErrorInfo, error, exception_info, known_errors_raised
from nlcontrol.outcome_maps.outcome_map_table import map_document
from nlcontrol.questions.push_prediction import PushPrediction, predict_push
from nlcontrol.references.object_names import face_of
from nlcontrol.results.result import Result
from nlcontrol.service.bundle import RunRequest, run_request
from nlcontrol.service.documents import (
    Affordances,
    FaceMap,
    NumberedEvent,
    Offer,
    RunInfo,
    RunKind,
    SessionSpec,
    Source,
    StatedObject,
    TableSpec,
    TableView,
    session_spec,
)
from nlcontrol.service.methods import (
    PlanningSession,
    ended_result,
    is_question,
    start_arguments,
)
from nlcontrol.service.offers import (
    LIFE,
    OfferedPlans,
    Tolerances,
    belief_digest,
    offer_drawing,
    require_unchanged,
    table_view,
)
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.events import Event
from nlcontrol.session.executor import Executor, Motion, Planner
from nlcontrol.session.frame_documents import Frames, text_of
from objectmodels import ModelError, Registry
from objectmodels.mechanics.outcome_map import outcome_map
from planner.problem.footprints import footprint, gap, room_to_edge
from planner.types.defaults import with_settings
from planner.types.world_state import PlanarPose, SeenObject
from sim import Scene
from sim.robots.cell_description import CellDescription, CellObject
from sim.simulated_executor import SimulatedExecutor
from sim.stated_table import StatedTable
from sim.supervision import StopToken

if TYPE_CHECKING:
    from sim.traces.trace import Trace

    RunBody = Callable[[Callable[[Event], None], StopToken], Result]


# A run in this process: a thread that carries something out, and all that it tells.


class SessionRun:
    """Something that a session carries out, from its construction on.

    Args:
        body: carries it out; it is given who is told of events, and what asks it to stop.
        session_id: name of the session.
        kind: kind of the run.
        text: the sentence.
        plan_id: the approved plan.
        table: the table on which it is carried out.
        on_event: told of every event, in the thread of the run.
        request: makes the request of what has just been carried out.

    Attributes:
        request: request with all that it takes to repeat the run; None until it has a result.
    """

    def __init__(
        self,
        body: RunBody,
        *,
        session_id: str,
        kind: RunKind,
        text: str,
        plan_id: str | None = None,
        table: TableSpec,
        on_event: Callable[[Event], object] | None = None,
        request: Callable[[Result], RunRequest],
    ) -> None:
        self.run_id = f"run-{secrets.token_hex(8)}"
        self.request: RunRequest | None = None
        self._body, self._on_event, self._make_request = body, on_event, request
        self._stop = StopToken()
        self._changed = Condition()
        self._events: list[NumberedEvent] = []
        self._result: Result | None = None
        self._failure: Exception | None = None  # raised by the callback
        now = time.time()
        self._info = RunInfo(
            run_id=self.run_id,
            session_id=session_id,
            kind=kind,
            state="running",
            text=text,
            plan_id=plan_id,
            scene=table.scene,
            seed=table.seed,
            asked_at=now,
            begun_at=now,
        )
        self._thread = Thread(target=self._carry_out, name=self.run_id)
        self._thread.start()

    def _carry_out(self) -> None:
        result: Result | None = None
        failure: ErrorInfo | None = None
        try:
            result = self._body(self._tell, self._stop)
            self.request = self._make_request(result)
        except Exception as raised:
            failure = exception_info(raised)
        with self._changed:
            self._result = result
            self._info = self._info.model_copy(
                update={
                    "state": "defect" if result is None else "ended",
                    "ended_at": time.time(),
                    "result": result,
                    "error": failure,
                }
            )
            self._changed.notify_all()

    def _tell(self, event: Event) -> None:
        with self._changed:
            self._events.append(NumberedEvent(number=len(self._events) + 1, event=event))
            self._changed.notify_all()
        if self._on_event is None or self._failure is not None:
            return
        try:
            self._on_event(event)
        except Exception as raised:
            self._failure = raised
            self.stop()

    def __repr__(self) -> str:
        return f"<Run {self.run_id} “{self._info.text}”: {self._info.state}>"

    @property
    def is_over(self) -> bool:
        """It has ended, in whichever way."""
        return self._info.ended_at is not None

    @property
    def is_stopped(self) -> bool:
        """It was asked to come to rest."""
        return self._stop.requested

    def info(self) -> RunInfo:
        """The run as it is now."""
        with self._changed:
            return self._info.model_copy(update={"events": len(self._events)})

    def events(self, after: int = 0) -> Iterator[NumberedEvent]:
        """Its events as they happen, until it has ended; see `Run.events`."""
        while fresh := self._events_after(after):
            yield from fresh
            after += len(fresh)

    def _events_after(self, number: int) -> list[NumberedEvent]:
        """The events since one, as soon as there is any; none if it has ended."""
        with self._changed:
            self._changed.wait_for(lambda: len(self._events) > number or self.is_over)
            return self._events[number:]

    def result(self, timeout: float | None = None) -> Result:
        """The result; waits until it has ended; see `Run.result`."""
        with self._changed:
            if not self._changed.wait_for(lambda: self.is_over, timeout):
                raise TimeoutError(f"it goes on after {timeout} s")
        if self._failure is not None:
            raise self._failure
        if self._info.error is not None:
            raise ControlError(self._info.error)
        assert self._result is not None, "a run ends with a result, or with an error"
        return self._result

    def stop(self) -> None:
        """Asks it to let go and come to rest; its result is then `cancelled`."""
        self._stop.request()

    def join(self) -> None:
        """Waits until it has ended."""
        self._thread.join()

    def trace(self) -> Trace | None:
        """The trace of what happened; None if nothing moved. Waits until it has ended."""
        self.join()
        return None if self._result is None else self._result.trace


# Objects that a caller states, checked and put on the table of a cell.


def stated_table(
    cell: CellDescription, objects: Sequence[StatedObject], registry: Registry
) -> StatedTable:
    """The table of a cell, with nothing on it but what is stated.

    Raises:
        ControlError: `bad_table`, with the place in the document.
    """
    taken: dict[str, int] = {}
    for index, item in enumerate(objects):
        first = taken.setdefault(item.name.casefold(), index)
        if first != index:
            raise _bad_table(
                f"objects[{index}].name",
                f"'{item.name}' is the name of objects[{first}] too",
                "give each object a name of its own, as 'left mug', and its `model`",
            )
    seen = [_seen(index, item, cell, registry) for index, item in enumerate(objects)]
    for (i, one), (k, other) in combinations(enumerate(seen), 2):
        apart = gap(footprint(one), footprint(other))
        # An overlap of 5 mm is explained by a camera's errors.
        if apart < -0.005:
            raise _bad_table(
                f"objects[{k}]",
                f"it stands {-1e3 * apart:.0f} mm deep in objects[{i}], the {one.name}",
                "poses are those of the middles of their bases, in metres and radians",
                numbers={"overlap": -apart},
            )
    standing = tuple(
        CellObject(
            name=item.name,
            model=item.model or item.name,
            synonyms=item.synonyms,
            fragile=item.fragile,
            fixed=item.fixed,
        )
        for item in objects
    )
    poses = {item.name: item.pose for item in seen}
    return StatedTable(cell.model_copy(update={"objects": standing}), poses)


def _seen(index: int, item: StatedObject, cell: CellDescription, registry: Registry) -> SeenObject:
    """An object as it is stated, on the table."""
    try:
        model = registry.get(item.model or item.name)
    except ModelError as raised:
        key = "name" if item.model is None else "model"
        hints = (*raised.suggestions, "`nlcontrol objects list` tells the models")
        raise _bad_table(f"objects[{index}].{key}", raised.message, *hints) from raised
    seen = SeenObject(item.name, PlanarPose(item.x, item.y, item.yaw), model)
    table = cell.table.extent
    beyond = -room_to_edge(footprint(seen), table)
    if beyond > 0.0:
        raise _bad_table(
            f"objects[{index}]",
            f"the {item.name} stands {1e3 * beyond:.0f} mm beyond the edge of the table",
            f"x is from {table.x_min:g} to {table.x_max:g} m, y from {table.y_min:g} to "
            f"{table.y_max:g} m, in W",
            numbers={"beyond": beyond},
        )
    return seen


def _bad_table(
    path: str, message: str, *suggestions: str, numbers: dict[str, float] | None = None
) -> ControlError:
    return ControlError(
        ErrorInfo(
            code="bad_table",
            message=message,
            suggestions=suggestions,
            numbers=numbers or {},
            path=path,
        )
    )


class Session(PlanningSession):
    """A table, a robot and a conversation; see `nlcontrol.service.methods`.

    Args:
        scene: name of a built-in scene, path of a scene file, or a scene; or all that is asked for.
        registry: object models; the default ones if not given. Those of the cell come on top.
        executor: a robot of one's own, whose cell takes the scene's place.
        planner: how plans are found; `planner.plan` if not given.
        seed, defaults, objects, approval: as in a `SessionSpec`, if none is given.
        time_limit: wall-clock time for each plan and answer [s]; none if not given.
        clock: by which plans expire [s].

    Attributes:
        session_id: name of the session.
        spec: the request that opened the session.
        controller: the robot, and what is believed.
        conversation: what was said and done.

    Raises:
        ControlError: the scene cannot be read, or a default is none.
    """

    @checked_arguments
    def __init__(
        self,
        scene: SessionSpec | Scene | str | Path = "kitchen",
        *,
        registry: Registry | None = None,
        executor: Executor | None = None,
        planner: Planner | None = None,
        seed: int = 0,
        defaults: Mapping[str, float] | None = None,
        objects: Sequence[StatedObject] | None = None,
        approval: Literal["plan", "none"] = "none",
        time_limit: float | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._scene = scene if isinstance(scene, Scene) else None
        if isinstance(scene, Scene):
            scene = scene.name
        self.spec = session_spec(
            str(scene) if isinstance(scene, Path) else scene,
            seed,
            defaults,
            objects,
            approval,
        )
        self.session_id = f"session-{secrets.token_hex(8)}"
        self._registry, self._executor, self._planner = registry, executor, planner
        self._time_limit = time_limit
        self._own_turn = RLock()
        self._run: SessionRun | None = None
        self._asked: SessionRun | None = None
        self._plans = OfferedPlans(clock)
        self._open()

    def __repr__(self) -> str:
        return f"<Session {self.session_id} of {self.spec.scene}>"

    def _open(self) -> None:
        """Begins with the table as it was asked for."""
        self.controller = self._controller(self.spec.objects)
        self.conversation = Conversation(self.controller)
        self._plans.drop()

    def _controller(self, objects: Sequence[StatedObject] | None) -> Controller:
        """The controller of a table on which objects are stated, or of the robot's own."""
        executor = self._executor
        with known_errors_raised():
            if executor is None:
                executor = SimulatedExecutor.open(
                    self._scene or self.spec.scene, seed=self.spec.seed
                )
            defaults = with_settings(executor.cell.defaults, self.spec.defaults)
            if objects is not None:
                registry = Registry.default() if self._registry is None else self._registry.copy()
                for path in executor.cell.models:
                    registry.load(path)
                executor = stated_table(executor.cell, objects, registry)
        return Controller(
            executor=executor,
            registry=self._registry,
            planner=self._planner,
            defaults=defaults,
            time_limit=self._time_limit,
        )

    @property
    def has_robot(self) -> bool:
        """Plans can be carried out here; not on a table that is stated."""
        return self.spec.objects is None

    @checked_arguments
    def look(self, objects: Sequence[StatedObject] | None = None) -> TableView:
        """The table as the robot sees it now, or as it is stated; see `PlanningSession`."""
        with self._idle():
            if objects is not None:
                self._state(objects)
            state = self.controller.look()
            executor = self.controller.executor
            source: Source = "camera" if self.has_robot else "stated"
            return table_view(state, executor.cell, executor.time, source)

    def _state(self, objects: Sequence[StatedObject]) -> None:
        """Takes what stands on the table from the caller; the conversation goes on."""
        if self.has_robot:
            raise error(
                "bad_table",
                "this robot sees by itself where everything stands",
                suggestions=("look without objects, or open a session with `objects`",),
            )
        self.conversation.controller = self.controller = self._controller(objects)
        self.conversation.turn = self.controller.turn

    @checked_arguments
    def parse(self, said: str | Frames) -> Command:
        """The frames of a sentence, its references not yet resolved; see `PlanningSession`."""
        return self.controller.command(said)

    @checked_arguments
    def ask(self, said: str | Frames, *, motion: Motion = "never") -> Result:
        """The answer to a question; it moves nothing unless that is allowed.

        A sentence that is no question is planned and not executed.

        Raises:
            ControlError: `busy`; where motion is allowed, also what `say` raises.
        """
        if motion == "simulate" and is_question(self, said):
            self._asked = self.start(said, motion=motion)
            return ended_result(self._asked)
        with self._idle():
            return self.conversation.plan(said).result

    @checked_arguments
    def predict(
        self,
        name: str,
        *,
        face: str = "front",
        lateral: float = 0.0,
        height: float,
        direction: tuple[float, float, float] | None = None,
        force: float | None = None,
        friction: Literal["static", "kinetic"] = "static",
    ) -> PushPrediction:
        """The prediction of one push; see `PlanningSession`.

        Raises:
            ControlError: `unknown_object`, `unknown_face`, `bad_push`, `busy`.
        """
        seen = self._seen(name)
        yaw = seen.pose.yaw
        if direction is not None:
            x, y, z = (direction @ seen.pose.R_WB).tolist()
            direction = (x, y, z)
        return predict_push(
            seen.model,
            face,
            face_of(seen.model, face, yaw),
            lateral=lateral,
            height=height,
            direction=direction,
            force=force,
            friction=friction,
            yaw=yaw,
        )

    @checked_arguments
    def map(self, name: str, *, face: str = "front", spacing: float = 0.01) -> FaceMap:
        """Outcomes of pushes all over a face.

        Args:
            name: name of the object, as it lies and is turned on the table.
            face: name of the face, as the robot sees it.
            spacing: between contacts [m].

        Raises:
            ControlError: `unknown_object`, `unknown_face`, `bad_value`, `busy`.
        """
        seen = self._seen(name)
        side = face_of(seen.model, face, seen.pose.yaw)
        with known_errors_raised():
            chart = outcome_map(seen.model, side, spacing=spacing)
        return FaceMap.model_validate(map_document(chart, face))

    @checked_arguments
    def affordances(self, name: str) -> Affordances:
        """Outcomes that the robot can bring about with an object; see `PlanningSession`."""
        with self._idle(), self.controller.last_look.kept():
            found = self.controller.affordances(name)
        return Affordances.of(name, self.controller.cell.name, found)

    def _seen(self, name: str) -> SeenObject:
        """An object as it was seen last."""
        with self._idle(), self.controller.last_look.kept():
            return self.controller.locate(name)[0]

    @checked_arguments
    def plan(self, said: str | Frames) -> Offer:
        """A plan of a sentence, to be approved; nothing moves.

        Raises:
            ControlError: `busy`.
        """
        with self._idle(), self.controller.last_look.kept():
            era = self._plans.era
            proposal = self.conversation.plan(said)
            state = self.controller.look()
            plan_id = None
            if proposal.intention is not None and self.has_robot:
                plan_id = self._plans.offer(proposal, text_of(said), state, era)
            return Offer(
                plan_id=plan_id,
                expires_in=None if plan_id is None else LIFE,
                digest=belief_digest(state),
                result=proposal.result,
                drawing=offer_drawing(proposal.result),
            )

    @checked_arguments
    def start(
        self,
        said: str | Frames | Offer | None = None,
        *,
        plan_id: str | None = None,
        text: str | None = None,
        motion: Motion | None = None,
        on_event: Callable[[Event], object] | None = None,
    ) -> SessionRun:
        """Begins to do what a sentence says, or what was planned; see `PlanningSession.start`."""
        said, plan_id = start_arguments(said, plan_id)
        with self._idle():
            era = self._plans.era
            self._require_robot()
            if plan_id is not None:
                return self._start_plan(plan_id, text, on_event, era)
            assert said is not None, "either a sentence or a plan"
            return self._start_sentence(said, motion, on_event, era)

    def _start_plan(
        self,
        plan_id: str,
        text: str | None,
        on_event: Callable[[Event], object] | None,
        era: int,
    ) -> SessionRun:
        plan = self._plans.approved(plan_id, text)
        tolerances = Tolerances.of(self.controller.cell.vision)
        require_unchanged(plan.state, self.controller.look(), tolerances)
        self._plans.use(plan_id)

        def execute(tell: Callable[[Event], None], stop: StopToken) -> Result:
            return self.conversation.execute(plan.proposal, on_event=tell, stop=stop)

        planned, digest = plan.proposal.result.text, belief_digest(plan.state)
        return self._begin("execute", execute, planned, on_event, era, plan_id, digest)

    def _start_sentence(
        self,
        said: str | Frames,
        motion: Motion | None,
        on_event: Callable[[Event], object] | None,
        era: int,
    ) -> SessionRun:
        if self.spec.approval == "plan":
            raise error(
                "approval_required",
                "in this session only plans that were approved are carried out",
                suggestions=("plan it, and execute the `plan_id` of that offer",),
            )

        def say(tell: Callable[[Event], None], stop: StopToken) -> Result:
            return self.conversation.say(said, motion=motion, on_event=tell, stop=stop)

        return self._begin("say", say, text_of(said), on_event, era)

    def _begin(
        self,
        kind: RunKind,
        body: RunBody,
        text: str,
        on_event: Callable[[Event], object] | None,
        era: int,
        plan_id: str | None = None,
        digest: str | None = None,
    ) -> SessionRun:
        self._run = run = SessionRun(
            body,
            session_id=self.session_id,
            kind=kind,
            text=text,
            plan_id=plan_id,
            table=self.spec,
            on_event=on_event,
            request=lambda result: run_request(self.controller, result, digest),
        )
        if self._plans.era != era:  # it was stopped while it was being begun
            run.stop()
        return run

    def stop(self) -> None:
        """Asks what is being carried out to let go and come to rest; plans are dropped.

        It waits for nothing, and may be called from any thread: what is asked for meanwhile is
        asked for before this, so that a run that is just being begun is stopped as well.
        """
        self._plans.drop()
        if (run := self._run) is not None:
            run.stop()

    def give_up_answer(self) -> None:
        """Stops what moves for an answer that nobody waits for any more; waits for nothing."""
        if self._asked is not None:
            self._asked.stop()

    def reset(self) -> None:
        """Puts everything back as it was at the beginning; see `PlanningSession`."""
        with self._idle():
            if self._executor is not None:
                raise error(
                    "no_reset",
                    "what was done on this robot's table is not undone by itself",
                    suggestions=("put things back by hand, and open another session",),
                )
            self._open()

    def close(self) -> None:
        """Ends the session; what is being carried out is stopped first."""
        self.stop()
        if self._run is not None:
            self._run.join()

    @contextmanager
    def _idle(self) -> Iterator[None]:
        """Context in which no run begins; raises `busy` if one is under way."""
        with self._own_turn:
            if self._run is not None and not self._run.is_over:
                raise error(
                    "busy",
                    "something is being carried out in this session",
                    suggestions=("wait for the result of the run, or stop it",),
                )
            yield

    def _require_robot(self) -> None:
        if not self.has_robot:
            raise error(
                "no_robot",
                "this table was stated, so there is no robot that could move anything on it",
                suggestions=("open a session without stated objects, to have it simulated",),
            )

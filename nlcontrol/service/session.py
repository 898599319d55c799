"""A planning session in this process: look, plan, approve, do, verify.

    from nlcontrol import Session

    with Session("kitchen") as session:
        offer = session.plan("push the ice tea box away without toppling it")
        print(offer.result.text)
        result = session.execute(offer.plan_id).result()

A plan is carried out as it was approved, from a table that is as it was then: `execute` looks
again first. After the first plan the robot looks, learns and plans anew as in every sentence.
"""

from __future__ import annotations

import secrets
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from threading import RLock
from typing import TYPE_CHECKING, Literal

from nlcontrol.errors import error, known_errors_raised
from nlcontrol.service.beliefs import Tolerances, belief_digest, require_unchanged, table_view
from nlcontrol.service.bundles.run_request import run_request
from nlcontrol.service.documents import Affordances, FaceMap, Offer, SessionSpec, TableView
from nlcontrol.service.offer_drawing import offer_drawing
from nlcontrol.service.offered_plans import LIFE, OfferedPlans
from nlcontrol.service.session_protocol import PlanningSession, is_question
from nlcontrol.service.session_runs import SessionRun
from nlcontrol.service.stated_objects import stated_table
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.frame_documents import text_of
from objectmodels import Registry
from planner.types.defaults import with_settings
from sim.simulated_executor import SimulatedExecutor

if TYPE_CHECKING:
    from grammar.frames.command import Command
    from nlcontrol.questions.push_prediction import PushPrediction
    from nlcontrol.results.result import Result
    from nlcontrol.service.documents import RunKind, Source, StatedObject
    from nlcontrol.service.session_runs import Deed
    from nlcontrol.session.events import Event
    from nlcontrol.session.executor import Executor, Motion
    from nlcontrol.session.frame_documents import Frames
    from planner.types.world_state import SeenObject
    from sim.supervision import StopToken


class Session(PlanningSession):
    """A table, a robot and a conversation; see `nlcontrol.service.session_protocol`.

    Args:
        table: what is asked for, or the name of a scene, or the path of a scene file.
        registry: object models; the default ones if not given.
        executor: a robot of one's own, whose cell takes the scene's place.
        seed, defaults, objects, approval: as in a `SessionSpec`, if none is given.
        time_limit: of each plan and answer, by the clock on the wall [s]; none if not given.
        clock: by which plans expire [s].

    Attributes:
        session_id: of it.
        spec: as it was asked for.
        controller: the robot, and what is believed.
        conversation: what was said and done.

    Raises:
        ControlError: the scene cannot be read, or a default is none.
    """

    def __init__(
        self,
        table: SessionSpec | str | Path = "kitchen",
        *,
        registry: Registry | None = None,
        executor: Executor | None = None,
        seed: int = 0,
        defaults: Mapping[str, float] | None = None,
        objects: Sequence[StatedObject] | None = None,
        approval: Literal["plan", "none"] = "none",
        time_limit: float | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        if not isinstance(table, SessionSpec):
            table = SessionSpec(
                scene=str(table),
                seed=seed,
                defaults=dict(defaults or {}),
                objects=None if objects is None else tuple(objects),
                approval=approval,
            )
        self.session_id = f"session-{secrets.token_hex(8)}"
        self.spec = table
        self._registry, self._executor, self._time_limit = registry, executor, time_limit
        self._own_turn = RLock()
        self._run: SessionRun | None = None
        self._asked: SessionRun | None = None
        self._plans = OfferedPlans(clock)
        self._open()

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
                executor = SimulatedExecutor.open(self.spec.scene, seed=self.spec.seed)
            defaults = with_settings(executor.cell.defaults, self.spec.defaults)
            if objects is not None:
                registry = Registry.default() if self._registry is None else self._registry.copy()
                for path in executor.cell.models:
                    registry.load(path)
                executor = stated_table(executor.cell, objects, registry)
        return Controller(
            executor=executor,
            registry=self._registry,
            defaults=defaults,
            time_limit=self._time_limit,
        )

    @property
    def executes(self) -> bool:
        """Plans can be carried out here; not on a table that is stated."""
        return self.spec.objects is None

    # --- questions -----------------------------------------------------------------------------

    def look(self, objects: Sequence[StatedObject] | None = None) -> TableView:
        """The table as the robot sees it now, or as it is stated; see `PlanningSession`."""
        with self._idle():
            if objects is not None:
                self._state(objects)
            state = self.controller.look()
            executor = self.controller.executor
            source: Source = "camera" if self.executes else "stated"
            return table_view(state, executor.cell, executor.time, source)

    def _state(self, objects: Sequence[StatedObject]) -> None:
        """Takes what stands on the table from the caller; the conversation goes on."""
        if self.executes:
            raise error(
                "bad_table",
                "this robot sees by itself where everything stands",
                suggestions=("look without objects, or open a session with `objects`",),
            )
        self.conversation.controller = self.controller = self._controller(objects)
        self.conversation.turn = self.controller.turn

    def parse(self, said: str | Frames) -> Command:
        """The frames of a sentence, its references not yet resolved; see `PlanningSession`."""
        return self.controller.command(said)

    def ask(self, said: str | Frames, *, motion: Motion = "never") -> Result:
        """The answer to a question; it moves nothing unless that is allowed.

        A sentence that is no question is planned and not executed.

        Raises:
            ControlError: `busy`; where motion is allowed, also what `say` raises.
        """
        if motion == "simulate" and is_question(self, said):
            self._asked = self.say(said, motion=motion)
            return self._asked.result()
        with self._idle():
            return self.conversation.plan(said).result

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
        from nlcontrol.questions.push_prediction import predict_push
        from nlcontrol.references.object_names import face_of

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

    def map(self, name: str, *, face: str = "front", spacing: float = 0.01) -> FaceMap:
        """Outcomes of pushes all over a face.

        Args:
            name: of the object, as it lies and is turned on the table.
            face: as the robot calls it.
            spacing: between contacts [m].

        Raises:
            ControlError: `unknown_object`, `unknown_face`, `bad_value`, `busy`.
        """
        from nlcontrol.outcome_maps.outcome_map_table import map_document
        from nlcontrol.references.object_names import face_of
        from objectmodels.mechanics.outcome_map import outcome_map

        seen = self._seen(name)
        side = face_of(seen.model, face, seen.pose.yaw)
        with known_errors_raised():
            chart = outcome_map(seen.model, side, spacing=spacing)
        return FaceMap.model_validate(map_document(chart, face))

    def affordances(self, name: str) -> Affordances:
        """Outcomes that the robot can bring about with an object; see `PlanningSession`."""
        with self._idle(), self.controller.last_look.kept():
            found = self.controller.affordances(name)
        return Affordances.of(name, self.controller.cell.name, found)

    def _seen(self, name: str) -> SeenObject:
        """An object as it was seen last."""
        with self._idle(), self.controller.last_look.kept():
            return self.controller.surroundings(name)[0]

    # --- plan, approve, do ---------------------------------------------------------------------

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
            if proposal.intention is not None and self.executes:
                plan_id = self._plans.offer(proposal, text_of(said), state, era)
            return Offer(
                plan_id=plan_id,
                expires_in=None if plan_id is None else LIFE,
                digest=belief_digest(state),
                result=proposal.result,
                drawing=offer_drawing(proposal.result),
            )

    def execute(
        self,
        plan_id: str,
        *,
        text: str | None = None,
        on_event: Callable[[Event], object] | None = None,
    ) -> SessionRun:
        """Begins to carry out a sentence by the plan that was approved; see `PlanningSession`."""
        with self._idle():
            era = self._plans.era
            self._require_robot()
            plan = self._plans.approved(plan_id, text)
            tolerances = Tolerances.of(self.controller.cell.vision)
            require_unchanged(plan.state, self.controller.look(), tolerances)
            self._plans.use(plan_id)

            def execute(tell: Callable[[Event], None], stop: StopToken) -> Result:
                return self.conversation.execute(plan.proposal, on_event=tell, stop=stop)

            said, digest = plan.proposal.result.text, belief_digest(plan.state)
            return self._begin("execute", execute, said, on_event, era, plan_id, digest)

    def say(
        self,
        said: str | Frames,
        *,
        motion: Motion | None = None,
        on_event: Callable[[Event], object] | None = None,
    ) -> SessionRun:
        """Begins to do what a sentence says, planned and executed at one go.

        Raises:
            ControlError: `approval_required`, `busy`, `no_robot`.
        """
        with self._idle():
            era = self._plans.era
            self._require_robot()
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
        deed: Deed,
        text: str,
        on_event: Callable[[Event], object] | None,
        era: int,
        plan_id: str | None = None,
        digest: str | None = None,
    ) -> SessionRun:
        self._run = run = SessionRun(
            deed,
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

    # --- stop and begin anew -------------------------------------------------------------------

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
        if not self.executes:
            raise error(
                "no_robot",
                "this table was stated, so there is no robot that could move anything on it",
                suggestions=("open a session without stated objects, to have it simulated",),
            )

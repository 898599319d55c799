"""The way of a sentence: parse, resolve, plan, execute, check, each a call of its own.

The controller knows what the robot is told of its cell and what it believes: models, and poses as
the executor sees them. What is true in a simulated world stays behind the executor. Poses are in W.
"""

from __future__ import annotations

import math
from functools import cached_property
from pathlib import Path
from threading import RLock
from typing import TYPE_CHECKING

from grammar.frames.command import Command, Frame
from nlcontrol.errors import error, executor_failures_raised, known_errors_raised
from nlcontrol.references.object_names import names_on_table
from nlcontrol.references.reference_resolution import NOTHING_SAID, resolve_references
from nlcontrol.references.reference_search import Context
from nlcontrol.results.result import Result, result_with
from nlcontrol.session.executor import CancellableRobot, Executor, Planner
from nlcontrol.session.recipe import LOOKED, Journal, Recipe
from nlcontrol.session.turns import TakesTurns, in_turn
from objectmodels import ModelError, ObjectModel, Registry
from planner.types.plan import Plan, Reached
from planner.types.refusal import Refusal
from planner.types.world_state import Held, PlanarPose, SeenObject, TableState, WorldState
from sim.control.object_estimate import LastLook
from sim.robots.cell_description import LOOK, CellObject

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from grammar.parser import Parser
    from nlcontrol.checks.verdicts import Check
    from nlcontrol.questions.answer import Answer
    from nlcontrol.session.frame_documents import Frames
    from planner.affordances import Affordance
    from planner.types.defaults import Defaults
    from planner.types.robot import Failed, Robot
    from sim import Scene
    from sim.supervision import Progress, StopToken
    from sim.traces.trace import Trace


def _initial_model(item: CellObject, registry: Registry) -> ObjectModel:
    """The first belief about an object of a cell; raises `scene_and_registry_differ`."""
    try:
        return registry.get(item.model)
    except ModelError as raised:
        message = f"the scene's '{item.name}' is a '{item.model}', but {raised.message}"
        raise error(
            "scene_and_registry_differ", message, suggestions=raised.suggestions
        ) from raised


class Controller(TakesTurns):
    """A robot at a table, ready to be told what to do; threads that share it take turns.

    Args:
        scene: name of a built-in scene, path of a scene file, or a scene, to be simulated.
        registry: object models; the default ones if not given. Those of the cell come on top.
        executor: the robot; that of the simulated scene if not given. `scene` and `seed` do not
            count beside it.
        planner: how plans are found; `planner.plan` if not given.
        seed: seed of everything random; the same seed gives the same trace.
        defaults: what a clause means when a sentence does not say more; the scene's if not given.
        time_limit: wall-clock time for each plan and answer [s]; none if not given, so
            that results do not depend on the machine.

    Raises:
        ControlError: the scene cannot be read, or names a model that the registry lacks.
    """

    def __init__(
        self,
        scene: str | Path | Scene = "kitchen",
        *,
        registry: Registry | None = None,
        executor: Executor | None = None,
        planner: Planner | None = None,
        seed: int = 0,
        defaults: Defaults | None = None,
        time_limit: float | None = None,
    ) -> None:
        self.turn = RLock()
        with known_errors_raised():
            if executor is None:
                from sim.simulated_executor import SimulatedExecutor

                executor = SimulatedExecutor.open(scene, seed=seed)
            self.executor: Executor = executor
            self.cell = self.executor.cell
            self.registry = Registry.default() if registry is None else registry.copy()
            for path in self.cell.models:
                self.registry.load(path)
        self.models = {item.name: _initial_model(item, self.registry) for item in self.cell.objects}
        self.journal = Journal(self.executor, self.models)
        self.planner = planner
        self.seed = self.executor.seed
        self.defaults = self.cell.defaults if defaults is None else defaults
        self.time_limit = time_limit
        self.last_look = LastLook()

    @property
    def robot(self) -> Robot:
        """Arm and hand, as the planner asks for them."""
        return self.executor.robot

    @property
    def table(self) -> TableState:
        """Extent of the table top."""
        return self.cell.table.extent

    @in_turn
    def parse(self, text: str) -> Command:
        """The frames of a sentence.

        Raises:
            ControlError: it is not understood.
        """
        with known_errors_raised():
            return self.parser.parse(text)

    def command(self, said: str | Frames, before: Sequence[str] | None = None) -> Command:
        """The command of a sentence, or of frames; see `frame_documents.command_of`.

        Raises:
            ControlError: it is not understood.
        """
        from nlcontrol.session.frame_documents import command_of

        return command_of(said, self.parser, before)

    @cached_property
    def parser(self) -> Parser:
        """Reads sentences in which the objects of scene and registry may be named."""
        from grammar.parser import parser_for

        objects = (name for item in self.cell.objects for name in (item.name, *item.synonyms))
        models = (name for model in self.registry for name in (model.name, *model.synonyms))
        return parser_for({*objects, *models})

    @in_turn
    def resolve(self, command: Command, context: Context = NOTHING_SAID) -> Command:
        """The command with every object bound to one on the table, and lengths in metres.

        The object of a question may be bound to a model of the registry that is not on the table:
        `locate` says where it is taken to stand. The context is what "it" and "the other
        one" refer to.

        Raises:
            ControlError: `unknown_object`, `ambiguous_object`, `not_on_table` or `no_antecedent`.
        """
        here, known = names_on_table(self.cell.objects, self.models), tuple(self.registry)
        return resolve_references(command, here, known, self.look, context, self.defaults)

    @in_turn
    def look(self) -> WorldState:
        """The robot's belief now: poses from the camera port, models from the registry."""
        with executor_failures_raised(), self.journal.deed(LOOKED, self.models):
            return self.last_look.look(self.executor, self.models)

    @in_turn
    def recipe(self) -> Recipe:
        """All that it takes to build this controller elsewhere; raises `not_repeatable`."""
        return self.journal.recipe(self.registry, self.models, self.defaults)

    @property
    def held(self) -> Held | None:
        """The object in the hand, as the robot knows; None if it holds nothing."""
        return self.executor.held

    @in_turn
    def affordances(self, name: str) -> tuple[Affordance, ...]:
        """Outcomes that this robot can bring about with an object; for the others, why not.

        Args:
            name: an object of the scene, or a model of the registry; one that does not stand in the
                scene is taken as standing alone in the middle of the table.

        Raises:
            ControlError: `unknown_object`; `time_limit`.
        """
        from planner.affordances import affordances

        seen, state = self.locate(name)
        return affordances(seen, state, self._robot_until(None), defaults=self.defaults)

    @in_turn
    def locate(self, name: str) -> tuple[SeenObject, WorldState]:
        """An object and everything about it that is believed.

        Args:
            name: as in `affordances`.

        Raises:
            ControlError: `unknown_object`.
        """
        here = {item.casefold(): item for item in self.cell.names}.get(name.casefold())
        if here is None:
            with known_errors_raised():
                model = self.registry.find_one(name)
            here = next((n for n, m in self.models.items() if m == model), None)
            if here is None:
                alone = SeenObject(model.name, PlanarPose(*self.cell.table.centre_m), model)
                return alone, WorldState({alone.name: alone}, self.table)
        state = self.look()
        return state.objects[here], state

    @in_turn
    def answer(
        self, frame: Frame, state: WorldState | None = None, *, stop: StopToken | None = None
    ) -> Answer:
        """The answer to a resolved question, by what is believed now or then; nothing is moved.

        Raises:
            Stopped: that was asked for.
            ControlError: why it cannot be answered.
        """
        from nlcontrol.questions.question_answers import answer

        vision = self.cell.vision
        return answer(
            frame,
            self.believed_state(frame) if state is None else state,
            lambda: self._robot_until(stop),
            self.defaults,
            position_sd=vision.position_noise_m / math.sqrt(max(vision.rate_hz * LOOK, 1.0)),
        )

    def _robot_until(self, stop: StopToken | None) -> Robot:
        """The robot to ask; it raises what ends a search, once that was asked for."""
        if stop is None and self.time_limit is None:
            return self.robot
        return CancellableRobot(self.robot, stop, self.time_limit)

    def believed_state(self, frame: Frame) -> WorldState:
        """The belief about the object of a question, which may not be on the table."""
        name = frame.object.id if frame.object else None
        return self.look() if name is None else self.locate(name)[1]

    @in_turn
    def plan(
        self,
        frame: Frame,
        state: WorldState | None = None,
        *,
        previous: Plan | None = None,
        failed: Sequence[Failed] = (),
        notify: Callable[[str], None] = lambda _: None,
        stop: StopToken | None = None,
    ) -> Plan | Reached | Refusal:
        """A plan that satisfies a frame, by pushes or with a whole hand, or why there is none.

        Args:
            frame: what is asked, its objects resolved.
            state: what is believed; looked up now if not given.
            previous: the plan whose first push was made last; its aim is kept.
            failed: pushes and holds of this frame that went wrong; see `planner.plan`.
            notify: called with a sentence before a search that takes long.
            stop: asked at every question to the robot whether to go on.

        Raises:
            Stopped: that was asked for.
            ControlError: `uncheckable` if a clause could not be checked afterwards; `time_limit`.
        """
        from nlcontrol.checks.frame_checks import require_checkable
        from planner import plan

        state = self.look() if state is None else state
        made = (self.planner or plan)(
            frame,
            state,
            self._robot_until(stop),
            defaults=self.defaults,
            previous=previous,
            failed=failed,
            notify=notify,
        )
        if not isinstance(made, Refusal):
            require_checkable(frame)
        return made

    @in_turn
    def execute(self, plan: Plan, progress: Progress | None = None) -> Trace:
        """Carries out a plan; see `nlcontrol.session.executor.Executor.execute`."""
        self.last_look.forget()
        with executor_failures_raised():
            return self.executor.execute(plan, self.models, progress)

    @in_turn
    def watch(self, name: str) -> Trace:
        """A look during which nothing is done; see `nlcontrol.session.executor.Executor.watch`."""
        with executor_failures_raised():
            return self.executor.watch(name)

    def check(self, frame: Frame, trace: Trace) -> tuple[Check, ...]:
        """The robot's own verdict on each clause; see `nlcontrol.checks.own_verdicts`."""
        from nlcontrol.checks.own_accounts import Knowledge
        from nlcontrol.checks.own_verdicts import verdicts

        known = Knowledge(self.models, self.table, self.cell.vision, self.defaults)
        return verdicts(frame, trace, known)

    def empty_result(self, text: str, command: Command | None = None) -> Result:
        """The result of a sentence of which nothing has come yet."""
        result = Result(ok=False, status="failed", text=text, scene=self.cell.name, seed=self.seed)
        if command is None:
            return result
        return result_with(
            result,
            paraphrase=command.paraphrase,
            left_out=command.left_out,
            frames=command.frames,
        )

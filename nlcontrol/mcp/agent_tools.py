"""Tools of a language model at a planning session: look, ask, plan, and execute what was planned.

No tool takes joints, velocities, paths or files. `execute` alone moves anything, and only by the id
of a fresh plan; without leave to move it is not even there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from nlcontrol.errors import error
from nlcontrol.mcp import agent_documents as documents
from nlcontrol.mcp.foreign_text import ForeignNames
from nlcontrol.mcp.tool_answers import ToolAnswer, short_text

if TYPE_CHECKING:
    from nlcontrol.service.session_protocol import PlanningSession, Run

KEPT_RUNS = 20
"""Runs whose verdict can still be asked for."""

Sentence = Annotated[str, Field(min_length=1, max_length=1000)]
Name = Annotated[str, Field(min_length=1, max_length=100)]
Identifier = Annotated[str, Field(min_length=1, max_length=200)]
_Detail = Annotated[bool, Field(description="show the whole document, which may have 10 kB")]


class Arguments(BaseModel):
    """Arguments of a tool; none but these."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


class LookArguments(Arguments):
    """Arguments of `look`."""

    detail: _Detail = False


class AskArguments(Arguments):
    """Arguments of `ask`."""

    question: Sentence = Field(description="a question in English")
    detail: _Detail = False


class PredictArguments(Arguments):
    """Arguments of `predict`."""

    object: Name = Field(description="name of an object on the table")
    face: Name = Field("front", description="the face that is pushed: front looks at the robot")
    height_m: float = Field(description="of the contact above the table [m]", ge=0.0, le=10.0)
    lateral_m: float = Field(
        0.0, description="of the contact, to the right of the face's middle [m]", ge=-10.0, le=10.0
    )
    force_n: float | None = Field(
        None, description="of the push [N]; without it, when it begins to move", gt=0.0, le=1000.0
    )
    detail: _Detail = False


class AffordancesArguments(Arguments):
    """Arguments of `affordances`."""

    object: Name = Field(description="name of an object on the table")
    detail: _Detail = False


class PlanArguments(Arguments):
    """Arguments of `plan`."""

    sentence: Sentence = Field(description="what should be done, in English")
    detail: _Detail = False


class ExecuteArguments(Arguments):
    """Arguments of `execute`."""

    plan_id: Identifier = Field(description="of a plan that `plan` has given")
    detail: _Detail = False


class VerdictArguments(Arguments):
    """Arguments of `verdict`."""

    run_id: Identifier | None = Field(None, description="of a run; the last one if not given")
    detail: _Detail = False


class StopArguments(Arguments):
    """`stop` takes no arguments."""


class AgentTools:
    """The tools at one session, which threads may share.

    Args:
        session: at which they work.
        allow_motion: whether there is `execute`.
        known: names of objects besides those on the table, which messages may bear.

    Attributes:
        names: that others gave, as they stood on the table at the beginning.

    Raises:
        ControlError: the table cannot be seen.
    """

    def __init__(
        self, session: PlanningSession, *, allow_motion: bool = False, known: Iterable[str] = ()
    ) -> None:
        self.session = session
        self.allow_motion = allow_motion
        view = session.look()
        on_table = (name for item in view.objects for name in (item.name, item.model))
        self.names = ForeignNames((*on_table, *known))
        self._runs: dict[str, Run] = {}

    def look(self, asked: LookArguments) -> ToolAnswer:
        """The table as it is believed to be."""
        return documents.table_answer(self.session.look(), asked.detail)

    def ask(self, asked: AskArguments) -> ToolAnswer:
        """The answer to a question; nothing moves."""
        return documents.result_answer(
            self.session.ask(asked.question, motion="never"), asked.detail
        )

    def predict(self, asked: PredictArguments) -> ToolAnswer:
        """The prediction of one push; nothing moves."""
        prediction = self.session.predict(
            asked.object,
            face=asked.face,
            lateral=asked.lateral_m,
            height=asked.height_m,
            force=asked.force_n,
        )
        return documents.prediction_answer(prediction, asked.detail)

    def affordances(self, asked: AffordancesArguments) -> ToolAnswer:
        """Outcomes that the robot can bring about with an object."""
        return documents.affordances_answer(self.session.affordances(asked.object), asked.detail)

    def plan(self, asked: PlanArguments) -> ToolAnswer:
        """A plan to be approved, or why there is none; nothing moves."""
        return documents.offer_answer(self.session.plan(asked.sentence), asked.detail)

    def begin(self, asked: ExecuteArguments) -> Run:
        """Begins to carry out a plan; the run is kept for `verdict`.

        Raises:
            ControlError: `motion_not_allowed`, or as `PlanningSession.execute`.
        """
        if not self.allow_motion:
            raise error(
                "motion_not_allowed",
                "nothing may be moved here: plans can be made, and not executed",
                suggestions=(
                    "ask the person who runs this server to start it with --allow-motion",
                ),
            )
        run = self.session.execute(asked.plan_id)
        self._runs[run.run_id] = run
        for old in list(self._runs)[:-KEPT_RUNS]:
            del self._runs[old]
        return run

    def verdict(self, asked: VerdictArguments) -> ToolAnswer:
        """Each clause of what was executed, with what was asked and what was measured.

        Raises:
            ControlError: `unknown_run`.
        """
        name = asked.run_id or next(reversed(self._runs), None)
        run = self._runs.get(name or "")
        if run is None:
            known = f"runs: {', '.join(self._runs)}" if self._runs else "execute a plan first"
            what = "nothing was executed yet" if name is None else f"there is no run “{name}”"
            raise error("unknown_run", what, suggestions=(known,))
        return documents.run_answer(run.info(), asked.detail)

    def stop(self, _asked: StopArguments) -> ToolAnswer:
        """Lets go and comes to rest; plans are dropped."""
        self.session.stop()
        return ToolAnswer(
            ok=True,
            status="stopping",
            message="it lets go and comes to rest; plans are dropped",
        )


@dataclass(frozen=True)
class AgentTool:
    """A tool as it is listed.

    Attributes:
        name: of it.
        title: in a few words.
        description: when to use it and what it answers.
        arguments: model of what it takes.
        answer: what answers it; None for `execute`, which takes its time.
        moves: something may move.
    """

    name: str
    title: str
    description: str
    arguments: type[Arguments]
    answer: Callable[[AgentTools, Any], ToolAnswer] | None
    moves: bool = False

    def read_arguments(self, given: dict[str, Any]) -> Arguments:
        """Arguments that make sense.

        Raises:
            ControlError: `bad_arguments`, with those that there are.
        """
        try:
            return self.arguments.model_validate(given)
        except ValidationError as raised:
            first = raised.errors(include_url=False, include_input=False)[0]
            where = ".".join(map(str, first["loc"])) or "arguments"
            taken = ", ".join(self.arguments.model_fields) or "none"
            raise error(
                "bad_arguments",
                f"“{short_text(where, 60)}”: {short_text(first['msg'], 120).lower()}",
                suggestions=(f"`{self.name}` takes: {taken}",),
            ) from None


TOOLS: tuple[AgentTool, ...] = (
    AgentTool(
        "look",
        "See the table",
        "The objects on the table: names, places [m], headings [rad], sizes. Begin here: only "
        "objects that stand there can be spoken of.",
        LookArguments,
        AgentTools.look,
    ),
    AgentTool(
        "ask",
        "Ask a question",
        "Answers a question from what is known of the objects, with the figures behind it. Never "
        "moves anything.",
        AskArguments,
        AgentTools.ask,
    ),
    AgentTool(
        "predict",
        "Predict one push",
        "What one push on a face of an object would do: forces at which it slides and topples, "
        "with probabilities. Moves nothing.",
        PredictArguments,
        AgentTools.predict,
    ),
    AgentTool(
        "affordances",
        "What can be done with an object",
        "Outcomes that this robot can bring about with an object; for the others, why not.",
        AffordancesArguments,
        AgentTools.affordances,
    ),
    AgentTool(
        "plan",
        "Plan a sentence",
        "Plans what a sentence asks for, and moves nothing. Gives a plan_id and what is predicted, "
        "or the reason why not with the number that decided; `say` then holds whole sentences that "
        "would do instead.",
        PlanArguments,
        AgentTools.plan,
    ),
    AgentTool(
        "execute",
        "Carry out a plan",
        "Carries out the plan with this plan_id, once, after a look at the table, and waits for "
        "the verdicts. Refuses a plan that is old, used, or made for a table that looked "
        "otherwise: then plan again.",
        ExecuteArguments,
        None,
        moves=True,
    ),
    AgentTool(
        "verdict",
        "Read the verdicts",
        "Each clause of the last run, or of a named one: what was asked, what was measured, "
        "whether it held.",
        VerdictArguments,
        AgentTools.verdict,
    ),
    AgentTool(
        "stop",
        "Stop the robot",
        "Lets go and comes to rest, and drops all plans. Use it at any time.",
        StopArguments,
        AgentTools.stop,
    ),
)
"""The tools, in the order in which they are listed."""

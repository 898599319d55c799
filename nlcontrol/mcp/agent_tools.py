"""Tools of a language model at a planning session: look, ask, plan, and execute what was planned.

No tool takes joints, velocities, paths or files. `execute` alone moves anything, and only by the id
of a fresh plan; without leave to move it is not even there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, create_model

from nlcontrol.errors import error
from nlcontrol.json_document import docstring_parts
from nlcontrol.mcp.agent_documents import document_answer, run_answer
from nlcontrol.mcp.foreign_text import ForeignNames
from nlcontrol.mcp.tool_answers import ToolAnswer, short_text
from nlcontrol.service.methods import QUESTIONS, Question

if TYPE_CHECKING:
    from nlcontrol.service.session_protocol import PlanningSession, Run

KEPT_RUNS = 20
"""Runs whose verdict can still be asked for."""

Sentence = Annotated[str, Field(min_length=1, max_length=1000)]
Identifier = Annotated[str, Field(min_length=1, max_length=200)]

_Detail = Annotated[bool, Field(description="show the whole document, which may have 10 kB")]

_SENTENCES = ("text",)
"""Fields that hold a sentence: a tool takes no frames in its place."""

_NOT_FOR_TOOLS = ("frames", "explain", "objects")


class Arguments(BaseModel):
    """Arguments of a tool; none but these."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


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

    def answer_question(self, asked: Question, given: Any) -> ToolAnswer:
        """The answer to a question; nothing moves."""
        body = asked.asks.model_validate(_fields(asked, given))
        return document_answer(getattr(self.session, asked.name)(**body.arguments), given.detail)

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
        return run_answer(run.info(), asked.detail)

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


def _taken(question: Question) -> Mapping[str, str]:
    """What a tool takes: the names there of the fields of a body."""
    assert question.tool is not None, "it is offered"
    if question.tool.takes is not None:
        return question.tool.takes
    fields = question.asks.model_fields.items()
    return {told.alias or name: name for name, told in fields if name not in _NOT_FOR_TOOLS}


def _fields(question: Question, given: Arguments) -> dict[str, Any]:
    """The body of a question, as JSON, from the arguments of its tool."""
    names = {name: told.alias or name for name, told in question.asks.model_fields.items()}
    return {names[field]: getattr(given, name) for name, field in _taken(question).items()}


def _arguments_of(question: Question) -> type[Arguments]:
    """The model of what a tool takes."""
    told: dict[str, str] = {}
    for base in reversed(question.asks.__mro__):
        told |= docstring_parts(base.__dict__.get("__doc__") or "")[1]
    fields: dict[str, Any] = {}
    for name, field in _taken(question).items():
        of_body = question.asks.model_fields[field]
        is_sentence = field in _SENTENCES
        kind = Sentence if is_sentence else of_body.annotation
        taken = (kind, Field(description=told[field]), *of_body.metadata)
        fields[name] = (
            Annotated[taken],
            ... if is_sentence or of_body.is_required() else of_body.default,
        )
    fields["detail"] = (_Detail, False)
    made = create_model(
        f"{question.name.capitalize()}Arguments", __base__=Arguments, __module__=__name__, **fields
    )
    made.__doc__ = f"Arguments of `{question.name}`."
    return made


def _tool_of(question: Question) -> AgentTool:
    """The tool with which a question is asked."""
    assert question.tool is not None, "it is offered"
    return AgentTool(
        question.name,
        question.tool.title or question.name.capitalize(),
        question.tool.description or question.told,
        _arguments_of(question),
        lambda tools, given: tools.answer_question(question, given),
    )


TOOLS: tuple[AgentTool, ...] = (
    *(_tool_of(question) for question in QUESTIONS if question.tool is not None),
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

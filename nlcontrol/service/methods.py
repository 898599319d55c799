"""Questions of a planning session: what each is asked, what it answers; a method a question.

All that offers a question is made from its row: routes with and without a session, the document of
the service, its client, the tools of language models. Nothing moves by any of them. A further
question is a method here, and what answers it in `nlcontrol.service.session.Session`.
"""

from __future__ import annotations

import inspect
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, wraps
from types import MappingProxyType, TracebackType
from typing import TYPE_CHECKING, Annotated, Any, Literal, Protocol, Self, TypeVar, cast

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    SkipValidation,
    StrictBool,
    WithJsonSchema,
    create_model,
    model_validator,
)

from grammar.frames.command import Command, Frame
from nlcontrol.argument_types import checked_arguments
from nlcontrol.errors import ControlError, error
from nlcontrol.json_document import DocumentPart, plain_json
from nlcontrol.questions.push_prediction import PushPrediction
from nlcontrol.results.result import Result
from nlcontrol.service.documents import (
    Affordances,
    FaceMap,
    Number,
    NumberedEvent,
    Offer,
    RunInfo,
    StatedObject,
    StatedObjects,
    TableSpec,
    TableView,
    Understanding,
)
from nlcontrol.session.events import Event
from nlcontrol.session.executor import Motion
from nlcontrol.session.frame_documents import Frames

if TYPE_CHECKING:
    from sim.traces.trace import Trace


# The methods of `Questions` have no body of their own: their declaration gives them one.
# mypy: disable-error-code="empty-body"


ObjectName = Annotated[str, Field(min_length=1, max_length=100)]

M = TypeVar("M", bound=Callable[..., Any])


_FRAMES = {"anyOf": [{"type": "array", "items": {}}, {"type": "object"}, {"type": "null"}]}
_TEXT_OR_FRAMES: dict[str, Any] = {
    "if": {"required": ["text"], "properties": {"text": {"type": "string"}}},
    "then": {"properties": {"frames": {"type": "null"}}},
    "else": {"required": ["frames"], "properties": {"frames": {"type": ["array", "object"]}}},
}


class RequestBody(DocumentPart):
    """Body of a request; its checks are ready before the first one comes."""

    model_config = ConfigDict(defer_build=False)

    @property
    def arguments(self) -> dict[str, Any]:
        """Arguments of a session's method, as JSON has them."""
        return self.model_dump(mode="json", exclude={"table"})

    @classmethod
    def fields_of(cls, arguments: Mapping[str, Any]) -> dict[str, Any]:
        """The body of a request, as JSON, that asks for a method with these arguments."""
        names = {name: told.alias or name for name, told in cls.model_fields.items()}
        given = {names[name]: value for name, value in arguments.items() if name in names}
        return {name: plain_json(value) for name, value in given.items() if value is not None}


def body_example(body: type[BaseModel]) -> dict[str, Any]:
    """Example of a body, made from those of its fields; of those that have none, nothing."""
    found: dict[str, Any] = {}
    for name, described in body.model_fields.items():
        if described.examples:
            found[described.alias or name] = described.examples[0]
        elif isinstance(described.annotation, type) and issubclass(described.annotation, BaseModel):
            found[name] = body_example(described.annotation)
    return found


class SaidBody(RequestBody):
    """A sentence, or frames in its place.

    Attributes:
        text: an English sentence.
        frames: a list of `Frame`, or a command that bears such `frames`; docs/frames.md.
    """

    model_config = ConfigDict(json_schema_extra=_TEXT_OR_FRAMES)

    text: str | None = Field(default=None, min_length=1, examples=["push the ice tea box away"])
    # Frames are checked by the rules that the parser keeps, which say more than a schema: what is
    # wrong with them is an answer (`bad_frame`), and any list or object is taken.
    frames: Annotated[
        tuple[Frame, ...] | Command | None, SkipValidation, WithJsonSchema(_FRAMES)
    ] = None

    @model_validator(mode="after")
    def _require_one(self) -> Self:
        if (self.text is None) == (self.frames is None):
            raise ValueError("either text or frames")
        if not isinstance(self.frames, list | dict | None):
            raise ValueError("frames as a list or an object")
        return self

    @property
    def arguments(self) -> dict[str, Any]:
        """Arguments of a session's method, as JSON has them."""
        return {"said": self.frames if self.text is None else self.text}

    @classmethod
    def fields_of(cls, arguments: Mapping[str, Any]) -> dict[str, Any]:
        """The body of a request, as JSON, that asks for a method with these arguments."""
        said = arguments["said"]
        kind = "text" if isinstance(said, str) else "frames"
        return {**super().fields_of(arguments), kind: plain_json(said)}


class ExplainedBody(SaidBody):
    """A sentence to be planned, or frames in its place.

    Attributes:
        explain: a result says which words became which parameters.
    """

    explain: StrictBool = False

    @property
    def arguments(self) -> dict[str, Any]:
        """Arguments of a session's method, as JSON has them."""
        return {**super().arguments, **({"explain": True} if self.explain else {})}


class LookBody(RequestBody):
    """A look at the table.

    Attributes:
        objects: all that stands on a table that is stated, where it stands now; as before if not
            given.
    """

    objects: StatedObjects | None = None


class ObjectBody(RequestBody):
    """An object.

    Attributes:
        name: the object's name on the table, or that of a model of the registry.
    """

    name: ObjectName = Field(alias="object", examples=["ice tea box"])


class PredictBody(ObjectBody):
    """A push to be predicted.

    Attributes:
        face: the face that is pushed, as the robot calls it: front looks at the robot.
        lateral: place of the contact, to the right of the face's middle as one looks at it [m].
        height: height of the contact above the table [m].
        direction: direction of the force in W; straight into the face if not given.
        force: size of the force [N]; the outcome at the onset of motion is told if not given.
        friction: the coefficient at the table that counts.
    """

    face: ObjectName = "front"
    lateral: Number = 0.0
    height: Number = Field(examples=[0.05])
    direction: tuple[Number, Number, Number] | None = None
    force: Number | None = None
    friction: Literal["static", "kinetic"] = "static"


class MapBody(ObjectBody):
    """A face to be mapped.

    Attributes:
        face: name of the face, as the robot calls it.
        spacing: distance between contacts [m].
    """

    face: ObjectName = "front"
    spacing: Number = Field(default=0.01, gt=0.0, le=1.0)


class TableBody(RequestBody):
    """A table to think about, without a session.

    Attributes:
        table: table of a scene, or one that the caller states; the kitchen's if not given.
    """

    table: TableSpec = TableSpec()


@cache
def at_table(asks: type[RequestBody]) -> type[RequestBody]:
    """The body of a request without a session: the same, and the table that it is about."""
    made = create_model(f"Table{asks.__name__}", __base__=(asks, TableBody), __module__=__name__)
    made.__doc__ = f"{inspect.getdoc(asks)}".partition("\n")[0]
    return cast("type[RequestBody]", made)


@dataclass(frozen=True)
class Tool:
    """A question as language models are offered it.

    Attributes:
        title: title in a few words; its name if not given.
        description: when to use it and what it answers; what it does, if not given.
        takes: fields of the body by what they are called there; all if not given.
    """

    title: str = ""
    description: str = ""
    takes: Mapping[str, str] | None = None


@dataclass(frozen=True)
class Question:
    """A question of a session.

    Attributes:
        name: name of the session's method and of the operation.
        asks: body of a request to a session; it may be left out if nothing in it has to be said.
        answers: kind of the document that answers it.
        told: description in the document of the service.
        path: path of the session's route.
        alone: body of a request without a session; None if it takes one.
        told_alone: description of the request without a session.
        reads: makes what the method returns from the document.
        example: fields of a body in which its example is another than that of the fields.
        tool: tool for language models; None if they have no use for it.
    """

    name: str
    asks: type[RequestBody]
    answers: type[BaseModel]
    told: str
    path: str
    alone: type[RequestBody] | None
    told_alone: str
    reads: Callable[[Any], Any]
    example: Mapping[str, Any]
    tool: Tool | None


def question(
    asks: type[RequestBody],
    answers: type[BaseModel],
    *,
    path: str = "",
    alone: type[RequestBody] | None = None,
    told_alone: str = "",
    reads: Callable[[Any], Any] = lambda document: document,
    example: Mapping[str, Any] = MappingProxyType({}),
    tool: Tool | None = Tool(),
) -> Callable[[M], M]:
    """Declares a method of `Questions` as a question; see the attributes of `Question`.

    The method then asks whatever `answer_question` asks; its docstring tells what it does.
    """

    def declare(method: M) -> M:
        name, told = method.__name__, inspect.getdoc(method) or ""
        told = " ".join(told.partition("\n\n")[0].split())
        path_of, alone_told = path or name, told_alone or told
        row = Question(name, asks, answers, told, path_of, alone, alone_told, reads, example, tool)
        signature = inspect.signature(method)

        @checked_arguments
        @wraps(method)
        def ask(self: Questions, *args: Any, **kwargs: Any) -> Any:
            arguments = signature.bind(self, *args, **kwargs).arguments
            return reads(self.answer_question(row, asks.fields_of(arguments)))

        ask.question = row  # type: ignore[attr-defined]
        return ask  # type: ignore[return-value]

    return declare


class Questions:
    """The questions of a session.

    A sentence may be frames instead (docs/frames.md). What is not understood or refused is a result
    and raises nothing; a `ControlError` says that the call itself made no sense.
    """

    def answer_question(self, asked: Question, fields: Mapping[str, Any]) -> BaseModel:
        """The document that answers a question, wherever that is.

        Args:
            asked: the question.
            fields: fields of its body, as JSON.
        """
        raise NotImplementedError

    @question(
        LookBody,
        TableView,
        tool=Tool(
            "See the table",
            "The objects on the table: names, places [m], headings [rad], sizes. Begin here: only "
            "objects that stand there can be spoken of.",
            takes={},
        ),
    )
    def look(self, objects: Sequence[StatedObject] | None = None) -> TableView:
        """Looks at the table, or takes where everything stands from the caller.

        Args:
            objects: all that stands on a table that is stated, where it stands now; as before if
                not given.

        Raises:
            ControlError: `bad_table`: the objects make no sense, or the robot has a camera; `busy`.
        """

    @question(
        SaidBody,
        Understanding,
        alone=at_table(ExplainedBody),
        reads=Understanding.command,
        tool=None,
    )
    def parse(self, said: str | Frames) -> Command:
        """Reads a sentence: its frames, or why it is not understood.

        References are not yet resolved.

        Raises:
            ControlError: it is not understood.
        """

    @question(
        ExplainedBody,
        Result,
        alone=at_table(ExplainedBody),
        told_alone="Answers a question; a sentence that is none is planned.",
        example={"text": "how heavy is the mug?"},
        tool=Tool(
            "Ask a question",
            "Answers a question from what is known of the objects, with the figures behind it. "
            "Never moves anything.",
            takes={"question": "text"},
        ),
    )
    def ask(self, said: str | Frames, *, motion: Motion = "never") -> Result:
        """Answers a question from what is believed; nothing moves.

        A sentence that is no question is planned and not executed.

        Args:
            said: a sentence, or frames.
            motion: `simulate` lets the question be tried out; that is a run.
        """

    @question(
        PredictBody,
        PushPrediction,
        alone=at_table(PredictBody),
        tool=Tool(
            "Predict one push",
            "What one push on a face of an object would do: forces at which it slides and topples, "
            "with probabilities. Moves nothing.",
            takes={
                "object": "name",
                "face": "face",
                "height_m": "height",
                "lateral_m": "lateral",
                "force_n": "force",
            },
        ),
    )
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
        """Predicts a push at a place of a face.

        See `nlcontrol.questions.push_prediction.predict_push`.

        Raises:
            ControlError: `unknown_object`, `unknown_face`, `bad_push`.
        """

    @question(MapBody, FaceMap, alone=at_table(MapBody), tool=None)
    def map(self, name: str, *, face: str = "front", spacing: float = 0.01) -> FaceMap:
        """Predicts pushes all over a face.

        Args:
            name: name of the object, which is taken as it lies and is turned on the table.
            face: name of the face, as the robot calls it.
            spacing: distance between contacts [m].

        Raises:
            ControlError: `unknown_object`, `unknown_face`, `bad_value`.
        """

    @question(
        ObjectBody,
        Affordances,
        alone=at_table(ObjectBody),
        tool=Tool(
            "What can be done with an object",
            "Outcomes that this robot can bring about with an object; for the others, why not.",
        ),
    )
    def affordances(self, name: str) -> Affordances:
        """Lists what the robot can bring about with an object, and for the rest, why not.

        Raises:
            ControlError: `unknown_object`.
        """

    @question(
        ExplainedBody,
        Offer,
        path="plans",
        alone=at_table(ExplainedBody),
        told_alone="Plans a sentence; the offer bears no plan id, since nothing of it can be "
        "executed.",
        tool=Tool(
            "Plan a sentence",
            "Plans what a sentence asks for, and moves nothing. Gives a plan_id and what is "
            "predicted, or the reason why not with the number that decided; `say` then holds whole "
            "sentences that would do instead.",
            takes={"sentence": "text"},
        ),
    )
    def plan(self, said: str | Frames) -> Offer:
        """Plans a sentence; the offer bears the plan id with which it is executed."""


QUESTIONS: tuple[Question, ...] = tuple(
    method.question for method in vars(Questions).values() if hasattr(method, "question")
)
"""All of them, in their order."""


# A planning session and its runs, in this process or over a wire.
#
# `nlcontrol.service.session.Session` is one in this process, and
# `nlcontrol.service.remote_session.Client` opens one at a server. A program that uses one
# can use the other.


class Run(Protocol):
    """Something that is carried out."""

    @property
    def run_id(self) -> str:
        """Name of the run."""

    def info(self) -> RunInfo:
        """The run as it is now."""

    def events(self, after: int = 0) -> Iterator[NumberedEvent]:
        """Its events as they happen, until it has ended.

        Args:
            after: number of the last event that is known already.
        """

    def result(self, timeout: float | None = None) -> Result:
        """The result; waits until it has ended.

        Args:
            timeout: longest time to wait, by the clock on the wall [s]; None for no limit.

        Raises:
            TimeoutError: it goes on.
            ControlError: it has no result; the code says why.
        """

    def stop(self) -> None:
        """Asks it to let go and come to rest; its result is then `cancelled`."""

    def trace(self) -> Trace | None:
        """The trace of what happened; None if nothing moved. Waits until it has ended."""


class Closed(ABC):
    """Something that is closed at the end of a `with` block."""

    @abstractmethod
    def close(self) -> None:
        """Ends it."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        raised: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()


class PlanningSession(Questions, Closed):
    """A table, a robot and a conversation: look, plan, approve, do, verify.

    Attributes:
        session_id: name of the session.
    """

    session_id: str

    @property
    @abstractmethod
    def has_robot(self) -> bool:
        """Plans can be carried out here; not on a table that was stated."""

    @abstractmethod
    def start(
        self,
        said: str | Frames | Offer | None = None,
        *,
        plan_id: str | None = None,
        text: str | None = None,
        motion: Motion | None = None,
        on_event: Callable[[Event], object] | None = None,
    ) -> Run:
        """Begins to do what a sentence says, or what was planned, and returns at once.

        Before it carries out a plan the robot looks again. A plan is carried out once, and expires.

        Args:
            said: a sentence, frames, or what `plan` offered.
            plan_id: name of an offered plan, in its place.
            text: under which the plan was approved, such as the sentence that a person saw beside
                it; not compared if not given.
            motion: `simulate` also lets a question move something, `never` nothing at all.
            on_event: told of every event, in a thread of the run. If it fails, the run comes to
                rest, and `Run.result` raises what it raised.

        Raises:
            ControlError: `busy`, `no_robot` (the table was stated); for a sentence
                `approval_required` if plans are to be approved first; for a plan `unknown_plan`,
                `used_plan`, `expired_plan`, `stale_plan` (something moved, or is believed in
                another way), `other_sentence` (the text is not the one that was planned);
                `bad_arguments`.
        """

    @checked_arguments
    def say(
        self,
        said: str | Frames,
        *,
        motion: Motion | None = None,
        on_event: Callable[[Event], object] | None = None,
    ) -> Result:
        """Does what a sentence says, planned and executed at one go, and tells what came of it.

        It may be a remark on what was said and done before: "again", "no, the other one", "undo
        that". What is not understood or refused is a result too. If the wait is interrupted, the
        run is stopped.

        Args:
            said: a sentence, or frames.
            motion: permission as for `start`.
            on_event: callback as for `start`.

        Raises:
            ControlError: as for `start`.
            Exception: what the callback has raised, once the robot is at rest.
        """
        return ended_result(self.start(said, motion=motion, on_event=on_event))

    @checked_arguments
    def execute(
        self,
        plan: Offer | str,
        *,
        text: str | None = None,
        on_event: Callable[[Event], object] | None = None,
    ) -> Result:
        """Carries out what was planned, as `start` does, and tells what came of it.

        Args:
            plan: what `plan` offered, or its plan id.
            text: approved text as for `start`.
            on_event: callback as for `start`.

        Raises:
            ControlError: as for `start`; what was offered without a plan is `unknown_plan`.
            Exception: what the callback has raised, once the robot is at rest.
        """
        return ended_result(self.start(plan_id=plan_id_of(plan), text=text, on_event=on_event))

    @abstractmethod
    def stop(self) -> None:
        """Asks what is being carried out to let go and come to rest; plans are dropped."""

    @abstractmethod
    def reset(self) -> None:
        """Puts everything back as it was at the beginning: table, beliefs, conversation, plans.

        Raises:
            ControlError: `busy`, `no_reset` (a real robot's table).
        """

    @abstractmethod
    def close(self) -> None:
        """Ends the session; what is being carried out is stopped first."""


def ended_result(run: Run) -> Result:
    """The result of a run; if the wait for it is interrupted, the run is stopped and awaited."""
    try:
        return run.result()
    except KeyboardInterrupt:
        run.stop()
        run.result()
        raise


def start_arguments(
    said: str | Frames | Offer | None, plan_id: str | None
) -> tuple[str | Frames | None, str | None]:
    """A sentence, or a plan id in its place; raises `bad_arguments` unless it is one of both."""
    given = plan_id_of(said) if isinstance(said, Offer) else said
    if (given is None) == (plan_id is None):
        raise error(
            "bad_arguments",
            "what begins is either a sentence or a plan",
            suggestions=("start(sentence), start(offer), or start(plan_id=…)",),
        )
    return (None, plan_id_of(said)) if isinstance(said, Offer) else (said, plan_id)


def plan_id_of(plan: Offer | str) -> str:
    """The plan id of an offer; raises `unknown_plan` where the offer bears none."""
    if isinstance(plan, str):
        return plan
    if plan.plan_id is None:
        raise error(
            "unknown_plan",
            f"nothing was planned that could be carried out: {plan.result.status}",
            suggestions=("`result` says why", "plan another sentence"),
        )
    return plan.plan_id


def is_question(session: PlanningSession, said: str | Frames) -> bool:
    """Return True if all that is said asks, and nothing commands."""
    try:
        return asks_only(session.parse(said))
    except ControlError:
        return False


def asks_only(command: Command) -> bool:
    """Return True if all frames of a command are questions."""
    return all(frame.query is not None for frame in command.frames)

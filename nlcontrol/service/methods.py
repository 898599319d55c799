"""Questions of a planning session: what each is asked, what it answers; a row a question.

Routes with and without a session, what a worker answers, and the document of the service are made
from the rows. Nothing moves by any of them. A further question is a row here and a method of
`nlcontrol.service.session.Session`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, SkipValidation, model_validator

from grammar.frames.command import Command, Frame
from nlcontrol.json_document import DocumentPart
from nlcontrol.questions.push_prediction import PushPrediction
from nlcontrol.results.result import Result
from nlcontrol.service.documents import (
    Affordances,
    FaceMap,
    Offer,
    StatedObjects,
    TableSpec,
    TableView,
    Understanding,
)

ObjectName = Annotated[str, Field(min_length=1, max_length=100)]


class RequestBody(DocumentPart):
    """Body of a request; its checks are ready before the first one comes."""

    model_config = ConfigDict(defer_build=False)

    @property
    def arguments(self) -> dict[str, Any]:
        """Arguments of a session's method, as JSON has them."""
        return self.model_dump(mode="json", exclude={"table"})


class SaidBody(RequestBody):
    """A sentence, or frames in its place.

    Attributes:
        text: an English sentence.
        frames: a list of frames, or a command that bears them; docs/frames.md.
    """

    text: str | None = Field(default=None, min_length=1, examples=["push the ice tea box away"])
    # Frames are checked by the rules that the parser keeps, which say more than a schema.
    frames: Annotated[tuple[Frame, ...] | Command | None, SkipValidation] = None

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


class ExplainedBody(SaidBody):
    """A sentence to be planned, or frames in its place.

    Attributes:
        explain: a result says which words became which parameters.
    """

    explain: bool = False

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
        object: its name on the table, or that of a model of the registry.
    """

    object: ObjectName = Field(examples=["ice tea box"])

    @property
    def arguments(self) -> dict[str, Any]:
        """Arguments of a session's method, as JSON has them."""
        rest = self.model_dump(mode="json", exclude={"object", "table"})
        return {"name": self.object, **rest}


class PredictBody(ObjectBody):
    """A push to be predicted.

    Attributes:
        face: that is touched, as the robot calls it.
        lateral: along the face from its middle, to the right of who looks at it [m].
        height: above the table [m].
        direction: of the force in W; straight into the face if not given.
        force: its size [N]; the class at the onset is told if not given.
        friction: which coefficient at the table counts.
    """

    face: ObjectName = "front"
    lateral: float = 0.0
    height: float = Field(examples=[0.05])
    direction: tuple[float, float, float] | None = None
    force: float | None = None
    friction: Literal["static", "kinetic"] = "static"


class MapBody(ObjectBody):
    """A face to be mapped.

    Attributes:
        face: as the robot calls it.
        spacing: between contacts [m].
    """

    face: ObjectName = "front"
    spacing: float = Field(default=0.01, gt=0.0, le=1.0)


class TableBody(RequestBody):
    """A table to think about, without a session.

    Attributes:
        table: that of a scene, or one that the caller states; the kitchen's if not given.
    """

    table: TableSpec = TableSpec()


class TableSaidBody(ExplainedBody, TableBody):
    """A sentence or frames, and the table that it is about."""


class TableObjectBody(ObjectBody, TableBody):
    """An object, and the table on which it stands."""


class TablePredictBody(PredictBody, TableBody):
    """A push to be predicted, and the table on which it is made."""


class TableMapBody(MapBody, TableBody):
    """A face to be mapped, and the table on which its object stands."""


@dataclass(frozen=True)
class Question:
    """A question of a session.

    Attributes:
        name: of the method of a session, and of the operation.
        asks: body of a request to a session; it may be left out if nothing in it has to be said.
        answers: kind of the document.
        told: what it does, in the document of the service.
        path: of the route of a session; the name if not given.
        asks_alone: body of a request without a session; None if it takes one.
        told_alone: what it does then; the same if not given.
    """

    name: str
    asks: type[RequestBody]
    answers: type[BaseModel]
    told: str
    path: str = ""
    asks_alone: type[RequestBody] | None = None
    told_alone: str = ""


QUESTIONS: tuple[Question, ...] = (
    Question(
        "look", LookBody, TableView,
        "Looks at the table, or takes where everything stands from the caller.",
    ),
    Question(
        "parse", SaidBody, Understanding,
        "Reads a sentence: its frames, or why it is not understood.",
        asks_alone=TableSaidBody,
    ),
    Question(
        "ask", ExplainedBody, Result,
        "Answers a question from what is believed; nothing moves.",
        asks_alone=TableSaidBody,
        told_alone="Answers a question; a sentence that is none is planned.",
    ),
    Question(
        "predict", PredictBody, PushPrediction,
        "Predicts a push at a place of a face.",
        asks_alone=TablePredictBody,
    ),
    Question(
        "map", MapBody, FaceMap,
        "Predicts pushes all over a face.",
        asks_alone=TableMapBody,
    ),
    Question(
        "affordances", ObjectBody, Affordances,
        "Lists what the robot can bring about with an object, and for the rest, why not.",
        asks_alone=TableObjectBody,
    ),
    Question(
        "plan", ExplainedBody, Offer,
        "Plans a sentence; the offer bears the plan id with which it is executed.",
        path="plans",
        asks_alone=TableSaidBody,
        told_alone="Plans a sentence; the offer bears no plan id, since nothing of it can be "
        "executed.",
    ),
)  # fmt: skip
"""All of them."""

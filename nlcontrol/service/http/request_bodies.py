"""Bodies of requests, and what stands in paths and headers; nothing unknown, nothing unbounded."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from fastapi import Header, Path, Query
from pydantic import ConfigDict, Field, SkipValidation, model_validator

from grammar.frames.command import Command, Frame
from nlcontrol.json_document import DocumentPart
from nlcontrol.service.documents import SessionSpec, StatedObjects, TableSpec
from nlcontrol.session.executor import Motion

_NAME = r"^[A-Za-z0-9_-]{1,64}$"

SessionId = Annotated[str, Path(pattern=_NAME, description="Of a session.")]
RunId = Annotated[str, Path(pattern=_NAME, description="Of a run.")]
IdempotencyKey = Annotated[
    str | None,
    Header(
        alias="Idempotency-Key",
        pattern=r"^[\x21-\x7e]{1,200}$",
        description="Chosen by the caller: the same request with the same key begins nothing anew.",
    ),
]
AfterNumber = Annotated[
    int, Query(ge=0, le=2**53, description="Number of the last event that is known already.")
]
IdleTime = Annotated[
    float | None,
    Query(
        gt=0.0,
        le=60.0,
        description="Closes it only once nobody has used it for so long [s], and not if somebody"
        " takes it up again meanwhile, or a run is under way.",
    ),
]
ObjectPath = Annotated[
    str, Path(max_length=100, description="Name or synonym of an object model of the host.")
]
ObjectName = Annotated[str, Field(min_length=1, max_length=100)]


class RequestBody(DocumentPart):
    """Body of a request; its checks are ready before the first one comes."""

    model_config = ConfigDict(defer_build=False)


class SessionBody(SessionSpec, RequestBody):
    """A session to be opened."""


class LoginBody(RequestBody):
    """A login.

    Attributes:
        secret: the token of the service, or the code of the link that it has printed.
    """

    secret: str = Field(min_length=1, max_length=1000)


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


class SayBody(SaidBody):
    """A sentence to be carried out, or frames in its place.

    Attributes:
        motion: `simulate` also lets a question move something, `never` nothing at all.
    """

    motion: Motion | None = None

    @property
    def arguments(self) -> dict[str, Any]:
        """Arguments of a session's method, as JSON has them."""
        return {**super().arguments, "motion": self.motion}


class LookBody(RequestBody):
    """A look at the table.

    Attributes:
        objects: all that stands on a table that is stated, where it stands now; as before if not
            given.
    """

    objects: StatedObjects | None = None

    @property
    def arguments(self) -> dict[str, Any]:
        """Arguments of a session's method, as JSON has them."""
        return self.model_dump(mode="json")


class PlanIdBody(RequestBody):
    """A plan to be executed.

    Attributes:
        plan_id: of an offer.
        text: that was shown to whoever approved the plan; it is refused (`other_sentence`) unless
            it is the text that was planned. Not compared if not given.
    """

    plan_id: str = Field(pattern=_NAME)
    text: str | None = None


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

"""Rows of a batch, and their results.

Result of a row, one line of a file of results.
"""

from __future__ import annotations

from typing import Any, Literal

from pydantic import ConfigDict, Field, model_validator

from nlcontrol.errors import ErrorInfo
from nlcontrol.json_document import Document, DocumentPart
from nlcontrol.results.result import Result, ResultStatus

# Row of a batch: what is said, where, and from which seed.


SceneKind = Literal["table", "alone"]


class DrawnScene(DocumentPart):
    """Recipe of a scene whose objects, their places and their true parameters are drawn.

    Attributes:
        draw: `table` for one to six objects, `alone` for one.
        seed: of the scene; equal recipes draw equal scenes.
        object: name of a built-in model that stands within reach; drawn too if null.
    """

    draw: SceneKind
    seed: int = Field(ge=0)
    object: str | None = None


class BatchRow(DocumentPart):
    """Row of a batch, of a sentence or of frames.

    Attributes:
        text: the sentence.
        frames: in place of it, as in docs/frames.md.
        scene: a built-in one by its name, the path of a scene file, or a recipe.
        seed: of everything random but the scene's own.
        execute: whether the plan is carried out.
        settings: defaults that are set, as with `--set`.
        id: the caller's own name of the row, given back with its result.
    """

    text: str | None = None
    frames: list[Any] | dict[str, Any] | None = None
    scene: str | DrawnScene = "kitchen"
    seed: int = Field(default=0, ge=0)
    execute: bool = True
    settings: dict[str, float] = Field(default_factory=dict)
    id: str | int | None = None

    @model_validator(mode="after")
    def _require_one_task(self) -> BatchRow:
        if (self.text is None) == (self.frames is None):
            raise ValueError("a row has either text or frames")
        return self

    @property
    def said(self) -> str | list[Any] | dict[str, Any]:
        """The sentence, or the frames."""
        return self.frames if self.text is None else self.text  # type: ignore[return-value]


RowStatus = ResultStatus | Literal["bad_row", "lost", "crashed"]


class RowOutcome(Document):
    """Outcome of a row in a few fields.

    Attributes:
        ok: as in the row's result; false if it has none.
        line: its place among the rows, from 1; in a file its line.
        id: as in the row.
        key: of all that determines the result: row, contents of its scene, models, versions.
        status: as in `Result`; `bad_row` if it is no row, `lost` if it ended two workers, `crashed`
            if a defect ended it.
        error: why it is not ok.
        not_held: clauses that did not hold.
        unknown: clauses that can be neither confirmed nor denied.
        differs: clauses of which an observer of the simulation has another verdict than the robot.
        seconds: time that it took in its worker, by the clock on the wall [s].
        simulated: time of its executions [s].
        digest: of result and trace; equal if and only if they are equal to the digit. Null if there
            is no result.
    """

    model_config = ConfigDict(defer_build=True, frozen=True, extra="ignore", allow_inf_nan=False)

    ok: bool
    line: int
    id: str | int | None = None
    key: str
    status: RowStatus
    error: ErrorInfo | None = None
    not_held: tuple[str, ...] = ()
    unknown: tuple[str, ...] = ()
    differs: tuple[str, ...] = ()
    seconds: float = 0.0
    simulated: float = 0.0
    digest: str | None = None

    @property
    def has_result(self) -> bool:
        """True if the row was carried out to a result, be it a refusal."""
        return self.digest is not None

    @property
    def error_with_line(self) -> ErrorInfo | None:
        """The error, with the line in its message."""
        if self.error is None:
            return None
        message = f"line {self.line}: {self.error.message}"
        return self.error.model_copy(update={"message": message})


class RowResult(RowOutcome):
    """Outcome of a row with its result.

    Attributes:
        result: of the sentence, without its trace; null if there is none, or it was left out.
    """

    result: Result | None = None

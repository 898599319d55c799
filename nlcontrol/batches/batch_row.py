"""Row of a batch: what is said, where, and from which seed."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field, model_validator

from nlcontrol.json_document import DocumentPart

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

"""What goals and constraints are made of: names, quantities, and the objects that are spoken of.

Directions are the robot's, which stands at the table's −x edge of W and looks along +x: `away` is
+x, `toward` −x, `left` +y, `right` −y. Everything is in SI units and radians.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_serializer

Span = tuple[int, int]
Spans = tuple[Span, ...]

Action = Literal[
    "push", "pull", "move", "slide", "turn", "tilt", "topple",
    "lift", "place", "open", "close", "pour", "explore",
]  # fmt: skip
Query = Literal["predict", "possible", "how_hard", "where", "why", "value", "affordances"]
Dialogue = Literal["undo", "stop", "repeat", "correct", "more"]

Direction = Literal["away", "toward", "left", "right"]
Amount = Literal["little", "lot"]
Bound = Literal["exact", "at_least", "at_most"]
Sense = Literal["cw", "ccw"]
Side = Literal["length", "width", "height"]
FaceName = Literal["front", "back", "left", "right", "top"]
Relation = Literal[
    "next_to", "left_of", "right_of", "in_front_of", "behind", "between", "touching", "at", "on",
]  # fmt: skip
TableRegion = Literal[
    "center", "edge", "left_edge", "right_edge", "front_edge", "back_edge", "corner",
    "front_left_corner", "front_right_corner", "back_left_corner", "back_right_corner",
]  # fmt: skip

Positive = Annotated[float, Field(gt=0.0)]


class Part(BaseModel):
    """A part of a frame: frozen, and without infinities."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, populate_by_name=True
    )


class ObjectRef(Part):
    """An object as the sentence names it.

    Attributes:
        text: the name as written, without its article.
        spans: where it stands in the sentence.
        id: name of the object in the scene, filled in when the name is resolved.
    """

    text: str = Field(min_length=1)
    spans: Spans = ()
    id: str | None = None


class RelativeLength(Part):
    """A length measured in objects ("two box widths"): `value` times a side of `of`."""

    value: Positive
    of: ObjectRef
    side: Side | None = None


class Point(Part):
    """A point on the table, in W [m]."""

    x: float
    y: float


class ContactHeight(Part):
    """Height of a contact [m], measured upwards from the table or downwards from the top."""

    value: float = Field(ge=0.0)
    origin: Literal["table", "top"] = Field(alias="from")

    @model_serializer
    def _with_the_contract_s_key(self) -> dict[str, float | str]:
        # `from` is a keyword of Python, so the field cannot bear the contract's name itself.
        return {"value": self.value, "from": self.origin}

"""Names, quantities and objects, of which goals and constraints are made.

Directions are the robot's, which stands at the table's −x edge of W and looks along +x: `away` is
+x, `toward` −x, `left` +y, `right` −y. Everything is in SI units and radians.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import (
    ConfigDict,
    Field,
)

from objectmodels.short_repr import ShortRepr

Span = tuple[int, int]
Spans = tuple[Span, ...]

Action = Literal[
    "push", "pull", "move", "slide", "turn", "tilt", "topple",
    "lift", "place", "open", "close", "pour", "explore", "hand_over",
]  # fmt: skip
Query = Literal[
    "predict", "possible", "how_hard", "where", "why", "value", "affordances",
    "compare", "capable", "seen", "did",
]  # fmt: skip
Dialogue = Literal[
    "undo", "stop", "repeat", "correct", "more", "same", "reverse", "do", "thank",
]  # fmt: skip

Event = Literal[
    "moves", "slides", "tips", "tilts", "turns", "stays_upright", "spills", "holds",
    "ends_up",
]  # fmt: skip
Method = Literal["lift", "tilt"]

Direction = Literal["away", "toward", "left", "right"]
Amount = Literal["little", "lot"]
Bound = Literal["exact", "exactly", "at_least", "at_most"]
Sense = Literal["cw", "ccw"]
Side = Literal["length", "width", "height"]
FaceName = Literal["front", "back", "left", "right", "top"]
Relation = Literal[
    "next_to", "left_of", "right_of", "in_front_of", "behind", "between", "touching", "at", "on",
    "front_left_of", "front_right_of", "behind_left_of", "behind_right_of", "in", "out_of", "off",
    "clear_of", "place_of", "back", "in_row", "together", "stacked", "over",
]  # fmt: skip
TableRegion = Literal[
    "center", "edge", "left_edge", "right_edge", "front_edge", "back_edge", "corner",
    "front_left_corner", "front_right_corner", "back_left_corner", "back_right_corner",
    "left_half", "right_half", "front_half", "back_half",
]  # fmt: skip

Quality = Literal[
    "red", "orange", "yellow", "green", "blue", "purple", "pink", "brown", "black", "white", "grey",
    "big", "small", "tall", "short", "wide", "narrow", "heavy", "light",
    "slippery", "rough", "left", "right", "middle", "near", "far", "other", "same",
    "moved_first", "moved_last",
]  # fmt: skip
Quantifier = Literal["all", "both", "rest", "any"]

Unit = Literal["", "m", "rad", "N", "m/s", "s"]

Positive = Annotated[float, Field(gt=0.0)]


class Part(ShortRepr):
    """A part of a frame: frozen, and without infinities."""

    model_config = ConfigDict(
        defer_build=True, frozen=True, extra="forbid", allow_inf_nan=False, populate_by_name=True
    )


class ObjectRef(Part):
    """An object as the sentence names it, with what tells it from others.

    Attributes:
        text: the name as written, without its article and without the place that tells it apart.
        spans: where it stands in the sentence, the place included.
        id: name of the object in the scene, filled in when the name is resolved; where it is
            given, it decides, whatever the words are.
        pronoun: whether it stands for what was spoken of before ("it", "that one").
        qualities: what its adjectives say; of colours, sizes and positions each is the one that
            has most of it ("the tall box": the tallest).
        noun: `text` without the adjectives; "" if nothing is left ("the red one").
        relation: where it is ("the box next to the mug"), as seen from `reference`.
        reference: the objects that it is beside.
        quantifier: how many are meant of those that fit; one if it is not said. The rest are those
            that were not spoken of before; any is one of them, whichever it is.
        exceptions: objects that are not meant ("every box but the red one").
        ordinal: its place among those that are compared by the last quality ("the third tin from
            the right").
    """

    text: str = Field(min_length=1)
    spans: Spans = ()
    id: str | None = None
    pronoun: bool = False
    qualities: tuple[Quality, ...] = ()
    noun: str = ""
    relation: Relation | None = None
    reference: tuple[ObjectRef, ...] = ()
    quantifier: Quantifier | None = None
    exceptions: tuple[ObjectRef, ...] = ()
    ordinal: Annotated[int, Field(ge=1)] | None = None


class RelativeLength(Part):
    """A length measured in objects ("two box widths").

    Attributes:
        value: how many times; more than 0, at most 100.
        of: object that it is measured in; "its" is the frame's own.
        side: side that is meant, of the object as it lies.
    """

    value: Positive
    of: ObjectRef
    side: Side | None = None


class Point(Part):
    """A point on the table, in W.

    Attributes:
        x: along the robot's line of sight, growing away from it [m].
        y: to the left as the robot sees it [m].
    """

    x: float
    y: float


class ContactHeight(Part):
    """Height of a contact, measured upwards from the table or downwards from the top.

    Attributes:
        value: in metres, or measured in objects ("half its height").
        origin: end that it is measured from, `from` in JSON.
        bound: whether the contact is at this height, or at least or at most so high above the
            table (so far below the top).
    """

    model_config = ConfigDict(serialize_by_alias=True)

    value: Annotated[float, Field(ge=0.0)] | RelativeLength
    # `from` is a keyword of Python, so the field cannot bear the contract's name itself.
    origin: Annotated[Literal["table", "top"], Field(alias="from")]
    bound: Literal["exact", "at_least", "at_most"] = "exact"

"""Marks of a refusal: where its numbers are on the table, so that they can be drawn there.

Points and directions are in W. Each mark has a text of a few words to stand beside it.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from planner.types.actions import Vector3
from planner.types.frozen_value import Value


class HeightMark(Value):
    """A height above the table at which something changes on an object.

    Attributes:
        object: name of it.
        height: above the table [m].
        about: what changes there: from where it `topples`, up to where it `slides`, what is `asked`
            of the contact, or within the fingers' `reach`.
        text: the same in words.
    """

    kind: Literal["height"] = "height"
    object: str
    height: float
    about: Literal["topples", "slides", "asked", "reach"]
    text: str


class LengthMark(Value):
    """A length that is there, and the one that is asked from the same point on.

    Attributes:
        start_W, end_W: of the length that is there [m].
        asked: length along the same direction [m]; None if it is not about one.
        text: both, or what the length is.
    """

    kind: Literal["length"] = "length"
    start_W: Vector3
    end_W: Vector3
    asked: float | None = None
    text: str


class TiltMark(Value):
    """An object tipped about an edge of its base.

    Attributes:
        object: name of it.
        edge_W: a point of the edge [m].
        axis_W: unit direction of the edge, about which it turns counter-clockwise.
        angle: by which it is tipped [rad].
        text: what happens there.
    """

    kind: Literal["tilt"] = "tilt"
    object: str
    edge_W: Vector3
    axis_W: Vector3
    angle: float
    text: str


class ObstacleMark(Value):
    """An object that stands in the way.

    Attributes:
        object: name of it.
        text: of what it is in the way.
    """

    kind: Literal["obstacle"] = "obstacle"
    object: str
    text: str


def obstacle_mark(name: str) -> ObstacleMark:
    """The mark of an object that stands in the way."""
    return ObstacleMark(object=name, text=f"the {name} stands in the way")


Mark = Annotated[
    HeightMark | LengthMark | TiltMark | ObstacleMark,
    Field(discriminator="kind"),
]

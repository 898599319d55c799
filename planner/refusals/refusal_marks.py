"""From the numbers of a refusal to marks on the scene."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from planner.types.marks import HeightMark, LengthMark, TiltMark
from planner.types.plain_vectors import plain_vector

_About = Literal["topples", "slides", "asked", "reach"]
_HEIGHTS: dict[str, tuple[_About, str]] = {
    "critical_height": ("topples", "above {} it topples"),
    "critical_height_worst": ("slides", "below {} it is sure to slide"),
    "lowest_asked": ("asked", "{} and more are asked"),
    "highest_asked": ("asked", "up to {} are asked"),
    "lowest_height": ("reach", "the lowest contact is {}"),
    "highest_height": ("reach", "the highest contact is {}"),
    "lowest": ("reach", "it may be held from {} up"),
    "highest": ("reach", "it may be held up to {}"),
}


def height_marks(name: str, numbers: Mapping[str, float]) -> Iterator[HeightMark]:
    """Marks on an object of those numbers that are heights, by their names [m]."""
    marked: set[float] = set()
    for key, (about, text) in _HEIGHTS.items():
        height = numbers.get(key, 0.0)
        if height > 0.0 and height not in marked:
            marked.add(height)
            length = f"{1e3 * height:.0f} mm"
            yield HeightMark(object=name, height=height, about=about, text=text.format(length))


def length_mark(
    start_W: NDArray[np.float64],
    direction_W: NDArray[np.float64],
    length: float,
    text: str,
    asked: float | None = None,
) -> LengthMark:
    """The mark of a length from a point along a unit direction, both in W, shape (3,) [m]."""
    end_W = start_W + max(length, 0.0) * direction_W
    # To a hundredth of a millimetre.
    return LengthMark(
        start_W=plain_vector(start_W.round(5)),
        end_W=plain_vector(end_W.round(5)),
        asked=asked,
        text=text,
    )


def tilt_mark(
    name: str,
    edge_W: NDArray[np.float64],
    direction_W: NDArray[np.float64],
    angle: float,
    text: str,
) -> TiltMark:
    """The mark of an object that tips over a point of its edge (3,) along a horizontal direction.

    Args:
        name: of the object.
        edge_W: the point [m].
        direction_W: unit direction in which its top goes, shape (3,).
        angle: by which it is tipped [rad].
        text: what happens there.
    """
    axis_W = np.cross([0.0, 0.0, 1.0], direction_W)
    return TiltMark(
        object=name,
        edge_W=plain_vector(edge_W.round(5)),
        axis_W=plain_vector(axis_W.round(5)),
        angle=angle,
        text=text,
    )

"""From the numbers of a refusal to marks on the scene."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from planner.types.actions import Vector3
from planner.types.marks import HeightMark, LengthMark, TiltMark

_HEIGHTS = {
    "critical_height": "above {} it topples",
    "critical_height_worst": "below {} it is sure to slide",
    "lowest_asked": "{} and more are asked",
    "highest_asked": "up to {} are asked",
    "lowest_height": "the lowest contact is {}",
    "highest_height": "the highest contact is {}",
    "lowest": "it may be held from {} up",
    "highest": "it may be held up to {}",
}


def height_marks(name: str, numbers: Mapping[str, float]) -> Iterator[HeightMark]:
    """Marks on an object of those numbers that are heights, by their names [m]."""
    told: set[float] = set()
    for key, text in _HEIGHTS.items():
        height = numbers.get(key, 0.0)
        if height > 0.0 and height not in told:
            told.add(height)
            yield HeightMark(object=name, height=height, text=text.format(f"{1e3 * height:.0f} mm"))


def length_mark(
    start_W: NDArray[np.float64],
    direction_W: NDArray[np.float64],
    length: float,
    text: str,
    asked: float | None = None,
) -> LengthMark:
    """The mark of a length from a point along a unit direction, both in W, shape (3,) [m]."""
    end_W = start_W + max(length, 0.0) * direction_W
    return LengthMark(start_W=_vector(start_W), end_W=_vector(end_W), asked=asked, text=text)


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
        object=name, edge_W=_vector(edge_W), axis_W=_vector(axis_W), angle=angle, text=text
    )


def _vector(values: NDArray[np.float64]) -> Vector3:
    """Three numbers of an array, to a hundredth of a millimetre."""
    x, y, z = values.round(5).tolist()
    return x, y, z

"""Open boxes: cuboids that are hollow from above, in which other objects may stand.

Model: four walls from the base to the rim, and a floor between them. Frame: B, at the centre of the
base, z up.
"""

from __future__ import annotations

import numpy as np

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array, Polygon
from objectmodels.models.object_parts import Cavity

Extent = tuple[float, float, float]


def open_box_parts(size: Extent, inside: Cavity) -> tuple[tuple[Array, Array], ...]:
    """The five cuboids of which an open box consists, the floor first.

    Args:
        size: of the whole box along x, y, z [m].
        inside: its cavity.

    Returns:
        Of each the corner of least coordinates and the opposite one in B, shape (3,) [m].
    """
    (x, y), (u, v) = np.array(size[:2]) / 2.0, np.array(inside.size) / 2.0
    high = size[2]
    spans = (
        ((-u, u), (-v, v), inside.floor),
        ((-x, -u), (-y, y), high),
        ((u, x), (-y, y), high),
        ((-u, u), (-y, -v), high),
        ((-u, u), (v, y), high),
    )
    return tuple(
        (np.array([left, near, 0.0]), np.array([right, far, top]))
        for (left, right), (near, far), top in spans
    )


def inner_floor(inside: Cavity) -> Polygon:
    """The floor of a cavity, seen from above in B."""
    return Polygon.rectangle(*inside.size)


def require_open_box(size: Extent, inside: Cavity) -> None:
    """Make sure that a box so large along x, y, z [m] has walls and a floor around a cavity.

    Raises:
        ModelError: `bad_value`.
    """
    inner = (("size_m", inside.size[0]), ("size_m", inside.size[1]), ("floor_m", inside.floor))
    for (key, length), own in zip(inner, size, strict=True):
        if length >= own:
            raise cavity_error(
                f".{key}", f"{length:g} m leave no wall in {own:g} m", "give it less than the box"
            )


def cavity_error(key: str, message: str, hint: str) -> ModelError:
    """Error of a model's block `inside`, or of a key in it."""
    return ModelError("bad_value", message, path=f"inside{key}", suggestions=(hint,))

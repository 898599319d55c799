"""Contact points that callers hand in: on the object, in metres.

Checked where a caller comes in, never inside the mechanics.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.vector_arrays import checked_pairs

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel


def checked_contacts(
    model: ObjectModel, points: ArrayLike, vectors: ArrayLike
) -> tuple[Array, Array]:
    """Contact points on an object in B, and a vector for each; both finite, shape (n, 3).

    Raises:
        ModelError: `bad_array`; `off_object` if a point is far outside of the box around it.
    """
    p, v = checked_pairs(points, vectors)
    low, high = model.contact_room
    if p.size and ((p.min(axis=0) < low) | (p.max(axis=0) > high)).any():
        off = ((p < low) | (p > high)).any(axis=1)
        raise _off_object(model, p[off.argmax()], low, high)
    return p, v


def _off_object(model: ObjectModel, p: Array, low: Array, high: Array) -> ModelError:
    x, y, z = (f"{side:.4g}" for side in model.extents)
    hint = "points are in B: the origin is the centre of the base, z goes up, in metres"
    if (
        np.abs(p).max() > 10.0 * max(model.extents)
        and ((low <= 1e-3 * p) & (1e-3 * p <= high)).all()
    ):
        hint = "millimetres? points are in metres"
    return ModelError(
        "off_object",
        f"the point [{', '.join(f'{c:.4g}' for c in p)}] m is not on the {model.name}, which is "
        f"{x} × {y} × {z} m large",
        suggestions=(hint,),
    )

"""Vectors as the three plain numbers that actions, marks and guides hold."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from planner.types.actions import Vector3


def plain_vector(v: ArrayLike) -> Vector3:
    """Three numbers of an array, shape (3,), none of them −0.0 in what people read."""
    x, y, z = (np.asarray(v, dtype=np.float64) + 0.0).tolist()
    return x, y, z

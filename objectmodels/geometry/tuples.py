"""Lists and arrays of numbers where a strict model wants tuples: they are as good."""

from __future__ import annotations

from typing import Any

import numpy as np


def as_tuple(value: Any) -> Any:
    """A list or an array as a tuple; anything else as it is."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    return tuple(value) if isinstance(value, list) else value


def as_tuples(value: Any) -> Any:
    """The same, and for the lists in it."""
    value = as_tuple(value)
    return tuple(map(as_tuple, value)) if isinstance(value, tuple) else value

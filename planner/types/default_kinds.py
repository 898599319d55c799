"""Kinds of defaults: their units, the values between which they lie, and the words for them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any


@dataclass(frozen=True)
class Kind:
    """Unit of a default, and the values between which it lies.

    Attributes:
        unit: SI unit; "" for a plain number.
        suffix: of its name where people set it.
        scale: SI units in one unit of theirs.
        most: the largest value.
        zero: whether it may be 0.
        whole: whether it counts something.
        words: for the values 0, 1, …, which people may set instead.
    """

    unit: str
    suffix: str
    scale: float
    most: float
    zero: bool = False
    whole: bool = False
    words: tuple[str, ...] = ()


DEGREE = math.radians(1.0)
LISTED = ("nlcontrol defaults lists all with their units",)

Length = Annotated[float, Kind("m", "_m", 1.0, 10.0)]
Gap = Annotated[float, Kind("m", "_m", 1.0, 10.0, zero=True)]
Angle = Annotated[float, Kind("rad", "_deg", DEGREE, math.tau)]
Rate = Annotated[float, Kind("rad/s", "_deg_s", DEGREE, math.tau)]
Volume = Annotated[float, Kind("m³", "_ml", 1e-6, 1e-2)]
Force = Annotated[float, Kind("N", "_n", 1.0, 1000.0)]
Speed = Annotated[float, Kind("m/s", "_m_s", 1.0, 10.0)]
Time = Annotated[float, Kind("s", "_s", 1.0, 1000.0)]
Share = Annotated[float, Kind("", "", 1.0, 1.0)]
Probability = Annotated[float, Kind("", "", 1.0, 0.9999)]
Count = Annotated[int, Kind("", "", 1.0, 1000.0, whole=True)]
Work = Annotated[int, Kind("", "", 1.0, 1e6, whole=True)]
Factor = Annotated[float, Kind("", "", 1.0, 10.0)]

CLEARED = ("no", "ask", "yes")
"""Whether what stands in the way is moved aside, by the value of `Defaults.clear`."""

Choice = Annotated[int, Kind("", "", 1.0, len(CLEARED) - 1, zero=True, whole=True, words=CLEARED)]


class DefaultsError(ValueError):
    """A default that is none, or that has no sensible value.

    Attributes:
        suggestions: what would be right.
    """

    def __init__(self, message: str, suggestions: tuple[str, ...] = LISTED) -> None:
        super().__init__(message)
        self.suggestions = suggestions


def out_of_range(name: str, value: float, kind: Kind) -> DefaultsError:
    """The error of a value, in the unit in which people give it."""
    least = "at least 0" if kind.zero else "more than 0"
    return DefaultsError(
        f"{name} must be {least} and at most {kind.most / kind.scale:g}, found {value:g}"
    )


def value_of_word(value: object, words: tuple[str, ...]) -> Any:
    """The number of a word; YAML reads "yes" and "no" as truth values."""
    word = {True: "yes", False: "no"}[value] if isinstance(value, bool) else value
    return words.index(word) if isinstance(word, str) and word in words else value

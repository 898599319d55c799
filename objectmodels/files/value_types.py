"""Types of the values in files from outside, with the ranges of the table of limits."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AfterValidator, Field

from objectmodels.files.limits import LIMITS


def range_of(key: str) -> Any:
    """The field of a number within a limit."""
    limit = LIMITS[key]
    return Field(ge=limit.least, le=limit.most)


def length_of(key: str) -> Any:
    """The field of a text or a sequence whose length is within a limit."""
    limit = LIMITS[key]
    return Field(min_length=int(limit.least), max_length=int(limit.most))


def _printable_name(text: str) -> str:
    if text != text.strip() or not text.isprintable():
        raise ValueError("signs that can be printed, without white space at the ends")
    if text.startswith("-"):
        raise ValueError("a name that does not begin with a dash, as options of commands do")
    return text


Name = Annotated[str, length_of("name"), AfterValidator(_printable_name)]
"""Name or synonym of an object, a model or a scene."""

Mass = Annotated[float, range_of("mass")]
Length = Annotated[float, range_of("length")]
TableLength = Annotated[float, range_of("table")]
Height = Annotated[float, range_of("height")]
Coordinate = Annotated[float, range_of("coordinate")]
Friction = Annotated[float, range_of("friction")]
Deviation = Annotated[float, range_of("deviation")]
Weight = Annotated[float, range_of("weight")]
Volume = Annotated[float, range_of("volume")]
Density = Annotated[float, range_of("density")]
Force = Annotated[float, range_of("force")]
Squeeze = Annotated[float, range_of("squeeze")]
Torque = Annotated[float, range_of("torque")]
Turns = Annotated[float, range_of("turns")]
Angle = Annotated[float, range_of("angle")]
OpeningAngle = Annotated[float, range_of("opening")]

"""Two runs of the same request beside each other: what came out otherwise, by how much, from when.

Numbers are the same if they are so to the last digit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from nlcontrol.json_document import DocumentPart, finite_or_none
from objectmodels.errors import printable
from sim.traces.trace import UNITS, Trace

_NOT_COMPARED = ("files", "explanation")
"""Fields of a result that tell of its reports and not of the run."""

_LONGEST = 200  # characters of a place or a value; a bundle may come from anybody


class Difference(DocumentPart):
    """Something that came out otherwise.

    Attributes:
        part: of the bundle.
        place: in it: a version's name, a field such as `steps[0].status`, an array such as
            `poses/mug`.
        recorded: in the bundle, as text; null if there was nothing.
        repeated: now.
        largest: difference of numbers, in `unit`.
        unit: of it, where it is known; `""` for a number without one.
        begins: time of the trace from which on it differs [s].
    """

    part: Literal["version", "result", "trace"]
    place: str
    recorded: str | None = None
    repeated: str | None = None
    largest: float | None = None
    unit: str | None = None
    begins: float | None = None


def version_differences(
    recorded: Mapping[str, str], repeated: Mapping[str, str]
) -> Iterator[Difference]:
    """Versions that are not the same."""
    for name in sorted(recorded.keys() | repeated.keys()):
        was, now = recorded.get(name), repeated.get(name)
        if was != now:
            texts = {"recorded": _short(was), "repeated": _short(now)}
            yield Difference(part="version", place=printable(name[:_LONGEST]), **texts)


def result_differences(
    recorded: Mapping[str, Any], repeated: Mapping[str, Any]
) -> Iterator[Difference]:
    """Fields of two results, as JSON, that are not the same."""
    for key in dict.fromkeys((*recorded, *repeated)):
        if key not in _NOT_COMPARED:
            yield from _value_differences(key, recorded.get(key), repeated.get(key))


def _value_differences(place: str, recorded: Any, repeated: Any) -> Iterator[Difference]:
    if isinstance(recorded, dict) and isinstance(repeated, dict):
        for key in dict.fromkeys((*recorded, *repeated)):
            yield from _value_differences(f"{place}.{key}", recorded.get(key), repeated.get(key))
    elif isinstance(recorded, list) and isinstance(repeated, list):
        if len(recorded) != len(repeated):
            lengths = f"{len(recorded)} items", f"{len(repeated)} items"
            yield _result_difference(place, *lengths)
        for index, (was, now) in enumerate(zip(recorded, repeated, strict=False)):
            yield from _value_differences(f"{place}[{index}]", was, now)
    elif _is_number(recorded) and _is_number(repeated):
        if recorded != repeated:
            texts = _short(recorded), _short(repeated)
            yield _result_difference(place, *texts, _distance(recorded, repeated))
    elif recorded != repeated:
        yield _result_difference(place, _short(recorded), _short(repeated))


def _result_difference(
    place: str, recorded: str | None, repeated: str | None, largest: float | None = None
) -> Difference:
    return Difference(
        part="result",
        place=printable(place[:_LONGEST]),
        recorded=recorded,
        repeated=repeated,
        largest=largest,
    )


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _distance(a: float, b: float) -> float | None:
    """Distance of two numbers from each other; None if that is no number itself."""
    try:
        return finite_or_none(abs(b - a))
    except OverflowError:  # of an integer beyond all floats
        return None


def _short(value: object) -> str | None:
    return None if value is None else printable(str(value)[:_LONGEST])


def trace_differences(recorded: Trace | None, repeated: Trace | None) -> Iterator[Difference]:
    """Arrays of two traces that are not the same; of unlike lengths as far as both go."""
    if recorded is None or repeated is None:
        if recorded is not repeated:
            yield _trace_difference("", _length(recorded), _length(repeated))
        return
    was, now = recorded.arrays(), repeated.arrays()
    for name in dict.fromkeys((*was, *now)):
        if name in was and name in now:
            arrays = np.atleast_1d(was[name]), np.atleast_1d(now[name])
            yield from _array_differences(name, *arrays, recorded.time)
        else:
            yield _trace_difference(name, _shape(was.get(name)), _shape(now.get(name)))


def _array_differences(
    name: str, recorded: NDArray[Any], repeated: NDArray[Any], time: NDArray[np.float64]
) -> Iterator[Difference]:
    """The differences of an array; of poses, those of the places and of the quaternions."""
    if recorded.shape != repeated.shape:
        yield _trace_difference(name, _shape(recorded), _shape(repeated))
    if recorded.shape[1:] != repeated.shape[1:]:
        return
    n = min(len(recorded), len(repeated))
    times = time[:n] if len(recorded) == len(time) else None
    unit = UNITS.get(name, UNITS.get(name.partition("/")[0], ""))
    if not unit.startswith("quaternion"):
        yield from _row_differences(name, unit, recorded[:n], repeated[:n], times)
        return
    for part, its_unit, columns in (("place", "m", slice(4, 7)), ("quaternion", "", slice(4))):
        rows = recorded[:n, columns], repeated[:n, columns]
        yield from _row_differences(f"{name} ({part})", its_unit, *rows, times)


def _row_differences(
    place: str,
    unit: str,
    recorded: NDArray[Any],
    repeated: NDArray[Any],
    times: NDArray[np.float64] | None,
) -> Iterator[Difference]:
    """The difference of arrays of one shape, the first index of which may go by times [s]."""
    differs = recorded != repeated
    if not differs.any():
        return
    first = int(np.argmax(differs.reshape(len(differs), -1).any(axis=1)))
    begins = None if times is None else finite_or_none(times[first])
    if recorded.dtype.kind == "U" or repeated.dtype.kind == "U":
        texts = _short(recorded[first]), _short(repeated[first])
        yield _trace_difference(place, *texts, begins=begins)
        return
    largest = finite_or_none(np.max(np.abs(recorded[differs] - repeated[differs])))
    yield _trace_difference(place, None, None, largest=largest, unit=unit, begins=begins)


def _length(trace: Trace | None) -> str | None:
    return None if trace is None else f"{len(trace.time)} samples"


def _shape(array: NDArray[Any] | None) -> str | None:
    return None if array is None else f"shape {array.shape}"


def _trace_difference(
    place: str, recorded: str | None, repeated: str | None, **figures: Any
) -> Difference:
    return Difference(part="trace", place=place, recorded=recorded, repeated=repeated, **figures)

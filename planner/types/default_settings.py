"""The table of defaults as people set it: names that carry their units, angles in degrees.

A length is set as `place_gap_m`, an angle as `turn_deg`, a force as `force_hard_n`, a speed as
`speed_m_s`, a time as `duration_tolerance_s`, a volume as `pour_little_ml`; a plain number bears
its name alone. The same names hold in the `defaults` of a scene file and on the command line. Code
uses the fields of `planner.types.defaults.Defaults`, in SI units.
"""

from __future__ import annotations

import difflib
import inspect
import math
import re
import sys
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from planner.types.defaults import DEFAULTS, Defaults, DefaultsError, Kind, kinds, out_of_range

if TYPE_CHECKING:
    from collections.abc import Mapping


@dataclass(frozen=True)
class Setting:
    """One default as people set it.

    Attributes:
        name: with its unit.
        value: in that unit.
        most: largest value, in that unit.
        zero: whether it may be 0.
        meaning: in words.
    """

    name: str
    value: float
    most: float
    zero: bool
    meaning: str


def settings(defaults: Defaults = DEFAULTS) -> tuple[Setting, ...]:
    """Every default in the order of the table."""
    meanings = _default_meanings()
    return tuple(
        Setting(
            name=name + kind.suffix,
            value=_value_as_set(getattr(defaults, name), kind),
            most=_value_as_set(kind.most, kind),
            zero=kind.zero,
            meaning=meanings.get(name, ""),
        )
        for name, kind in kinds().items()
    )


def table(defaults: Defaults = DEFAULTS) -> tuple[str, ...]:
    """The defaults as the lines of a table in Markdown."""
    rows = [("name", "value", "meaning"), ("---", "--:", "---")]
    rows += [(f"`{s.name}`", f"{s.value:g}", s.meaning) for s in settings(defaults)]
    return tuple(f"| {' | '.join(row)} |" for row in rows)


def changed(defaults: Defaults, values: Mapping[str, float]) -> Defaults:
    """The defaults with some of them set.

    Args:
        defaults: that are changed.
        values: by the names and in the units of `Setting`.

    Raises:
        DefaultsError: there is no such default, or the value is out of its range.
    """
    known = {name + kind.suffix: (name, kind) for name, kind in kinds().items()}
    found: dict[str, Any] = {}
    for said, value in values.items():
        if said not in known:
            raise _unknown_default(said, tuple(known))
        name, kind = known[said]
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise DefaultsError(f"{said} must be a number, found {value!r}")
        number = math.inf if abs(value) > sys.float_info.max else float(value)
        if not 0.0 <= number <= kind.most / kind.scale:
            raise out_of_range(said, number, kind)
        if kind.whole and number % 1.0:
            raise DefaultsError(f"{said} must be a whole number, found {value:g}")
        found[name] = int(value) if kind.whole else number * kind.scale
    return replace(defaults, **found)


def _unknown_default(said: str, names: tuple[str, ...]) -> DefaultsError:
    """The error of a name that is none; most often its unit is missing."""
    units = [
        name for name in names if re.fullmatch(rf"{re.escape(said)}_(m|deg|n|m_s|deg_s|ml|s)", name)
    ]
    close = units or difflib.get_close_matches(said, names, n=3)
    return DefaultsError(
        f"there is no default '{said}'",
        tuple(f"did you mean '{name}'?" for name in close) or ("nlcontrol defaults lists them",),
    )


def _value_as_set(value: float, kind: Kind) -> float:
    """A value in the unit in which it is set, without the rounding of the way there and back."""
    return float(f"{value / kind.scale:.10g}")


def _default_meanings() -> dict[str, str]:
    """Meaning of each default, from the one place where that is said."""
    text = inspect.cleandoc(Defaults.__doc__ or "")
    found = re.findall(r"^    (\w+): (.*(?:\n {8}.*)*)", text, re.MULTILINE)
    unit = re.compile(r"\s*\[[^]]*\]")
    return {name: unit.sub("", " ".join(said.split())).rstrip(".") for name, said in found}

"""Which heights of an object a clause about contact means."""

from __future__ import annotations

from typing import TYPE_CHECKING

from grammar.frames import command as g

if TYPE_CHECKING:
    from collections.abc import Iterator

    from planner.types.defaults import Defaults

Band = tuple[float, float, str]
"""The lowest and the highest of some heights [m], and words for them."""


def bands(clause: g.ContactRegion, top: float, defaults: Defaults) -> Iterator[Band]:
    """The heights that a clause allows; all of them hold.

    Args:
        clause: what is said of the contact.
        top: height of the object [m].
        defaults: how exactly a height is meant.
    """
    if clause.region is not None:
        third = {"bottom": 0, "middle": 1, "top": 2}[clause.region]
        yield third * top / 3.0, (third + 1) * top / 3.0, f"at the {clause.region}"
    if clause.height is not None:
        yield _at_height(clause.height, top, defaults)


def _at_height(height: g.ContactHeight, top: float, defaults: Defaults) -> Band:
    assert isinstance(height.value, float), "lengths measured in objects are resolved by now"
    upwards = height.origin == "table"
    at = height.value if upwards else top - height.value
    where = f"{1e3 * at:.0f} mm above the table"
    if height.bound == "exact":
        near = 0.5 * defaults.height_tolerance
        return at - near, at + near, where
    if (height.bound == "at_least") == upwards:
        return at, top, f"at least {where}"
    return 0.0, at, f"at most {where}"

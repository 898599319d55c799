"""The largest amount that has a plan, where a rule says which has one."""

from __future__ import annotations

import math

import pytest

from grammar.frames import command as g
from planner.feasible_amounts import frame_with_less


def lifted(height: float) -> g.Frame:
    return g.Frame(action="lift", goal=g.Lift(height=height))


def height_of(frame: g.Frame) -> float:
    assert isinstance(frame.goal, g.Lift)
    assert isinstance(frame.goal.height, float)
    return frame.goal.height


@pytest.mark.parametrize("most", [0.02, 0.37, 1.9])
def test_it_has_a_plan_and_is_near_the_most(most: float) -> None:
    tried: list[float] = []

    def is_planned(frame: g.Frame) -> bool:
        tried.append(height_of(frame))
        return tried[-1] <= most

    found = frame_with_less(lifted(3.0), is_planned)
    assert found is not None
    height = height_of(found)
    # Between halves or doubles a bracket of at most `most` is halved three times.
    assert most - max(0.125 * most, 0.01) <= height <= most
    assert math.isclose(100.0 * height, round(100.0 * height), abs_tol=1e-9)
    assert len(tried) <= math.log2(300) + 3


def test_nothing_is_found_where_nothing_has_a_plan() -> None:
    assert frame_with_less(lifted(3.0), lambda _: False) is None


def test_what_has_no_amount_has_no_less() -> None:
    assert frame_with_less(g.Frame(action="topple", goal=g.Topple()), lambda _: True) is None

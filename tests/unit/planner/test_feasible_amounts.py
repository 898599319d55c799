"""The largest amount that has a plan, where a rule says which has one."""

from __future__ import annotations

import math
import re

import pytest

from grammar import paraphrase
from grammar.frames import command as g
from planner.affordances import frame_with_less
from planner.types.defaults import DEFAULTS


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
    # Between doubles, or between the least and what is usual, a bracket is halved twice.
    assert most - max(0.2 * most, 0.01) <= height <= most
    assert math.isclose(100.0 * height, round(100.0 * height), abs_tol=1e-9)
    assert len(tried) <= math.log2(300) + 3


def test_nothing_is_found_where_nothing_has_a_plan() -> None:
    tried: list[float] = []

    def is_planned(frame: g.Frame) -> bool:
        tried.append(height_of(frame))
        return False

    assert frame_with_less(lifted(3.0), is_planned) is None
    assert tried == [DEFAULTS.lift_height, 0.01], "what is usual, and the least"


@pytest.mark.parametrize("cl", [2, 12, 15, 57])
def test_an_amount_is_said_without_rests_of_rounding(cl: int) -> None:
    poured = g.Frame(
        action="pour",
        object=g.ObjectRef(text="tea"),
        goal=g.Pour(into=g.ObjectRef(text="mug"), volume=0.9e-3),
    )

    def is_planned(frame: g.Frame) -> bool:
        assert isinstance(frame.goal, g.Pour)
        assert frame.goal.volume is not None
        return frame.goal.volume <= 1e-5 * (cl + 0.5)

    found = frame_with_less(poured, is_planned)
    assert found is not None
    assert re.search(r"pour \d+ ml of", paraphrase(found))


def test_what_has_no_amount_has_no_less() -> None:
    assert frame_with_less(g.Frame(action="topple", goal=g.Topple()), lambda _: True) is None

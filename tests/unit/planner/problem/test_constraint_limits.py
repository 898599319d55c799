"""Every kind of constraint has a rule for pushes, and one for hands or words for what they lack."""

from __future__ import annotations

from typing import get_args

import pytest

from grammar.frames import command as g
from planner.problem.constraint_limits import LIMITS, apply_constraint
from planner.refusals.blocked import Blocked
from planner.types.defaults import DEFAULTS
from planner.types.world_state import WorldState
from tests.unit.planner.conftest import frame_of, problem_of

KINDS = {
    get_args(part.model_fields["kind"].annotation)[0]
    for part in get_args(get_args(g.Constraint)[0])
}


def test_every_kind_of_constraint_has_its_row() -> None:
    assert set(LIMITS) == KINDS


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_a_row_says_what_pushes_and_hands_do(kind: str) -> None:
    rule = LIMITS[kind]
    assert rule.push is not None
    assert (rule.grasp is None) == bool(rule.unsupported)


def test_the_narrowest_of_two_limits_holds(kitchen: WorldState) -> None:
    for text in (
        "push the ice tea box away with at most 6 N and with at most 4 N",
        "push the ice tea box away with at most 4 N",
    ):
        assert problem_of(frame_of(text), kitchen, DEFAULTS).force.max == 4.0


def test_a_limit_leaves_the_problem_that_it_narrows_as_it_is(kitchen: WorldState) -> None:
    problem = problem_of(frame_of("push the ice tea box away"), kitchen, DEFAULTS)
    narrower = apply_constraint(problem, g.MaxForce(value=4.0))
    assert not isinstance(narrower, Blocked)
    assert (problem.force.max, narrower.force.max) == (float("inf"), 4.0)
    assert narrower.contact is problem.contact


def test_what_no_push_keeps_is_refused_by_its_words(kitchen: WorldState) -> None:
    problem = problem_of(frame_of("push the ice tea box away"), kitchen, DEFAULTS)
    why = apply_constraint(problem, g.Duration(value=3.0, spans=((0, 4),)))
    assert isinstance(why, Blocked)
    assert why.refusal.capability == "pushing for an exact time"
    assert why.spans == ((0, 4),)

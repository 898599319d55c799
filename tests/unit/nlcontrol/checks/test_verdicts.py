"""What an execution amounts to, and what cannot be checked."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, get_args

import pytest

from grammar.frames import command as g
from nlcontrol.checks.frame_checks import not_held, require_checkable
from nlcontrol.errors import ControlError
from objectmodels import BoxModel
from tests.unit.nlcontrol.checks.conftest import (
    AWAY,
    MUG,
    TraceMaker,
    check,
    frame_of,
)


@pytest.mark.parametrize("end", ["stroke", "turned", "returned", "event", "reached", "toppled"])
def test_ends_that_were_meant_are_not_early(
    make_trace: TraceMaker, box: BoxModel, end: Any
) -> None:
    trace = make_trace(travel=(0.02, 0.0), end=end)
    missed = [c for c in check(frame_of(), trace, box) if not c.ok]
    assert "early" not in not_held(missed, trace).message
    early = not_held(missed, replace(trace, end="too_close", detail="the mug is near"))
    assert "the push ended early: the mug is near" in early.message


def test_what_cannot_be_checked_is_an_error() -> None:
    with pytest.raises(ControlError) as raised:
        require_checkable(frame_of(g.HandOver()))
    assert raised.value.code == "uncheckable"


def test_the_words_of_an_uncheckable_clause_are_named() -> None:
    with pytest.raises(ControlError) as raised:
        require_checkable(frame_of(g.HandOver(spans=((3, 9),))))
    assert raised.value.info.span == (3, 9)


def test_no_clause_of_the_contract_is_passed_over(make_trace: TraceMaker, box: BoxModel) -> None:
    """Each kind of constraint either has a check that yields something, or is refused."""
    kinds = get_args(get_args(g.Constraint)[0])
    values = {"value": 1.0, "object": MUG, "tool": "finger", "event": "tips", "region": "bottom"}
    for kind in kinds:
        clause = kind(**{k: v for k, v in values.items() if k in kind.model_fields})
        frame = frame_of(AWAY, clause)
        try:
            checks = check(frame, make_trace(), box)
        except ControlError as raised:
            assert raised.code == "uncheckable"  # noqa: PT017
        else:
            assert any(c.clause == clause.kind for c in checks), clause.kind

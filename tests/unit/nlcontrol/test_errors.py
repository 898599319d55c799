"""The error table, and how each stage's exception and refusal enters it."""

from __future__ import annotations

from typing import get_args

import pytest

from grammar import ParseError
from nlcontrol import errors
from nlcontrol.errors import (
    ControlError,
    ErrorInfo,
    error,
    known_error,
    known_errors_raised,
    refusal_error,
)
from objectmodels import ModelError
from planner.types.refusal import Refusal, RefusalReason
from sim import SceneError


def test_every_status_is_one_of_the_contract() -> None:
    for status in (*errors.CODES.values(), *errors.FAMILIES.values()):
        assert status.exit in (*range(7), 130)
        assert 200 <= status.http < 600


def test_every_reason_of_a_refusal_is_in_the_table_and_exits_4() -> None:
    for reason in get_args(RefusalReason):
        info = refusal_error(
            Refusal(code="no_side", reason=reason, message="no", spans=((3, 5), (8, 9)))
        )
        assert info.code in errors.CODES
        assert info.status.exit == errors.NO_PLAN
        assert info.span == (3, 9)


@pytest.mark.parametrize(
    ("raised", "exit_status", "http"),
    [
        (ParseError("unknown_verb", "?", (0, 4), ("push",)), 3, 422),
        (ModelError("bad_value", "?", path="a.yaml", suggestions=("3",)), 2, 400),
        (SceneError("unknown_scene", "?", ("kitchen",)), 2, 400),
    ],
)
def test_the_stages_own_exceptions(raised: Exception, exit_status: int, http: int) -> None:
    known = known_error(raised)
    assert known is not None
    assert known.info.status == (exit_status, http)
    assert known.info.message == "?"
    assert str(known) == "?"


def test_a_defect_is_no_known_error_and_passes_through() -> None:
    assert known_error(ValueError("boom")) is None
    with pytest.raises(ValueError, match="boom"), known_errors_raised():
        raise ValueError("boom")


def test_translated_keeps_the_cause() -> None:
    with pytest.raises(ControlError) as raised, known_errors_raised():
        raise ParseError("unknown_verb", "no such verb", (0, 4), ("push",))
    assert isinstance(raised.value.__cause__, ParseError)
    assert raised.value.info.span == (0, 4)


def test_a_code_outside_the_table_is_refused_at_once() -> None:
    with pytest.raises(KeyError):
        error("no_such_code", "?", suggestions=())


def test_an_unknown_code_of_no_family_is_internal() -> None:
    assert ErrorInfo(code="odd", message="?").status.exit == errors.INTERNAL

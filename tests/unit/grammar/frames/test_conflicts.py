"""The table of conflicts: each row is needed by a sentence, and names kinds that there are."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from grammar import ParseError, parse
from grammar.clauses import consistency
from grammar.frames import constraints as conflicts
from grammar.frames.constraints import CONSTRAINTS
from grammar.frames.goals import GOALS

FORBIDDEN = {
    ("topple", "no_topple"): "topple it without toppling it",
    ("topple", "no_tilt"): "tip the box over without tilting it",
    ("topple", "max_tilt"): "knock it over without tilting it more than 5 degrees",
    ("tilt", "no_tilt"): "tilt it without tilting it",
    ("rotate", "no_turn"): "turn it clockwise without turning it",
    ("lift", "no_lift"): "lift it 5 cm without lifting it",
    ("pour", "no_tilt"): "pour the milk into the mug without tilting it",
    ("upright", "no_tilt"): "stand the mug up without tilting it",
    ("upright", "max_tilt"): "stand the mug up without tilting it more than 5 degrees",
    ("displace", "no_slide"): "slide it away without sliding it",
    ("place", "no_slide"): "push it next to the mug without sliding it",
}
FORBIDDEN_BELOW = {
    "tilt": "tilt it by 30 degrees without tilting it more than 10 degrees",
    "rotate": "turn it 90 degrees without turning it more than 30 degrees",
    "displace": "push it 20 cm without moving it more than 10 cm",
}
FORBIDDEN_EVENTS = {
    ("tips", "no_topple"): "push it until it tips without toppling it",
    ("tips", "no_tilt"): "push it until it tips without tilting it",
    ("about_to_tip", "no_tilt"): "push it until it almost tips without tilting it",
}
EXCLUSIVE = {
    ("gentle", "hard"): "push it gently and hard",
    ("slow", "fast"): "push it slowly but quickly",
    ("effector", "effector"): "push it with one finger with two fingers",
    ("force", "force"): "push it with 3 N and with 5 N",
    ("speed", "speed"): "push it at 2 cm/s at 3 cm/s",
    ("duration", "duration"): "push it for 5 seconds for 3 seconds",
    ("until", "until"): "push it until it moves until it tips",
}
ORDERED = {
    ("force", "max_force"): "push it with 5 N and with at most 3 N",
    ("min_force", "force"): "push it with 2 N and with at least 3 N",
    ("min_force", "max_force"): "push it with at least 5 N and with at most 3 N",
    ("speed", "max_speed"): "push it at 5 cm/s and at most 3 cm/s",
    ("min_speed", "speed"): "push it at 2 cm/s and at least 3 cm/s",
    ("min_speed", "max_speed"): "push it at least 5 cm/s and at most 3 cm/s",
    ("duration", "max_duration"): "push it for 5 seconds in at most 3 seconds",
}


def pairs(rows: dict[str, frozenset[str]]) -> set[tuple[str, str]]:
    return {(name, kind) for name, kinds in rows.items() for kind in kinds}


def test_every_row_has_its_sentence() -> None:
    assert set(FORBIDDEN) == pairs(conflicts.FORBIDS)
    assert set(FORBIDDEN_BELOW) == set(conflicts.FORBIDS_BELOW)
    assert set(FORBIDDEN_EVENTS) == pairs(conflicts.FORBIDS_EVENT)
    assert set(EXCLUSIVE) == conflicts.EXCLUSIVE
    assert set(ORDERED) == conflicts.ORDERED


def tables() -> Iterator[tuple[str, Any, str]]:
    """The name of a table, itself without one row, and the sentence that needs the row."""
    for name, rows, sentences in (
        ("FORBIDS", conflicts.FORBIDS, FORBIDDEN),
        ("FORBIDS_EVENT", conflicts.FORBIDS_EVENT, FORBIDDEN_EVENTS),
    ):
        for (key, kind), text in sentences.items():
            yield name, rows | {key: rows[key] - {kind}}, text
    for goal, text in FORBIDDEN_BELOW.items():
        rest = {key: row for key, row in conflicts.FORBIDS_BELOW.items() if key != goal}
        yield "FORBIDS_BELOW", rest, text
    for pair, text in EXCLUSIVE.items():
        yield "EXCLUSIVE", conflicts.EXCLUSIVE - {pair}, text
    for pair, text in ORDERED.items():
        yield "ORDERED", conflicts.ORDERED - {pair}, text


@pytest.mark.parametrize(("name", "rest", "text"), list(tables()))
def test_sentence_is_refused_by_its_row_alone(
    name: str, rest: Any, text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(ParseError) as caught:
        parse(text)
    assert caught.value.code == "contradiction"
    monkeypatch.setattr(consistency, name, rest)
    assert parse(text).frames


def test_tables_name_only_kinds_that_there_are() -> None:
    forbidden = {kind for kinds in conflicts.FORBIDS.values() for kind in kinds}
    forbidden |= {kind for kinds in conflicts.FORBIDS_EVENT.values() for kind in kinds}
    limits = {kind for _, kind in conflicts.FORBIDS_BELOW.values()}
    paired = {kind for pair in conflicts.EXCLUSIVE | conflicts.ORDERED for kind in pair}
    matters = conflicts.HOW_FAR.union(*conflicts.SAME_MATTER)
    assert forbidden | limits | paired | matters <= set(CONSTRAINTS)
    assert set(conflicts.FORBIDS) | set(conflicts.FORBIDS_BELOW) <= set(GOALS)
    for goal, (field, _) in conflicts.FORBIDS_BELOW.items():
        assert {field, "bound"} <= set(GOALS[goal].model_fields)


def test_limits_are_measured_in_their_unit() -> None:
    for kind in CONSTRAINTS.values():
        if kind.words.limit:
            assert CONSTRAINTS[kind.words.limit].words.unit in ("m", "rad")

"""Dead ends as values: which of several ways counts, and what a refusal is made of."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from nlcontrol.errors import refusal_error
from planner.refusals.blocked import Blocked, all_made, dead_end, first_made, reach_sentence
from planner.refusals.sentences import REACH
from planner.types.robot import ReachAnswer

NUMBERS = {"free": 0.123, "distance": 0.3}
FIRST, SECOND = (dead_end("in_the_way", NUMBERS, object="cup", other=other) for other in "ab")


def test_no_more_ways_are_made_than_it_takes() -> None:
    begun: list[str | Blocked] = []

    def ways() -> Iterator[str | Blocked]:
        for way in (FIRST, "made", "not needed"):
            begun.append(way)
            yield way

    assert first_made(ways()) == "made"
    assert begun == [FIRST, "made"]


def test_the_first_dead_end_counts_where_no_way_is_made() -> None:
    assert first_made([FIRST, SECOND]) is FIRST
    assert all_made([FIRST, SECOND]) is FIRST
    assert all_made([FIRST, 1, SECOND, 2]) == [1, 2]


def test_a_fact_goes_on_with_the_sentence_and_its_cures_come_first() -> None:
    fact = {"nearer": 0.25, "nearest_x": 0.4, "nearest_y": -0.1}
    plain, more = FIRST.refusal, FIRST.with_fact("nearer", fact).refusal
    assert more.message.startswith(f"{plain.message}; 250 mm nearer")
    assert more.suggestions == ("put it there by hand: x 0.40 m, y -0.10 m", *plain.suggestions)
    assert more.numbers == NUMBERS | fact
    assert (more.code, more.reason, more.marks) == (plain.code, plain.reason, plain.marks)


def test_cures_go_with_their_phrases_and_into_no_document() -> None:
    refusal = dead_end("in_the_way_so_far", NUMBERS, object="cup", other="jar").refusal
    (cure,) = refusal.cures
    assert (cure.kind, cure.text, cure.command) == (
        "change",
        refusal.suggestions[0],
        "no, 120 mm",
    )
    assert refusal_error(refusal).cures == refusal.cures
    for document in (refusal, refusal_error(refusal)):
        assert "cures" not in document.model_dump()
        assert "cures" not in type(document).model_json_schema(mode="serialization")["properties"]


@pytest.mark.parametrize("code", REACH)
def test_each_reason_of_a_robot_has_its_sentence(code: str) -> None:
    numbers = dict.fromkeys(("narrowest", "widest", "strength", "force", "lacks"), 0.1)
    words = {"object": "cup", "text": "so", "detail": "it fell", "met": "table", "height": 0.1}
    answer = ReachAnswer(False, "kinematics", code, "jar", numbers=numbers, words=words)
    assert "{" not in reach_sentence(answer)
    last = dead_end("no_push_reached", {"ways": 1.0}, object="cup", last=answer)
    assert last.sentence.endswith(reach_sentence(answer))

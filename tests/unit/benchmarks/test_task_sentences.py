"""Labels of sentences of other sources, by their verbs and prepositions."""

from typing import Any

import pytest

from benchmarks.public_sentences.task_sources import _clause, _labelled, _renamed

IN_CUP = {"kind": "place", "relation": "in", "reference": [{"text": "cup"}]}


def test_longer_names_are_replaced_first() -> None:
    names = {"black bowl": "mug", "black bowl stand": "cup"}
    assert _renamed("put the black bowl on the black bowl stand", names) == "put the mug on the cup"


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("put the box in the cup", {"object": {"text": "box"}, "goal": IN_CUP}),
        ("put the box in the middle in the cup", {"object": {"text": "box"}, "goal": IN_CUP}),
        ("pick the box next to the mug", {"action": "lift", "object": {"text": "box"}}),
        ("close the drawer", {"goal": {"kind": "close"}}),
    ],
)
def test_a_clause_means_one_frame(text: str, meant: dict[str, Any]) -> None:
    assert [list(frames) for frames in _clause(text).meanings] == [[meant]]


def test_what_is_picked_up_first_may_be_put_at_once() -> None:
    sentence = _labelled("source", "pick up the box and put it in the cup")
    put = {"object": {"text": "box"}, "goal": IN_CUP}
    assert [len(frames) for frames in sentence.meanings] == [2, 1]
    assert list(sentence.meanings[1]) == [put]


def test_furniture_may_be_refused_and_what_is_no_task_is_outside() -> None:
    assert _labelled("source", "put the box in the top drawer").refusable
    assert not _labelled("source", "put the box in the cup").refusable
    assert not _labelled("source", "turn on the stove and put the pot on it").meanings

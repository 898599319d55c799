"""Sentences that are understood, and sentences that are refused, from two lists."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from grammar import ParseError, paraphrase, parse

COMMANDS = Path(__file__).parents[2] / "data" / "commands"
UNDERSTOOD = yaml.safe_load((COMMANDS / "understood.yaml").read_text(encoding="utf-8"))
REFUSED = yaml.safe_load((COMMANDS / "refused.yaml").read_text(encoding="utf-8"))


def bare(value: Any) -> Any:
    """JSON without spans, and without what is null, empty or exact."""
    if isinstance(value, dict):
        kept = {key: bare(part) for key, part in value.items() if key not in ("spans", "id")}
        return {key: p for key, p in kept.items() if p not in (None, [], False, "", "exact")}
    if isinstance(value, list):
        return [bare(part) for part in value]
    return value


@pytest.mark.parametrize("case", UNDERSTOOD, ids=lambda case: case["text"])
def test_sentence_means_its_frame(case: dict[str, Any]) -> None:
    (frame,) = parse(case["text"]).frames
    found = bare(frame.model_dump(mode="json"))
    found["object"] = found["object"]["text"]
    assert found == case["frame"]


@pytest.mark.parametrize("case", UNDERSTOOD, ids=lambda case: case["text"])
def test_paraphrase_means_the_same(case: dict[str, Any]) -> None:
    command = parse(case["text"])
    again = parse(command.paraphrase)
    assert command.paraphrase == paraphrase(command.frames[0])
    assert [bare(f.model_dump(mode="json")) for f in again.frames] == [
        bare(f.model_dump(mode="json")) for f in command.frames
    ]


@pytest.mark.parametrize("case", REFUSED, ids=lambda case: case["text"] or "nothing")
def test_sentence_is_refused(case: dict[str, Any]) -> None:
    with pytest.raises(ParseError) as caught:
        parse(case["text"])
    error = caught.value
    assert error.code == case["code"]
    assert error.message
    assert error.message == str(error)
    at = None if error.span is None else case["text"][slice(*error.span)]
    assert at == case["at"]


def test_lists_are_long_enough_to_mean_something() -> None:
    assert len(UNDERSTOOD) >= 200
    assert len(REFUSED) >= 120

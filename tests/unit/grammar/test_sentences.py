"""Sentences that are understood, and sentences that are refused, from lists."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from grammar import Frame, ParseError, paraphrase, parse

COMMANDS = Path(__file__).parents[2] / "data" / "commands"
REFUSALS = {"refused", "out_of_domain", "typos"}
EMPTY: tuple[Any, ...] = (None, [], False, "", "exact")


def read(name: str) -> list[dict[str, Any]]:
    return list(yaml.safe_load((COMMANDS / f"{name}.yaml").read_text(encoding="utf-8")))


THEMES = sorted(path.stem for path in COMMANDS.glob("*.yaml") if path.stem not in REFUSALS)
UNDERSTOOD = [case for theme in THEMES for case in read(theme)]
TOPPLE_AND_TILT = {"no_topple", "no_tilt", "max_tilt"}


def bare(value: Any) -> Any:
    """JSON without spans, without what is empty or exact, and objects that are no more than a name
    as that name."""
    if isinstance(value, dict):
        kept = {key: bare(part) for key, part in value.items() if key not in ("spans", "id")}
        kept = {k: p for k, p in kept.items() if isinstance(p, float) or p not in EMPTY}
        if kept.get("goal") == {"kind": "none"}:
            del kept["goal"]
        return kept["text"] if kept.keys() == {"text"} else kept
    if isinstance(value, list):
        return [bare(part) for part in value]
    return value


def bare_frames(frames: tuple[Frame, ...]) -> list[Any]:
    return [bare(frame.model_dump(mode="json")) for frame in frames]


def meant(case: dict[str, Any]) -> list[Any]:
    frames: list[Any] = bare(case.get("frames") or [case["frame"]])
    return frames


@pytest.mark.parametrize("theme", THEMES)
def test_sentences_mean_their_frames(theme: str) -> None:
    wrong = {
        case["text"]: found
        for case in read(theme)
        if (found := bare_frames(parse(case["text"]).frames)) != meant(case)
    }
    assert not wrong


@pytest.mark.parametrize("theme", THEMES)
def test_paraphrases_mean_the_same(theme: str) -> None:
    for case in read(theme):
        command = parse(case["text"])
        assert command.paraphrase == paraphrase(command.frames)
        again = parse(command.paraphrase)
        assert bare_frames(again.frames) == bare_frames(command.frames), command.paraphrase


@pytest.mark.parametrize("case", read("refused"), ids=lambda case: case["text"] or "nothing")
def test_sentence_is_refused(case: dict[str, Any]) -> None:
    with pytest.raises(ParseError) as caught:
        parse(case["text"])
    error = caught.value
    assert error.code == case["code"]
    assert error.message
    assert error.message == str(error)
    at = None if error.span is None else case["text"][slice(*error.span)]
    assert at == case["at"]


@pytest.mark.parametrize("case", read("out_of_domain"), ids=lambda case: case["text"])
def test_what_is_not_for_this_robot_is_refused(case: dict[str, Any]) -> None:
    with pytest.raises(ParseError) as caught:
        parse(case["text"])
    error = caught.value
    assert error.span is not None
    assert error.suggestions
    assert error.code == case.get("code", error.code)
    if case["about"]:
        first, last = error.span
        found = [m.span() for m in re.finditer(re.escape(case["about"]), case["text"])]
        assert any(first < end and start < last for start, end in found)


@pytest.mark.parametrize("case", read("typos"), ids=lambda case: case["text"])
def test_typo_is_pointed_at_and_set_right(case: dict[str, Any]) -> None:
    with pytest.raises(ParseError) as caught:
        parse(case["text"])
    error = caught.value
    assert error.span is not None
    assert case["text"][slice(*error.span)] == case["about"]
    assert any(case["suggests"] in suggestion for suggestion in error.suggestions)


def test_lists_are_long_enough_to_mean_something() -> None:
    texts = [case["text"] for case in UNDERSTOOD]
    assert len(set(texts)) == len(texts) >= 1000
    assert len(read("out_of_domain")) >= 250
    limits = [
        text
        for text, case in zip(texts, UNDERSTOOD, strict=True)
        for frame in meant(case)
        if TOPPLE_AND_TILT & {clause["kind"] for clause in frame.get("constraints", [])}
    ]
    assert len(set(limits)) >= 150

"""Each row of courtesy and each rewording of the lexicon is said by a sentence of the tests.

A phrase of which no sentence makes use is no knowledge of the language: it is not kept.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator
from functools import cache
from itertools import chain
from pathlib import Path
from typing import Any

import pytest
import yaml

from grammar import ParseError
from grammar.parser import Parser, default_parser, parser_for
from grammar.phrases import other_readings
from grammar.unbound_words import COURTESY, without_marks
from grammar.words.normalisation import normalise
from grammar.words.phrase_templates import template_pattern

TESTS = Path(__file__).parents[3]
NAMES = ("ice tea box", "mug", "tea tin", "free bottle", "coffee box", "cereal box", "soup can",
         "jar", "ice tea cup", "sugar box", "water bottle")  # fmt: skip
BEFORE = ("push the mug 5 cm to the left",)
"""What was said before, so that amounts without a unit have one."""


def _sentences() -> set[str]:
    """Sentences of the tests: of their data, and strings of the tests of language and talk."""
    said = set[str]()
    for path in (TESTS / "data" / "commands").glob("*.yaml"):
        said |= {case["text"] for case in yaml.safe_load(path.read_text("utf-8"))}
    path = TESTS / "data" / "dialogues" / "developing.yaml"
    for dialogue in chain.from_iterable(yaml.safe_load(path.read_text("utf-8")).values()):
        turns: list[Any] = dialogue["turns"] if isinstance(dialogue, dict) else dialogue
        said |= {turn["say"] for turn in turns}
    for folder in ("grammar", "nlcontrol/session", "nlcontrol/reports"):
        for path in (TESTS / "unit" / folder).rglob("test_*.py"):
            said |= set(_strings(path.read_text("utf-8")))
    return said


def _strings(source: str) -> Iterator[str]:
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


@cache
def _used() -> tuple[frozenset[str], frozenset[str]]:
    """The templates of rewordings that fire, and the words that are left out."""
    fired, left_out = set[str](), set[str]()
    found = other_readings._found

    def noted(templates: Iterable[str], text: str, **options: bool) -> list[re.Match[str]]:
        new = (each for each in templates if each not in fired)
        fired.update(each for each in new if found([each], text, **options))
        return found([*templates], text, **options)

    parsers: tuple[tuple[Parser, tuple[str, ...] | None], ...] = (
        (default_parser(), None), (parser_for(NAMES), BEFORE),
    )  # fmt: skip
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(other_readings, "_found", noted)
        for text in sorted(_sentences()):
            for parser, before in parsers:
                try:
                    left_out |= set(parser.parse(text, before).left_out)
                except ParseError:
                    continue
    return frozenset(fired), frozenset(left_out)


def test_each_rewording_is_used() -> None:
    rewordings = default_parser().lexicon.rewordings.values()
    assert [each for said in rewordings for each in said if each not in _used()[0]] == []


def test_each_row_of_courtesy_is_used() -> None:
    lexicon = default_parser().lexicon
    plain = (normalise(words, lexicon.contractions).text for words in _used()[1])
    said = [" ".join(re.findall(r"[^ ,.;!?]+", words)) for words in plain]
    rows = [each for kind in COURTESY for each in lexicon.asides[kind]]
    rows += [row for said_of in lexicon.asking.values() for row in said_of]
    assert [row for row in rows if not any(map(_pattern_of(row).search, said))] == []


def _pattern_of(row: str) -> re.Pattern[str]:
    return re.compile(rf"(?<![^ ])(?:{template_pattern(without_marks(row))})(?= |$)")


def test_no_row_of_courtesy_is_open() -> None:
    """No row holds any word that it does not list; a rewording of a command neither, unseen."""
    lexicon = default_parser().lexicon
    rows = [each for kind in COURTESY for each in lexicon.asides[kind]]
    assert [row for row in rows if "_" in row or "{" in row] == []

"""The stored table is that of the rules, and trees are those that lark makes of the same tokens."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import lark
import pytest
from lark.lexer import Lexer

from grammar.phrases import lalr_parser as module
from grammar.phrases.lalr_parser import (
    STORED,
    LalrParser,
    Tree,
    UnexpectedTokenError,
    grammar_source,
    parse_table,
    table_data,
)
from grammar.words.lexicon import default_lexicon
from grammar.words.normalisation import normalise
from grammar.words.phrase_lexer import Accepts, PhraseLexer, Token

LEXICON = default_lexicon()
SOURCE = grammar_source(LEXICON)
SENTENCES = [
    "push the box away",
    "please gently push the tall box 10 cm to the left, then topple it without touching the mug",
    "do not tilt, turn or topple it",
    "move it twice its width away and to the left with at most 5 N",
    "pour half of the milk into the mug until it is 80 percent full",
    "how hard must I push the can of soup to make it slide?",
    "what is the mass and the friction of the box?",
    "no, not the mug",
]


class Tokens(Lexer):
    """Hands on tokens that were found before."""

    def __init__(self, _: object) -> None:
        pass

    def lex(self, tokens: Any) -> Iterator[lark.Token]:  # type: ignore[override]
        return iter(tokens)


LARK = lark.Lark(SOURCE, parser="lalr", lexer=Tokens, maybe_placeholders=False)


def tree(text: str) -> Tree:
    parser = LalrParser(parse_table(), PhraseLexer(LEXICON))
    return parser.parse(normalise(text, LEXICON.contractions).text)


def nested(node: Any) -> Any:
    if isinstance(node, Tree):
        return node.name, [nested(child) for child in node.children]
    if isinstance(node, lark.Tree):
        return str(node.data), [nested(child) for child in node.children]
    return node.type, str(node)


def test_stored_table_is_that_of_the_rules() -> None:
    stored = json.loads(STORED.read_text(encoding="utf-8"))
    made = json.loads(json.dumps(table_data(SOURCE)))
    assert stored == made, "run python -m grammar.phrases.lalr_parser"


@pytest.mark.parametrize("text", SENTENCES)
def test_tree_is_that_of_lark(text: str) -> None:
    ours = tree(text)
    tokens: Any = [lark.Token(t.type, str(t)) for t in ours.leaves()]
    assert nested(ours) == nested(LARK.parse(tokens))


@pytest.mark.parametrize(
    "text", ["push the", "push the box 10", "of", "push the box away at", "push the box 5 blorps"]
)
def test_parser_accepts_what_lark_accepts(text: str) -> None:
    with pytest.raises(UnexpectedTokenError) as caught:
        tree(text)
    taken: Any = [lark.Token(t.type, str(t)) for t in tokens_of(text)]
    with pytest.raises(lark.UnexpectedToken) as expected:
        LARK.parse(taken)
    assert caught.value.token.type == expected.value.token.type
    assert caught.value.accepts == expected.value.accepts


def tokens_of(text: str) -> list[Token]:
    """The tokens of a text up to the one that the parser cannot take."""
    found: list[Token] = []

    class Recorder(PhraseLexer):
        def tokens(self, text: str, acceptance: Callable[[], Accepts]) -> Iterator[Token]:
            for token in super().tokens(text, acceptance):
                found.append(token)
                yield token

    with pytest.raises(UnexpectedTokenError):
        LalrParser(parse_table(), Recorder(LEXICON)).parse(text)
    return found


@pytest.mark.parametrize("content", ["", "no JSON", json.dumps({"digest": "of other rules"})])
def test_table_of_other_rules_is_not_used(
    content: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    known = parse_table()
    other = tmp_path / "parse_table.json"
    other.write_text(content, encoding="utf-8")
    monkeypatch.setattr(module, "STORED", other)
    assert parse_table.__wrapped__() == known


def test_table_is_made_without_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    known = parse_table()
    monkeypatch.setattr(module, "STORED", tmp_path / "missing.json")
    assert parse_table.__wrapped__() == known

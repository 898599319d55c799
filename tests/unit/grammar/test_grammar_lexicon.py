"""The lexicon: templates, terminals that do not hide one another, and words of a plug-in."""

from __future__ import annotations

from pathlib import Path
from typing import Any, get_args

import pytest
from lark import Lark

import grammar
from grammar.frames import Action, Goal
from grammar.lexicon import Lexicon, default_lexicon, expand
from grammar.parser import Parser

RULES = (Path(grammar.__file__).parent / "nlcontrol.lark").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("template", "phrases"),
    [
        ("push", ["push"]),
        ("(a|b) c", ["a c", "b c"]),
        ("a [b]", ["a", "a b"]),
        ("to (the|your) left [side]", [
            "to the left", "to the left side", "to your left", "to your left side",
        ]),
        ("away [from (me|you)]", ["away", "away from me", "away", "away from you"]),
    ],
)  # fmt: skip
def test_templates_expand(template: str, phrases: list[str]) -> None:
    assert sorted(expand(template)) == sorted(phrases)


def every_phrase() -> list[str]:
    lexicon = default_lexicon()
    names = ["VERB", *lexicon.terminals]
    return sorted({phrase for name in names for phrase in lexicon.phrases(name)})


def test_no_phrase_is_hidden_by_a_shorter_one() -> None:
    text = f"{RULES}\n{default_lexicon().grammar_terminals()}"
    lark = Lark(text, parser="lalr", lexer="basic")
    for phrase in every_phrase():
        assert [str(token) for token in lark.lex(phrase)] == [phrase]


def test_phrases_are_in_plain_form() -> None:
    for phrase in every_phrase():
        assert phrase == " ".join(phrase.split()).casefold()
        assert not set(phrase) - set("abcdefghijklmnopqrstuvwxyz ,°")


def test_verbs_give_actions_and_goals_of_the_contract() -> None:
    goals = {m.model_fields["kind"].default for m in get_args(get_args(Goal)[0])}
    for verb in default_lexicon().verbs.values():
        assert verb.action in get_args(Action)
        assert verb.goal in goals


def test_labels_name_terminals() -> None:
    lexicon = default_lexicon()
    assert lexicon.labels.keys() <= {"VERB", "WORD", "NUMBER", *lexicon.terminals}


def test_no_words_are_both_read_and_put_off() -> None:
    lexicon = default_lexicon()
    assert not lexicon.later_verbs & lexicon.verb_words()


def test_plug_in_adds_words() -> None:
    lexicon = default_lexicon().extended(
        verbs=[{"says": ["scoot"], "action": "slide", "goal": "displace"}],
        terminals={"DIRECTION": {"left": ["portside"]}},
    )
    (frame,) = Parser(lexicon).parse("scoot the box portside").frames
    assert frame.action == "slide"
    assert frame.goal.model_dump()["direction"] == "left"
    with pytest.raises(grammar.ParseError):
        grammar.parse("scoot the box")


@pytest.mark.parametrize(
    "more",
    [
        {"verbs": [{"says": ["push"], "action": "pull", "goal": "displace"}]},
        {"terminals": {"DIRECTION": {"away": ["left"]}}},
        {"terminals": {"COLOUR": {"red": ["red"]}}},
    ],
)
def test_plug_in_cannot_change_meanings(more: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"means both|no terminal"):
        default_lexicon().extended(**more)


def test_terminals_that_begin_with_one_another_are_refused() -> None:
    # "with" begins "with at" and "at" begins "at with": no order of the two finds both.
    lexicon = default_lexicon().extended(
        terminals={"WITH": {"": ["at with"]}, "AT": {"": ["with at"]}}
    )
    with pytest.raises(ValueError, match="begin with one another"):
        lexicon.grammar_terminals()


def test_lexicon_survives_yaml_s_own_words(tmp_path: Path) -> None:
    # YAML 1.1 would read an unquoted "no" or "on" as a truth value.
    source = Path(grammar.__file__).with_name("lexicon.yaml")
    copy = tmp_path / "lexicon.yaml"
    copy.write_text(source.read_text(encoding="utf-8"), encoding="utf-8")
    assert Lexicon.read(copy) == default_lexicon()
    assert "on" in default_lexicon().later_words

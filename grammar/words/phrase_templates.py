"""Templates of phrases: `(a|b)` is a choice, `[c]` may be left out, `<name>` stands for a rule."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from itertools import product
from typing import Any

_RULE = re.compile(r"<(\w+)>")
_MARK = re.compile(r"([()\[\]|])")
_BEGINNING = re.compile(r"[(\[]")
_OPTION = re.compile(r" \[([^\[\]]*)\]|\[([^\[\]]*)\] ")


def expand_template(template: str) -> list[str]:
    """The phrases of a template: `(a|b)` is a choice, `[c]` may be left out."""
    choices = _choices_of(iter(_MARK.split(template)))
    # What is left out leaves the spaces on both its sides.
    return [" ".join(each.split()) if "  " in each else each.strip() for each in choices]


def _choices_of(pieces: Iterator[str]) -> list[str]:
    """The phrases of the pieces of a template, marks and words, up to the end of a group."""
    choices: list[str] = []
    parts: list[list[str]] = []
    for piece in pieces:
        if piece in (")", "]"):
            break
        if piece == "|":
            choices += map("".join, product(*parts))
            parts = []
        elif piece in ("(", "["):
            parts.append([""] * (piece == "[") + _choices_of(pieces))
        elif piece:
            parts.append([piece])
    choices += map("".join, product(*parts))
    return choices


def with_rules(said: Any, rules: Mapping[str, str]) -> Any:
    """Words with the choices of the rules in the place of their names: "<can>"."""
    if isinstance(said, str):
        while "<" in said:
            said = _RULE.sub(lambda named: f"({rules[named[1]]})", said)
        return said
    if isinstance(said, list):
        return [with_rules(each, rules) for each in said]
    if isinstance(said, dict):
        return {key: with_rules(each, rules) for key, each in said.items()}
    return said


def first_words(template: str) -> set[str]:
    """The words and marks that the phrases of a template may begin with."""
    group = _BEGINNING.match(template)
    if group is None:
        word = template.split(maxsplit=1)[0]
        return set(".;!?") if word == "." else {word}
    depth, end, start, choices = 0, 0, 1, list[str]()
    for end, char in enumerate(template):
        depth += (char in "([") - (char in ")]")
        if depth == 0 or (depth == 1 and char == "|"):
            choices.append(template[start:end])
            start = end + 1
        if depth == 0:
            break
    rest = template[end + 1 :].strip()
    if group[0] == "[" and rest:
        choices.append(rest)
    return set().union(*map(first_words, filter(None, choices)))


def needed_words(template: str) -> list[frozenset[str]]:
    """Sets of words and marks of each of which every phrase of a template has at least one."""
    needed, start, depth = list[frozenset[str]](), 0, 0
    for end, char in enumerate(f"{template} "):
        depth += (char in "([") - (char in ")]")
        if depth or char != " ":
            continue
        piece, start = template[start:end], end + 1
        words = set[str]() if piece.startswith("[") else first_words(piece)
        if words and not any("_" in word or "{" in word for word in words):
            needed.append(frozenset(words))
    return needed


def template_pattern(template: str) -> str:
    """The regular expression of a template.

    `(a|b)` is a choice, `[c]` may be left out, and `_` is any word, or the beginning of one.
    """
    pattern = template.replace("(", "(?:")
    while option := _OPTION.search(pattern):
        last, first = option.groups()
        either = f"(?:(?:{first}) )?" if last is None else f"(?: (?:{last}))?"
        pattern = pattern[: option.start()] + either + pattern[option.end() :]
    return re.sub(r"(?<![a-z])_(?=[a-z ')|]|$)", "[a-z']+", pattern.replace(".", "[.;!?]"))

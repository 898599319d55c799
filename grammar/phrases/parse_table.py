"""The LALR table of the grammar, made by lark once and kept as JSON beside the rules.

`python -m grammar.phrases.parse_table` writes the file anew after a change of `nlcontrol.lark` or
of the terminals in the lexicon. A file of other rules or terminals is not used: the table is then
made at the start of the program, which takes some tenths of a second.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple

from grammar.words.lexicon import Lexicon, default_lexicon

RULES = Path(__file__).with_name("nlcontrol.lark")
STORED = Path(__file__).with_name("parse_table.json")

END = "$END"
"""Terminal behind the last token."""


class Rule(NamedTuple):
    """A rule of the grammar, as it is reduced.

    Attributes:
        origin: symbol on its left side.
        size: number of symbols on its right side.
        name: name of its node in the tree.
        is_expanded: whether a single child takes the place of the node.
        inlined: places of the children whose own children take their place.
    """

    origin: str
    size: int
    name: str
    is_expanded: bool
    inlined: list[int]


@dataclass(frozen=True)
class ParseTable:
    """An LALR(1) table.

    Attributes:
        rules: the rules of the grammar.
        states: for each state the symbols that may follow: the next state, or below zero the
            complement of the rule that is reduced.
        end: the state of a complete sentence; the first state is 0.
    """

    rules: list[Rule]
    states: list[dict[str, int]]
    end: int


def grammar_source(lexicon: Lexicon) -> str:
    """The grammar in lark's language: the rules, and the terminals of a lexicon as declarations."""
    return f"{RULES.read_text(encoding='utf-8')}\n{lexicon.declarations()}"


@cache
def parse_table() -> ParseTable:
    """The table of the language: the stored one, if it is that of its rules and terminals."""
    source = grammar_source(default_lexicon())
    try:
        stored = json.loads(STORED.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        stored = {}
    if stored.get("digest") != _digest(source):
        stored = table_data(source)
    sets, symbols = stored["sets"], stored["symbols"]
    states = [
        {symbols[s]: action for s, action in zip(shifts[::2], shifts[1::2], strict=True)}
        | {symbols[s]: ~rule for rule, follow in reductions for s in sets[follow]}
        for shifts, reductions in stored["states"]
    ]
    rules = [Rule(*rule) for rule in stored["rules"]]
    return ParseTable(rules, states, stored["end"])


def table_data(source: str) -> dict[str, Any]:
    """The table of a grammar as the JSON that is stored; equal sets of terminals stand once."""
    from lark import Lark
    from lark.parsers.lalr_analysis import Shift

    lark = Lark(source, parser="lalr", lexer="basic", maybe_placeholders=False)
    table = lark.parser.parser._parse_table
    places = {rule: i for i, rule in enumerate(lark.rules)}
    symbols = sorted({symbol for actions in table.states.values() for symbol in actions})
    numbers = {symbol: i for i, symbol in enumerate(symbols)}
    sets: dict[tuple[int, ...], int] = {}
    states = []
    # Lark numbers the states anew each time; here they stand in the order of a breadth-first walk.
    order = [table.start_states["start"]]
    reached = {order[0]: 0}
    for state in order:
        shifts: list[int] = []
        reductions: dict[int, list[int]] = {}
        for symbol, (action, argument) in sorted(table.states[state].items()):
            if action is Shift:
                if argument not in reached:
                    reached[argument] = len(order)
                    order.append(argument)
                shifts += [numbers[symbol], reached[argument]]
            else:
                reductions.setdefault(places[argument], []).append(numbers[symbol])
        follow = {rule: sets.setdefault(tuple(s), len(sets)) for rule, s in reductions.items()}
        states.append([shifts, sorted(follow.items())])
    return {
        "digest": _digest(source),
        "rules": [_reduced_rule(rule) for rule in lark.rules],
        "symbols": symbols,
        "sets": [list(known) for known in sets],
        "states": states,
        "end": reached[table.end_states["start"]],
    }


def _reduced_rule(rule: Any) -> Rule:
    inlined = [
        i
        for i, symbol in enumerate(rule.expansion)
        if not symbol.is_term and symbol.name.startswith("_")
    ]
    is_expanded = bool(rule.options.expand1 and not rule.alias)
    name = rule.alias or rule.origin.name
    return Rule(rule.origin.name, len(rule.expansion), name, is_expanded, inlined)


def _digest(source: str) -> str:
    return sha256(source.encode()).hexdigest()


def main() -> None:
    """Write the table of the language."""
    data = table_data(grammar_source(default_lexicon()))
    STORED.write_text(json.dumps(data, separators=(",", ":")) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

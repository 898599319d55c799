"""An LALR(1) parser that its lexer may ask with what it could go on, and its table.

Lark makes the table once; it is kept as JSON beside the rules. `python -m
grammar.phrases.lalr_parser` writes the file anew after a change of `nlcontrol.lark` or of the
terminals in the lexicon. A file of other rules or terminals is not used: the table is then made at
the start of the program, which takes some tenths of a second.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from functools import cache, lru_cache, partial
from hashlib import sha256
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

from grammar.words.lexicon import Lexicon, default_lexicon
from grammar.words.phrase_lexer import Accepts, PhraseLexer, Token

RULES = Path(__file__).with_name("nlcontrol.lark")
STORED = Path(__file__).with_name("parse_table.json")

REMEMBERED = 32768
"""Steps from states by a terminal that a parser remembers."""

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


class ParseTable(NamedTuple):
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


class Tree(NamedTuple):
    """A node of the parse tree.

    Attributes:
        name: of its rule.
        children: nodes and tokens, in the order of the text.
    """

    name: str
    children: list[Any]

    def leaves(self) -> Iterator[Token]:
        """Yield the tokens of the tree."""
        for child in self.children:
            yield from child.leaves() if isinstance(child, Tree) else [child]

    def transform(self, build: Callable[[str, list[Any]], Any]) -> Any:
        """Build the value of the tree, leaves first, from the names and children of its nodes."""
        children = [c.transform(build) if isinstance(c, Tree) else c for c in self.children]
        return build(self.name, children)


class UnexpectedTokenError(Exception):
    """A token with which the parser cannot go on.

    Attributes:
        token: the token.
    """

    def __init__(self, token: Token, accepted: Callable[[], frozenset[str]]) -> None:
        super().__init__(token)
        self.token = token
        self._accepted = accepted

    @property
    def accepts(self) -> frozenset[str]:
        """Terminals with which it could have gone on."""
        return self._accepted()


class LalrParser:
    """Parses texts by the table of a grammar; the lexer finds the tokens."""

    def __init__(self, table: ParseTable, lexer: PhraseLexer) -> None:
        self._table = table
        self._lexer = lexer
        # Sentences pass through the same states again and again.
        self._take_terminal = lru_cache(maxsize=REMEMBERED)(self._read_terminal)

    def parse(self, text: str) -> Tree:
        """Parse a text in plain form.

        Raises:
            UnexpectedTokenError: the grammar does not allow it.
        """
        states: tuple[int, ...] = (0,)
        values: list[Any] = []

        def acceptance() -> Accepts:
            before = states
            return lambda terminal: self._take_terminal(before, terminal)[0]

        end = Token(END, "", len(text), len(text))
        for token in chain(self._lexer.tokens(text, acceptance), [end]):
            taken, states, rules = self._take_terminal(states, token.type)
            if not taken:
                raise UnexpectedTokenError(token, partial(self._acceptable_terminals, states))
            for rule in rules:
                _reduce(values, rule)
            values.append(token)
        tree: Tree = values[0]
        return tree

    def _read_terminal(
        self, before: tuple[int, ...], terminal: str
    ) -> tuple[bool, tuple[int, ...], tuple[Rule, ...]]:
        """Check whether a terminal may come next; the states then, and the rules reduced before it.

        A state may reduce on a terminal that cannot stand there after all, so the reductions are
        followed to the end.
        """
        table, states, rules = self._table, [*before], list[Rule]()
        while (action := table.states[states[-1]].get(terminal)) is not None:
            if action >= 0:
                return True, (*states, action), tuple(rules)
            rule = table.rules[~action]
            rules.append(rule)
            del states[len(states) - rule.size :]
            states.append(table.states[states[-1]][rule.origin])
            if terminal == END and states[-1] == table.end:
                return True, tuple(states), tuple(rules)
        return False, tuple(states), tuple(rules)

    def _acceptable_terminals(self, states: tuple[int, ...]) -> frozenset[str]:
        """The terminals that may come next; rules have names in lower case."""
        known = (symbol for symbol in self._table.states[states[-1]] if symbol.isupper())
        return frozenset(t for t in known if self._take_terminal(states, t)[0])


def _reduce(values: list[Any], rule: Rule) -> None:
    """Put the node of a rule in the place of its children."""
    first = len(values) - rule.size
    children = values[first:]
    for i in reversed(rule.inlined):
        children[i : i + 1] = children[i].children
    single = rule.is_expanded and len(children) == 1
    values[first:] = [children[0] if single else Tree(rule.name, children)]


# --- the table --------------------------------------------------------------------------------


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
    if stored.get("digest") != sha256(source.encode()).hexdigest():
        stored = table_data(source)
    sets = [symbols.split() for symbols in stored["sets"]]
    states = [{s: action for action, i in state for s in sets[i]} for state in stored["states"]]
    return ParseTable([Rule(*rule) for rule in stored["rules"]], states, stored["end"])


def table_data(source: str) -> dict[str, Any]:
    """The table of a grammar as the JSON that is stored.

    A state is a list of actions, each with the place of its symbols among the `sets`.
    """
    from lark import Lark
    from lark.parsers.lalr_analysis import Shift

    lark = Lark(source, parser="lalr", lexer="basic", maybe_placeholders=False)
    table = lark.parser.parser._parse_table
    places = {rule: i for i, rule in enumerate(lark.rules)}
    sets: dict[str, int] = {}
    states = []
    # Lark numbers the states anew each time; here they stand in the order of a breadth-first walk.
    order = {table.start_states["start"]: 0}
    for state in (walk := list(order)):
        actions: dict[int, list[str]] = {}
        for symbol, (action, argument) in sorted(table.states[state].items()):
            if action is Shift and argument not in order:
                order[argument] = len(order)
                walk.append(argument)
            number = order[argument] if action is Shift else ~places[argument]
            actions.setdefault(number, []).append(symbol)
        states.append([[a, sets.setdefault(" ".join(s), len(sets))] for a, s in actions.items()])
    return {
        "digest": sha256(source.encode()).hexdigest(),
        "rules": [_reduced_rule(rule) for rule in lark.rules],
        "sets": list(sets),
        "states": states,
        "end": order[table.end_states["start"]],
    }


def _reduced_rule(rule: Any) -> Rule:
    symbols, alias = rule.expansion, rule.alias
    inlined = [i for i, s in enumerate(symbols) if not s.is_term and s.name.startswith("_")]
    is_expanded = bool(rule.options.expand1 and not alias)
    return Rule(rule.origin.name, len(symbols), alias or rule.origin.name, is_expanded, inlined)


if __name__ == "__main__":
    data = table_data(grammar_source(default_lexicon()))
    STORED.write_text(json.dumps(data, separators=(",", ":")) + "\n", encoding="utf-8")

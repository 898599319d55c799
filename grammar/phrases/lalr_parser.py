"""An LALR(1) parser that its lexer may ask with what it could go on."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import cache
from typing import Any, NamedTuple

from grammar.phrases.parse_table import END, ParseTable
from grammar.words.phrase_lexer import PhraseLexer, Token


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
            if isinstance(child, Tree):
                yield from child.leaves()
            else:
                yield child

    def transform(self, build: Callable[[str, list[Any]], Any]) -> Any:
        """Build the value of the tree, leaves first, from the names and children of its nodes."""
        children = [c.transform(build) if isinstance(c, Tree) else c for c in self.children]
        return build(self.name, children)


class UnexpectedTokenError(Exception):
    """A token with which the parser cannot go on.

    Attributes:
        token: the token.
        accepts: terminals with which it could have gone on.
    """

    def __init__(self, token: Token, accepts: frozenset[str]) -> None:
        super().__init__(token)
        self.token = token
        self.accepts = accepts


class LalrParser:
    """Parses texts by an LALR table.

    Args:
        table: of the grammar.
        lexer: finds the tokens.
    """

    def __init__(self, table: ParseTable, lexer: PhraseLexer) -> None:
        self._table = table
        self._lexer = lexer

    def parse(self, text: str) -> Tree:
        """Parse a text.

        Args:
            text: in plain form.

        Raises:
            UnexpectedTokenError: the grammar does not allow it.
        """
        stack = _Stack(self._table)
        for token in self._lexer.tokens(text, stack.acceptance):
            stack.feed(token)
        stack.feed(Token(END, "", len(text), len(text)))
        return stack.tree()


class _Stack:
    """The stack of states of a parse, and the values that belong to them."""

    def __init__(self, table: ParseTable) -> None:
        self._table = table
        self._states = [0]
        self._values: list[Any] = []

    def acceptance(self) -> Callable[[str], bool]:
        """A function that checks whether a terminal may come next; it is asked again and again."""
        return cache(self._can_shift)

    def feed(self, token: Token) -> None:
        """Take one more token.

        Raises:
            UnexpectedTokenError: it cannot stand here.
        """
        states = self._table.states
        while True:
            action = states[self._states[-1]].get(token.type)
            if action is None:
                raise UnexpectedTokenError(
                    token, self._acceptable_terminals(states[self._states[-1]])
                )
            if action >= 0:
                self._states.append(action)
                self._values.append(token)
                return
            self._reduce(~action)
            if token.type == END and self._states[-1] == self._table.end:
                return

    def tree(self) -> Tree:
        """The tree of all tokens, behind the end of the text."""
        tree: Tree = self._values[-1]
        return tree

    def _reduce(self, number: int) -> None:
        rule = self._table.rules[number]
        children: list[Any] = []
        first = len(self._values) - rule.size
        for i, value in enumerate(self._values[first:]):
            children += value.children if i in rule.inlined else [value]
        del self._values[first:], self._states[first + 1 :]
        single = rule.is_expanded and len(children) == 1
        self._values.append(children[0] if single else Tree(rule.name, children))
        self._states.append(self._table.states[self._states[-1]][rule.origin])

    def _acceptable_terminals(self, symbols: Iterable[str]) -> frozenset[str]:
        """The terminals among symbols that may come next; rules have names in lower case."""
        return frozenset(s for s in symbols if s.isupper() and self._can_shift(s))

    def _can_shift(self, terminal: str) -> bool:
        """Check whether a terminal may come next.

        A state may reduce on a terminal that cannot stand there after all, so the reductions are
        followed to the end.
        """
        table, stack = self._table, self._states
        while True:
            action = table.states[stack[-1]].get(terminal)
            if action is None:
                return False
            if action >= 0:
                return True
            rule = table.rules[~action]
            stack = stack[: len(stack) - rule.size]
            stack = [*stack, table.states[stack[-1]][rule.origin]]
            if terminal == END and stack[-1] == table.end:
                return True

"""The most of a text that is read as a command, where the whole is not read.

A text falls into parts at its marks and before words that join. Of those of its parts that together
are a command the longest are taken, unless what is left out forbids or restricts it. It is not what
was said, and only good to be offered.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from grammar.frames.command import Command
    from grammar.parser import Parser

_END = re.compile(r"(?<=[,.;:!?])\s+|\s+(?=(?:and|but|so|because|since|which|then|while|if)\s)")

_MOST_PARTS = 7
"""Parts of a text of which any may be left out; of a longer one only those at its ends."""

_MOST_TRIED = 40
"""Texts that are tried, so that none takes long."""


def understood_part(parser: Parser, text: str, before: Sequence[str]) -> Command | None:
    """The command of the most of a text that is read; None if no part of it is a command."""
    for tried, (part, left) in enumerate(_shorter(_END.split(text))):
        if tried == _MOST_TRIED:
            return None
        if parser.has_effect(left):
            continue
        command = parser.command_if_read(part, before)
        acts = command and any(frame.action or frame.query for frame in command.frames)
        if command and acts and parser.knows_names_of(command):
            return command
    return None


def _shorter(parts: list[str]) -> Iterator[tuple[str, str]]:
    """Yield a text without some of its parts, those with the most letters first, and these."""
    n = len(parts)
    if n <= _MOST_PARTS:
        kept = [each for k in range(1, n) for each in combinations(range(n), k)]
    else:
        kept = [tuple(range(i, j)) for i in range(n) for j in range(i + 1, n + 1) if j - i < n]
    kept.sort(key=lambda chosen: -sum(len(parts[i]) for i in chosen))
    for chosen in kept:
        left = " , ".join(part for i, part in enumerate(parts) if i not in chosen)
        yield " ".join(parts[i] for i in chosen), left

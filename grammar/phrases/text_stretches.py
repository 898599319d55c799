"""Stretches of a text: the parts between marks, and what stands around a part."""

from __future__ import annotations

import re
from collections.abc import Sequence

from grammar.frames.command import Span


def match_end(match: re.Match[str] | None) -> int:
    """The end of a match; 0 if there is none."""
    return match.end() if match else 0


def parts_between(text: str, span: Span, end: re.Pattern[str]) -> list[Span]:
    """The parts of a stretch of a text up to each end, with the mark there."""
    ends = [mark.end() for mark in end.finditer(text, *span)]
    return list(zip([span[0], *(each + 1 for each in ends)], [*ends, span[1]], strict=True))


def without_ends(span: Span, heads: Sequence[int], tails: Sequence[int]) -> Span:
    """A stretch without the longest of what is told before it and behind it."""
    start = max(heads, default=span[0])
    return start, min((end for end in tails if end > start), default=span[1])


def parts_around(inner: Span, outer: Span) -> list[Span]:
    """The parts of a stretch before and behind an inner part of it."""
    parts = [(outer[0], inner[0] - 1), (inner[1] + 1, outer[1])]
    return [(start, end) for start, end in parts if start < end]


def splits_at(text: str, span: Span, pause: re.Pattern[str]) -> list[tuple[Span, Span]]:
    """Each pair of parts of a stretch of a text with a pause between them."""
    ends = [end for _, end in parts_between(text, span, pause)[:-1]]
    return [((span[0], end), (end + 1, span[1])) for end in ends]

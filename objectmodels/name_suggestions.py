"""Names that a mistyped one may have meant."""

from __future__ import annotations

from collections.abc import Iterable

CUTOFF = 75.0
"""Similarity below which a name is not worth suggesting, of 100."""

TIE = 5.0
"""Names this close to the best one in similarity are as likely meant as it."""


def fold_text(text: str) -> str:
    """Text for comparing: case and the amount of white space do not count."""
    return " ".join(text.casefold().split())


def suggest(text: str, names: Iterable[str]) -> tuple[str, ...]:
    """Names that `text` may have meant, best first; several if they are about equally likely.

    Args:
        text: what was written.
        names: what would have been valid.
    """
    from rapidfuzz import fuzz  # only needed after a mistake

    wanted = fold_text(text)
    scores = sorted(((fuzz.ratio(wanted, fold_text(name)), name) for name in names), reverse=True)
    least = max(CUTOFF, scores[0][0] - TIE) if scores else CUTOFF
    return tuple(name for score, name in scores if score >= least)

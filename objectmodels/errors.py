"""The base of all errors, that of this package, and names that may have been meant."""

from __future__ import annotations

from collections.abc import Iterable

CUTOFF = 75.0
"""Similarity below which a name is not worth suggesting, of 100."""

TIE = 5.0
"""Names this close to the best one in similarity are as likely meant as it."""


class NlcontrolError(Exception):
    """Whatever nlcontrol raises on purpose; each package derives its own error from it.

    Attributes:
        code: stable name of the kind of error in snake case.
        message: one plain sentence.
        suggestions: what would have been right.
    """

    code: str
    message: str
    suggestions: tuple[str, ...]


class ModelError(NlcontrolError, ValueError):
    """A model, a model file or a question to a model that makes no sense.

    Attributes:
        code: snake_case name of the kind of error, e.g. `unknown_object`, `bad_value`.
        message: one plain sentence.
        path: file and key the error is about, if it came from a file.
        suggestions: what would have been valid.
    """

    def __init__(
        self,
        code: str,
        message: str,
        *,
        suggestions: tuple[str, ...],
        path: str | None = None,
    ) -> None:
        super().__init__(code, message)
        self.code = code
        self.message = message
        self.path = None if path is None else printable(path)
        self.suggestions = suggestions

    def __str__(self) -> str:
        where = f"{self.path}: " if self.path else ""
        hint = f" ({'; '.join(self.suggestions)})" if self.suggestions else ""
        return f"{where}{self.message}{hint}"


def printable(text: str) -> str:
    """A text with signs that would steer a terminal, or cannot be written, as escapes."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


def fold_text(text: str) -> str:
    """Text for comparing: case and the amount of white space do not count."""
    return " ".join(text.casefold().split())


def suggest(text: str, names: Iterable[str]) -> tuple[str, ...]:
    """Names that `text` may have meant, best first; several if they are about equally likely."""
    from rapidfuzz import fuzz  # only needed after a mistake

    wanted = fold_text(text)
    scores = sorted(((fuzz.ratio(wanted, fold_text(name)), name) for name in names), reverse=True)
    least = max(CUTOFF, scores[0][0] - TIE) if scores else CUTOFF
    return tuple(name for score, name in scores if score >= least)

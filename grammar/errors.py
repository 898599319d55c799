"""The one error of this package: a sentence that is not understood."""

from __future__ import annotations

from grammar.frames.command import Span, Spans
from objectmodels.errors import NlcontrolError


class ParseError(NlcontrolError):
    """A sentence, or a part of it, cannot be read.

    Attributes:
        code: what is wrong, a stable name in snake case.
        message: the same as a sentence.
        span: where in the sentence as given, `[start, end)` in code points; None if it is about
            the whole.
        spans: every place that it is about; two for a contradiction.
        suggestions: what might have been meant, or could stand there.
        path: the place in a document of frames, if it is about one.
    """

    def __init__(
        self,
        code: str,
        message: str,
        span: Span | None,
        suggestions: tuple[str, ...],
        *,
        spans: Spans = (),
        path: str | None = None,
    ) -> None:
        super().__init__(message)
        self.code = code
        self.message = message
        self.span = span
        self.spans = spans or (() if span is None else (span,))
        self.suggestions = suggestions
        self.path = path

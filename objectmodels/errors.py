"""The error of this package: what is wrong with a model, where, and what would have been right."""

from __future__ import annotations


class ModelError(ValueError):
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
        path: str | None = None,
        suggestions: tuple[str, ...] = (),
    ) -> None:
        super().__init__(code, message)
        self.code = code
        self.message = message
        self.path = path
        self.suggestions = suggestions

    def __str__(self) -> str:
        where = f"{self.path}: " if self.path else ""
        hint = f" ({'; '.join(self.suggestions)})" if self.suggestions else ""
        return f"{where}{self.message}{hint}"

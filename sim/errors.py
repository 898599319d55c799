"""Errors of this package's callers, and of machines that lack something."""

from __future__ import annotations

from objectmodels.errors import NlcontrolError


class SimError(NlcontrolError):
    """Something that is asked for cannot be had.

    Attributes:
        code: a short name of the kind.
        message: what is wrong, with the file and the key.
        suggestions: what would be possible instead.
    """

    def __init__(self, code: str, message: str, suggestions: tuple[str, ...]) -> None:
        super().__init__(message)
        self.code = code
        self.message = message
        self.suggestions = suggestions

    def __reduce__(self) -> tuple[type[SimError], tuple[str, str, tuple[str, ...]]]:
        """So that it comes home from another process."""
        return type(self), (self.code, self.message, self.suggestions)


class SceneError(SimError):
    """A scene cannot be read: `unknown_scene` or `bad_scene`."""


class PictureError(SimError):
    """A picture cannot be drawn: `no_pictures` (the machine lacks a renderer) or `bad_picture`."""

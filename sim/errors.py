"""What the caller of this package did wrong, or what the machine lacks."""

from __future__ import annotations


class SimError(Exception):
    """Something that is asked for cannot be had.

    Attributes:
        code: a short name of the kind.
        message: what is wrong, with the file and the key.
        suggestions: what would be possible instead.
    """

    def __init__(self, code: str, message: str, suggestions: tuple[str, ...] = ()) -> None:
        super().__init__(message)
        self.code = code
        self.message = message
        self.suggestions = suggestions


class SceneError(SimError):
    """A scene cannot be read: `unknown_scene` or `bad_scene`."""


class PictureError(SimError):
    """A picture cannot be drawn: `no_pictures` (the machine lacks a renderer) or `bad_picture`."""

"""Goals that take a whole hand."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from grammar.frames.command import Frame

HAND_GOALS = {
    "lift": "lifting",
    "set_down": "putting down",
    "place": "lifting",
    "pour": "pouring from",
    "open": "opening",
    "close": "closing",
}
"""What each does to its object, in words."""


def is_handled(frame: Frame) -> bool:
    """Return True if a frame asks for a whole hand; what is placed may also be pushed there."""
    return frame.goal.kind in HAND_GOALS and (frame.goal.kind != "place" or frame.action == "place")

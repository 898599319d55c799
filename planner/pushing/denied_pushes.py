"""Pushes that the hand does not get to, so that others much like them are not asked for.

Frames: W, its table plane.
"""

from __future__ import annotations

import math

from planner.geometry.directions import angle_between
from planner.pushing.push_paths import PathSegment, moved_along
from planner.pushing.turn_planner import TurnStroke
from planner.types.refusal import Refusal
from planner.types.world_state import SeenObject

_ALIKE = 0.05  # half the depth of a hand: pushes that begin nearer to each other meet the same [m]
_SAME_WAY = math.radians(6.0)  # pushes whose headings differ by less go alike
_SHORTER = 0.5  # a push may be made if it is shorter than this share of one like it that is not
_SAME_SPOT, _SAME_HEADING = 1e-4, 1e-3  # objects that stand so near stand alike [m], [rad]


def is_denied(refusal: Refusal) -> bool:
    """Return True if a push was refused since the hand does not get there."""
    return refusal.reason in ("out_of_reach", "blocked")


class DeniedPushes:
    """The segments of paths and the parts of turns to which the hand does not get."""

    def __init__(self) -> None:
        self._segments: list[tuple[SeenObject, PathSegment]] = []
        self._strokes: list[tuple[SeenObject, TurnStroke]] = []

    def forget_segments(self) -> None:
        """Lets all segments be asked for again."""
        self._segments.clear()

    def note_segment(self, target: SeenObject, segment: PathSegment) -> None:
        """Takes note of a segment that begins where an object stands."""
        self._segments.append((target, segment))

    def note_stroke(self, target: SeenObject, stroke: TurnStroke) -> None:
        """Takes note of a part of a turn."""
        self._strokes.append((target, stroke))

    def cover_path(self, target: SeenObject, path: tuple[PathSegment, ...]) -> bool:
        """Return True if a push of a path is much like one of them."""
        for segment in path:
            for there, denied in self._segments:
                if (
                    _apart(target, there) < _ALIKE
                    and abs(angle_between(segment.heading, denied.heading)) <= _SAME_WAY
                    and segment.distance >= _SHORTER * denied.distance
                ):
                    return True
            target = moved_along(target, segment)
        return False

    def cover_turn(self, target: SeenObject, steps: tuple[TurnStroke, ...]) -> bool:
        """Return True if a part of a turn is one of them, or more of one."""
        for stroke in steps:
            for there, denied in self._strokes:
                if (
                    stroke.side.face == denied.side.face
                    and stroke.angle / denied.angle >= 1.0
                    and _apart(target, there) < _SAME_SPOT
                    and abs(angle_between(target.pose.yaw, there.pose.yaw)) < _SAME_HEADING
                ):
                    return True
            target = stroke.target_after(target)
        return False


def _apart(target: SeenObject, there: SeenObject) -> float:
    """Distance between two places of an object [m]."""
    return math.dist(target.pose.p_WB, there.pose.p_WB)

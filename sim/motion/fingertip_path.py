"""The way of the fingertips during a push or a tilt, and how the palm turns.

Model: a push that turns an object goes along an arc, since a fingertip that sticks to the object
and keeps its direction relative to it makes the object turn about a point at rest; see
`objectmodels.mechanics.push_motion`. All other pushes go straight. While an object is tilted about
the far edge of its base, that edge does not slide.

Frames: W is the world, B the object's, T the midpoint of the pushing fingertips' centres. D is the
frame of a push: x into the touched face, z up.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from objectmodels.geometry.rotations import Array, rot_z
from planner.types.actions import Push
from planner.types.world_state import SeenObject

STANDOFF = 0.03
"""Distance before the face at which the guarded approach begins [m]."""

BACK = 0.03
"""Distance by which the fingertips leave the face [m]."""

_STROKE_POINTS = np.array([0.0, 0.25, 0.5, 0.75, 1.0])  # shares at which the arm is looked at


@dataclass(frozen=True)
class FingertipPath:
    """Path of the midpoint of the fingertips in W, and turn of the palm along it.

    Attributes:
        inward: unit vector to which the hand is square: into the touched face, as that should look
            at the end of a straight push; horizontal, or down onto a top face.
        start: before the face; `touch`: at the face; `end`: after the stroke.
        turn: angle by which the palm turns about the vertical during the stroke, evenly [rad]; the
            stroke is then an arc.
    """

    inward: Array
    start: Array
    touch: Array
    end: Array
    turn: float = 0.0

    @classmethod
    def from_push(cls, push: Push, target: SeenObject, tip_radius: float) -> FingertipPath:
        """The way of a push on an object that is seen somewhere, for fingertips of a radius [m].

        A push that turns the object goes along the arc on which the stroke is used up when it has
        turned; the real one is shorter.
        """
        outward = np.array(push.normal_W)
        contact = target.pose.R_WB @ np.array(push.p_BC) + target.pose.p_WB
        touch = contact + tip_radius * outward
        along = push.stroke * np.array(push.direction_W)
        if push.ends_on == "turned":
            half = 0.5 * push.turn
            chord = np.sinc(half / np.pi) * rot_z(half) @ along
            end = contact + chord + tip_radius * rot_z(push.turn) @ outward
            return cls(-outward, touch + STANDOFF * outward, touch, end, turn=push.turn)
        inward = -(rot_z(push.turn) @ outward if push.ends_on == "stroke" else outward)
        return cls(inward, touch - STANDOFF * inward, touch, touch + along)

    def raised_by(self, height: float) -> FingertipPath:
        """The same so much higher [m]."""
        up = np.array([0.0, 0.0, height])
        return replace(self, start=self.start + up, touch=self.touch + up, end=self.end + up)

    @property
    def R_WD(self) -> Array:
        """Orientation of the push's frame D when the hand touches, shape (3, 3).

        That of a hand that presses from above looks along the way.
        """
        x, y, _ = self.inward if self.inward[2] == 0.0 else self.end - self.touch
        return rot_z(np.arctan2(y, x))

    def points_at(self, shares: Array = _STROKE_POINTS) -> Array:
        """Start, and the stroke at shares of it, shape (1 + n, 3)."""
        half, chord = 0.5 * self.turn, self.end - self.touch
        sines = np.sinc(shares * half / np.pi) / np.sinc(half / np.pi)
        turned = rot_z((shares - 1.0) * half) @ chord
        return np.vstack([self.start, self.touch + (shares * sines)[:, None] * turned])

    def turns_at(self, shares: Array = _STROKE_POINTS) -> Array:
        """Turn of the palm at these points, shape (1 + n,) [rad]."""
        return np.append(0.0, shares * self.turn)


@dataclass(frozen=True, eq=False)
class TiltArc:
    """The arc on which a fingertip goes while it tilts an object.

    Seen along the edge, T keeps the distance `length` + r from the plane through the edge that is
    parallel to the touched face, wherever on the face it slips to; so where T is tells the tilt.

    Attributes:
        origin: p_WT at the touch, the object upright, shape (3,) [m].
        u: horizontal unit direction of the push in W, shape (3,).
        length: from the touched face to the far edge [m].
        tip_radius: of the fingertip [m].
    """

    origin: Array
    u: Array
    length: float
    tip_radius: float

    @property
    def edge_distance(self) -> float:
        """Distance of T behind the edge at the touch [m]."""
        return self.length + self.tip_radius

    @property
    def arc_radius(self) -> float:
        """Distance of T from the edge [m]."""
        return float(np.hypot(self.edge_distance, self.origin[2]))

    def tip_at(self, angle: float) -> Array:
        """p_WT at a tilt [rad], if it sticks to the face, shape (3,) [m]."""
        up = float(self.origin[2])
        c, s = np.cos(angle), np.sin(angle)
        point = self.origin + (self.edge_distance - (self.edge_distance * c - up * s)) * self.u
        return np.array([point[0], point[1], self.edge_distance * s + up * c])

    def contact_heights(self, tips: Array) -> Array:
        """Heights in B at which fingertips p_WT, shape (n, 3), touch the face, shape (n,) [m]."""
        x, h = self._seen_from_edge(tips)
        return np.sqrt(np.maximum(x * x + h * h - self.edge_distance**2, 0.0))

    def tilt_angles(self, tips: Array) -> Array:
        """Tilts at which fingertips p_WT, shape (n, 3) [m], touch the face, shape (n,) [rad]."""
        x, h = self._seen_from_edge(tips)
        return np.asarray(
            np.arctan2(h, x) - np.arctan2(self.contact_heights(tips), self.edge_distance)
        )

    def _seen_from_edge(self, tips: Array) -> tuple[Array, Array]:
        """Distances behind the edge and above the table, shape (n,) each [m]."""
        return self.edge_distance - (tips - self.origin) @ self.u, tips[:, 2]

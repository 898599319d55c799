"""The hand while it waits, and postures that differ from it by a few fingers."""

from __future__ import annotations

import functools
from collections.abc import Mapping

import numpy as np

from sim.hands.four_finger.hand_kinematics import FINGERS, finger_points
from sim.hands.hand_model import Angles, Posture

CURLED: Angles = (0.0, 1.40, 1.60)
"""A finger that is out of the way [rad]."""

_THUMB_AWAY: Angles = (0.0, -0.65, 0.0)

RESTING = Posture(
    "resting", dict.fromkeys(FINGERS, CURLED) | {"thumb": _THUMB_AWAY}, (), np.zeros((0, 3))
)
"""The hand while it waits."""


def touching_posture(name: str, angles: Mapping[str, Angles], pushing: tuple[str, ...]) -> Posture:
    """The posture with some angles of all fingers, of which some touch."""
    tips = np.array([finger_points(finger, angles[finger])[3] for finger in pushing])
    return Posture(name, angles, pushing, tips)


def bent_posture(name: str, pushing: Mapping[str, Angles]) -> Posture:
    """The resting hand with some fingers bent to push."""
    return touching_posture(name, {**RESTING.angles, **pushing}, tuple(pushing))


@functools.cache
def finger_posture(finger: str, flexion: tuple[float, float]) -> Posture:
    """A posture with one finger bent and the others out of the way.

    Args:
        finger: one of `FINGERS`.
        flexion: of its proximal and middle joint [rad].
    """
    name = f"{finger} bent by {flexion[0]:.2f} and {flexion[1]:.2f}"
    return bent_posture(name, {finger: (0.0, *flexion)})

"""The hand in a posture: resting or with some fingers bent, and the spheres that cover it.

Every link is covered a little beyond its collision shape in `four_finger_hand.urdf`; a test holds
the two together. Frame: P is the palm.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Mapping

import numpy as np

from sim.collision.collision_spheres import sphere_row
from sim.hands.four_finger.hand_kinematics import (
    FINGERS,
    LINK_RADIUS,
    TIP_RADIUS,
    finger_points,
)
from sim.hands.hand_model import Angles, Posture
from sim.rotations import Array

CURLED: Angles = (0.0, 1.40, 1.60)
"""A finger that is out of the way [rad]."""

_THUMB_AWAY: Angles = (0.0, -0.65, 0.0)

RESTING = Posture(
    "resting", dict.fromkeys(FINGERS, CURLED) | {"thumb": _THUMB_AWAY}, (), np.zeros((0, 3))
)
"""The hand while it waits."""

FLANGE_TO_PALM = 0.03
"""Distance from the flange to the palm's origin, along z [m]."""

_PALM_RADIUS = 0.022
_WRIST_RADIUS = 0.05
_SPACING = 0.010

# A pushing finger may come near the face only at its tip: this much more room per metre from it,
# up to a largest allowance, keeps a finger nearly parallel to the face from touching it twice.
_OPENING, _OPENING_FROM, _OPENING_MOST = 0.2, 0.012, 0.012
_TIP_ZONE = 0.006


def touching_posture(name: str, angles: Mapping[str, Angles], pushing: tuple[str, ...]) -> Posture:
    """The posture with some angles of all fingers, of which some touch."""
    tips = np.array([finger_points(finger, angles[finger])[3] for finger in pushing])
    return Posture(name, angles, pushing, tips)


def bent_posture(name: str, pushing: Mapping[str, Angles]) -> Posture:
    """The resting hand with some fingers bent to push."""
    return touching_posture(name, {**RESTING.angles, **pushing}, tuple(pushing))


@functools.lru_cache(maxsize=64)
def hand_spheres(posture: Posture, wrist: float) -> Array:
    """Spheres of palm, thumb block, wrist and fingers in P, shape (n, 4).

    The pushing fingertips themselves are left out, since they are meant to touch. `wrist` is the
    distance from the arm's wrist to its flange, which is covered too [m].
    """
    parts = [_palm_spheres(wrist)]
    for finger in FINGERS:
        points = finger_points(finger, posture.angles[finger])
        links = np.vstack(
            [sphere_row(a, b, LINK_RADIUS, _SPACING) for a, b in itertools.pairwise(points)]
        )
        if finger in posture.pushing:
            from_tip = np.linalg.norm(links[:, :3] - points[-1], axis=1)
            links[:, 3] += np.clip(_OPENING * (from_tip - _OPENING_FROM), 0.0, _OPENING_MOST)
            links = links[from_tip > _TIP_ZONE]
        else:
            links[:, 3] += 0.004
            links = np.vstack([links, [*points[-1], TIP_RADIUS]])
        parts.append(links)
    return np.vstack(parts)


def whole_spheres(posture: Posture, wrist: float) -> Array:
    """The same with the pushing fingertips, which come last, shape (n, 4)."""
    tips = np.column_stack([posture.tips, np.full(len(posture.tips), TIP_RADIUS)])
    return np.vstack([hand_spheres(posture, wrist), tips])


def thin_spheres(posture: Posture, wrist: float) -> Array:
    """Spheres of the whole hand in P, its fingers as thin as they are, shape (n, 4)."""
    fingers = [finger_points(finger, posture.angles[finger]) for finger in FINGERS]
    links = [
        sphere_row(a, b, LINK_RADIUS, _SPACING)
        for each in fingers
        for a, b in itertools.pairwise(each)
    ]
    return np.vstack([_palm_spheres(wrist), *links])


@functools.cache
def _palm_spheres(wrist: float) -> Array:
    y, z = np.meshgrid(np.linspace(-0.036, 0.036, 4), np.linspace(0.010, 0.105, 5))
    palm = np.column_stack([np.zeros(y.size), y.ravel(), z.ravel()])
    block = sphere_row(np.array([0.02, 0.0, 0.052]), np.array([0.078, 0.0, 0.052]), 0.027, 0.015)
    behind = sphere_row(
        np.array([0.0, 0.0, -FLANGE_TO_PALM - wrist]),
        np.array([0.0, 0.0, -0.005]),
        _WRIST_RADIUS,
        0.025,
    )
    return np.vstack([np.column_stack([palm, np.full(len(palm), _PALM_RADIUS)]), block, behind])

"""The robot as spheres, and their distance from boxes and from the table.

Model: every link is covered by a row or a grid of spheres, a little larger than its collision
shape in the URDF files (a test holds the two together); an object is the box that the robot
believes it to be. That is all that planning a motion needs, and it takes whole arrays.

Frames: hand spheres in the palm frame P, arm spheres in the arm's base frame A or in W.
"""

from __future__ import annotations

import functools
import itertools

import numpy as np

from sim.arms.lwr import lwr_kinematics as arm
from sim.hands.four_finger.hand_kinematics import (
    FINGERS,
    FLANGE_TO_PALM,
    LINK_RADIUS,
    TIP_RADIUS,
    Posture,
    finger_points,
)
from sim.rotations import Array

ARM_RADIUS = 0.065
"""Radius of the arm's links, a little more than that of their capsules [m]."""

_PALM_RADIUS = 0.022
_WRIST_RADIUS = 0.05
_SPACING = 0.010

# A pushing finger may come near the face only at its tip: this much more room per metre from it,
# up to a largest allowance, keeps a finger nearly parallel to the face from touching it twice.
_OPENING, _OPENING_FROM, _OPENING_MOST = 0.2, 0.012, 0.012
_TIP_ZONE = 0.006


def row(start: Array, end: Array, radius: float, spacing: float) -> Array:
    """Spheres along a segment, shape (n, 4): centre and radius [m]."""
    n = max(2, int(np.ceil(np.linalg.norm(end - start) / spacing)) + 1)
    t = np.linspace(0.0, 1.0, n)[:, None]
    return np.hstack([start + (end - start) * t, np.full((n, 1), radius)])


@functools.lru_cache(maxsize=64)
def hand_spheres(posture: Posture) -> Array:
    """Spheres of palm, thumb block, wrist and fingers in P, shape (n, 4).

    The pushing fingertips themselves are left out, since they are meant to touch.
    """
    parts = [_palm_spheres()]
    for finger in FINGERS:
        points = finger_points(finger, posture.angles[finger])
        links = np.vstack([row(a, b, LINK_RADIUS, _SPACING) for a, b in itertools.pairwise(points)])
        if finger in posture.pushing:
            from_tip = np.linalg.norm(links[:, :3] - points[-1], axis=1)
            links[:, 3] += np.clip(_OPENING * (from_tip - _OPENING_FROM), 0.0, _OPENING_MOST)
            links = links[from_tip > _TIP_ZONE]
        else:
            links[:, 3] += 0.004
            links = np.vstack([links, [*points[-1], TIP_RADIUS]])
        parts.append(links)
    return np.vstack(parts)


def tip_spheres(posture: Posture) -> Array:
    """Spheres of the pushing fingertips in P, shape (k, 4)."""
    return np.column_stack([posture.tips, np.full(len(posture.tips), TIP_RADIUS)])


def whole_hand(posture: Posture) -> Array:
    """Spheres of the whole hand in P, the pushing fingertips last, shape (n, 4)."""
    return np.vstack([hand_spheres(posture), tip_spheres(posture)])


def bare_hand(posture: Posture) -> Array:
    """Spheres of the whole hand in P, its fingers as thin as they are, shape (n, 4)."""
    fingers = [finger_points(finger, posture.angles[finger]) for finger in FINGERS]
    links = [
        row(a, b, LINK_RADIUS, _SPACING) for each in fingers for a, b in itertools.pairwise(each)
    ]
    return np.vstack([_palm_spheres(), *links])


def _palm_spheres() -> Array:
    y, z = np.meshgrid(np.linspace(-0.036, 0.036, 4), np.linspace(0.010, 0.105, 5))
    palm = np.column_stack([np.zeros(y.size), y.ravel(), z.ravel()])
    block = row(np.array([0.02, 0.0, 0.052]), np.array([0.078, 0.0, 0.052]), 0.027, 0.015)
    wrist = row(
        np.array([0.0, 0.0, -FLANGE_TO_PALM - arm.FLANGE]),
        np.array([0.0, 0.0, -0.005]),
        _WRIST_RADIUS,
        0.025,
    )
    return np.vstack([np.column_stack([palm, np.full(len(palm), _PALM_RADIUS)]), block, wrist])


def arm_spheres(q: Array) -> Array:
    """Spheres of the arm from its elbow to its wrist in A, shape (..., n, 4).

    The links above the shoulder stay within the mount's reach and far from the table.

    Args:
        q: joint angles, shape (..., 7) [rad].
    """
    _, _, joints = arm.forward(q)
    shoulder, elbow, wrist = joints[..., 1, :], joints[..., 3, :], joints[..., 5, :]
    t = np.linspace(0.0, 1.0, 8)[:, None]
    upper = shoulder[..., None, :] + (elbow - shoulder)[..., None, :] * t[4:]
    lower = elbow[..., None, :] + (wrist - elbow)[..., None, :] * t[1:]
    centres = np.concatenate([upper, lower], axis=-2)
    return np.concatenate([centres, np.full((*centres.shape[:-1], 1), ARM_RADIUS)], axis=-1)


def placed(spheres: Array, R: Array, p: Array) -> Array:
    """Spheres brought into another frame: R shape (..., 3, 3), p shape (..., 3)."""
    centres = spheres[..., :3] @ np.swapaxes(R, -1, -2) + p[..., None, :]
    radii = np.broadcast_to(spheres[..., 3:], (*centres.shape[:-1], 1))
    return np.concatenate([centres, radii], axis=-1)


def distance_to_box(spheres: Array, low: Array, high: Array) -> Array:
    """Signed distance of spheres from an axis-aligned box, shape (...) [m].

    Args:
        spheres: shape (..., 4), in the box's own axes.
        low: its corner of least coordinates, shape (3,) [m].
        high: the opposite corner.
    """
    centre = spheres[..., :3]
    outside = np.maximum(low - centre, centre - high)
    far = np.linalg.norm(np.maximum(outside, 0.0), axis=-1)
    near = np.minimum(outside.max(axis=-1), 0.0)
    return np.asarray(far + near - spheres[..., 3])


def distance_to_prism(spheres: Array, outline: Array, height: float) -> Array:
    """Signed distance of spheres from an upright prism on the table, shape (...) [m].

    Args:
        spheres: shape (..., 4), in the prism's frame.
        outline: convex, its corners counter-clockwise, shape (k, 2) [m].
        height: of the prism [m].
    """
    low, high = outline.min(axis=0), outline.max(axis=0)
    if len(outline) == 4 and ((outline == low) | (outline == high)).all():
        return distance_to_box(spheres, np.append(low, 0.0), np.append(high, height))
    x, y = spheres[..., 0], spheres[..., 1]
    across, beside = np.full(x.shape, -np.inf), np.full(x.shape, np.inf)
    for (a_x, a_y), (b_x, b_y) in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        along = np.array([b_x - a_x, b_y - a_y])
        length = np.hypot(*along)
        e_x, e_y = along / length
        across = np.maximum(across, (x - a_x) * e_y - (y - a_y) * e_x)
        t = np.clip((x - a_x) * e_x + (y - a_y) * e_y, 0.0, length)
        beside = np.minimum(beside, np.hypot(x - a_x - t * e_x, y - a_y - t * e_y))
    return _distance_upright(np.where(across > 0.0, beside, across), spheres, height)


def distance_to_cylinder(spheres: Array, radius: float, height: float) -> Array:
    """Signed distance of spheres from an upright cylinder on the table, shape (...) [m].

    Args:
        spheres: shape (..., 4), in the cylinder's frame.
        radius: of the cylinder [m].
        height: of the cylinder [m].
    """
    level = np.hypot(spheres[..., 0], spheres[..., 1]) - radius
    return _distance_upright(level, spheres, height)


def _distance_upright(level: Array, spheres: Array, height: float) -> Array:
    """Signed distance from an upright solid, from the one in its horizontal section."""
    z = spheres[..., 2]
    over = np.maximum(-z, z - height)
    far = np.hypot(np.maximum(level, 0.0), np.maximum(over, 0.0))
    return np.asarray(far + np.minimum(np.maximum(level, over), 0.0) - spheres[..., 3])


def height_above_table(spheres: Array) -> Array:
    """Distance of spheres from the plane z = 0, shape (...) [m]."""
    return np.asarray(spheres[..., 2] - spheres[..., 3])

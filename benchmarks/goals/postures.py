"""Is there any hand at all that stands behind a fingertip, clear of everything?

Finer than the robot's own search, and less strict: finger angles and orientations of the palm are
drawn anywhere within their limits (of two fingertips, which are level, the palm turns about the
line between them), elbows lie 5° apart, and the hand only has to be clear at the beginning, in the
middle and at the end of a stroke: of the others by what a look may be off, of what is fragile by
what the robot always keeps, else by no distance. Its fingers may press up or down by half of what
they press along the stroke; the robot's by a third. How it gets there, how well it feels the push
and how much room the joints have is not asked.

Frames: see `sim.motion.inverse_kinematics`.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from benchmarks.worlds.strokes import Array, Generator, Stroke
from objectmodels.geometry.rotations import rot_x, rot_y, rot_z
from planner.types.world_state import WorldState
from sim.motion.collision_scene import FRAGILE_CLEARANCE
from sim.robots.cell_description import RobotMount, Vision
from sim.robots.collision_spheres import (
    distance_to_prism,
    height_above_table,
    place_spheres,
)
from sim.robots.finger_kinematics import FINGER_LIMITS, bent_posture
from sim.robots.four_finger_hand import pushing_quality, two_finger_postures
from sim.robots.hand import Mount, Posture
from sim.robots.robots import ARM, HAND

UNSEEN = Vision().position_noise_m
"""A distance that no single look tells from none [m]."""

SKEW = 0.5
"""Largest vertical force of a fingertip that sticks per force along the stroke."""

POSTURES, ORIENTATIONS = 80, 250
"""Random finger angles, and orientations for each of them."""

_ELBOWS = np.radians(np.arange(-180.0, 180.0, 5.0))
_SHARES = (0.0, 0.5, 1.0)  # of the stroke, where the hand must be clear
_AT_ONCE = 40  # hands whose arms are solved together


def reachable(
    stroke: Stroke, fingers: int, robot: RobotMount, state: WorldState, rng: Generator
) -> bool:
    """Whether some hand and arm could make a stroke.

    Args:
        stroke: of the fingertips.
        fingers: how many.
        robot: and its mount.
        state: where everything stands; the object that is pushed moves ahead of the hand.
        rng: to draw from.
    """
    mount = Mount.from_cell(robot, ARM, HAND)
    points = [stroke.start + share * (stroke.end - stroke.start) for share in _SHARES]
    R_WD = rot_z(stroke.heading)
    for posture in _postures(fingers, rng):
        R_DP = _orientations(fingers, rng)
        _, skew, _ = pushing_quality(posture, R_DP)
        R_WP = R_WD @ R_DP[skew < SKEW]
        free = _clear_hands(posture, R_WP, points, stroke.object, state)
        for some in np.array_split(R_WP[free], max(1, -(-int(free.sum()) // _AT_ONCE))):
            if len(some) and _arm_reaches(mount, posture, some, points, stroke.object, state):
                return True
    return False


def _postures(fingers: int, rng: Generator) -> Iterator[Posture]:
    if fingers == 2:
        for spread in HAND.finger_spreads:
            yield from two_finger_postures(spread)
        return
    low, high = FINGER_LIMITS.T
    for _ in range(POSTURES):
        finger = ("index", "middle", "ring")[int(rng.integers(3))]
        abduction, proximal, middle = rng.uniform(low, high).tolist()
        yield bent_posture("drawn", {finger: (abduction, proximal, middle)})


def _orientations(fingers: int, rng: Generator) -> Array:
    """Palms in the push's frame: fingers down, leaned any way but away from the push."""
    tilt, side = rng.uniform(-np.pi / 2, np.pi / 2, (2, ORIENTATIONS))
    roll = rng.uniform(-np.pi, np.pi, ORIENTATIONS)
    if fingers == 2:
        side, roll = np.zeros(ORIENTATIONS), np.where(roll > 0.0, 0.0, np.pi)
    return np.asarray(rot_x(side) @ rot_y(-tilt) @ np.diag([1.0, -1.0, -1.0]) @ rot_z(roll))


def _clear_hands(
    posture: Posture, R_WP: Array, points: list[Array], pushed: str, state: WorldState
) -> NDArray[np.bool_]:
    """Which orientations keep the hand clear at all points of the stroke."""
    free = np.ones(len(R_WP), dtype=bool)
    parts = HAND.spheres(posture)
    middle = posture.tips.mean(axis=0)
    for k, point in enumerate(points):
        placed = place_spheres(parts, R_WP, point - R_WP @ middle)
        free &= _are_clear(placed, pushed, k, state)
    return free


def _arm_reaches(
    mount: Mount,
    posture: Posture,
    R_WP: Array,
    points: list[Array],
    pushed: str,
    state: WorldState,
) -> bool:
    """Whether one arm solution stays within its limits and clear, at all points."""
    n = len(R_WP)
    elbow = np.tile(_ELBOWS, n)
    R = np.repeat(R_WP, len(_ELBOWS), axis=0)
    tip = R @ posture.tips.mean(axis=0)
    ok = np.ones((len(R), mount.arm.branches), dtype=bool)
    for k, point in enumerate(points):
        q, valid = mount.arm.inverse(*mount.flange_poses(R, point - tip), elbow)
        ok &= valid
        if not ok.any():
            return False
        rows = np.nonzero(ok)
        ok[rows] = _are_clear(mount.arm_spheres(q[rows]), pushed, k, state)
    return bool(ok.any())


def _are_clear(placed: Array, pushed: str, point: int, state: WorldState) -> NDArray[np.bool_]:
    """Which sets of spheres in W are clear of the table and of the objects at a point."""
    clear = np.asarray(height_above_table(placed).min(axis=-1) > 0.0)
    for name, seen in state.objects.items():
        if name == pushed and point > 0:  # it has moved on
            continue
        apart = FRAGILE_CLEARANCE if seen.fragile else UNSEEN
        R_BW = seen.pose.R_WB.T
        inside = place_spheres(placed, R_BW, -R_BW @ seen.pose.p_WB)
        distances = distance_to_prism(inside, seen.model.outline, seen.model.top)
        clear &= distances.min(axis=-1) > (0.0 if name == pushed else apart)
    return clear

"""A map of where the arm brings the hand, for questions that need no certainty.

Model: at the middle of a cell of place, height and heading, the room to the joint limits that the
arm has with the best of some hands, an empty table taken for granted. A sample of the hands and
every other elbow angle tell that. Cells are looked at when they are first asked for, and kept for
all robots mounted alike; what is kept changes the time of an answer, never the answer.

Frames: W is the world.
"""

from __future__ import annotations

import functools

import numpy as np

from sim.arms.arm_kinematics import ArmKinematics
from sim.cell.cell_description import RobotMount
from sim.collision.collision_scene import TABLE_CLEARANCE
from sim.hands.hand_model import Hand
from sim.hands.mount import Mount
from sim.motion.ik_search import in_range, solve_poses
from sim.rotations import Array, rot_z

CELL = 0.04
"""Length of a cell along each axis [m]."""

TURNS = 24
"""Headings in a full turn."""

_SAMPLED = 32  # hands


class ReachabilityMap:
    """The map of one mount.

    Args:
        mount: of the arm.
    """

    def __init__(self, mount: Mount) -> None:
        self._mount = mount
        self._kept: dict[tuple[int, ...], float] = {}

    def room_at(self, fingers: int, spread: float, point: Array, heading: float) -> float:
        """Room to the joint limits at about a place; 0 if none of the hands gets there [rad].

        Args:
            fingers: how many push.
            spread: distance between the outer fingertips [m].
            point: of T in W, shape (3,) [m].
            heading: of the normal into the touched face [rad].
        """
        i, j, k = np.floor(point / CELL).astype(int).tolist()
        turn = round(heading * TURNS / (2.0 * np.pi)) % TURNS
        cell = (fingers, round(1e6 * spread), i, j, k, turn)
        if cell not in self._kept:
            middle = CELL * (np.array([i, j, k]) + 0.5)
            R_WD = rot_z(turn * 2.0 * np.pi / TURNS)
            self._kept[cell] = self._best_room(fingers, spread, middle, R_WD)
        return self._kept[cell]

    def _best_room(self, fingers: int, spread: float, point: Array, R_WD: Array) -> float:
        arm = self._mount.arm
        every = self._mount.hand.pushing_postures(fingers, spread)
        near = in_range(self._mount, every, R_WD[None], point[None])
        near &= point[2] + every.lowest_points > TABLE_CLEARANCE
        if not near.any():
            return 0.0
        some = np.flatnonzero(near)
        some = some[np.linspace(0, len(some) - 1, min(_SAMPLED, len(some))).astype(int)]
        elbows = arm.redundancy_samples[::2]
        sampled = every[np.repeat(some, len(elbows))]
        angles = np.tile(elbows, len(some))
        q, usable = solve_poses(self._mount, sampled, R_WD[None], point[None], angles)
        room = np.where(usable, arm.joint_room(q), 0.0)
        return float(room.max())


@functools.lru_cache(maxsize=16)
def reachability_map(robot: RobotMount, arm: ArmKinematics, hand: Hand) -> ReachabilityMap:
    """The map of an arm with a hand that is mounted somewhere; always the same one."""
    return ReachabilityMap(Mount.from_cell(robot, arm, hand))

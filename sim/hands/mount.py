"""The mounted robot: an arm on its base with a hand on its flange, and where it waits.

Frames: W is the world, A the arm's base, F its flange, P the palm.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.arms.arm_kinematics import ArmKinematics
from sim.cell.cell_description import RobotMount
from sim.collision.collision_spheres import place_spheres
from sim.errors import SceneError
from sim.hands.hand_model import Hand
from sim.rotations import Array, rot_x, rot_y, rot_z


@dataclass(frozen=True, eq=False)
class Mount:
    """An arm with n joints and a hand, and where its base stands.

    Attributes:
        arm: on the base.
        hand: on the arm's flange.
        R_WA: orientation of the base, shape (3, 3).
        p_WA: its place, shape (3,) [m].
        home: joint angles of the arm while it waits, shape (n,) [rad].
    """

    arm: ArmKinematics
    hand: Hand
    R_WA: Array
    p_WA: Array
    home: Array

    @classmethod
    def from_cell(cls, cell: RobotMount, arm: ArmKinematics, hand: Hand) -> Mount:
        """The mount that a cell's description names.

        Raises:
            SceneError: the cell's joint angles are not as many as the arm's joints.
        """
        given, joints = len(cell.home_deg), len(arm.joint_names)
        if given != joints:
            message = f"robot.home_deg: {given} joint angles, and the arm has {joints} joints"
            hint = f"give robot.home_deg {joints} angles"
            raise SceneError("bad_scene", message, (hint,))
        roll, pitch, yaw = np.radians(cell.base_rpy_deg)
        R_WA = rot_z(yaw) @ rot_y(pitch) @ rot_x(roll)
        return cls(arm, hand, R_WA, np.array(cell.base_m), np.radians(cell.home_deg))

    @functools.cached_property
    def p_PW(self) -> Array:
        """Centre of the arm's wrist in P, shape (3,) [m]."""
        return np.asarray(self.hand.R_FP.T @ (self.arm.p_FW - self.hand.p_FP))

    def flange_poses(self, R_WP: Array, p_WP: Array) -> tuple[Array, Array]:
        """Flange poses in A for palm poses in W, shapes (..., 3, 3) and (..., 3)."""
        R_WF = R_WP @ self.hand.R_FP.T
        p_WF = p_WP - R_WF @ self.hand.p_FP
        return self.R_WA.T @ R_WF, (p_WF - self.p_WA) @ self.R_WA

    def palm_poses(self, q: Array) -> tuple[Array, Array]:
        """Palm poses in W for arm angles, shapes (..., 3, 3) and (..., 3)."""
        R_AF, p_AF = self.arm.forward(q)
        R_WF = self.R_WA @ R_AF
        p_WF = p_AF @ self.R_WA.T + self.p_WA
        return R_WF @ self.hand.R_FP, p_WF + R_WF @ self.hand.p_FP

    def solve_palm(
        self,
        R_WP: Array,
        p_WP: Array,
        redundancy: Array,
        branch: NDArray[np.intp] | None = None,
    ) -> tuple[Array, NDArray[np.bool_]]:
        """Arm angles that bring the palm along n paths of w poses.

        Args:
            R_WP: shape (n, w, 3, 3).
            p_WP: shape (n, w, 3) [m].
            redundancy: of the arm along each path, shape (n,) [rad].
            branch: of the arm along each path, shape (n,); all if not given.

        Returns:
            Angles, shape (n, w, branches, joints) [rad], and which of them reach their pose away
            from the arm's singularities, shape (n, w, branches).
        """
        R_AF, p_AF = self.flange_poses(R_WP, p_WP)
        n, w = p_AF.shape[:2]
        q, valid = self.arm.inverse(
            R_AF.reshape(-1, 3, 3),
            p_AF.reshape(-1, 3),
            np.repeat(redundancy, w),
            None if branch is None else np.repeat(branch, w)[:, None],
        )
        usable = np.asarray(valid & self.arm.is_regular(q))
        return q.reshape(n, w, *q.shape[1:]), usable.reshape(n, w, *usable.shape[1:])

    def arm_spheres(self, q: Array) -> Array:
        """Spheres of the arm in W for arm angles, shape (..., k, 4)."""
        return place_spheres(self.arm.spheres(q), self.R_WA, self.p_WA)

    def robot_spheres(self, hand_P: Array, q: Array) -> Array:
        """Spheres of hand and arm in W for arm angles (n, joints) [rad], shape (n, k, 4).

        Those of the hand come first; in P they have the shape (h, 4).
        """
        hand = place_spheres(hand_P, *self.palm_poses(q))
        return np.concatenate([hand, self.arm_spheres(q)], axis=-2)

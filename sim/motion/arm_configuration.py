"""How arm and hand stand while they push: one family of poses along the path of the fingertips.

The palm keeps its orientation, or turns about the vertical with an object that is turned.

Frames: W is the world, A the arm's base, F its flange, P the palm, T the midpoint of the pushing
fingertips' centres. D is the frame of a push: x into the touched face, z up.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.arms.lwr import lwr_kinematics as arm
from sim.cell.cell_description import RobotMount
from sim.hands.four_finger.hand_kinematics import (
    FLANGE_TO_PALM,
    R_FP,
    TIP_RADIUS,
    Angles,
    Posture,
    force_noise_gain,
    tip_stiffness,
)
from sim.rotations import Array, rot_x, rot_y, rot_z


class UnreachableError(Exception):
    """The hand cannot be brought to a pose in this stance."""


@dataclass(frozen=True)
class Mount:
    """Where the arm's base stands: R_WA, shape (3, 3), and p_WA, shape (3,) [m]."""

    R_WA: Array
    p_WA: Array

    @classmethod
    def of(cls, robot: RobotMount) -> Mount:
        """The mount that a scene's robot has."""
        roll, pitch, yaw = np.radians(robot.base_rpy_deg)
        return cls(rot_z(yaw) @ rot_y(pitch) @ rot_x(roll), np.array(robot.base_m))

    def flange(self, R_WP: Array, p_WP: Array) -> tuple[Array, Array]:
        """Flange poses in A for palm poses in W, shapes (n, 3, 3) and (n, 3)."""
        R_WF = R_WP @ R_FP.T
        p_WF = p_WP - FLANGE_TO_PALM * R_WF[..., :, 2]
        return self.R_WA.T @ R_WF, (p_WF - self.p_WA) @ self.R_WA

    def palm(self, q: Array) -> tuple[Array, Array]:
        """Palm poses in W for arm angles of shape (..., 7)."""
        R_AF, p_AF, _ = arm.forward(q)
        R_WF = self.R_WA @ R_AF
        p_WF = p_AF @ self.R_WA.T + self.p_WA
        return R_WF @ R_FP, p_WF + FLANGE_TO_PALM * R_WF[..., :, 2]


@dataclass(frozen=True)
class ArmConfiguration:
    """A hand posture, the palm's orientation and the arm's branch; fingertips may go anywhere.

    Attributes:
        mount: of the arm.
        posture: of the hand.
        R_WP: orientation of the palm before it turns, shape (3, 3).
        elbow: angle of the elbow [rad].
        branch: which of the arm's eight solutions.
        lift: height of T from which the hand descends [m].
        via: arm angles between home and there, around obstacles.
    """

    mount: Mount
    posture: Posture
    R_WP: Array
    elbow: float
    branch: int
    lift: float
    via: tuple[Array, ...] = ()

    def joints(self, p_WT: Array, turned: float = 0.0) -> Array:
        """Arm angles that bring T to a point in W, shape (7,) [rad].

        Args:
            p_WT: the point, shape (3,) [m].
            turned: angle by which the palm is turned about the vertical there [rad].

        Raises:
            UnreachableError: the arm does not get there in this stance.
        """
        R_WP = rot_z(turned) @ self.R_WP if turned else self.R_WP
        p_WP = p_WT - R_WP @ self.posture.midpoint
        R_AF, p_AF = self.mount.flange(R_WP, p_WP)
        q, valid = arm.inverse(R_AF[None], p_AF[None], np.array([self.elbow]), [self.branch])
        if not valid[0, 0]:
            at = ", ".join(f"{1e3 * x:.0f}" for x in p_WT)
            raise UnreachableError(f"the arm does not bring the fingertips to ({at}) mm")
        return np.asarray(q[0, 0])

    def stiffness(self, direction_W: Array) -> float:
        """Force per displacement of the pushing fingers along a unit direction in W [N/m]."""
        along = self.R_WP.T @ direction_W
        each = [along @ tip_stiffness(*c) @ along for c in self._contacts(along)]
        return float(sum(each))

    def force_noise_gain(self, direction_W: Array) -> float:
        """Noise of the force felt by all fingers per noise of a torque sensor [1/m]."""
        along = self.R_WP.T @ direction_W
        each = [float(force_noise_gain(*c, along)) for c in self._contacts(along)]
        return float(np.linalg.norm(each))

    def _contacts(self, along_P: Array) -> list[tuple[str, Angles, Array]]:
        """Finger, angles and contact point in P of each pushing finger."""
        return [
            (finger, self.posture.angles[finger], tip + TIP_RADIUS * along_P)
            for finger, tip in zip(self.posture.pushing, self.posture.tips, strict=True)
        ]

"""Arm and hand while they push: one family of poses along the path of the fingertips.

The palm keeps its orientation, or turns about the vertical with an object that is turned.

Frames: W is the world, A the arm's base, F its flange, P the palm, T the midpoint of the pushing
fingertips' centres. D is the frame of a push: x into the touched face, z up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim.hands.hand_model import Angles, Posture
from sim.hands.mount import Mount
from sim.rotations import Array, rot_z


class UnreachableError(Exception):
    """The hand cannot be brought to a pose in this stance."""


@dataclass(frozen=True)
class ArmConfiguration:
    """A hand posture, the palm's orientation and the arm's branch; fingertips may go anywhere.

    Attributes:
        mount: of the arm.
        posture: of the hand.
        R_WP: orientation of the palm before it turns, shape (3, 3).
        elbow: redundancy angle of the arm [rad].
        branch: which of the arm's solutions.
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

    def joint_angles(self, p_WT: Array, turned: float = 0.0) -> Array:
        """Arm angles that bring T to a point in W, shape (n,) [rad].

        Args:
            p_WT: the point, shape (3,) [m].
            turned: angle by which the palm is turned about the vertical there [rad].

        Raises:
            UnreachableError: the arm does not get there in this stance.
        """
        R_WP = rot_z(turned) @ self.R_WP if turned else self.R_WP
        p_WP = p_WT - R_WP @ self.posture.tip_midpoint
        R_AF, p_AF = self.mount.flange_poses(R_WP, p_WP)
        q, valid = self.mount.arm.inverse(
            R_AF[None], p_AF[None], np.array([self.elbow]), [self.branch]
        )
        if not valid[0, 0]:
            at = ", ".join(f"{1e3 * x:.0f}" for x in p_WT)
            raise UnreachableError(f"the arm does not bring the fingertips to ({at}) mm")
        return np.asarray(q[0, 0])

    def robot_spheres(self, q: Array) -> Array:
        """Spheres of hand and arm in W for arm angles (n, joints), shape (n, k, 4)."""
        return self.mount.robot_spheres(self.mount.hand.whole_spheres(self.posture), q)

    def push_stiffness(self, direction_W: Array) -> float:
        """Force per displacement of the pushing fingers along a unit direction in W [N/m]."""
        along, hand = self.R_WP.T @ direction_W, self.mount.hand
        each = [along @ hand.tip_stiffness(*c) @ along for c in self._contact_points(along)]
        return float(sum(each))

    def bend(self, force_W: Array) -> Array:
        """Way by which a fingertip stays behind its command under the force that it exerts, (3,).

        The force [N] is that on what is touched, in W, shape (3,), and shared by all fingers.
        """
        along, hand = self.R_WP.T @ force_W, self.mount.hand
        unit = along / np.linalg.norm(along)
        whole = sum(hand.tip_stiffness(*contact) for contact in self._contact_points(unit))
        return np.asarray(self.R_WP @ np.linalg.solve(whole, along))

    def reaches_bent(self, points: Array, forces: Sequence[Array]) -> bool:
        """True if T can be commanded so that it is at points, (n, 3), whichever force bends it."""
        try:
            for force in forces:
                for point in points + self.bend(force):
                    self.joint_angles(point)
        except UnreachableError:
            return False
        return True

    def force_noise_gain(self, direction_W: Array) -> float:
        """Noise of the force felt by all fingers per noise of a torque sensor [1/m]."""
        along, hand = self.R_WP.T @ direction_W, self.mount.hand
        each = [float(hand.force_noise_gain(*c, along)) for c in self._contact_points(along)]
        return float(np.linalg.norm(each))

    def _contact_points(self, along_P: Array) -> list[tuple[str, Angles, Array]]:
        """Finger, angles and contact point in P of each pushing finger."""
        radius = self.mount.hand.tip_radius
        return [
            (finger, self.posture.angles[finger], tip + radius * along_P)
            for finger, tip in zip(self.posture.pushing, self.posture.tips, strict=True)
        ]

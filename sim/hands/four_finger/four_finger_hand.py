"""The four-finger hand behind the protocol of `sim.hands.hand_model`."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import resources
from importlib.resources.abc import Traversable

import numpy as np

from sim.hands.four_finger import hand_kinematics as kinematics
from sim.hands.four_finger.flip_postures import flip_postures
from sim.hands.four_finger.grasp_postures import (
    HOLDING,
    NARROWEST,
    WIDEST,
    FourFingerGrasp,
    closing_direction,
    grasp_posture,
)
from sim.hands.four_finger.hand_posture import (
    FLANGE_TO_PALM,
    RESTING,
    hand_spheres,
    thin_spheres,
    whole_spheres,
)
from sim.hands.four_finger.pushing_postures import FINGER_SPREADS, LARGEST_SKEW, pushing_postures
from sim.hands.hand_model import Angles, FlipPostureSet, Posture, PostureSet
from sim.paths.lid_arc_path import LidShape
from sim.rotations import Array


@dataclass(frozen=True)
class FourFingerHand:
    """The four-finger hand on some arm; see `sim.hands.hand_model.Hand`.

    Attributes:
        wrist: distance from the arm's wrist to its flange, which the hand's spheres cover [m].
    """

    wrist: float

    fingers = kinematics.FINGERS
    grasp_fingers = HOLDING
    tip_radius = kinematics.TIP_RADIUS
    finger_spreads = FINGER_SPREADS
    force_skew = LARGEST_SKEW
    grasp_widths = (NARROWEST, WIDEST)
    # The palm is turned by π on the flange.
    R_FP = np.diag([-1.0, -1.0, 1.0])
    p_FP = np.array([0.0, 0.0, FLANGE_TO_PALM])
    palm_link = "palm"
    resting = RESTING

    @property
    def model_file(self) -> Traversable:
        """URDF model of the hand."""
        return resources.files("sim") / "hands" / "four_finger" / "four_finger_hand.urdf"

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the independent joints, three of each finger."""
        return tuple(joint for finger in self.fingers for joint in self.model_joints(finger)[:3])

    def model_joints(self, finger: str) -> tuple[str, ...]:
        """Names of a finger's four joints; the distal one follows the middle one."""
        return tuple(f"{finger}_{joint}" for joint in kinematics.FINGER_JOINTS)

    def model_angles(self, angles: Angles) -> Angles:
        """Angles of a finger's four joints [rad]."""
        return (*angles, angles[-1])

    def pushing_postures(self, fingers: int, spread: float, *, fine: bool = False) -> PostureSet:
        """See `pushing_postures`."""
        return pushing_postures(fingers, spread, fine=fine, wrist=self.wrist)

    def grasp_posture(self, width: float, *, pinch: bool = False) -> FourFingerGrasp | None:
        """See `grasp_postures`."""
        return grasp_posture(width, pinch=pinch, wrist=self.wrist)

    def flip_postures(self, lid: LidShape) -> FlipPostureSet:
        """See `flip_postures`."""
        return flip_postures(lid, self.wrist)

    def closing_direction(self, finger: str) -> Array:
        """Direction in which a finger presses on what is held, in P, shape (3,)."""
        return closing_direction(finger)

    def tip_centre(self, finger: str, angles: Angles) -> Array:
        """Centre of a fingertip in P, shape (3,) [m]."""
        return np.asarray(kinematics.finger_points(finger, angles)[3])

    def tip_force(self, finger: str, angles: Angles, p_PC: Array, torques: Array) -> Array:
        """Force at a point of a fingertip from its joints' torques, J⁻ᵀτ, in P, shape (3,) [N]."""
        J = kinematics.finger_jacobian(finger, angles, p_PC)
        return np.asarray(np.linalg.solve(J.T, torques))

    def tip_stiffness(self, finger: str, angles: Angles, p_PC: Array) -> Array:
        """Force at points of a fingertip per displacement, in P, shape (..., 3, 3) [N/m]."""
        return kinematics.tip_stiffness(finger, angles, p_PC)

    def force_noise_gain(self, finger: str, angles: Angles, p_PC: Array, along_P: Array) -> Array:
        """Noise of the force felt along unit directions per noise of a torque sensor [1/m]."""
        return kinematics.force_noise_gain(finger, angles, p_PC, along_P)

    def is_at_stop(self, angles: Angles) -> bool:
        """True if a joint of a finger is at its stop."""
        return kinematics.is_at_stop(angles)

    def spheres(self, posture: Posture) -> Array:
        """Spheres of the hand in P with room about its fingers, without the pushing tips."""
        return hand_spheres(posture, self.wrist)

    def whole_spheres(self, posture: Posture) -> Array:
        """The same with the pushing fingertips, which come last."""
        return whole_spheres(posture, self.wrist)

    def thin_spheres(self, posture: Posture) -> Array:
        """Spheres of the whole hand in P, its fingers as thin as they are."""
        return thin_spheres(posture, self.wrist)

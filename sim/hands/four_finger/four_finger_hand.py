"""The four-finger hand behind the protocol of `sim.hands.hand_model`."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import resources

import numpy as np

from sim.hands.four_finger import hand_kinematics as kinematics
from sim.hands.four_finger.flip_postures import flip_postures
from sim.hands.four_finger.grasp_postures import (
    HOLDING,
    NARROWEST,
    WIDEST,
    FourFingerGrasp,
    best_grasp,
    closing_direction,
)
from sim.hands.four_finger.hand_posture import (
    FLANGE_TO_PALM,
    RESTING,
    hand_spheres,
    thin_spheres,
    whole_spheres,
)
from sim.hands.four_finger.pressing_postures import pressing_postures
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
    joint_names = kinematics.JOINT_NAMES
    grasp_fingers = HOLDING
    tip_radius = kinematics.TIP_RADIUS
    finger_spreads = FINGER_SPREADS
    force_skew = LARGEST_SKEW
    grasp_widths = (NARROWEST, WIDEST)
    # The palm is turned by π on the flange.
    R_FP = np.diag([-1.0, -1.0, 1.0])
    p_FP = np.array([0.0, 0.0, FLANGE_TO_PALM])
    palm_link = "palm"
    model_file = resources.files("sim") / "hands" / "four_finger" / "four_finger_hand.urdf"
    resting = RESTING

    closing_direction = staticmethod(closing_direction)
    tip_centre = staticmethod(kinematics.tip_centre)
    tip_force = staticmethod(kinematics.tip_force)
    tip_stiffness = staticmethod(kinematics.tip_stiffness)
    force_noise_gain = staticmethod(kinematics.force_noise_gain)
    is_at_stop = staticmethod(kinematics.is_at_stop)

    def model_joints(self, finger: str) -> tuple[str, ...]:
        """Names of a finger's four joints; the distal one follows the middle one."""
        return tuple(f"{finger}_{joint}" for joint in kinematics.FINGER_JOINTS)

    def model_angles(self, angles: Angles) -> Angles:
        """Angles of a finger's four joints [rad]."""
        return (*angles, angles[-1])

    def pushing_postures(self, fingers: int, spread: float, *, fine: bool = False) -> PostureSet:
        """Postures whose fingers bear and feel the push."""
        return pushing_postures(fingers, spread, fine=fine, wrist=self.wrist)

    def pressing_postures(self) -> PostureSet:
        """Postures whose finger bears and feels the pressing while it drags."""
        return pressing_postures(self.wrist)

    def grasp_posture(
        self, width: float, *, pinch: bool = False, depth: float = 0.0
    ) -> FourFingerGrasp | None:
        """The grasp about a width; by thumb and middle finger alone about a knob."""
        if not NARROWEST <= width <= WIDEST:
            return None
        return best_grasp(round(width, 4), pinch=pinch, wrist=self.wrist, depth=depth)

    def flip_postures(self, lid: LidShape) -> FlipPostureSet:
        """Postures whose finger bears and feels the lid."""
        return flip_postures(lid, self.wrist)

    def spheres(self, posture: Posture) -> Array:
        """Spheres with room about the fingers, without the pushing tips."""
        return hand_spheres(posture, self.wrist)

    def whole_spheres(self, posture: Posture) -> Array:
        """The same with the pushing tips, which come last."""
        return whole_spheres(posture, self.wrist)

    def thin_spheres(self, posture: Posture) -> Array:
        """Spheres of the fingers as thin as they are."""
        return thin_spheres(posture, self.wrist)

"""Sensing with the pushing fingers: where the tips are and what they press.

Model: a fingertip touches with the point of its sphere that faces the object, and its joints'
torques balance the force there: τ = Jᵀ f, J at that point and not at the sphere's centre.

Frames: P is the palm, T a fingertip's centre; forces are those on the object, in W.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from sim.hands.mount import Mount
from sim.rotations import Array
from sim.worlds.ports import RobotPort


@dataclass(frozen=True)
class Touch:
    """Fingertips at one time.

    Attributes:
        tips: centres p_WT, shape (k, 3) [m].
        forces: on the object in W, shape (k, 3) [N].
    """

    tips: Array
    forces: Array

    @functools.cached_property
    def midpoint(self) -> Array:
        """Midpoint of the tips' centres in W, shape (3,) [m]."""
        return np.asarray(self.tips.mean(axis=0))


def sense_touch(
    port: RobotPort, mount: Mount, fingers: tuple[str, ...], inward_W: Array, torques: Array
) -> Touch:
    """Places of the pushing fingertips and what they press, by their joints' sensors.

    Args:
        port: of the robot.
        mount: of the arm.
        fingers: names of the pushing fingers.
        inward_W: unit normal into the touched face in W, shape (3,), or of each finger, (k, 3).
        torques: of the fingers' joints, their sensors' zero taken off, shape (k, 3) [N·m].
    """
    hand = mount.hand
    R_WP, p_WP = mount.palm_poses(port.arm_angles())
    tips, forces = [], []
    inwards = np.broadcast_to(inward_W, (len(fingers), 3))
    for finger, inward, tau in zip(fingers, inwards, torques, strict=True):
        angles = port.finger_angles(finger)
        p_PT = hand.tip_centre(finger, angles)
        f_P = hand.tip_force(finger, angles, p_PT + hand.tip_radius * R_WP.T @ inward, tau)
        tips.append(R_WP @ p_PT + p_WP)
        forces.append(R_WP @ f_P)
    return Touch(np.array(tips), np.array(forces))

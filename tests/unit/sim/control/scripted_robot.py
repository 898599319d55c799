"""A robot whose arm follows at once and whose fingers are springs, in a world of a few lines.

Where a law of control is to be held against what is felt and seen at one moment, an engine's world
says it too late and too roughly. Here a `Body` says in each control step what the fingertips press,
and where the camera sees everything, from where the fingertips are commanded to be.

Model: joints of the fingers are springs, q = q_commanded − Jᵀf / k, and the torques are Jᵀf.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from objectmodels.geometry.rotations import Array
from sim import load_scene
from sim.motion.robot_reach import ArmHandReach
from sim.robots.cell_description import CellDescription
from sim.robots.finger_kinematics import FINGERS, JOINT_STIFFNESS, finger_jacobian
from sim.robots.hand import Angles
from sim.robots.robots import ARM, HAND
from sim.truth.object_truth import Truth
from sim.worlds.ports import Frame, SeenPose, WorldRecord

CELL = load_scene("kitchen").cell
REACH = ArmHandReach(CELL, ARM, HAND)
PERIOD = 0.01


class Body(Protocol):
    """What the fingertips meet."""

    def press(self, tips: dict[str, Array], time: float) -> dict[str, Array]:
        """Forces on it in W, (3,) each [N], with fingertips commanded to centres in W, (3,) [m]."""

    def seen(self) -> dict[str, SeenPose]:
        """Poses that the camera shows now, without noise."""

    def lids(self) -> dict[str, float]:
        """Angles or ways by which lids are seen open."""


class ScriptedRobot:
    """Port and observer of such a robot."""

    seed = 0
    torque_noise = 0.0
    period = PERIOD
    joint_names: tuple[str, ...] = ()

    def __init__(self, body: Body, q_arm: Array, q_hand: Array) -> None:
        self.cell: CellDescription = CELL
        self.time = 0.0
        self.body = body
        self.commanded = (q_arm, q_hand)
        self.tips: dict[str, Array] = {}
        self.pressed: dict[str, Array] = {}
        self._torques = {finger: np.zeros(3) for finger in FINGERS}
        self._frames: list[Frame] = []
        self._next_frame = 0.0

    def step(self, q_arm: Array, q_hand: Array) -> None:
        self.commanded = (np.array(q_arm), np.array(q_hand))
        self.time += PERIOD
        R_WP, p_WP = REACH.mount.palm_poses(self.commanded[0])
        for finger in FINGERS:
            self.tips[finger] = p_WP + R_WP @ HAND.tip_centre(finger, self._commanded(finger))
        self.pressed = self.body.press(self.tips, self.time)
        self._torques = {finger: np.zeros(3) for finger in FINGERS}
        for finger, f_W in self.pressed.items():
            f_P = R_WP.T @ f_W
            into = f_P / max(float(np.linalg.norm(f_P)), 1e-9)
            angles = self._commanded(finger)
            point = HAND.tip_centre(finger, angles) + HAND.tip_radius * into
            self._torques[finger] = finger_jacobian(finger, angles, point).T @ f_P
        if self.time >= self._next_frame:
            self._next_frame += 1.0 / self.cell.vision.rate_hz
            frame = Frame(self.time, self.time, self.body.seen(), lids=self.body.lids())
            self._frames.append(frame)

    def arm_angles(self) -> Array:
        return self.commanded[0]

    def finger_angles(self, finger: str) -> Angles:
        bent = np.array(self._commanded(finger)) - self._torques[finger] / JOINT_STIFFNESS
        return tuple(bent.tolist())

    def finger_torques(self, finger: str) -> Array:
        return self._torques[finger]

    def frames(self) -> list[Frame]:
        arrived, self._frames = self._frames, []
        return arrived

    def record(self) -> WorldRecord:
        return WorldRecord([])

    def truth_now(self, name: str) -> Truth:
        raise AssertionError(f"nobody asks a script for the truth of the {name}")

    def _commanded(self, finger: str) -> Angles:
        first = 3 * FINGERS.index(finger)
        return tuple(self.commanded[1][first : first + 3].tolist())

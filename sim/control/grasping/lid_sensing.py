"""Sensing of a lid: the camera's view of it and its object, and forces while it is held.

The camera shows how far a lid is open, and the object to which it belongs; it does not show where a
lid is in the hand. The fingers' torques tell how hard a cap turns.

Model: frames are noisy; each filtered value is an exponential mean of them. The object stands where
it was seen before, upright; it should stay so.

Frames: W is the world.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from objectmodels.containers.lids import lid_name
from planner.types.world_state import SeenObject
from sim.cell.cell_description import Vision
from sim.control.camera_noise import noise_left
from sim.control.grasping.held_object_sensing import HandSense
from sim.control.trace_recorder import EarlyEndError, TraceRecorder
from sim.motion.grasp_motion_search import GraspMotion
from sim.paths.held_object_path import HeldObject
from sim.rotations import Array, wrap, yaw_of
from sim.worlds.ports import Frame

LEANS, MOVES, TURNS = float(np.radians(3.0)), 0.008, float(np.radians(6.0))
"""Tilt [rad], displacement [m] and turn [rad] of the object at which its lid is let go."""

_TURNING = 0.15  # time constant of the felt torque [s]
_LID_SHARE, _POSE_SHARE = 0.3, 0.2  # weights of a new frame
_LEFT = noise_left(_POSE_SHARE)  # of a frame's noise, once filtered
_SIGMAS = 5.0  # of that, which noise in two directions exceeds in one of 270,000 frames


class LidEstimator:
    """A lid and its object as they are seen, from how they were seen before.

    Attributes:
        lid: how far it is open.
        is_off: whether it is off its object.
        turn: of the object about the vertical [rad].
        unsure, unsure_angle: displacement [m], and tilt or turn [rad], that may be noise.

    Args:
        target: the object as it was seen before.
        lid: how far it was open.
        vision: noise of the camera.
    """

    def __init__(self, target: SeenObject, lid: float, vision: Vision) -> None:
        self.unsure = _SIGMAS * _LEFT * vision.position_noise_m
        self.unsure_angle = _SIGMAS * _LEFT * float(np.radians(vision.angle_noise_deg))
        self.lid = lid
        self.is_off = target.lid_at is not None
        self._name = target.name
        self._before = target.pose
        self._up = np.array([0.0, 0.0, 1.0])
        self._p_WB = target.pose.p_WB
        self.turn = 0.0

    def update_from_camera(self, frames: Iterable[Frame]) -> None:
        """Takes in what arrived."""
        for frame in frames:
            pose = frame.poses[self._name]
            self.is_off = lid_name(self._name) in frame.poses
            self.lid += _LID_SHARE * (frame.lids[self._name] - self.lid)
            self._up = self._up + _POSE_SHARE * (pose.R_WB[:, 2] - self._up)
            self._p_WB = self._p_WB + _POSE_SHARE * (pose.p_WB - self._p_WB)
            turned = float(wrap(yaw_of(pose.R_WB) - self._before.yaw))
            self.turn += _POSE_SHARE * (turned - self.turn)

    @property
    def tilt(self) -> float:
        """By which the object leans [rad]."""
        return float(np.arctan2(np.hypot(*self._up[:2]), self._up[2]))

    @property
    def displacement(self) -> float:
        """Distance of the object from where it stood [m]."""
        return float(np.hypot(*(self._p_WB - self._before.p_WB)[:2]))


class LidSense(HandSense):
    """Feels and sees while a lid is held.

    Attributes:
        view: of the lid and its object.
        most_torque: with which the hand may turn the lid [N·m].
        torque: with which it does, about the vertical [N·m].
    """

    def __init__(self, recorder: TraceRecorder, way: GraspMotion, handled: HeldObject) -> None:
        p_BG = np.array(handled.grasp.p_BG)
        super().__init__(recorder, way.mount, handled.held.name, p_BG, handled.state)
        self._lid_way = way
        self.holding = way.grip.touching_fingers
        self._owner = handled.state.objects[handled.name]
        vision = recorder.port.cell.vision
        self.view = LidEstimator(self._owner, handled.opened, vision)
        self.most_torque = np.inf
        self.torque = 0.0

    def step(self, q_arm: Array, q_hand: Array) -> None:
        """Commands joint angles, and takes in what is felt and seen then."""
        super().step(q_arm, q_hand)
        self.view.update_from_camera(self._recorder.frames)
        touch = self._recorder.touch
        if touch is None:
            return
        R_WP, p_WP = self._mount.palm_poses(q_arm)
        arms = touch.tips - (p_WP + R_WP @ self._lid_way.grip.middle)
        # A fingertip touches something round on the line to its middle.
        arms *= 1.0 - self._hand.tip_radius / np.linalg.norm(arms, axis=1, keepdims=True)
        turning = arms[:, 0] * touch.forces[:, 1] - arms[:, 1] * touch.forces[:, 0]
        share = min(1.0, self._period / _TURNING)
        self.torque += share * (float(turning.sum()) - self.torque)

    def require_others(self) -> None:
        """Requires that the object whose lid it is stays where it stands, as all others.

        Raises:
            EarlyEndError: one was seen to be moved, or the cap turns too hard.
        """
        view, name = self.view, self._owner.name
        if abs(view.turn) > max(TURNS, view.unsure_angle):
            turned = np.degrees(view.turn)
            raise EarlyEndError("turned_off", f"the {name} turned along by {turned:.0f}°")
        if view.tilt > max(LEANS, view.unsure_angle):
            raise EarlyEndError("tilted", f"the {name} leans by {np.degrees(view.tilt):.0f}°")
        if view.displacement > max(MOVES, view.unsure):
            moved = 1e3 * view.displacement
            raise EarlyEndError("nudged", f"the {name} was moved by {moved:.0f} mm")
        super().require_others()
        if abs(self.torque) > self.most_torque:
            torque = abs(self.torque)
            raise EarlyEndError("force", f"the cap does not turn with {torque:.3f} N·m")

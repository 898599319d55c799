"""What the camera shows while something is done to an object's lid: the lid, and its object.

Model: frames are noisy; each filtered value is an exponential mean of them. The object stands where
it was seen before, upright; it should stay so.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from objectmodels.containers.lid_geometry import lid_name
from planner.types.world_state import SeenObject
from sim.rotations import wrap, yaw_of
from sim.worlds.ports import Frame

_LID_SHARE, _POSE_SHARE = 0.3, 0.2  # weights of a new frame


class LidView:
    """A lid and its object as they are seen.

    Args:
        target: the object as it was seen before.
        lid: how far its lid was open then.

    Attributes:
        lid: how far it is open.
        is_off: whether it is off its object.
    """

    def __init__(self, target: SeenObject, lid: float) -> None:
        self.lid = lid
        self.is_off = target.lid_at is not None
        self._name = target.name
        self._before = target.pose
        self._up = np.array([0.0, 0.0, 1.0])
        self._p_WB = target.pose.p_WB
        self._turned = 0.0

    def seen(self, frames: Iterable[Frame]) -> None:
        """Takes in what arrived."""
        for frame in frames:
            pose = frame.poses[self._name]
            self.is_off = lid_name(self._name) in frame.poses
            self.lid += _LID_SHARE * (frame.lids[self._name] - self.lid)
            self._up = self._up + _POSE_SHARE * (pose.R_WB[:, 2] - self._up)
            self._p_WB = self._p_WB + _POSE_SHARE * (pose.p_WB - self._p_WB)
            turned = float(wrap(yaw_of(pose.R_WB) - self._before.yaw))
            self._turned += _POSE_SHARE * (turned - self._turned)

    @property
    def tilt(self) -> float:
        """By which the object leans [rad]."""
        return float(np.arctan2(np.hypot(*self._up[:2]), self._up[2]))

    @property
    def moved(self) -> float:
        """How far it is from where it stood [m]."""
        return float(np.hypot(*(self._p_WB - self._before.p_WB)[:2]))

    @property
    def turned(self) -> float:
        """By which it has turned about the vertical [rad]."""
        return self._turned

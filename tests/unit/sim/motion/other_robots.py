"""A gripper with two fingers and an arm with six joints, as unlike the standard robot as may be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.resources.abc import Traversable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.rotations import Array, rot_x, rot_y, rot_z
from planner.types.robot import Grip
from sim.robots.collision_spheres import sphere_row
from sim.robots.hand import Angles, FlipPostureSet, GraspPosture, Posture, PostureSet
from sim.robots.lid_path import LidPath, LidShape
from sim.robots.lwr_arm import LwrKinematics

_LENGTH, _ASIDE = 0.18, -0.03  # of the fingers along z, and of both along y in P [m]
_CLOSING = {"left": 1.0, "right": -1.0}  # direction along x
_STIFFNESS = 2000.0  # [N/m]


@dataclass(frozen=True, eq=False)
class GripperGrasp(GraspPosture):
    """The gripper about a width."""

    touching_fingers = ("right", "left")

    @property
    def squeeze_offsets(self) -> Array:
        """Both fingers are commanded inwards."""
        return np.full(2, -1.0 / _STIFFNESS)

    def posture_at(self, opening: float = 0.0) -> Posture:
        """Both fingertips as far from the middle."""
        half = self.width / 2.0 + opening + TwoFingerGripper.tip_radius
        return _posture("gripper", {"left": (half,), "right": (half,)}, self.touching_fingers)

    def force_offsets(self, force_P: Array) -> Array:
        """Along x alone."""
        return np.array([-0.5, 0.5]) * float(force_P[0]) / _STIFFNESS


class TwoFingerGripper:
    """Two fingers that slide along x, one joint each: its distance from the middle [m]."""

    fingers: tuple[str, ...] = ("left", "right")
    grasp_fingers: tuple[str, ...] = ("right", "left")
    finger_spreads: tuple[float, ...] = (0.05,)
    grasp_widths = (0.01, 0.07)
    palm_link = "gripper"
    model_file: Traversable = Path("gripper.urdf")
    tip_radius = 0.006
    force_skew = 0.1
    R_FP = np.diag([-1.0, 1.0, -1.0]) @ np.diag([1.0, -1.0, -1.0])
    p_FP = np.array([0.0, 0.0, 0.05])

    @property
    def resting(self) -> Posture:
        """Half open."""
        return _posture("half open", {"left": (0.02,), "right": (0.02,)}, ())

    @property
    def joint_names(self) -> tuple[str, ...]:
        """One of each finger."""
        return tuple(f"slide {finger}" for finger in self.fingers)

    def model_joints(self, finger: str) -> tuple[str, ...]:
        """One of each finger."""
        return (f"slide {finger}",)

    def model_angles(self, angles: Angles) -> Angles:
        """No joint follows another."""
        return angles

    def pushing_postures(self, fingers: int, spread: float, *, fine: bool = False) -> PostureSet:
        """One finger ahead of the other, or both side by side; the palm leans either way."""
        if fingers == 1:
            postures = (_posture("one finger", {"left": (0.035,), "right": (0.0,)}, ("left",)),)
        else:
            half = spread / 2.0
            postures = (_posture("two", {"left": (half,), "right": (half,)}, self.fingers),)
        tilts, sides = np.radians([0.0, 15.0, 30.0, 45.0, 60.0]), np.radians([-20.0, 0.0, 20.0])
        tilt, side = (a.ravel() for a in np.meshgrid(tilts, sides))
        # Two fingers stand side by side across the push, one of them ahead of the other.
        turn = np.pi / 2.0 if fingers == 2 else np.pi
        R_DP = rot_x(side) @ rot_y(-tilt) @ np.diag([1.0, -1.0, -1.0]) @ rot_z(np.array(turn))
        n = len(R_DP)
        spheres = tuple(self.whole_spheres(posture) for posture in postures)
        return PostureSet.from_postures(
            postures, spheres, np.zeros(n, dtype=int), R_DP, np.full(n, 20.0)
        )

    def pressing_postures(self) -> PostureSet:
        return self.pushing_postures(1, 0.0)[:0]

    def grasp_posture(
        self, width: float, *, pinch: bool = False, depth: float = 0.0
    ) -> GripperGrasp | None:
        """Both fingers about the width."""
        if not self.grasp_widths[0] <= width <= self.grasp_widths[1]:
            return None
        grip = Grip(np.zeros((2, 2)), np.ones(2), 15.0, (0.02, 0.02), ahead=self.tip_radius)
        return GripperGrasp(width, np.array([0.0, _ASIDE, _LENGTH]), 0.01, grip)

    def flip_postures(self, lid: LidShape) -> FlipPostureSet:
        """It flips no lids."""
        path = LidPath.from_lid(lid)
        return FlipPostureSet(path, (), (), np.zeros((0, len(path.points), 3, 3)), np.zeros((0, 3)))

    def closing_direction(self, finger: str) -> Array:
        """To the middle."""
        return np.array([_CLOSING[finger], 0.0, 0.0])

    def tip_centre(self, finger: str, angles: Angles) -> Array:
        """At the end of the finger."""
        return np.array([-_CLOSING[finger] * angles[0], _ASIDE, _LENGTH])

    def tip_force(self, finger: str, angles: Angles, p_PC: Array, torques: Array) -> Array:
        """Along the slide."""
        return np.array([-_CLOSING[finger] * torques[0], 0.0, 0.0])

    def tip_stiffness(self, finger: str, angles: Angles, p_PC: Array) -> Array:
        """The same any way."""
        return np.tile(_STIFFNESS * np.eye(3), (*p_PC.shape[:-1], 1, 1))

    def force_noise_gain(self, finger: str, angles: Angles, p_PC: Array, along_P: Array) -> Array:
        """A lever of a decimetre."""
        return np.full(along_P.shape[:-1], 10.0)

    def is_at_stop(self, angles: Angles) -> bool:
        """Wide open."""
        return angles[0] > 0.05

    def spheres(self, posture: Posture) -> Array:
        """A body and two thin fingers, without the tips that touch."""
        rows = [sphere_row(np.array([0.0, 0.0, -0.1]), np.array([0.0, 0.0, 0.06]), 0.04, 0.02)]
        for finger, angles in posture.angles.items():
            tip = self.tip_centre(finger, angles)
            end = tip - [0.0, 0.0, 0.02 if finger in posture.pushing else 0.0]
            rows.append(sphere_row(tip * [1.0, 1.0, 0.4], end, 0.004, 0.01))
        return np.vstack(rows)

    def whole_spheres(self, posture: Posture) -> Array:
        """With the tips that touch."""
        tips = np.column_stack([posture.tips, np.full(len(posture.tips), self.tip_radius)])
        return np.vstack([self.spheres(posture), tips])

    def thin_spheres(self, posture: Posture) -> Array:
        """It is as thin as it is."""
        return self.whole_spheres(posture)


def _posture(name: str, angles: Mapping[str, Angles], pushing: tuple[str, ...]) -> Posture:
    hand = TwoFingerGripper()
    tips = np.array([hand.tip_centre(finger, angles[finger]) for finger in pushing])
    return Posture(name, angles, pushing, tips.reshape(-1, 3))


class SixJointArm(LwrKinematics):
    """The standard arm with its third joint locked: the elbow stays in an upright plane."""

    joint_names = tuple(f"axis {k}" for k in "ABCDEF")
    efforts = np.array([176.0, 176.0, 100.0, 100.0, 38.0, 38.0])
    redundancy_samples = np.array([0.0, np.pi])  # elbow above and below
    link_radius = 0.08

    def forward(self, q: Array) -> tuple[Array, Array]:
        """As of the seven joints."""
        return super().forward(_with_locked(q))

    def inverse(
        self,
        R_AF: Array,
        p_AF: Array,
        redundancy: Array,
        branches: Sequence[int] | NDArray[np.intp] | None = None,
    ) -> tuple[Array, NDArray[np.bool_]]:
        """Solutions of the seven joints, the third of which stays where it is locked."""
        q, valid = super().inverse(R_AF, p_AF, redundancy, branches)
        return np.delete(q, 2, axis=-1), valid & (np.abs(q[..., 2]) < 1e-6)

    def torques(self, q: Array, p_AC: Array, f_A: Array) -> Array:
        """Without that of the locked joint."""
        return np.delete(super().torques(_with_locked(q), p_AC, f_A), 2, axis=-1)

    def joint_room(self, q: Array) -> Array:
        """As of the seven joints."""
        return super().joint_room(_with_locked(q))

    def is_regular(self, q: Array) -> NDArray[np.bool_]:
        """As of the seven joints."""
        return super().is_regular(_with_locked(q))

    def spheres(self, q: Array) -> Array:
        """As of the seven joints."""
        return super().spheres(_with_locked(q))


def _with_locked(q: Array) -> Array:
    return np.insert(q, 2, 0.0, axis=-1)

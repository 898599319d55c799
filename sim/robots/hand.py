"""Protocol of a hand, and its values: all that planning and control know of it.

Frames: F is the arm's flange. P is the palm: z along the straight fingers, x from the fingers to
the one that opposes them, which is the direction in which the hand closes. D is the frame of a
push (x into the touched face, z up), T the midpoint of the pushing fingertips' centres. E stands
at the hinge of a lid, see `sim.robots.lid_path`. Another hand is a folder of its own
in this room.
"""

from __future__ import annotations

import functools
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields
from importlib.resources.abc import Traversable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.rotations import Array, rot_x, rot_y, rot_z
from objectmodels.geometry.side_faces import FLAT, SidePress
from planner.types.robot import Grip
from sim.errors import SceneError
from sim.robots.arm import ArmKinematics
from sim.robots.cell_description import RobotMount
from sim.robots.collision_spheres import place_spheres
from sim.robots.lid_path import LidPath, LidShape

Angles = tuple[float, ...]
"""Angles of a finger's independent joints [rad]."""


@dataclass(frozen=True, eq=False)
class Posture:
    """Joint angles of the whole hand and the fingers whose tips touch.

    Attributes:
        name: for reports.
        angles: per finger.
        pushing: names of the fingers that touch.
        tips: centres of their fingertips in P, shape (k, 3) [m].
    """

    name: str
    angles: Mapping[str, Angles]
    pushing: tuple[str, ...]
    tips: Array

    @functools.cached_property
    def tip_midpoint(self) -> Array:
        """Midpoint of the pushing fingertips' centres in P, shape (3,) [m]."""
        return np.asarray(self.tips.mean(axis=0))

    @functools.cached_property
    def joint_angles(self) -> Array:
        """Angles of the independent finger joints, finger after finger, shape (n,) [rad]."""
        return np.array([a for each in self.angles.values() for a in each])


@dataclass(frozen=True, eq=False)
class PostureSet:
    """Postures that push and orientations of the palm, n of them, the best first.

    Where the spheres of each are is computed for the few that are looked at.

    Attributes:
        postures: the different ones.
        spheres: of the hand in each, from T, in P, the pushing tips last, shape (p, k, 4) [m].
        which: index of the posture, shape (n,).
        R_DP: orientation of the palm, shape (n, 3, 3).
        strength: force along the push that each pushing finger bears, shape (n,) [N].
        palm: origin of P, from T, in D, shape (n, 3) [m].
        lowest_points: height of the lowest point but the pushing tips above T, shape (n,) [m].
        extents: largest horizontal distance of any point from T, shape (n,) [m].
        circles: about all spheres as seen from above: the middle from T in D, and the radius,
            shape (n, 3) [m].
        fronts: how far any point but the pushing tips is ahead of T along D's x, shape (n,) [m].
        number: place among all that the hand has, shape (n,).
    """

    postures: tuple[Posture, ...]
    spheres: Array
    which: NDArray[np.intp]
    R_DP: Array
    strength: Array
    palm: Array
    lowest_points: Array
    extents: Array
    circles: Array
    fronts: Array
    number: NDArray[np.intp]

    @classmethod
    def from_postures(
        cls,
        postures: tuple[Posture, ...],
        spheres: tuple[Array, ...],
        which: NDArray[np.intp],
        R_DP: Array,
        strength: Array,
    ) -> PostureSet:
        """The set of some postures with their spheres in P, shape (k, 4) each."""
        tips = np.array([posture.tip_midpoint for posture in postures])
        palm = -(R_DP @ tips[which][..., None])[..., 0]
        about = np.array(padded_spheres(spheres))
        about[..., :3] -= tips[:, None]
        touching = len(postures[0].pushing)
        rows = []
        # So many hands at once need little memory.
        for k in range(0, len(which), 1024):
            some = slice(k, k + 1024)
            placed = place_spheres(about[which[some]], R_DP[some], np.zeros(3))
            # numpy is much faster on arrays that lie in a row.
            rows.append(np.ascontiguousarray(np.moveaxis(placed, -1, 0)))
        lowest = [(z - r)[:, :-touching].min(axis=1, initial=np.inf) for _, _, z, r in rows]
        extents = [(np.sqrt(x * x + y * y) + r).max(axis=1) for x, y, _, r in rows]
        fronts = [(x + r)[:, :-touching].max(axis=1, initial=-np.inf) for x, _, _, r in rows]
        none = np.zeros(0)
        return cls(
            postures,
            about,
            which,
            R_DP,
            strength,
            palm,
            lowest_points=np.concatenate([none, *lowest]),
            extents=np.concatenate([none, *extents]),
            circles=np.concatenate([np.zeros((0, 3)), *map(_circles_around, rows)]),
            fronts=np.concatenate([none, *fronts]),
            number=np.arange(len(which)),
        )

    def __len__(self) -> int:
        return len(self.which)

    def __getitem__(self, chosen: NDArray[np.bool_] | NDArray[np.intp] | slice) -> PostureSet:
        k = np.arange(len(self))[chosen]  # numpy takes rows faster than it sorts them out
        rows = (getattr(self, field.name).take(k, axis=0) for field in fields(self)[2:])
        return PostureSet(self.postures, self.spheres, *rows)

    def posture_at(self, index: int) -> Posture:
        """Posture of one of them."""
        return self.postures[int(self.which[index])]

    def palms_along(self, R_WD: Array, points: Array) -> tuple[Array, Array]:
        """Palm poses in W with T at points, shapes (n, w, 3, 3) and (n, w, 3); see below."""
        p_WP = points + (R_WD @ self.palm[:, None, :, None])[..., 0]
        return R_WD @ self.R_DP[:, None], p_WP

    def spheres_in_D(self, part: NDArray[np.intp] | slice = slice(None)) -> Array:
        """The spheres from T, in D, shape (n, k, 4), or a part of them."""
        return self.spheres_along(np.eye(3)[None], np.zeros((1, 3)), part)[:, 0]

    def spheres_along(
        self, R_WD: Array, points: Array, part: NDArray[np.intp] | slice = slice(None)
    ) -> Array:
        """The spheres in W with T at w points, shape (n, w, k, 4).

        Args:
            R_WD: frame of the push at each point, shape (w, 3, 3).
            points: shape (w, 3), or (n, w, 3) [m].
            part: indices of the spheres that are wanted; all if not given.
        """
        about = self.spheres[:, part][self.which, None]
        return place_spheres(about, R_WD @ self.R_DP[:, None], np.asarray(points))


@dataclass(frozen=True, eq=False)
class FlipPostureSet:
    """Postures that flip a lid, n of them, those that feel best first.

    Attributes:
        path: of the fingertip.
        postures: of each.
        spheres: of each posture in P, the fingertip last, shape (k, 4) each.
        R_EP: orientation of the palm along the path, shape (n, w, 3, 3).
        tips: centre of the fingertip in P, shape (n, 3) [m].
    """

    path: LidPath
    postures: tuple[Posture, ...]
    spheres: tuple[Array, ...]
    R_EP: Array
    tips: Array

    def __len__(self) -> int:
        return len(self.postures)

    def __getitem__(self, chosen: NDArray[np.intp]) -> FlipPostureSet:
        which = chosen.tolist()
        return FlipPostureSet(
            self.path,
            tuple(self.postures[k] for k in which),
            tuple(self.spheres[k] for k in which),
            self.R_EP[chosen],
            self.tips[chosen],
        )

    @functools.cached_property
    def path_spheres(self) -> Array:
        """Spheres of the hand in E along the path, the fingertip last, shape (n, w, k, 4)."""
        most = max(map(len, self.spheres), default=1)
        about = np.reshape(padded_spheres(self.spheres), (len(self), 1, most, 4))
        about = about - np.pad(self.tips, ((0, 0), (0, 1)))[:, None, None]
        points = np.broadcast_to(self.path.points, self.R_EP.shape[:3])
        return place_spheres(about, self.R_EP, points)


def _circles_around(spheres: Array) -> Array:
    """Circles as seen from above about some spheres, shape (4, n, k): x, y, radius, (n, 3) [m]."""
    x, y, _, r = spheres
    middle_x, middle_y = (0.5 * ((c - r).min(axis=1) + (c + r).max(axis=1)) for c in (x, y))
    x_off, y_off = x - middle_x[:, None], y - middle_y[:, None]
    around = (np.sqrt(x_off * x_off + y_off * y_off) + r).max(axis=1)
    return np.column_stack([middle_x, middle_y, around])


def padded_spheres(spheres: tuple[Array, ...]) -> list[Array]:
    """As many spheres of each posture, shape (k, 4): the first of some stands there repeatedly."""
    most = max(map(len, spheres), default=1)
    return [np.vstack([np.tile(some[:1], (most - len(some), 1)), some]) for some in spheres]


@dataclass(frozen=True, eq=False)
class GraspPosture(ABC):
    """A posture of a hand with n finger joints that closes about something of a width.

    Attributes:
        width: distance between the touched sides [m].
        middle: of the grasp in P, shape (3,) [m].
        opening: distance of the fingertips from each side before they close [m].
        grip: as the planner knows it.
        press: of the outer fingers on the side that they touch.
    """

    width: float
    middle: Array
    opening: float
    grip: Grip
    press: SidePress = FLAT

    @property
    @abstractmethod
    def touching_fingers(self) -> tuple[str, ...]:
        """Names of the fingers that touch."""

    @property
    @abstractmethod
    def squeeze_offsets(self) -> Array:
        """Change of the commanded finger angles per squeeze, shape (n,) [rad/N]."""

    @abstractmethod
    def posture_at(self, opening: float = 0.0) -> Posture:
        """The hand with its fingertips so far off each side [m]; negative: beyond it."""

    @abstractmethod
    def force_offsets(self, force_P: Array) -> Array:
        """Change of the commanded finger angles with which both sides exert a force.

        Args:
            force_P: on what is held, in P, shape (3,) [N].

        Returns:
            Shape (n,) [rad].
        """


class Hand(Protocol):
    """Postures and kinematics of a hand with n independent finger joints."""

    fingers: tuple[str, ...]
    """Names of the fingers, in the order of the joints."""

    grasp_fingers: tuple[str, ...]
    """Names of the fingers that hold something, the one that opposes the others first."""

    tip_radius: float
    """Radius of a fingertip [m]."""

    finger_spreads: tuple[float, ...]
    """Distances between the fingertips of a two-finger push, the largest first [m]."""

    force_skew: float
    """Largest vertical force per force along the push of a posture that pushes."""

    grasp_widths: tuple[float, float]
    """Least and largest width about which the hand closes [m]."""

    R_FP: Array
    """Orientation of the palm on the flange, shape (3, 3)."""

    p_FP: Array
    """Place of the palm on the flange, shape (3,) [m]."""

    palm_link: str
    """Name of the model's link whose frame is P."""

    model_file: Traversable
    """URDF model, for a simulator."""

    def __hash__(self) -> int: ...

    @property
    def resting(self) -> Posture:
        """The hand while it waits."""

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the independent joints in the order of `Posture.joint_angles`."""

    def model_joints(self, finger: str) -> tuple[str, ...]:
        """Names of all joints of a finger in the model: the independent ones, then the others."""

    def model_angles(self, angles: Angles) -> Angles:
        """Angles of all joints of a finger in the model, in their order [rad]."""

    def pushing_postures(self, fingers: int, spread: float, *, fine: bool = False) -> PostureSet:
        """Postures in which so many fingers push, the best first.

        Args:
            fingers: one or two.
            spread: distance between two fingertips [m].
            fine: the palm may lean by small angles and large ones.
        """

    def pressing_postures(self) -> PostureSet:
        """Postures in which one finger presses down on something level, the best first.

        D's x axis is then the way along which it drags; strength is that of the pressing meanwhile.
        """

    def grasp_posture(
        self, width: float, *, pinch: bool = False, depth: float = 0.0
    ) -> GraspPosture | None:
        """The grasp about a width [m], or about a knob of it; None if there is none.

        It leaves free so much room between its middle and the palm [m], as `Robot.grasp` has it.
        """

    def flip_postures(self, lid: LidShape) -> FlipPostureSet:
        """Postures in which one finger flips a lid."""

    def closing_direction(self, finger: str) -> Array:
        """Direction in which a finger presses on what is held, in P, shape (3,)."""

    def tip_centre(self, finger: str, angles: Angles) -> Array:
        """Centre of a fingertip in P, shape (3,) [m]."""

    def tip_force(self, finger: str, angles: Angles, p_PC: Array, torques: Array) -> Array:
        """Force at a point of a fingertip that balances its joints' torques, in P, shape (3,) [N].

        The torques [N·m] are those of its independent joints.
        """

    def tip_stiffness(self, finger: str, angles: Angles, p_PC: Array) -> Array:
        """Force at points of a fingertip per displacement, in P, shape (..., 3, 3) [N/m]."""

    def force_noise_gain(self, finger: str, angles: Angles, p_PC: Array, along_P: Array) -> Array:
        """Noise of the force felt along unit directions per noise of a torque sensor [1/m].

        The finger touches at p_PC, shape (..., 3) [m]; along_P has the same shape.
        """

    def is_at_stop(self, angles: Angles) -> bool:
        """True if a joint of a finger is at its stop, which bears what no torque sensor shows."""

    def spheres(self, posture: Posture) -> Array:
        """Spheres of the hand in P with room about its fingers, without the pushing tips, (n, 4).

        They reach back to the wrist of the arm.
        """

    def whole_spheres(self, posture: Posture) -> Array:
        """The same with the pushing fingertips, which come last."""

    def thin_spheres(self, posture: Posture) -> Array:
        """Spheres of the whole hand in P, its fingers as thin as they are, shape (n, 4)."""


@dataclass(frozen=True, eq=False)
class Mount:
    """An arm with n joints and a hand on its flange, and where its base stands.

    Frames: W is the world, A the arm's base.

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

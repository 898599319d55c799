"""Kinematics of the seven-joint arm, in closed form.

Model: a spherical shoulder, an elbow and a spherical wrist (the LWR's alternating axes), so a
flange pose leaves one freedom: the elbow's angle about the line from shoulder to wrist. For each
elbow angle there are eight solutions (the signs of joints 2, 4 and 6).

Frames: A is the arm's base, z along joint 1; F the flange. The figures are those of
`lwr_arm.urdf`; a test holds the two together.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import resources

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.rotations import Array, rot_x, rot_y

SHOULDER, UPPER_ARM, FOREARM, FLANGE = 0.31, 0.40, 0.39, 0.078
"""Heights of the shoulder above the base and lengths of the links [m]."""

LIMITS = np.radians([170.0, 120.0, 170.0, 120.0, 170.0, 120.0, 170.0])
"""Largest magnitude of each joint angle [rad]."""

LINK_RADIUS = 0.065
"""Radius of the links, a little more than that of their capsules [m]."""

_SHARES = np.linspace(0.0, 1.0, 8)[:, None]  # of a link, where its spheres are

_SIGNS = np.array([1.0, 1.0, 1.0, -1.0, 1.0, 1.0, 1.0])  # joint 4 turns about −y

_BRANCHES = tuple(itertools.product((1.0, -1.0), repeat=3))
"""Signs of joints 4, 2 and 6 of the eight solutions."""

_DIFFERS = np.array([(s, s, e * s, e, e * w, w, w) for e, s, w in _BRANCHES]) < 0.0
"""Joints whose angle in a branch is another than in the first, shape (8, 7)."""


@dataclass(frozen=True)
class LwrKinematics:
    """The seven-joint arm; see `sim.robots.arm.ArmKinematics`."""

    joint_names = tuple(f"arm_joint_{i}" for i in range(1, 8))
    efforts = np.array([176.0, 176.0, 100.0, 100.0, 100.0, 38.0, 38.0])
    branches = len(_BRANCHES)
    redundancy_samples = np.radians(np.arange(-180.0, 180.0, 15.0))
    p_FW = np.array([0.0, 0.0, -FLANGE])
    link_radius = LINK_RADIUS
    base_link, flange_link = "arm_base", "arm_link_7"
    model_file = resources.files("sim") / "robots" / "builtin" / "lwr_arm.urdf"

    def forward(self, q: Array) -> tuple[Array, Array]:
        """Flange pose R_AF and p_AF [m]."""
        *_, (R_AF, p_AF) = _link_frames(q)
        return R_AF, p_AF

    def joint_origins(self, q: Array) -> Array:
        """Origins of the joints' frames in A, shape (..., 7, 3) [m]."""
        return np.stack([p for _, p in itertools.islice(_link_frames(q), 7)], axis=-2)

    def torques(self, q: Array, p_AC: Array, f_A: Array) -> Array:
        """Torques with which the joints exert a force at a point, Jᵀf [N·m]."""
        (c_x, c_y, c_z), (f_x, f_y, f_z) = np.moveaxis(p_AC, -1, 0), np.moveaxis(f_A, -1, 0)
        each = []
        turned_about = 2, 1, 2, 1, 2, 1, 2  # axis of each joint's frame
        for (R, p), sign, axis in zip(_link_frames(q), _SIGNS, turned_about, strict=False):
            n_x, n_y, n_z = sign * np.moveaxis(R[..., axis], -1, 0)
            x, y, z = c_x - p[..., 0], c_y - p[..., 1], c_z - p[..., 2]
            turning = n_x * (y * f_z - z * f_y) + n_y * (z * f_x - x * f_z)
            each.append(turning + n_z * (x * f_y - y * f_x))
        return np.stack(each, axis=-1)

    def inverse(
        self,
        R_AF: Array,
        p_AF: Array,
        redundancy: Array,
        branches: Sequence[int] | NDArray[np.intp] | None = None,
    ) -> tuple[Array, NDArray[np.bool_]]:
        """Joint angles for flange poses; the redundancy angle is that of the elbow."""
        p_SW = p_AF - FLANGE * R_AF[:, :, 2] - np.array([0.0, 0.0, SHOULDER])
        squared = np.sum(p_SW * p_SW, axis=1)
        cos_q4 = (squared - UPPER_ARM**2 - FOREARM**2) / (2.0 * UPPER_ARM * FOREARM)
        reachable = np.abs(cos_q4) < 1.0 - 1e-4
        q4 = np.arccos(np.clip(cos_q4, -1.0, 1.0))
        R_arm = _frames_along(*p_SW.T) @ rot_x(redundancy)
        # The line from shoulder to wrist, seen from joint 3 at zero angles of joints 1 to 3.
        line = -FOREARM * np.sin(q4), np.zeros_like(q4), UPPER_ARM + FOREARM * np.cos(q4)
        R_03 = R_arm @ np.swapaxes(_frames_along(*line), -1, -2)
        R_47 = np.swapaxes(R_03 @ rot_y(-q4), -1, -2) @ R_AF
        # One joint after the other: numpy is much faster on arrays that lie in a row.
        one = np.stack([*_zyz_angles(R_03), q4, *_zyz_angles(R_47)])[..., None]
        # With another sign of joint 2, 4 or 6 those beside it turn by half a turn.
        other = -one
        other[::2] = one[::2] - np.copysign(np.pi, one[::2])
        differs = _DIFFERS[np.atleast_2d(range(8) if branches is None else branches)]
        q = np.moveaxis(np.where(np.moveaxis(differs, -1, 0), other, one), 0, -1)
        # Below these |q2| and |q6| the axes of joints 1 and 3, or 5 and 7, nearly coincide.
        valid = (
            reachable[:, None]
            & (np.abs(q) < LIMITS).all(axis=-1)
            & (np.abs(q[..., 1]) > 0.01)  # [rad]
            & (np.abs(q[..., 5]) > 0.05)  # [rad]
        )
        return q, valid

    def joint_room(self, q: Array) -> Array:
        """Least distance of any joint from its limits [rad]."""
        return np.asarray((LIMITS - np.abs(q)).min(axis=-1))

    def is_regular(self, q: Array) -> NDArray[np.bool_]:
        """Joint angles with the wrist bent enough to move on."""
        return np.asarray(np.abs(q[..., 5]) > 0.15)  # [rad]

    def range_excess(self, p_AW: Array, margin: float) -> Array:
        """How far wrist centres are out of the reach of the elbow; the room is joint 4's [m]."""
        distance = np.linalg.norm(p_AW - np.array([0.0, 0.0, SHOULDER]), axis=-1)
        nearest, farthest = shoulder_to_wrist(LIMITS[3] - margin), shoulder_to_wrist(0.0)
        return np.asarray(np.maximum(0.0, np.maximum(nearest - distance, distance - farthest)))

    def spheres(self, q: Array) -> Array:
        """Spheres from the elbow to the wrist.

        The links above the shoulder stay within the mount's reach and far from the table.
        """
        (s1, s2, s3, s4), (c1, c2, c3, c4) = (
            np.moveaxis(each(q[..., :4]), -1, 0) for each in (np.sin, np.cos)
        )
        upper_arm = np.stack([c1 * s2, s1 * s2, c2], axis=-1)
        # The forearm seen from joint 3, and from the base before joint 1 turns.
        x, y = -c3 * s4, -s3 * s4
        x, z = c2 * x + s2 * c4, c2 * c4 - s2 * x
        forearm = np.stack([c1 * x - s1 * y, s1 * x + c1 * y, z], axis=-1)
        spheres = np.empty((*q.shape[:-1], 11, 4))
        spheres[..., :4, :3] = UPPER_ARM * upper_arm[..., None, :] * _SHARES[4:]
        spheres[..., 4:, :3] = FOREARM * forearm[..., None, :] * _SHARES[1:]
        spheres[..., 4:, :3] += UPPER_ARM * upper_arm[..., None, :]
        spheres[..., 2] += SHOULDER
        spheres[..., 3] = LINK_RADIUS
        return spheres


def _link_frames(q: Array) -> Iterator[tuple[Array, Array]]:
    """R and p [m] in A of each joint's frame before it turns, and of the flange at last."""
    R = np.broadcast_to(np.eye(3), (*q.shape[:-1], 3, 3))
    p = np.zeros((*q.shape[:-1], 3))
    turns = _joint_rotations(q)
    # Distance of each joint's frame from the one before, along z.
    for joint, offset in enumerate((0.11, 0.20, 0.20, 0.20, 0.20, 0.19, FLANGE)):
        p = p + R[..., :, 2] * offset
        yield R, p
        R = R @ turns[joint] if joint else turns[0]
    yield R, p


def _joint_rotations(q: Array) -> Array:
    """Rotation of each joint, shape (7, ..., 3, 3)."""
    angles = np.moveaxis(_SIGNS * q, -1, 0)
    cos, sin = np.cos(angles), np.sin(angles)
    R = np.zeros((*angles.shape, 3, 3))
    about_z, about_y = slice(0, None, 2), slice(1, None, 2)
    R[about_z, ..., 2, 2] = R[about_y, ..., 1, 1] = 1.0
    R[..., 0, 0] = cos
    R[about_z, ..., 1, 1], R[about_y, ..., 2, 2] = cos[about_z], cos[about_y]
    R[about_z, ..., 1, 0], R[about_z, ..., 0, 1] = sin[about_z], -sin[about_z]
    R[about_y, ..., 0, 2], R[about_y, ..., 2, 0] = sin[about_y], -sin[about_y]
    return R


def shoulder_to_wrist(q4: float) -> float:
    """Distance between shoulder and wrist at an angle of joint 4 [m]."""
    return float(np.sqrt(UPPER_ARM**2 + FOREARM**2 + 2.0 * UPPER_ARM * FOREARM * np.cos(q4)))


def _frames_along(x: Array, y: Array, z: Array) -> Array:
    """Frames with their first axis along (x, y, z), shapes (n,), and their second upwards."""
    level = np.hypot(x, y)
    length = np.maximum(np.hypot(level, z), 1e-9)
    cos, sin = x / np.maximum(level, 1e-9), y / np.maximum(level, 1e-9)
    level, rise = level / length, z / length
    R = np.zeros((*level.shape, 3, 3))
    R[..., 0, 0], R[..., 1, 0], R[..., 2, 0] = level * cos, level * sin, rise
    R[..., 0, 1], R[..., 1, 1], R[..., 2, 1] = -rise * cos, -rise * sin, level
    R[..., 0, 2], R[..., 1, 2] = sin, -cos
    return R


def _zyz_angles(R: Array) -> tuple[Array, Array, Array]:
    """Angles a, b ≥ 0 and c of rotations rot_z(a) rot_y(b) rot_z(c), (k, 3, 3), shape (k,) each."""
    b = np.arccos(np.clip(R[:, 2, 2], -1.0, 1.0))
    return np.arctan2(R[:, 1, 2], R[:, 0, 2]), b, np.arctan2(R[:, 2, 1], -R[:, 2, 0])

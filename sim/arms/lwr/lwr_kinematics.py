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

from sim.rotations import Array, cross, rot_x, rot_y, rot_z

SHOULDER, UPPER_ARM, FOREARM, FLANGE = 0.31, 0.40, 0.39, 0.078
"""Heights of the shoulder above the base and lengths of the links [m]."""

JOINT_OFFSETS = (0.11, 0.20, 0.20, 0.20, 0.20, 0.19, 0.078)
"""Distance of each joint's frame from the one before, along z [m]."""

LIMITS = np.radians([170.0, 120.0, 170.0, 120.0, 170.0, 120.0, 170.0])
"""Largest magnitude of each joint angle [rad]."""

LINK_RADIUS = 0.065
"""Radius of the links, a little more than that of their capsules [m]."""

# Below these |q2| and |q6| the axes of joints 1 and 3, or 5 and 7, nearly coincide [rad].
_SHOULDER_SINGULARITY, _WRIST_SINGULARITY = 0.01, 0.05
_WRIST_BEND = 0.15  # |q6| stays above this where the arm is to move on [rad]
_ELBOW_STEP = 15.0  # between elbow angles worth trying [degrees]

_TURNS = (rot_z, rot_y, rot_z, rot_y, rot_z, rot_y, rot_z)
_SIGNS = np.array([1.0, 1.0, 1.0, -1.0, 1.0, 1.0, 1.0])  # joint 4 turns about −y
_AXES = _SIGNS[:, None] * np.eye(3)[[2, 1, 2, 1, 2, 1, 2]]

BRANCHES = tuple(itertools.product((1.0, -1.0), repeat=3))
"""Signs of joints 4, 2 and 6 of the eight solutions."""


@dataclass(frozen=True)
class LwrKinematics:
    """The seven-joint arm; see `sim.arms.arm_kinematics.ArmKinematics`."""

    joint_names = tuple(f"arm_joint_{i}" for i in range(1, 8))
    efforts = np.array([176.0, 176.0, 100.0, 100.0, 100.0, 38.0, 38.0])
    branches = len(BRANCHES)
    redundancy_samples = np.radians(np.arange(-180.0, 180.0, _ELBOW_STEP))
    p_FW = np.array([0.0, 0.0, -FLANGE])
    link_radius = LINK_RADIUS
    base_link, flange_link = "arm_base", "arm_link_7"
    model_file = resources.files("sim") / "arms" / "lwr" / "lwr_arm.urdf"

    def forward(self, q: Array) -> tuple[Array, Array]:
        """Flange pose R_AF and p_AF [m]."""
        *_, (R_AF, p_AF) = _link_frames(q)
        return R_AF, p_AF

    def joint_origins(self, q: Array) -> Array:
        """Origins of the joints' frames in A, shape (..., 7, 3) [m]."""
        return np.stack([p for _, p in itertools.islice(_link_frames(q), 7)], axis=-2)

    def torques(self, q: Array, p_AC: Array, f_A: Array) -> Array:
        """Torques with which the joints exert a force at a point, Jᵀf [N·m]."""
        joints = itertools.islice(_link_frames(q), 7)
        each = [
            np.sum(R @ axis * cross(p_AC - p, f_A), axis=-1)
            for (R, p), axis in zip(joints, _AXES, strict=True)
        ]
        return np.stack(each, axis=-1)

    def inverse(
        self,
        R_AF: Array,
        p_AF: Array,
        redundancy: Array,
        branches: Sequence[int] | None = None,
    ) -> tuple[Array, NDArray[np.bool_]]:
        """Joint angles for flange poses; the redundancy angle is that of the elbow."""
        p_SW = p_AF - FLANGE * R_AF[:, :, 2] - np.array([0.0, 0.0, SHOULDER])
        squared = np.sum(p_SW * p_SW, axis=1)
        cos_q4 = (squared - UPPER_ARM**2 - FOREARM**2) / (2.0 * UPPER_ARM * FOREARM)
        reachable = np.abs(cos_q4) < 1.0 - 1e-4
        bend = np.arccos(np.clip(cos_q4, -1.0, 1.0))
        R_arm = _frames_along(*p_SW.T) @ rot_x(redundancy)

        signs = BRANCHES if branches is None else [BRANCHES[k] for k in branches]
        q = np.empty((len(p_AF), len(signs), 7))
        for sign_4 in {sign for sign, _, _ in signs}:
            q4 = sign_4 * bend
            # The line from shoulder to wrist, seen from joint 3 at zero angles of joints 1 to 3.
            line = -FOREARM * np.sin(q4), np.zeros_like(q4), UPPER_ARM + FOREARM * np.cos(q4)
            R_03 = R_arm @ np.swapaxes(_frames_along(*line), -1, -2)
            R_47 = np.swapaxes(R_03 @ rot_y(-q4), -1, -2) @ R_AF
            shoulder, wrist = _zyz_angles(R_03), _zyz_angles(R_47)
            for column, (sign, sign_2, sign_6) in enumerate(signs):
                if sign == sign_4:
                    q[:, column, :3] = shoulder[0 if sign_2 > 0.0 else 1]
                    q[:, column, 3] = q4
                    q[:, column, 4:] = wrist[0 if sign_6 > 0.0 else 1]
        valid = (
            reachable[:, None]
            & (np.abs(q) < LIMITS).all(axis=-1)
            & (np.abs(q[..., 1]) > _SHOULDER_SINGULARITY)
            & (np.abs(q[..., 5]) > _WRIST_SINGULARITY)
        )
        return q, valid

    def joint_room(self, q: Array) -> Array:
        """Least distance of any joint from its limits [rad]."""
        return np.asarray((LIMITS - np.abs(q)).min(axis=-1))

    def is_regular(self, q: Array) -> NDArray[np.bool_]:
        """Joint angles with the wrist bent enough to move on."""
        return np.asarray(np.abs(q[..., 5]) > _WRIST_BEND)

    def is_in_range(self, p_AW: Array, margin: float) -> NDArray[np.bool_]:
        """Wrist centres within the reach of the elbow; the room is that of joint 4."""
        distance = np.linalg.norm(p_AW - np.array([0.0, 0.0, SHOULDER]), axis=-1)
        nearest = shoulder_to_wrist(LIMITS[3] - margin)
        return np.asarray((distance > nearest) & (distance < shoulder_to_wrist(0.0)))

    def spheres(self, q: Array) -> Array:
        """Spheres from the elbow to the wrist.

        The links above the shoulder stay within the mount's reach and far from the table.
        """
        shoulder, elbow, wrist = (p for _, p in itertools.islice(_link_frames(q), 1, 6, 2))
        t = np.linspace(0.0, 1.0, 8)[:, None]
        upper = shoulder[..., None, :] + (elbow - shoulder)[..., None, :] * t[4:]
        lower = elbow[..., None, :] + (wrist - elbow)[..., None, :] * t[1:]
        centres = np.concatenate([upper, lower], axis=-2)
        return np.concatenate([centres, np.full((*centres.shape[:-1], 1), LINK_RADIUS)], axis=-1)


def _link_frames(q: Array) -> Iterator[tuple[Array, Array]]:
    """R and p [m] in A of each joint's frame before it turns, and of the flange at last."""
    R = np.broadcast_to(np.eye(3), (*q.shape[:-1], 3, 3))
    p = np.zeros((*q.shape[:-1], 3))
    for joint, (turn, offset) in enumerate(zip(_TURNS, JOINT_OFFSETS, strict=True)):
        p = p + R[..., :, 2] * offset
        yield R, p
        R = R @ turn(_SIGNS[joint] * q[..., joint])
    yield R, p


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


def _zyz_angles(R: Array) -> tuple[Array, Array]:
    """Angles of R = rot_z(a) rot_y(b) rot_z(c), once with b ≥ 0 and once with b ≤ 0."""
    b = np.arccos(np.clip(R[:, 2, 2], -1.0, 1.0))
    a = np.arctan2(R[:, 1, 2], R[:, 0, 2])
    c = np.arctan2(R[:, 2, 1], -R[:, 2, 0])
    bent = np.stack([a, b, c], axis=-1)
    turned = bent - np.copysign(np.pi, bent)
    turned[:, 1] = -b
    return bent, turned

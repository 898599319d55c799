"""Kinematics of the seven-joint arm, in closed form.

Model: a spherical shoulder, an elbow and a spherical wrist (the LWR's alternating axes), so a
flange pose leaves one freedom: the elbow's angle about the line from shoulder to wrist. For each
elbow angle there are eight solutions (the signs of joints 2, 4 and 6).

Frames: A is the arm's base, z along joint 1; F the flange. The figures are those of
`robots/lwr_arm.urdf`; a test holds the two together.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import numpy as np

from sim.rotations import Array, cross, rot_x, rot_y, rot_z

SHOULDER, UPPER_ARM, FOREARM, FLANGE = 0.31, 0.40, 0.39, 0.078
"""Heights of the shoulder above the base and lengths of the links [m]."""

JOINT_OFFSETS = (0.11, 0.20, 0.20, 0.20, 0.20, 0.19, 0.078)
"""Distance of each joint's frame from the one before, along z [m]."""

LIMITS = np.radians([170.0, 120.0, 170.0, 120.0, 170.0, 120.0, 170.0])
"""Largest magnitude of each joint angle [rad]."""

EFFORTS = np.array([176.0, 176.0, 100.0, 100.0, 100.0, 38.0, 38.0])
"""Largest torque of each joint [N·m]."""

JOINT_NAMES = tuple(f"arm_joint_{i}" for i in range(1, 8))

# Below these |q2| and |q6| the axes of joints 1 and 3, or 5 and 7, nearly coincide [rad].
_SHOULDER_SINGULARITY, _WRIST_SINGULARITY = 0.01, 0.05


def _elbow_turn(angle: Array) -> Array:
    """Joint 4 turns about −y."""
    return rot_y(-angle)


_AXES = np.array([[0, 0, 1], [0, 1, 0], [0, 0, 1], [0, -1, 0], [0, 0, 1], [0, 1, 0], [0, 0, 1.0]])

_JOINT_TURNS: tuple[Callable[[Array], Array], ...] = (
    rot_z,
    rot_y,
    rot_z,
    _elbow_turn,
    rot_z,
    rot_y,
    rot_z,
)


def forward(q: Array) -> tuple[Array, Array, Array]:
    """Flange pose and the joints' positions.

    Args:
        q: joint angles, shape (..., 7) [rad].

    Returns:
        R_AF shape (..., 3, 3), p_AF shape (..., 3) [m], and the origins of the seven joint
        frames in A, shape (..., 7, 3) [m].
    """
    R = np.broadcast_to(np.eye(3), (*q.shape[:-1], 3, 3))
    p = np.zeros((*q.shape[:-1], 3))
    origins = []
    for joint, (turn, offset) in enumerate(zip(_JOINT_TURNS, JOINT_OFFSETS, strict=True)):
        p = p + R[..., :, 2] * offset
        origins.append(p)
        R = R @ turn(q[..., joint])
    return R, p, np.stack(origins, axis=-2)


def holding(q: Array, p_AC: Array, f_A: Array) -> Array:
    """Torques with which the joints exert a force at a point, Jᵀf.

    Args:
        q: joint angles, shape (..., 7) [rad].
        p_AC: the point in A, shape (..., 3) [m].
        f_A: the force on what is touched, in A, shape (..., 3) [N].

    Returns:
        Shape (..., 7) [N·m].
    """
    R = np.broadcast_to(np.eye(3), (*q.shape[:-1], 3, 3))
    p = np.zeros((*q.shape[:-1], 3))
    torques = []
    for joint, (turn, offset) in enumerate(zip(_JOINT_TURNS, JOINT_OFFSETS, strict=True)):
        p = p + R[..., :, 2] * offset
        torques.append(np.sum(R @ _AXES[joint] * cross(p_AC - p, f_A), axis=-1))
        R = R @ turn(q[..., joint])
    return np.stack(torques, axis=-1)


def stretched(q4: float) -> float:
    """Distance between shoulder and wrist at an angle of joint 4 [m]."""
    return float(np.sqrt(UPPER_ARM**2 + FOREARM**2 + 2.0 * UPPER_ARM * FOREARM * np.cos(q4)))


def _pointing(x: Array, y: Array, z: Array) -> Array:
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


BRANCHES = tuple(itertools.product((1.0, -1.0), repeat=3))
"""Signs of joints 4, 2 and 6 of the eight solutions."""


def inverse(
    R_AF: Array, p_AF: Array, elbow: Array, branches: Sequence[int] = tuple(range(8))
) -> tuple[Array, Array]:
    """All joint angles that bring the flange to a pose with a given elbow angle.

    Args:
        R_AF: flange orientations, shape (n, 3, 3).
        p_AF: flange positions, shape (n, 3) [m].
        elbow: angle of the elbow about the line from shoulder to wrist, shape (n,) [rad].
        branches: which of the solutions, k of them; all eight if not given.

    Returns:
        Joint angles, shape (n, k, 7) [rad], and which of them reach the pose within the joint
        limits and away from the singularities, shape (n, k).
    """
    p_SW = p_AF - FLANGE * R_AF[:, :, 2] - np.array([0.0, 0.0, SHOULDER])
    squared = np.sum(p_SW * p_SW, axis=1)
    cos_q4 = (squared - UPPER_ARM**2 - FOREARM**2) / (2.0 * UPPER_ARM * FOREARM)
    reachable = np.abs(cos_q4) < 1.0 - 1e-4
    bend = np.arccos(np.clip(cos_q4, -1.0, 1.0))
    R_arm = _pointing(*p_SW.T) @ rot_x(elbow)

    q = np.empty((len(p_AF), len(branches), 7))
    for sign_4 in {BRANCHES[k][0] for k in branches}:
        q4 = sign_4 * bend
        # The same line from shoulder to wrist, seen from joint 3 at zero angles of joints 1 to 3.
        line = -FOREARM * np.sin(q4), np.zeros_like(q4), UPPER_ARM + FOREARM * np.cos(q4)
        R_03 = R_arm @ np.swapaxes(_pointing(*line), -1, -2)
        R_47 = np.swapaxes(R_03 @ rot_y(-q4), -1, -2) @ R_AF
        shoulder, wrist = _zyz(R_03), _zyz(R_47)
        for column, (sign, sign_2, sign_6) in enumerate(BRANCHES[k] for k in branches):
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


def _zyz(R: Array) -> tuple[Array, Array]:
    """Angles of R = rot_z(a) rot_y(b) rot_z(c), once with b ≥ 0 and once with b ≤ 0."""
    b = np.arccos(np.clip(R[:, 2, 2], -1.0, 1.0))
    a = np.arctan2(R[:, 1, 2], R[:, 0, 2])
    c = np.arctan2(R[:, 2, 1], -R[:, 2, 0])
    bent = np.stack([a, b, c], axis=-1)
    turned = bent - np.copysign(np.pi, bent)
    turned[:, 1] = -b
    return bent, turned

"""Kinematics and statics of the fingers of the four-finger hand.

Frames: P is the palm (z along the straight fingers, x the palm's normal, towards which fingers
flex). The figures are those of `four_finger_hand.urdf`; spheres cover every link a bit beyond its
collision shape there. Tests hold the two together.

A finger has three independent angles: abduction, proximal and middle flexion; the distal joint
follows the middle one.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Mapping

import numpy as np

from objectmodels.geometry.rotations import Array, axis_rotation, rot_x, rot_y, spatial_cross
from objectmodels.safety_figure import SafetyFigure
from sim.robots.collision_spheres import sphere_row
from sim.robots.hand import Angles, Posture

LINKS = (0.0678, 0.030, 0.0295)
"""Lengths of the proximal, middle and distal link [m]."""

TIP_RADIUS = 0.010
LINK_RADIUS = 0.010
JOINT_STIFFNESS = 8.0
"""Of the impedance control of each finger joint [N·m/rad]."""

EFFORT = 2.0
"""Largest torque of each finger joint [N·m]."""

EFFORT_SHARE: SafetyFigure = 0.8
"""Share of it that a push may take; the rest is for the impedance control."""

STOP_ROOM: SafetyFigure = 0.02
"""Room that a loaded joint keeps to its stops, which would bear what no sensor shows [rad]."""

FINGER_LIMITS = np.radians([[-20.0, 20.0], [-40.0, 85.0], [0.0, 100.0]])
"""Stops of abduction, proximal and middle joint, shape (3, 2) [rad]."""

FINGERS: tuple[str, ...] = ("index", "middle", "ring", "thumb")
FINGER_JOINTS = ("abduction", "proximal", "middle", "distal")
JOINT_NAMES = tuple(f"{finger}_{joint}" for finger in FINGERS for joint in FINGER_JOINTS[:3])

BASES: Mapping[str, Array] = {
    "index": np.array([0.0, 0.0268, 0.114]),
    "middle": np.array([0.0, 0.0, 0.119]),
    "ring": np.array([0.0, -0.0268, 0.114]),
    "thumb": np.array([0.08, 0.0, 0.08]),
}
_BASE_R = dict.fromkeys(FINGERS, np.eye(3)) | {
    "thumb": rot_y(np.radians(27.0)) @ axis_rotation([0.0, 0.0, 1.0], np.pi)
}

CURLED: Angles = (0.0, 1.40, 1.60)
"""A finger that is out of the way [rad]."""

RESTING = Posture(
    "resting", dict.fromkeys(FINGERS, CURLED) | {"thumb": (0.0, -0.65, 0.0)}, (), np.zeros((0, 3))
)
"""The hand while it waits."""

FLANGE_TO_PALM = 0.03
"""Distance from the flange to the palm's origin, along z [m]."""


def finger_points(finger: str, angles: Angles) -> Array:
    """Joints and tip of a finger in the palm frame.

    Args:
        finger: one of `FINGERS`.
        angles: abduction, proximal and middle flexion [rad].

    Returns:
        Proximal joint, middle joint, distal joint and fingertip centre, shape (4, 3) [m].
    """
    abduction, proximal, middle = angles
    # All joints but abduction bend the finger in one plane.
    x = z = bent = 0.0
    flat = [(x, 0.0, z)]
    for flexion, length in zip((proximal, middle, middle), LINKS, strict=True):
        bent += flexion
        x, z = x + length * math.sin(bent), z + length * math.cos(bent)
        flat.append((x, 0.0, z))
    return np.asarray(BASES[finger] + np.array(flat) @ _finger_frame(finger, abduction).T)


def _finger_frame(finger: str, abduction: float) -> Array:
    """Axes of a finger in P, shape (3, 3): of abduction, of flexion, along it when straight."""
    return np.asarray(_BASE_R[finger] @ rot_x(abduction))


@functools.cache
def _tip_chain() -> tuple[Array, Array]:
    """Middle flexions, and the tip from the proximal joint with them, along x and z, (n, 2)."""
    middle = np.linspace(FINGER_LIMITS[2, 1], 0.0, 4001)
    bends = np.outer(middle, [0.0, 1.0, 2.0])
    tips = np.stack([np.sin(bends) @ LINKS, np.cos(bends) @ LINKS], axis=-1)
    return middle, tips


def angles_reaching(finger: str, p_PT: Array) -> Angles | None:
    """Angles with which a finger that is not spread has its tip somewhere in its own plane.

    Args:
        finger: one of `FINGERS`.
        p_PT: the tip's centre in P, shape (3,) [m]; y does not count.

    Returns:
        None if it is too far, or too near to the finger's base; stops do not count otherwise.
    """
    x, _, z = _BASE_R[finger].T @ (p_PT - BASES[finger])
    middle, tips = _tip_chain()
    lengths = np.hypot(*tips.T)
    distance = float(np.hypot(x, z))
    if not lengths[0] < distance < lengths[-1]:
        return None
    flexion = float(np.interp(distance, lengths, middle))
    bends = flexion * np.array([0.0, 1.0, 2.0])
    own = np.arctan2(np.sin(bends) @ LINKS, np.cos(bends) @ LINKS)
    return 0.0, float(np.arctan2(x, z) - own), flexion


def finger_jacobian(finger: str, angles: Angles, p_PC: Array) -> Array:
    """Velocity of points of the distal link per rate of each independent joint.

    The distal joint follows the middle one, whose drive and torque sensor serve both.

    Args:
        finger: one of `FINGERS`.
        angles: abduction, proximal and middle flexion [rad].
        p_PC: the points in P, shape (..., 3) [m].

    Returns:
        Columns of abduction, proximal and middle joint, shape (..., 3, 3) [m].
    """
    base, middle, distal = finger_points(finger, angles)[:3]
    R = _finger_frame(finger, angles[0])
    from_base = p_PC - base
    # The distal joint's axis is parallel to the middle one's: their arms add up.
    arms = np.stack([from_base, from_base, 2.0 * p_PC - middle - distal], axis=-2)
    return np.swapaxes(spatial_cross(R[:, [0, 1, 1]].T, arms), -1, -2)


def tip_centre(finger: str, angles: Angles) -> Array:
    """Centre of a fingertip in P [m]."""
    return np.asarray(finger_points(finger, angles)[3])


def tip_force(finger: str, angles: Angles, p_PC: Array, torques: Array) -> Array:
    """Force at a point of a fingertip from its joints' torques, J⁻ᵀτ, in P [N]."""
    return np.asarray(np.linalg.solve(finger_jacobian(finger, angles, p_PC).T, torques))


def tip_stiffness(finger: str, angles: Angles, p_PC: Array) -> Array:
    """Force at points of the distal link per displacement, (J k⁻¹ Jᵀ)⁻¹, in P [N/m]."""
    J = finger_jacobian(finger, angles, p_PC)
    return np.asarray(np.linalg.inv(J @ np.swapaxes(J, -1, -2) / JOINT_STIFFNESS))


def force_noise_gain(finger: str, angles: Angles, p_PC: Array, along_P: Array) -> Array:
    """Noise of the force felt along unit directions per noise of a torque sensor [1/m]."""
    J = finger_jacobian(finger, angles, p_PC)
    return np.asarray(np.linalg.norm(np.linalg.solve(J, along_P[..., None])[..., 0], axis=-1))


def max_tip_force(finger: str, angles: Angles, p_PC: Array, load_P: Array) -> Array:
    """Largest multiple of a load that a finger exerts without overloading or stopping a joint.

    The joints are springs: exerting the torque Jᵀf, a joint gives way by Jᵀf/k towards a stop.

    Args:
        finger: one of `FINGERS`.
        angles: to which its joints are commanded [rad].
        p_PC: where it touches, in P, shape (..., 3) [m].
        load_P: force on what it touches, in P, shape (..., 3) [N].

    Returns:
        Shape (...).
    """
    J = finger_jacobian(finger, angles, p_PC)
    torque = np.einsum("...ij,...i->...j", J, load_P)
    low, high = FINGER_LIMITS.T
    room = np.where(torque > 0.0, angles - low, high - angles) - STOP_ROOM
    most = np.minimum(EFFORT_SHARE * EFFORT, JOINT_STIFFNESS * np.maximum(room, 0.0))
    return np.asarray((most / np.maximum(np.abs(torque), 1e-12)).min(axis=-1))


def is_at_stop(angles: Angles) -> bool:
    """True if a joint of a finger is at its stop, which bears what no torque sensor shows."""
    low, high = FINGER_LIMITS.T
    room = np.minimum(angles - low, high - angles)
    return bool(room.min() < 0.005)  # [rad]


def touching_posture(name: str, angles: Mapping[str, Angles], pushing: tuple[str, ...]) -> Posture:
    """The posture with some angles of all fingers, of which some touch."""
    tips = np.array([finger_points(finger, angles[finger])[3] for finger in pushing])
    return Posture(name, angles, pushing, tips)


def bent_posture(name: str, pushing: Mapping[str, Angles]) -> Posture:
    """The resting hand with some fingers bent to push."""
    return touching_posture(name, {**RESTING.angles, **pushing}, tuple(pushing))


@functools.lru_cache(maxsize=64)
def hand_spheres(posture: Posture, wrist: float) -> Array:
    """Spheres of palm, thumb block, wrist and fingers in P, shape (n, 4).

    The pushing fingertips themselves are left out, since they are meant to touch. `wrist` is the
    distance from the arm's wrist to its flange, which is covered too [m].
    """
    parts = [_palm_spheres(wrist)]
    for finger in FINGERS:
        points = finger_points(finger, posture.angles[finger])
        links = np.vstack(_link_spheres(points))
        if finger in posture.pushing:
            # It may come near the face only at its tip: so much more room per metre from there, up
            # to a largest allowance, keeps one nearly parallel to the face from touching it twice.
            from_tip = np.linalg.norm(links[:, :3] - points[-1], axis=1)
            links[:, 3] += np.clip(0.2 * (from_tip - 0.012), 0.0, 0.012)
            links = links[from_tip > 0.006]
        else:
            links[:, 3] += 0.004
            links = np.vstack([links, [*points[-1], TIP_RADIUS]])
        parts.append(links)
    return np.vstack(parts)


def whole_spheres(posture: Posture, wrist: float) -> Array:
    """The same with the pushing fingertips, which come last, shape (n, 4)."""
    tips = np.column_stack([posture.tips, np.full(len(posture.tips), TIP_RADIUS)])
    return np.vstack([hand_spheres(posture, wrist), tips])


def thin_spheres(posture: Posture, wrist: float) -> Array:
    """Spheres of the whole hand in P, its fingers as thin as they are, shape (n, 4)."""
    links = [
        spheres
        for finger in FINGERS
        for spheres in _link_spheres(finger_points(finger, posture.angles[finger]))
    ]
    return np.vstack([_palm_spheres(wrist), *links])


def _link_spheres(points: Array) -> list[Array]:
    """Spheres along the links between the joints and the tip of a finger."""
    return [sphere_row(a, b, LINK_RADIUS, 0.010) for a, b in itertools.pairwise(points)]


PALM_RADIUS: SafetyFigure = 0.022
"""Radius of the spheres that cover the palm [m]."""


@functools.cache
def _palm_spheres(wrist: float) -> Array:
    y, z = np.meshgrid(np.linspace(-0.036, 0.036, 4), np.linspace(0.010, 0.105, 5))
    palm = np.column_stack([np.zeros(y.size), y.ravel(), z.ravel()])
    block = sphere_row(np.array([0.02, 0.0, 0.052]), np.array([0.078, 0.0, 0.052]), 0.027, 0.015)
    behind = sphere_row(
        np.array([0.0, 0.0, -FLANGE_TO_PALM - wrist]),
        np.array([0.0, 0.0, -0.005]),
        0.05,
        0.025,
    )
    return np.vstack([np.column_stack([palm, np.full(len(palm), PALM_RADIUS)]), block, behind])

"""In which hands the robot pushes: postures of the fingers and orientations of the palm.

Model: all postures, tilts along the push, sides and rolls are looked at once. Kept are those whose
torque sensors feel the push and whose fingers press straight when loaded. For each it is known how
much force it bears, and where its spheres are about the fingertips: a push turns and shifts them,
no more.

A fingertip that sticks to the face drags along it as the fingers' own stiffness has it; one that
slips does not. A hand must bear both.

Frames: D is the frame of a push (x into the touched face, z up), P the palm, T the midpoint of the
pushing fingertips' centres.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping

import numpy as np

from sim.hands.four_finger.hand_kinematics import (
    BASES,
    TIP_RADIUS,
    finger_points,
    force_noise_gain,
    max_tip_force,
    tip_stiffness,
)
from sim.hands.four_finger.hand_posture import bent_posture, whole_spheres
from sim.hands.hand_model import Posture, PostureSet
from sim.rotations import Array, rot_x, rot_y, rot_z

LARGEST_SKEW = 0.35
"""Largest vertical force per force along the push of a hand that is used.

Loaded along the push, a slanted finger also presses up or down. Pressing down makes the object
heavier on the table, which makes it move in jerks."""

FINGER_SPREADS: tuple[float, ...] = (0.04, 0.032, 0.024)
"""Distances between the fingertips of a two-finger push, the largest first [m]."""

_TILTS = np.radians(np.arange(-60.0, 83.0, 7.5))
_SIDES = np.radians([0.0, -30.0, 30.0])
_FINE_SIDES = np.radians([0.0, -15.0, 15.0, -30.0, 30.0, -45.0, 45.0, -60.0, 60.0])

# 1 / lever with which the sensors feel the push [1/m]: 60 makes 1.6 mN·m a noise of 0.1 N.
_COARSEST_FEELING = 60.0
_CLOSED = 1.2  # flexion of the middle joint from which a finger counts as closed [rad]
_BLURRED = 0.2  # what a closed finger counts less, as a skew

# Proximal and middle flexion [rad]: fingers stretched back at the base and bent towards the tip
# press clear of the palm, and hooked ones are about as stiff across as along. Those stretched back
# as far as they go reach lowest, but bear little before they come to their stops.
_FLEXIONS: Mapping[str, tuple[float, float]] = {
    "arched": (-0.40, 0.50),
    "arched back": (-0.57, 0.50),
    "arched far back": (-0.65, 0.50),
    "bent back": (-0.57, 0.70),
    "bent far back": (-0.65, 0.70),
    "bent": (-0.40, 0.70),
    "straight": (0.0, 0.50),
    "hooked back": (-0.57, 1.10),
    "hooked far back": (-0.65, 1.10),
    "hooked": (-0.20, 0.90),
    "closed": (-0.40, 1.30),
}


@functools.cache
def one_finger_postures() -> tuple[Posture, ...]:
    """Postures that push with the tip of the index, middle or ring finger."""
    return tuple(
        bent_posture(f"{finger} {name}", {finger: (0.0, *flexion)})
        for finger in ("middle", "index", "ring")
        for name, flexion in _FLEXIONS.items()
    )


@functools.cache
def two_finger_postures(spread: float) -> tuple[Posture, ...]:
    """Postures that push with index and ring, their tips' centres a distance apart [m]."""
    postures = []
    for name, flexion in _FLEXIONS.items():
        length = finger_points("index", (0.0, *flexion))[3, 2] - BASES["index"][2]
        # Abduction by a turns the finger's z towards −y: the tip moves by −length·sin(a).
        inward = float(np.arcsin((BASES["index"][1] - spread / 2.0) / length))
        pushing = {"index": (inward, *flexion), "ring": (-inward, *flexion)}
        postures.append(bent_posture(f"two fingers {name}", pushing))
    return tuple(postures)


@functools.cache
def pushing_postures(
    fingers: int, spread: float, *, fine: bool = False, wrist: float
) -> PostureSet:
    """See `Hand.pushing_postures`; one finger lets the palm lean to its sides, two do not."""
    sides = np.zeros(1) if fingers == 2 else _FINE_SIDES if fine else _SIDES
    tilt, side, roll = (
        a.ravel() for a in np.meshgrid(_TILTS, sides, np.array([0.0, np.pi]), indexing="ij")
    )
    # At zero tilt the fingers point down; a positive tilt leans the hand back, behind the push.
    upright = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
    turned = rot_x(side) @ rot_y(-tilt) @ upright @ rot_z(roll)
    postures = one_finger_postures() if fingers == 1 else two_finger_postures(spread)
    which = np.repeat(np.arange(len(postures)), len(turned))
    R_DP = np.tile(turned, (len(postures), 1, 1))
    coarse, skew, bears = np.hstack([pushing_quality(posture, turned) for posture in postures])
    good = np.flatnonzero((coarse < _COARSEST_FEELING) & (skew < LARGEST_SKEW))
    # A finger that is closed gives way across as it presses, which blurs what it feels.
    closed = [any(each.angles[f][2] >= _CLOSED for f in each.pushing) for each in postures]
    blurred = np.repeat(closed, len(turned))
    order = good[np.argsort((skew + coarse / 200.0 + _BLURRED * blurred)[good], kind="stable")]
    which, R_DP = which[order], R_DP[order]
    spheres = tuple(whole_spheres(posture, wrist) for posture in postures)
    return PostureSet.from_postures(postures, spheres, which, R_DP, bears[order])


def pushing_quality(posture: Posture, R_DP: Array) -> tuple[Array, Array, Array]:
    """Quality of a push along D's x axis in each orientation, by the hand's worst finger.

    Args:
        posture: of its fingers.
        R_DP: orientations of the palm, shape (n, 3, 3).

    Returns:
        Noise of the felt push per noise of a torque sensor [1/m], the vertical force per force
        along the push while the fingertip sticks to the face, and the force that each finger bears
        [N]; all of shape (n,).
    """
    into_face, up = R_DP[:, 0], R_DP[:, 2]  # D's x and z axes in P
    coarse, skew, bears = np.zeros(len(R_DP)), np.zeros(len(R_DP)), np.full(len(R_DP), np.inf)
    for finger, tip in zip(posture.pushing, posture.tips, strict=True):
        angles, p_PC = posture.angles[finger], tip + TIP_RADIUS * into_face
        stiffness = tip_stiffness(finger, angles, p_PC)
        force = (R_DP @ stiffness @ into_face[..., None])[..., 0]
        drag = force[:, 2] / force[:, 0]
        coarse = np.maximum(coarse, force_noise_gain(finger, angles, p_PC, into_face))
        skew = np.maximum(skew, np.abs(drag))
        for load in (into_face, into_face + drag[:, None] * up):
            bears = np.minimum(bears, max_tip_force(finger, angles, p_PC, load))
    return coarse, skew, bears

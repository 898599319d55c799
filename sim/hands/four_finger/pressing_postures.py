"""In which hands a fingertip presses down on something level, to draw it along.

Model: one finger pokes down, more or less slanted, the palm turned anywhere about the vertical.
Kept are hands that are clear of the plane on which they press, whose torque sensors feel the
pressing, and whose finger bears it, with the friction along the plane and without.

Frames: D has its x axis along the drag, z up; P is the palm, T the fingertip's centre.
"""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np

from sim.hands.four_finger.hand_kinematics import TIP_RADIUS, force_noise_gain, max_tip_force
from sim.hands.four_finger.hand_posture import whole_spheres
from sim.hands.four_finger.pushing_postures import one_finger_postures
from sim.hands.hand_model import Posture, PostureSet
from sim.rotations import Array, rot_x, rot_y, rot_z

_LEANS = np.radians(np.arange(-45.0, 46.0, 15.0))  # of the palm, along the finger's flexion
_SIDES = np.radians([0.0, -30.0, 30.0])
_HEADINGS = np.radians(np.arange(0.0, 360.0, 30.0))
_DOWN, _AHEAD = np.array([0.0, 0.0, -1.0]), np.array([1.0, 0.0, 0.0])

_ASIDE = 0.5
"""Force along the drag per pressing force that a finger bears; more than most things take."""

_COARSEST_FEELING = 60.0  # 1 / lever with which the sensors feel the pressing [1/m]
_CLEAR = 0.004  # of all but the fingertip from the plane on which it presses [m]


@functools.cache
def pressing_postures(wrist: float) -> PostureSet:
    """See `Hand.pressing_postures`; `wrist` as of `FourFingerHand`."""
    heading, lean, side = (a.ravel() for a in np.meshgrid(_HEADINGS, _LEANS, _SIDES, indexing="ij"))
    # Fingers straight down.
    upright = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
    R_DP = rot_z(heading) @ rot_x(side) @ rot_y(-lean) @ upright
    postures = one_finger_postures()
    spheres = tuple(whole_spheres(posture, wrist) for posture in postures)
    every = PostureSet.from_postures(
        postures,
        spheres,
        np.repeat(np.arange(len(postures)), len(R_DP)),
        np.tile(R_DP, (len(postures), 1, 1)),
        np.concatenate([_strength(posture, R_DP) for posture in postures]),
    )
    clear = every.lowest_points > _CLEAR - TIP_RADIUS
    good = every[np.flatnonzero(clear & (every.strength > 0.0))]
    best = good[np.argsort(-good.strength.round(1), kind="stable")]
    return replace(best, number=np.arange(len(best)))


def _strength(posture: Posture, R_DP: Array) -> Array:
    """Pressing force that the finger bears in each orientation [N]; 0 where it feels it badly."""
    (finger,), (tip,) = posture.pushing, posture.tips
    angles, down = posture.angles[finger], _DOWN @ R_DP
    p_PC = tip + TIP_RADIUS * down
    bears = np.full(len(R_DP), np.inf)
    for along in (0.0, _ASIDE):
        load = (_DOWN + along * _AHEAD) @ R_DP
        bears = np.minimum(bears, max_tip_force(finger, angles, p_PC, load))
    coarse = force_noise_gain(finger, angles, p_PC, down)
    return np.where(coarse < _COARSEST_FEELING, bears, 0.0)

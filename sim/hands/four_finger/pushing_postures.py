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
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.arms.lwr import lwr_kinematics as arm
from sim.collision import collision_spheres as spheres
from sim.hands.four_finger.hand_kinematics import (
    FLANGE_TO_PALM,
    TIP_RADIUS,
    Posture,
    force_noise_gain,
    max_tip_force,
    one_finger_postures,
    tip_stiffness,
    two_finger_postures,
)
from sim.rotations import Array, rot_x, rot_y, rot_z

LARGEST_SKEW = 0.35
"""Largest vertical force per force along the push of a hand that is used.

Loaded along the push, a slanted finger also presses up or down. Pressing down makes the object
heavier on the table, which makes it move in jerks."""

_TILTS = np.radians(np.arange(-60.0, 83.0, 7.5))
_SIDES = np.radians([0.0, -30.0, 30.0])
_FINE_SIDES = np.radians([0.0, -15.0, 15.0, -30.0, 30.0, -45.0, 45.0, -60.0, 60.0])

# 1 / lever with which the sensors feel the push [1/m]: 60 makes 1.6 mN·m a noise of 0.1 N.
_COARSEST_FEELING = 60.0
_BLURRED = 0.2  # what a closed finger counts less, as a skew


@dataclass(frozen=True, eq=False)
class PostureSet:
    """Postures and orientations of the palm, n of them, the best first.

    Attributes:
        postures: the different ones.
        which: index of the posture, shape (n,).
        R_DP: orientation of the palm, shape (n, 3, 3).
        strength: force along the push that each pushing finger bears, shape (n,) [N].
        centres: of the spheres of the hand, the pushing tips last, from T, in D,
            shape (n, k, 3) [m].
        radii: of these, shape (n, k) [m].
        palm: origin of P, from T, in D, shape (n, 3) [m].
        wrist: of the arm, from T, in D, shape (n, 3) [m].
    """

    postures: tuple[Posture, ...]
    which: NDArray[np.intp]
    R_DP: Array
    strength: Array
    centres: Array
    radii: Array
    palm: Array
    wrist: Array

    def __len__(self) -> int:
        return len(self.which)

    def __getitem__(self, chosen: NDArray[np.bool_] | NDArray[np.intp] | slice) -> PostureSet:
        return PostureSet(
            self.postures,
            self.which[chosen],
            self.R_DP[chosen],
            self.strength[chosen],
            self.centres[chosen],
            self.radii[chosen],
            self.palm[chosen],
            self.wrist[chosen],
        )

    def posture(self, index: int) -> Posture:
        """Of one of them."""
        return self.postures[int(self.which[index])]

    @property
    def tip_count(self) -> int:
        """How many fingers push."""
        return len(self.postures[0].pushing)

    @functools.cached_property
    def lowest(self) -> Array:
        """Height of the lowest point but the pushing tips above T, shape (n,) [m]."""
        tips = self.tip_count
        below = self.centres[:, :-tips, 2] - self.radii[:, :-tips]
        return np.asarray(below.min(axis=1, initial=np.inf))

    @functools.cached_property
    def size(self) -> float:
        """Largest horizontal distance of any point from T [m]."""
        far = np.hypot(self.centres[..., 0], self.centres[..., 1]) + self.radii
        return float(far.max(initial=0.0))

    def placed(self, R_WD: Array, points: Array) -> Array:
        """The spheres in W with T at w points, shape (n, w, k, 4).

        Args:
            R_WD: frame of the push at each point, shape (w, 3, 3).
            points: shape (w, 3), or (n, w, 3) [m].
        """
        centres = self.centres[:, None] @ np.swapaxes(R_WD, -1, -2) + points[..., None, :]
        radii = np.broadcast_to(self.radii[:, None, :, None], (*centres.shape[:-1], 1))
        return np.concatenate([centres, radii], axis=-1)


@functools.cache
def hands(fingers: int, spread: float, *, fine: bool = False) -> PostureSet:
    """Everything in which a hand may push with so many fingers.

    Args:
        fingers: one, which lets the palm lean to its sides, or two, which do not.
        spread: distance between two fingertips [m].
        fine: whether it may lean by small angles and large ones.
    """
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
    coarse, skew, bears = np.hstack([quality(posture, turned) for posture in postures])
    good = np.flatnonzero((coarse < _COARSEST_FEELING) & (skew < LARGEST_SKEW))
    # A finger that is closed gives way across as it presses, which blurs what it feels.
    blurred = np.repeat([posture.closed for posture in postures], len(turned))
    order = good[np.argsort((skew + coarse / 200.0 + _BLURRED * blurred)[good], kind="stable")]
    which, R_DP = which[order], R_DP[order]
    tips = np.array([posture.midpoint for posture in postures])[which]
    palm = -(R_DP @ tips[..., None])[..., 0]
    about_T = _padded(postures)[which]
    return PostureSet(
        postures,
        which,
        R_DP,
        bears[order],
        (about_T[..., :3] - tips[:, None]) @ np.swapaxes(R_DP, -1, -2),
        about_T[..., 3],
        palm,
        palm - (FLANGE_TO_PALM + arm.FLANGE) * R_DP[..., 2],
    )


def strongest(fingers: int, spread: float) -> float:
    """Largest force of one fingertip in any hand [N]."""
    return float(hands(fingers, spread).strength.max())


def _padded(postures: tuple[Posture, ...]) -> Array:
    """Spheres of each posture in P, as many of each: some twice, shape (m, k, 4)."""
    each = [spheres.whole_hand(posture) for posture in postures]
    most = max(map(len, each))
    return np.array([np.vstack([np.tile(some[:1], (most - len(some), 1)), some]) for some in each])


def quality(posture: Posture, R_DP: Array) -> tuple[Array, Array, Array]:
    """How well a hand pushes along D's x axis in each orientation, by its worst finger.

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

"""Grasps of something of a width: four fingertips on two parallel sides.

Model: no finger is spread, so that each moves in its own plane across the palm. The fingertips
touch at one height along the straight fingers, thumb against the other three, and close along a
line: a posture is a width. Of all places where they meet, the one that bears the largest squeeze is
taken, with a fingertip leading each finger and room for something deep before the palm. About a
round side index and ring finger go on as far as that lies back beside the middle finger, and press
a little towards each other.

Frames: P is the palm; x is the closing direction, from the fingers' side to the thumb's.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from objectmodels.geometry.rotations import spatial_cross
from planner.types.robot import Grip
from sim.hands.four_finger.hand_kinematics import (
    EFFORT,
    EFFORT_SHARE,
    FINGER_LIMITS,
    FINGERS,
    JOINT_STIFFNESS,
    STOP_ROOM,
    TIP_RADIUS,
    angles_reaching,
    finger_jacobian,
    finger_points,
    tip_stiffness,
)
from sim.hands.four_finger.hand_posture import CURLED, hand_spheres, touching_posture
from sim.hands.hand_model import Angles, GraspPosture, Posture
from sim.rotations import Array

HOLDING: tuple[str, ...] = ("thumb", "index", "middle", "ring")
"""The fingers that hold, in the order of `Grip.contacts`."""

SHARES = np.array([1.0, 1 / 3, 1 / 3, 1 / 3])
"""Of the squeeze that each of them bears: the fingers stand side by side about the thumb."""

PINCH = np.array([1.0, 0.0, 1.0, 0.0])
"""The same where thumb and middle finger alone close about a knob, past which the others go."""

_OUTER = ("index", "ring")  # beside the middle finger, which is opposite the thumb

NARROWEST, WIDEST = 0.008, 0.100
"""Widths that the hand closes about [m]."""

OPENING = 0.020
"""How far the fingertips stand off each side before they close; less of what is wide [m]."""

_LEAST_OPENING = 0.003  # less does not get around what is seen a little wrongly [m]
_DEEP_OPENING = 0.006  # the least about something deep, which the palm is close to [m]
_FACE_ROOM = 0.003  # between the hand and a side that it does not touch [m]
_ACROSS = np.arange(0.030, 0.0901, 0.005)  # middle of the grasp along the closing direction [m]
_ALONG = np.arange(0.165, 0.2051, 0.005)  # along the straight fingers [m]
_DEPTH_WORTH = 100.0  # squeeze that room before the palm is worth [N/m]
_OPENING_WORTH = 200.0  # the same of room beside what it closes about
_HANGING_WORTH = 1000.0  # the same of joints that do not hang below the fingertips of a pinch
_LEAN = np.radians([20.0, 125.0])  # of a distal link that leads with its tip [rad]
_LOADS = ((0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))  # tangential, per squeeze
_UNKNOWN = Grip(np.zeros((4, 2)), SHARES, 0.0, (0.0, 0.0))


@dataclass(frozen=True, eq=False)
class FourFingerGrasp(GraspPosture):
    """A grasp of this hand.

    Attributes:
        shares: of the squeeze that each of `HOLDING` bears, shape (4,).
    """

    shares: Array = field(default_factory=lambda: SHARES)

    @property
    def touching_fingers(self) -> tuple[str, ...]:
        """The fingers that touch."""
        return _touching_fingers(self.shares)

    def posture_at(self, opening: float = 0.0) -> Posture:
        """The hand with its fingertips off each side; the others are curled up."""
        name = f"grip of {1e3 * self.width:.0f} mm"
        x, _, z = self.middle.tolist()
        width = self.width + 2.0 * opening
        return _closed_posture(name, width, x, z, self.touching_fingers, self.press.behind)

    def touch_point(self, finger: str) -> Array:
        """Place at which a finger touches, in P, shape (3,) [m]."""
        tip = finger_points(finger, self.posture_at().angles[finger])[3]
        return np.asarray(tip + TIP_RADIUS * closing_direction(finger))

    @functools.cached_property
    def squeeze_offsets(self) -> Array:
        """Change of the commanded angles per squeeze [rad/N]."""
        beside = {"index": -self.press.inward, "ring": self.press.inward}
        torques = [self._finger_torques(finger, 0.0, beside.get(finger, 0.0)) for finger in FINGERS]
        return np.concatenate(torques) / JOINT_STIFFNESS

    def force_offsets(self, force_P: Array) -> Array:
        """Change of the commanded angles with which both sides together exert a force [rad]."""
        forces = {f: 0.5 * share * force_P for f, share in zip(HOLDING, self.shares, strict=True)}
        torques = [self._finger_jacobians[f].T @ forces[f] for f in FINGERS]
        return np.concatenate(torques) / JOINT_STIFFNESS

    @functools.cached_property
    def _finger_jacobians(self) -> dict[str, Array]:
        angles = self.posture_at().angles
        return {f: finger_jacobian(f, angles[f], self.touch_point(f)) for f in FINGERS}

    def _finger_torques(self, finger: str, along: float, beside: float) -> Array:
        """Torques per squeeze with a tangential load beside it, shape (3,) [m]."""
        load = self.shares[HOLDING.index(finger)] * (
            closing_direction(finger) + np.array([0.0, beside, along])
        )
        return np.asarray(self._finger_jacobians[finger].T @ load)

    def depth_at(self, opening: float, wrist: float) -> float:
        """Room between its middle and what of the hand is beside or before the width [m]."""
        spheres = hand_spheres(self.posture_at(opening), wrist)
        beside = np.abs(spheres[:, 0] - self.middle[0]) - spheres[:, 3]
        inside = spheres[beside < self.width / 2.0 + _FACE_ROOM]
        return float(self.middle[2] - (inside[:, 2] + inside[:, 3]).max())

    @functools.cached_property
    def stiffness(self) -> float:
        """Moment about the closing direction per angle, the fingertips sticking [N·m/rad]."""
        if len(self.touching_fingers) < 3:
            return 0.0  # it turns about two fingertips
        whole = np.zeros((6, 6))
        angles = self.posture_at().angles
        for finger in self.touching_fingers:
            arm = self.touch_point(finger) - self.middle
            motion = np.hstack([np.eye(3), spatial_cross(np.eye(3), arm[None, :]).T])
            held = tip_stiffness(finger, angles[finger], self.touch_point(finger))
            whole += motion.T @ held @ motion
        return float(1.0 / np.linalg.inv(whole)[3, 3])

    @functools.cached_property
    def largest_squeeze(self) -> float:
        """Largest squeeze, with a tangential load as large beside it [N]."""
        each = [self._finger_torques(f, *load) for f, load in itertools.product(FINGERS, _LOADS)]
        return float(EFFORT_SHARE * EFFORT / np.abs(each).max())


def closing_direction(finger: str) -> Array:
    """Direction in which a finger presses, in P, shape (3,)."""
    return np.array([-1.0 if finger == "thumb" else 1.0, 0.0, 0.0])


@functools.lru_cache(maxsize=256)
def best_grasp(
    width: float, *, pinch: bool, wrist: float, depth: float = 0.0
) -> FourFingerGrasp | None:
    """See `Hand.grasp_posture`; thumb and middle finger pinch a knob or a cap."""
    shares = PINCH if pinch else SHARES
    found = [_grasp_at(width, x, z, shares) for x, z in itertools.product(_ACROSS, _ALONG)]
    worth = _pinch_worth if pinch else _grasp_worth
    closing = [each for each in found if each is not None]
    if depth > 0.0:
        closing = [each for grip in closing for each in _opened_about(grip, depth, wrist)]
    best = max(closing, key=worth, default=None)
    return None if best is None else replace(best, grip=_planner_grip(best, wrist))


def _grasp_worth(grip: FourFingerGrasp) -> float:
    return float(
        grip.largest_squeeze + _DEPTH_WORTH * grip.middle[2] + _OPENING_WORTH * grip.opening
    )


def _pinch_worth(grip: FourFingerGrasp) -> float:
    """A knob stands on something that the fingers must not touch."""
    hanging = [
        finger_points(finger, grip.posture_at(opening).angles[finger])[:, 2].max() - grip.middle[2]
        for finger in grip.touching_fingers
        for opening in (0.0, grip.opening)
    ]
    return _grasp_worth(grip) - _HANGING_WORTH * float(max(hanging))


def _touching_fingers(shares: Array) -> tuple[str, ...]:
    return tuple(finger for finger, share in zip(HOLDING, shares, strict=True) if share > 0.0)


def _grasp_at(width: float, x: float, z: float, shares: Array) -> FourFingerGrasp | None:
    """The grip about a width in one place; None if the fingers do not get there."""
    holding = _touching_fingers(shares)
    closed = _finger_angles(width, x, z, holding)
    if closed is None or not all(_LEAN[0] < a[1] + 2.0 * a[2] < _LEAN[1] for a in closed.values()):
        return None
    # All of the closing is possible where both its ends are.
    openings = np.arange(OPENING, _LEAST_OPENING - 1e-9, -0.001)
    opening = next((o for o in openings if _finger_angles(width + 2.0 * o, x, z, holding)), None)
    if opening is None:
        return None
    return FourFingerGrasp(width, np.array([x, 0.0, z]), float(opening), _UNKNOWN, shares=shares)


def _opened_about(grip: FourFingerGrasp, depth: float, wrist: float) -> Iterator[FourFingerGrasp]:
    """The same, as wide open as leaves room before the palm; none if it never does."""
    if grip.depth_at(0.0, wrist) >= depth:
        openings = np.arange(grip.opening, _DEEP_OPENING - 1e-9, -0.002).tolist()
        deep = (each for each in openings if grip.depth_at(each, wrist) >= depth)
        yield from (replace(grip, opening=each) for each in itertools.islice(deep, 1))


def _planner_grip(found: FourFingerGrasp, wrist: float) -> Grip:
    """The grip as the planner knows it."""
    x, _, z = found.middle
    contacts = np.array(
        [found.touch_point(finger)[[2, 1]] - [z, 0.0] for finger in found.touching_fingers]
    )
    # Open or closed, whatever needs more.
    around = np.vstack([hand_spheres(found.posture_at(o), wrist) for o in (0.0, found.opening)])
    low, high = (around[:, 0] - around[:, 3]).min(), (around[:, 0] + around[:, 3]).max()
    room = (float(x - found.width / 2.0 - low), float(high - x - found.width / 2.0))
    ahead = float((around[:, 2] + around[:, 3]).max() - z)
    shares = found.shares[found.shares > 0.0]
    return Grip(contacts, shares, found.largest_squeeze, room, ahead, found.stiffness)


@functools.lru_cache(maxsize=4096)
def _finger_angles(
    width: float, x: float, z: float, holding: tuple[str, ...]
) -> dict[str, Angles] | None:
    """Angles of the fingers that hold a width; None where one does not get there."""
    angles = {}
    low, high = FINGER_LIMITS.T
    for finger in holding:
        bent = _bent_finger(finger, width, x, z)
        if bent is None or not ((bent > low + STOP_ROOM) & (bent < high - STOP_ROOM))[1:].all():
            return None
        angles[finger] = bent
    return angles


def _bent_finger(finger: str, width: float, x: float, z: float) -> Angles | None:
    """Angles with which a fingertip touches its side of a width, whatever its stops."""
    side = np.array([x, 0.0, z]) - (width / 2.0 + TIP_RADIUS) * closing_direction(finger)
    return angles_reaching(finger, side)


@functools.lru_cache(maxsize=64)
def _closed_posture(
    name: str, width: float, x: float, z: float, holding: tuple[str, ...], behind: float
) -> Posture:
    """The hand about a width, wherever its fingers get; those that do not hold are curled up."""
    angles = dict.fromkeys(FINGERS, CURLED)
    for finger in holding:
        bent = _bent_finger(finger, width - 2.0 * behind * (finger in _OUTER), x, z)
        assert bent is not None, "a grip is about a width that the fingers reach"
        angles[finger] = bent
    return touching_posture(name, angles, holding)

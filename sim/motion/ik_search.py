"""How the arm stands along the way of a push, for many hands at once.

Model: the arm's eight closed-form solutions over a ring of elbow angles, first at both ends of the
stroke, which sorts out most, then along the whole way for the best. They are ranked by the room to
the joint limits, and by how far from home they are. What is continuous and bears the force of the
push is an arm pose of a stance, if nothing is in the way.

Frames: see `sim.motion.arm_configuration`; D is the frame of the push.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from planner.types.actions import Push
from sim.arms.lwr import lwr_kinematics as arm
from sim.hands.four_finger.hand_kinematics import TIP_RADIUS
from sim.hands.four_finger.pushing_postures import LARGEST_SKEW, PostureSet
from sim.motion.arm_configuration import ArmConfiguration, Mount
from sim.motion.roadmap import LIMIT_MARGIN
from sim.rotations import Array

EFFORT_SHARE = 0.5
"""Share of the arm joints' largest torques that a push may take; the rest moves and holds it."""

ENOUGH_MARGIN = 0.35
"""More room to the joint limits than this is no better [rad]."""

ELBOWS = np.radians(np.arange(-180.0, 180.0, 15.0))
"""Angles of the elbow that are tried [rad]."""

_LIFTS = np.array([0.36, 0.30, 0.24, 0.18])  # heights of T above the start, the best first [m]
_DESCENT = np.linspace(0.0, 1.0, 6)
_LARGEST_STEP = 1.0  # more change of a joint between points of the way is a jump [rad]
_HOMESICK = 0.2  # room to the limits that a joint's being one radian nearer to home is worth
_WRIST_BEND = 0.15  # |q6| stays above this, away from the singularity [rad]
_FOLLOWED, _SOLVED = 24, 240  # solutions that are followed along the way together, and in all


@dataclass(frozen=True, eq=False)
class IkSolutions:
    """Arm poses along the way, k of them.

    Attributes:
        hand: index of the hand, shape (k,).
        elbow, branch: of the arm, shape (k,).
        q: arm angles at the points of the way, shape (k, w, 7) [rad].
        descent: the same from above down to the start, shape (k, d, 7) [rad].
        lift: height of T above the start, shape (k,) [m].
        room: to the joint limits, shape (k,) [rad].
    """

    hand: NDArray[np.intp]
    elbow: Array
    branch: NDArray[np.intp]
    q: Array
    descent: Array
    lift: Array
    room: Array

    def __len__(self) -> int:
        return len(self.hand)

    def __getitem__(self, k: NDArray[np.bool_]) -> IkSolutions:
        return IkSolutions(*(getattr(self, field.name)[k] for field in fields(self)))

    def stance(self, k: int, mount: Mount, hands: PostureSet, R_WD: Array) -> ArmConfiguration:
        """One of them."""
        hand = self.hand[k]
        return ArmConfiguration(
            mount=mount,
            posture=hands.posture(hand),
            R_WP=R_WD @ hands.R_DP[hand],
            elbow=float(self.elbow[k]),
            branch=int(self.branch[k]),
            lift=float(self.lift[k]),
        )


class PushIkSearch:
    """The arm poses of one push.

    Args:
        mount: of the arm.
        home: arm angles from which it comes, shape (7,) [rad].
        push: what is to be done.
        points: of T: the start, the touch, and on to the end of the stroke, shape (w, 3) [m].
        R_WD: frame of the push at each of them, shape (w, 3, 3).

    Attributes:
        too_weak: whether an arm did not bear the force of the push.
    """

    def __init__(self, mount: Mount, home: Array, push: Push, points: Array, R_WD: Array) -> None:
        self._mount = mount
        self._home = home
        self._push = push
        self._points = points
        self._R_WD = R_WD
        self.too_weak = False

    def along(self, hands: PostureSet, least: float) -> Iterator[IkSolutions]:
        """What is reachable and strong enough, the best first, some at a time.

        Args:
            hands: with which.
            least: only what has more room than this to the joint limits [rad].
        """
        hand, elbow, branch = self._at_both_ends(hands, least)
        for first in range(0, len(hand), _FOLLOWED):
            few = slice(first, first + _FOLLOWED)
            solved = self._followed(hands, hand[few], elbow[few], branch[few])
            solved = solved[solved.room > least]
            strong = self._bears(solved)
            self.too_weak |= not strong.all()
            if strong.any():
                yield solved[strong]

    def _at_both_ends(
        self, hands: PostureSet, least: float
    ) -> tuple[NDArray[np.intp], Array, NDArray[np.intp]]:
        """Hands, elbow angles and branches that reach both ends of the stroke, the best first."""
        n = len(hands)
        hand, elbow = np.repeat(np.arange(n), len(ELBOWS)), np.tile(ELBOWS, n)
        ends = [1, -1]
        q, valid = poses(self._mount, hands[hand], self._R_WD[ends], self._points[ends], elbow)
        room = (arm.LIMITS - np.abs(q)).min(axis=(1, 3))
        far = np.abs(q[:, 0] - self._home).max(axis=-1)
        good = valid.all(axis=1) & (room > least)
        score = np.where(good, np.minimum(room, ENOUGH_MARGIN) - _HOMESICK * far, -np.inf)
        best = np.argsort(-score, axis=None, kind="stable")[:_SOLVED]
        row, branch = np.unravel_index(best[score.ravel()[best] > -np.inf], score.shape)
        return hand[row], elbow[row], branch

    def _followed(
        self, hands: PostureSet, hand: NDArray[np.intp], elbow: Array, branch: NDArray[np.intp]
    ) -> IkSolutions:
        """What is continuous along the whole way, from a height above the start on."""
        start, w = self._points[0], len(self._points)
        lifts = _LIFTS[start[2] + 0.03 < _LIFTS]
        above = np.column_stack([np.tile(start[:2], (len(lifts), 1)), lifts])
        points = np.vstack([self._points, above])
        R_WD = np.concatenate([self._R_WD, np.broadcast_to(self._R_WD[0], (len(lifts), 3, 3))])
        q, valid = poses(self._mount, hands[hand], R_WD, points, elbow)
        rows = np.arange(len(hand))
        q, valid = q[rows, :, branch], valid[rows, :, branch]
        steady = np.abs(np.diff(q[:, :w], axis=1)).max(axis=(1, 2)) < _LARGEST_STEP
        near = np.abs(q[:, w:] - q[:, :1]).max(axis=2) < 2.0 * _LARGEST_STEP
        lifted = valid[:, w:] & near
        good = valid[:, :w].all(axis=1) & steady & lifted.any(axis=1)
        lift = lifts[lifted.argmax(axis=1)]
        room = (arm.LIMITS - np.abs(q[:, :w])).min(axis=(1, 2))
        solved = IkSolutions(hand, elbow, branch, q[:, :w], q[:, :0], lift, room)[good]
        return self._let_down(hands, solved)

    def _let_down(self, hands: PostureSet, solved: IkSolutions) -> IkSolutions:
        """The same with the descent from above to the start."""
        points = descent(self._points[0], solved.lift)
        R_WD = np.broadcast_to(self._R_WD[0], (len(_DESCENT), 3, 3))
        q, valid = poses(self._mount, hands[solved.hand], R_WD, points, solved.elbow)
        rows = np.arange(len(solved))
        q, valid = q[rows, :, solved.branch], valid[rows, :, solved.branch]
        return replace(solved, descent=q)[np.asarray(valid.all(axis=1))]

    def _bears(self, solved: IkSolutions) -> NDArray[np.bool_]:
        """Which arms bear the force of the push all along the stroke, shape (k,)."""
        R_WA, p_WA = self._mount.R_WA, self._mount.p_WA
        p_AC = (self._points[1:] + TIP_RADIUS * self._R_WD[1:, :, 0] - p_WA) @ R_WA
        along_push = np.array(self._push.direction_W)
        bears = np.ones(len(solved), dtype=bool)
        for drag in (-LARGEST_SKEW, LARGEST_SKEW):
            f_W = self._push.force_limit * (along_push + np.array([0.0, 0.0, drag]))
            torques = arm.holding(solved.q[:, 1:], p_AC, f_W @ R_WA)
            bears &= (np.abs(torques) < EFFORT_SHARE * arm.EFFORTS).all(axis=(1, 2))
        return bears


def in_range(mount: Mount, hands: PostureSet, R_WD: Array, points: Array) -> NDArray[np.bool_]:
    """Which hands are neither too far from the shoulder nor too near to it.

    Args:
        mount: of the arm.
        hands: n of them.
        R_WD: frame of the push at each point, shape (w, 3, 3).
        points: where T must get, shape (w, 3) [m].

    Returns:
        Shape (n,).
    """
    p_WS = mount.p_WA + arm.SHOULDER * mount.R_WA[:, 2]
    wrist = np.einsum("wij,nj->nwi", R_WD, hands.wrist) + points
    distance = np.linalg.norm(wrist - p_WS, axis=-1)
    nearest = arm.stretched(arm.LIMITS[3] - LIMIT_MARGIN)
    inside = (distance > nearest) & (distance < arm.stretched(0.0))
    return np.asarray(inside.all(axis=1))


def poses(
    mount: Mount, hands: PostureSet, R_WD: Array, points: Array, elbow: Array
) -> tuple[Array, Array]:
    """Arm angles of n hands and elbow angles with T at w points each.

    Args:
        mount: of the arm.
        hands: n of them.
        R_WD: frame of the push at each point, shape (w, 3, 3).
        points: shape (w, 3), or (n, w, 3) [m].
        elbow: shape (n,) [rad].

    Returns:
        Angles, shape (n, w, 8, 7), and which of them are to be used, shape (n, w, 8).
    """
    n, w = len(hands), len(R_WD)
    R_WP = R_WD @ hands.R_DP[:, None]
    p_WP = points + (R_WD @ hands.palm[:, None, :, None])[..., 0]
    R_AF, p_AF = mount.flange(R_WP, p_WP)
    q, valid = arm.inverse(R_AF.reshape(-1, 3, 3), p_AF.reshape(-1, 3), np.repeat(elbow, w))
    room = (arm.LIMITS - np.abs(q)).min(axis=-1)
    usable = valid & (room > LIMIT_MARGIN) & (np.abs(q[..., 5]) > _WRIST_BEND)
    return q.reshape(n, w, 8, 7), usable.reshape(n, w, 8)


def descent(start: Array, lift: Array) -> Array:
    """Points of T from heights down to the start, shape (k, d, 3) for heights (k,) [m]."""
    points = np.tile(start, (len(lift), len(_DESCENT), 1))
    points[..., 2] = lift[:, None] + _DESCENT * (start[2] - lift[:, None])
    return points

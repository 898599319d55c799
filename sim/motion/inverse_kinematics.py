"""Inverse kinematics of the arm: a stance, and the search for arm poses along the path of a push.

Frames: W is the world, A the arm's base, F its flange, P the palm, T the midpoint of the pushing
fingertips' centres. D is the frame of a push: x into the touched face, z up.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.rotations import Array, rot_z
from objectmodels.safety_figure import SafetyFigure
from planner.types.actions import Push
from sim.motion.roadmap import LIMIT_MARGIN
from sim.robots.hand import Angles, Mount, Posture, PostureSet

EFFORT_SHARE: SafetyFigure = 0.5
"""Share of the arm joints' largest torques that a push may take; the rest moves and holds it."""

ENOUGH_MARGIN = 0.35
"""More room to the joint limits than this is no better [rad]."""

_DESCENT = np.linspace(0.0, 1.0, 6)  # to the start of a push, shares of the lift
_WORK, _TOGETHER = 4, 24  # units of work, and solutions that are followed for them


class UnreachableError(Exception):
    """The hand cannot be brought to a pose in this stance."""


@dataclass(frozen=True)
class ArmConfiguration:
    """A hand posture, the palm's orientation and the arm's branch; fingertips may go anywhere.

    The palm keeps its orientation, or turns about the vertical with an object that is turned.

    Attributes:
        mount: of the arm.
        posture: of the hand.
        R_WP: orientation of the palm before it turns, shape (3, 3).
        elbow: redundancy angle of the arm [rad].
        branch: which of the arm's solutions.
        lift: height of T from which the hand descends [m].
        via: arm angles between home and there, around obstacles.
    """

    mount: Mount
    posture: Posture
    R_WP: Array
    elbow: float
    branch: int
    lift: float
    via: tuple[Array, ...] = ()

    def joint_angles(self, p_WT: Array, turned: float = 0.0) -> Array:
        """Arm angles that bring T to a point in W, shape (n,) [rad].

        Args:
            p_WT: the point, shape (3,) [m].
            turned: angle by which the palm is turned about the vertical there [rad].

        Raises:
            UnreachableError: the arm does not get there in this stance.
        """
        R_WP = rot_z(turned) @ self.R_WP if turned else self.R_WP
        p_WP = p_WT - R_WP @ self.posture.tip_midpoint
        R_AF, p_AF = self.mount.flange_poses(R_WP, p_WP)
        q, valid = self.mount.arm.inverse(
            R_AF[None], p_AF[None], np.array([self.elbow]), [self.branch]
        )
        if not valid[0, 0]:
            at = ", ".join(f"{1e3 * x:.0f}" for x in p_WT)
            raise UnreachableError(f"the arm does not bring the fingertips to ({at}) mm")
        return np.asarray(q[0, 0])

    def robot_spheres(self, q: Array) -> Array:
        """Spheres of hand and arm in W for arm angles (n, joints), shape (n, k, 4)."""
        return self.mount.robot_spheres(self.mount.hand.whole_spheres(self.posture), q)

    def push_stiffness(self, direction_W: Array) -> float:
        """Force per displacement of the pushing fingers along a unit direction in W [N/m]."""
        along, hand = self.R_WP.T @ direction_W, self.mount.hand
        each = [along @ hand.tip_stiffness(*c) @ along for c in self._contact_points(along)]
        return float(sum(each))

    def bend(self, force_W: Array) -> Array:
        """Way by which a fingertip stays behind its command under the force that it exerts, (3,).

        The force [N] is that on what is touched, in W, shape (3,), and shared by all fingers.
        """
        along, hand = self.R_WP.T @ force_W, self.mount.hand
        unit = along / np.linalg.norm(along)
        whole = sum(hand.tip_stiffness(*contact) for contact in self._contact_points(unit))
        return np.asarray(self.R_WP @ np.linalg.solve(whole, along))

    def force_noise_gain(self, direction_W: Array) -> float:
        """Noise of the force felt by all fingers per noise of a torque sensor [1/m]."""
        along, hand = self.R_WP.T @ direction_W, self.mount.hand
        each = [float(hand.force_noise_gain(*c, along)) for c in self._contact_points(along)]
        return float(np.linalg.norm(each))

    def _contact_points(self, along_P: Array) -> list[tuple[str, Angles, Array]]:
        """Finger, angles and contact point in P of each pushing finger."""
        radius = self.mount.hand.tip_radius
        return [
            (finger, self.posture.angles[finger], tip + radius * along_P)
            for finger, tip in zip(self.posture.pushing, self.posture.tips, strict=True)
        ]


@dataclass(frozen=True, eq=False)
class IkSolutions:
    """Arm poses along the way, k of them.

    Attributes:
        hand: index of the hand, shape (k,).
        elbow, branch: of the arm, shape (k,).
        q: arm angles at the points of the way, shape (k, w, joints) [rad].
        descent: the same from above down to the start, shape (k, d, joints) [rad].
        lift: height of T above the start, shape (k,) [m].
        room: to the joint limits, shape (k,) [rad].
        work: units of work of the search once each was followed, shape (k,).
    """

    hand: NDArray[np.intp]
    elbow: Array
    branch: NDArray[np.intp]
    q: Array
    descent: Array
    lift: Array
    room: Array
    work: NDArray[np.intp]

    def __len__(self) -> int:
        return len(self.hand)

    def __getitem__(self, k: NDArray[np.bool_] | slice) -> IkSolutions:
        return IkSolutions(*(getattr(self, field.name)[k] for field in fields(self)))


class PushIkSearch:
    """The arm poses of one push, for many hands at once.

    Model: all solutions of the arm over a ring of redundancy angles (of the elbow), first at both
    ends of the stroke, which sorts out most, then along the whole way for the best. They are ranked
    by the room to the joint limits, and by how far from home they are. What is continuous and bears
    the force of the push is an arm pose of a stance, if nothing is in the way.

    Args:
        mount: of the arm.
        push: what is to be done.
        points: of T: the start, the touch, and on to the end of the stroke, shape (w, 3) [m].
        R_WD: frame of the push at each of them, shape (w, 3, 3).

    Attributes:
        too_weak: whether an arm did not bear the force of the push.
        work: units of work done so far; who takes one of some solutions sets it to theirs.
    """

    def __init__(self, mount: Mount, push: Push, points: Array, R_WD: Array) -> None:
        self._mount = mount
        self._push = push
        self._points = points
        self._R_WD = R_WD
        self.too_weak = False
        self.work = 0

    def solutions_along(self, hands: PostureSet, least: float) -> Iterator[IkSolutions]:
        """Solutions that are reachable and strong enough, the best first, some at a time.

        Args:
            hands: with which.
            least: only what has more room than this to the joint limits [rad].
        """
        hand, elbow, branch = self._at_both_ends(hands, least)
        before = self.work
        work = before + _WORK * (np.arange(len(hand)) // _TOGETHER + 1)
        # Mostly the first few will do; if not, most of the others will not either.
        for few in (slice(_TOGETHER), slice(_TOGETHER, None)):
            if not len(hand[few]):
                break
            solved = self._follow_path(hands, hand[few], elbow[few], branch[few], work[few])
            solved = solved[solved.room > least]
            strong = self._bear_force(solved)
            self.too_weak |= not strong.all()
            if strong.any():
                yield solved[strong]
        self.work = before + _WORK * math.ceil(len(hand) / _TOGETHER)

    def _at_both_ends(
        self, hands: PostureSet, least: float
    ) -> tuple[NDArray[np.intp], Array, NDArray[np.intp]]:
        """Hands, elbow angles and branches that reach both ends of the stroke, the best first."""
        n = len(hands)
        elbows = self._mount.arm.redundancy_samples
        hand, elbow = np.repeat(np.arange(n), len(elbows)), np.tile(elbows, n)
        at_touch, good, room = self._at_point(1, hands[hand], elbow, least)
        # Where the arm does not get to the touch, it is not asked for the end.
        some = good.any(axis=1)
        hand, elbow, at_touch = hand[some], elbow[some], at_touch[some]
        _, good_too, room_too = self._at_point(-1, hands[hand], elbow, least)
        good, room = good[some] & good_too, np.minimum(room[some], room_too)
        off = at_touch - self._mount.home
        row, branch = best_solutions(good, room, off, homesick=0.2, most=240)
        return hand[row], elbow[row], branch

    def _at_point(
        self, point: int, hands: PostureSet, elbow: Array, least: float
    ) -> tuple[Array, NDArray[np.bool_], Array]:
        """Angles of n hands and elbow angles at a point of the way, which are good, their room.

        Shapes (n, branches, joints), (n, branches) and (n, branches).
        """
        at = [point]
        q, valid = solve_poses(self._mount, hands, self._R_WD[at], self._points[at], elbow)
        room = self._mount.arm.joint_room(q[:, 0])
        return q[:, 0], valid[:, 0] & (room > least), room

    def _follow_path(
        self,
        hands: PostureSet,
        hand: NDArray[np.intp],
        elbow: Array,
        branch: NDArray[np.intp],
        work: NDArray[np.intp],
    ) -> IkSolutions:
        """Solutions that are continuous along the whole path, from above the start on."""
        start, w = self._points[0], len(self._points)
        # Heights of T above the start, the best first.
        lifts = np.array([0.36, 0.30, 0.24, 0.18])
        lifts = lifts[start[2] + 0.03 < lifts]
        above = np.column_stack([np.tile(start[:2], (len(lifts), 1)), lifts])
        points = np.vstack([self._points, above])
        R_WD = np.concatenate([self._R_WD, np.broadcast_to(self._R_WD[0], (len(lifts), 3, 3))])
        q, valid = solve_poses(self._mount, hands[hand], R_WD, points, elbow, branch)
        q, valid = q[:, :, 0], valid[:, :, 0]
        # More change of a joint between points of the way is a jump.
        steady = np.abs(np.diff(q[:, :w], axis=1)).max(axis=(1, 2)) < 1.0
        near = np.abs(q[:, w:] - q[:, :1]).max(axis=2) < 2.0
        lifted = valid[:, w:] & near
        good = valid[:, :w].all(axis=1) & steady & lifted.any(axis=1)
        lift = lifts[lifted.argmax(axis=1)]
        room = self._mount.arm.joint_room(q[:, :w]).min(axis=1)
        solved = IkSolutions(hand, elbow, branch, q[:, :w], q[:, :0], lift, room, work)[good]
        points = descent_points(self._points[0], solved.lift)
        R_WD = np.broadcast_to(self._R_WD[0], (len(_DESCENT), 3, 3))
        q, valid = solve_poses(
            self._mount, hands[solved.hand], R_WD, points, solved.elbow, solved.branch
        )
        return replace(solved, descent=q[:, :, 0])[np.asarray(valid.all(axis=(1, 2)))]

    def _bear_force(self, solved: IkSolutions) -> NDArray[np.bool_]:
        """Which arms bear the force of the push all along the stroke, shape (k,)."""
        arm, hand, R_WA = self._mount.arm, self._mount.hand, self._mount.R_WA
        into = self._R_WD[1:, :, 0]
        along_push, up = np.array(self._push.direction_W), np.array([0.0, 0.0, 1.0])
        if self._push.press:
            into = -up
            forces = np.array([[0.0], [self._push.force_limit]]) * along_push - (
                self._push.press * up
            )
        else:
            skews = hand.force_skew * np.array([[-1.0], [1.0]])
            forces = self._push.force_limit * (along_push + skews * up)
        contact = self._points[1:] + hand.tip_radius * into
        p_AC = (contact - self._mount.p_WA) @ R_WA
        f_A = np.array([f_W @ R_WA for f_W in forces])
        torques = arm.torques(solved.q[:, 1:], p_AC, f_A[:, None, None])
        return np.asarray((np.abs(torques) < EFFORT_SHARE * arm.efforts).all(axis=(0, 2, 3)))


def in_range(mount: Mount, hands: PostureSet, R_WD: Array, points: Array) -> NDArray[np.bool_]:
    """Which hands bring the arm's wrist where the arm may get at all, shape (n,).

    Args:
        mount: of the arm.
        hands: n of them.
        R_WD: frame of the push at each point, shape (w, 3, 3).
        points: where T must get, shape (w, 3) [m].
    """
    R_AD, p_AT = mount.R_WA.T @ R_WD, (points - mount.p_WA) @ mount.R_WA
    wrists = hands.palm + hands.R_DP @ mount.p_PW
    p_AW = wrists @ np.swapaxes(R_AD, -1, -2) + p_AT[:, None]
    return np.asarray((mount.arm.range_excess(p_AW, LIMIT_MARGIN) == 0.0).all(axis=0))


def solve_poses(
    mount: Mount,
    hands: PostureSet,
    R_WD: Array,
    points: Array,
    elbow: Array,
    branch: NDArray[np.intp] | None = None,
) -> tuple[Array, NDArray[np.bool_]]:
    """Arm angles of n hands and redundancy angles with T at w points each.

    Args:
        mount: of the arm.
        hands: n of them.
        R_WD: frame of the push at each point, shape (w, 3, 3).
        points: shape (w, 3), or (n, w, 3) [m].
        elbow: redundancy angles, shape (n,) [rad].
        branch: of the arm, shape (n,); all if not given.

    Returns:
        Angles, shape (n, w, branches, joints), and which of them are to be used, shape
        (n, w, branches).
    """
    q, usable = mount.solve_palm(*hands.palms_along(R_WD, points), elbow, branch)
    return q, usable & (mount.arm.joint_room(q) > LIMIT_MARGIN)


def best_solutions(
    good: NDArray[np.bool_], room: Array, off: Array, homesick: float, most: int
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Rows and branches of the good solutions, those with most room and nearest to home first.

    Args:
        good: which of them are good, shape (n, branches).
        room: to the joint limits, of the same shape [rad].
        off: joint angles against home, shape (n, branches, joints) [rad].
        homesick: room that a joint's being one radian nearer to home is worth.
        most: number of solutions.
    """
    far = np.abs(off).max(axis=-1)
    score = np.where(good, np.minimum(room, ENOUGH_MARGIN) - homesick * far, -np.inf)
    best = np.argsort(-score, axis=None, kind="stable")[: min(most, int(good.sum()))]
    row, branch = np.unravel_index(best, score.shape)
    return row, branch


def descent_points(start: Array, lift: Array) -> Array:
    """Points of T from heights down to the start, shape (k, d, 3) for heights (k,) [m]."""
    points = np.tile(start, (len(lift), len(_DESCENT), 1))
    points[..., 2] = lift[:, None] + _DESCENT * (start[2] - lift[:, None])
    return points

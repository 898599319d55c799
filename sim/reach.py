"""Can the hand get there? Stances of arm and hand for a push, checked against all that is near.

Model: the hand keeps its posture during a push. It keeps its orientation too, square to the touched
face, unless the push is to turn the object: then the palm turns as the face does. All
postures, tilts along the push, sides and rolls are tried at once: first those whose spheres stay
clear of the pushed box and the table, then, for these, the arm's eight closed-form solutions over
a ring of elbow angles at the points of the way. What is continuous, away from the joint limits
and clear of every object is ranked by the room that is left to the limits. Only hands are tried
whose torque sensors feel the push and whose fingers press straight when loaded.

The way: home, over obstacles where needed, a point above the start, down to 3 cm before the face,
to the face, the stroke; and back the same way, which is known to be free.

Frames: see `sim.stance`. Objects are where and what the robot believes, never what is true.
"""

from __future__ import annotations

import functools
import itertools
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planner.plan import Push
from planner.reach import ReachAnswer
from planner.state import SeenObject, WorldState
from sim import arm, spheres
from sim.hand import (
    TIP_RADIUS,
    Posture,
    coarseness,
    fingertip_stiffness,
    one_finger_postures,
    two_finger_postures,
)
from sim.rotations import Array, rot_x, rot_y, rot_z
from sim.scene import Scene
from sim.stance import Mount, Stance
from sim.way import ENDS, Way

FINGER_SPREAD = 0.04
MAX_FORCE = 10.0
"""Force at a fingertip that the finger joints' 2 N·m hold with room to spare [N]."""

TABLE_CLEARANCE = 0.005
OBJECT_CLEARANCE = 0.012
"""Least distance of the hand and arm from what they must not touch [m]."""

_FACE_CLEARANCE = 0.0005  # of all but the fingertips from the pushed face [m]

_TILTS = np.radians(np.arange(-60.0, 83.0, 7.5))
_SIDES = {1: np.radians([0.0, -30.0, 30.0]), 2: np.radians([0.0])}
_ELBOWS = np.radians(np.arange(-180.0, 180.0, 15.0))
_LIFTS = np.array([0.36, 0.30, 0.24, 0.18])

_LIMIT_MARGIN = 0.08  # least room to the joint limits on the way [rad]
_ENOUGH_MARGIN = 0.35  # more room than this is no better [rad]
_LARGEST_STEP = 1.0  # more change of a joint between points of the way is a jump [rad]
_WRIST_BEND = 0.15  # |q6| stays above this, away from the singularity [rad]

# 1 / lever with which the sensors feel the push [1/m]: 60 makes 1.6 mN·m a noise of 0.1 N.
_COARSEST_FEELING = 60.0
_MOST_HANDS = 60  # hands that the arm's kinematics are asked for, the best first
_SOLVED = 240  # solutions at both ends of the stroke that are followed along the way
# Loaded along the push, a slanted finger also presses up or down. Pressing down makes the object
# heavier on the table, which makes it move in jerks.
_LARGEST_SKEW = 0.35

_CHECK_STEP = 0.05  # largest change of a joint between two poses checked in free motion [rad]
_RAISED = (0.0, 0.4, 0.8, 1.2)  # ways around obstacles: how far the arm swings up halfway [rad]
_CHECKED = 24  # solutions whose whole way is checked for collisions, best first


@dataclass(frozen=True)
class _Hands:
    """Postures and orientations of the palm, n of them.

    Attributes:
        postures: the different ones.
        which: index of the posture, shape (n,).
        R_DP: orientation of the palm, shape (n, 3, 3).
    """

    postures: tuple[Posture, ...]
    which: NDArray[np.intp]
    R_DP: Array

    def __len__(self) -> int:
        return len(self.which)

    def __getitem__(self, chosen: NDArray[np.bool_] | NDArray[np.intp] | slice) -> _Hands:
        return _Hands(self.postures, self.which[chosen], self.R_DP[chosen])

    def tips(self) -> Array:
        """Midpoints of the fingertips' centres in P, shape (n, 3) [m]."""
        return np.array([p.tips.mean(axis=0) for p in self.postures])[self.which]


@functools.cache
def _hands(fingers: int, spread: float) -> _Hands:
    """Everything in which a hand may push, the best first."""
    tilt, side, roll = (
        a.ravel()
        for a in np.meshgrid(_TILTS, _SIDES[fingers], np.array([0.0, np.pi]), indexing="ij")
    )
    # At zero tilt the fingers point down; a positive tilt leans the hand back, behind the push.
    upright = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
    turned = rot_x(side) @ rot_y(-tilt) @ upright @ rot_z(roll)
    postures = one_finger_postures() if fingers == 1 else two_finger_postures(spread)
    which = np.repeat(np.arange(len(postures)), len(turned))
    R_DP = np.tile(turned, (len(postures), 1, 1))
    coarse, skew = np.hstack([_quality(posture, turned) for posture in postures])
    good = np.flatnonzero((coarse < _COARSEST_FEELING) & (skew < _LARGEST_SKEW))
    order = good[np.argsort(skew[good] + coarse[good] / 200.0)]
    return _Hands(postures, which[order], R_DP[order])


def _quality(posture: Posture, R_DP: Array) -> tuple[Array, Array]:
    """How well a hand pushes along D's x axis in each orientation, by its worst finger.

    Returns:
        Noise of the felt push per noise of a torque sensor [1/m], and the vertical force per
        force along the push while the fingertip sticks to the face; both of shape (n,).
    """
    into_face = R_DP[:, 0]  # D's x axis in P
    coarse, skew = np.zeros(len(R_DP)), np.zeros(len(R_DP))
    for finger, tip in zip(posture.pushing, posture.tips, strict=True):
        angles, p_PC = posture.angles[finger], tip + TIP_RADIUS * into_face
        stiffness = fingertip_stiffness(finger, angles, p_PC)
        force = (R_DP @ stiffness @ into_face[..., None])[..., 0]
        coarse = np.maximum(coarse, coarseness(finger, angles, p_PC, into_face))
        skew = np.maximum(skew, np.abs(force[:, 2] / force[:, 0]))
    return coarse, skew


class ArmReach:
    """The reach of a scene's robot; answers the planner's question.

    Attributes:
        fingertip_radius: [m].
        finger_spread: distance between the fingertips of a two-finger push [m].
        max_force: of one fingertip [N].
        force_skew: largest vertical force per force along the push.
        lowest_height: of a contact above the table [m].
    """

    fingertip_radius = TIP_RADIUS
    finger_spread = FINGER_SPREAD
    max_force = MAX_FORCE
    force_skew = _LARGEST_SKEW
    lowest_height = TIP_RADIUS + 0.015

    def __init__(self, scene: Scene) -> None:
        self.mount = Mount.of(scene.robot)
        self.home = np.radians(scene.robot.home_deg)

    def __call__(self, push: Push, state: WorldState) -> ReachAnswer:
        """Whether the whole way of a push is reachable and free."""
        answer = self.stance(push, state)
        return answer if isinstance(answer, ReachAnswer) else answer[1]

    def stance(self, push: Push, state: WorldState) -> tuple[Stance, ReachAnswer] | ReachAnswer:
        """The best stance for a push, or why there is none."""
        way = Way.of(push, state.objects[push.object])
        if push.p_BC[2] < self.lowest_height - 1e-9:
            return _no("table", f"the finger would touch the table {1e3 * push.p_BC[2]:.0f} mm up")
        free, stopped = _clear_hands(_hands(push.fingers, push.spread), way, state, push)
        if not len(free):
            return _blocked(push, stopped)
        found = self._solutions(free[:_MOST_HANDS], way)
        if not found:
            return _no("kinematics", "the arm does not reach along the whole way of the push")
        for margin, stance in found:
            free_stance = self._free_way(stance, way, state)
            if free_stance is not None:
                return free_stance, ReachAnswer(ok=True, margin=margin)
        return _no("approach", "arm or hand would hit something on the way to the contact")

    def _solutions(self, hands: _Hands, way: Way) -> list[tuple[float, Stance]]:
        """The best of what the arm's kinematics allow: room to the limits and stance."""
        n = len(hands) * len(_ELBOWS)
        hand, elbow = np.divmod(np.arange(n), len(_ELBOWS))
        R_WP = (way.R_WD @ hands.R_DP)[hand]
        tip = hands.tips()[hand]

        # Both ends of the stroke sort out most; what is left is solved along the whole way.
        ends, turns = way.points(ENDS)[1:], way.turns(ENDS)[1:]
        q, valid = self._inverse(R_WP, tip, ends, turns, _ELBOWS[elbow])
        score = np.where(valid.all(axis=1), self._score(q), -np.inf)
        best = np.argsort(-score, axis=None)[:_SOLVED]
        i, branch = np.unravel_index(best[score.ravel()[best] > -np.inf], score.shape)
        if not len(i):
            return []
        lifts = _LIFTS[way.start[2] + 0.03 < _LIFTS]
        above = np.column_stack([np.tile(way.start[:2], (len(lifts), 1)), lifts])
        points = np.vstack([way.points(), above])
        turns = np.append(way.turns(), np.zeros(len(lifts)))
        q, valid = self._inverse(R_WP[i], tip[i], points, turns, _ELBOWS[elbow[i]])
        rows, w = np.arange(len(i)), len(points) - len(lifts)
        q, valid = q[rows, :, branch], valid[rows, :, branch]
        steady = np.abs(np.diff(q[:, :w], axis=1)).max(axis=(1, 2)) < _LARGEST_STEP
        near = np.abs(q[:, w:] - q[:, :1]).max(axis=2) < 2.0 * _LARGEST_STEP
        lifted = valid[:, w:] & near
        good = np.flatnonzero(valid[:, :w].all(axis=1) & steady & lifted.any(axis=1))
        room = (arm.LIMITS - np.abs(q[:, :w])).min(axis=(1, 2))
        highest = lifts[lifted.argmax(axis=1)]
        return [
            (
                float(room[k]),
                Stance(
                    mount=self.mount,
                    posture=hands.postures[hands.which[hand[i[k]]]],
                    R_WP=R_WP[i[k]],
                    elbow=float(_ELBOWS[elbow[i[k]]]),
                    branch=int(branch[k]),
                    lift=float(highest[k]),
                ),
            )
            for k in good[:_CHECKED]
        ]

    def _score(self, q: Array) -> Array:
        """Room to the joint limits, less for arms far from home; (n, w, 8, 7) to (n, 8)."""
        room = (arm.LIMITS - np.abs(q)).min(axis=(1, 3))
        far = np.abs(q[:, 0] - self.home).max(axis=-1)
        return np.asarray(np.minimum(room, _ENOUGH_MARGIN) - 0.2 * far)

    def _inverse(
        self, R_WP: Array, p_PT: Array, points: Array, turns: Array, elbow: Array
    ) -> tuple[Array, Array]:
        """Arm angles for n hands and elbow angles at w points each.

        Args:
            R_WP: orientations of the palm before it turns, shape (n, 3, 3).
            p_PT: midpoints of the fingertips in P, shape (n, 3) [m].
            points: where they go, shape (w, 3) [m].
            turns: how far the palm has turned there, shape (w,) [rad].
            elbow: shape (n,) [rad].

        Returns:
            Angles, shape (n, w, 8, 7), and which of them are to be used, shape (n, w, 8).
        """
        n, w = len(R_WP), len(points)
        turned = rot_z(turns) @ R_WP[:, None]
        p_WP = points - np.einsum("nwij,nj->nwi", turned, p_PT)
        R_AF, p_AF = self.mount.flange(turned, p_WP)
        q, valid = arm.inverse(R_AF.reshape(-1, 3, 3), p_AF.reshape(-1, 3), np.repeat(elbow, w))
        room = (arm.LIMITS - np.abs(q)).min(axis=-1)
        usable = valid & (room > _LIMIT_MARGIN) & (np.abs(q[..., 5]) > _WRIST_BEND)
        return q.reshape(n, w, 8, 7), usable.reshape(n, w, 8)

    def _free_way(self, stance: Stance, way: Way, state: WorldState) -> Stance | None:
        """The stance with a way from home on which hand and arm stay clear of everything."""
        above = np.array([*way.start[:2], stance.lift])
        descent = above + np.linspace(0.0, 1.0, 6)[:, None] * (way.start - above)
        q_descent = np.array([stance.joints(p) for p in descent])
        # During the stroke the hand's own clearance is known; the arm and the pushed box are left.
        stroke = zip(way.points(way.checks)[1:], way.turns(way.checks)[1:], strict=True)
        q_push = np.array([stance.joints(p, turned) for p, turned in stroke])
        if not self._is_clear(q_descent, stance.posture, state):
            return None
        if not _are_clear(self._arm(q_push), state):
            return None
        for raised in _RAISED:
            via = self._via(q_descent[0], raised)
            legs = np.vstack([self.home, *via, q_descent[0]])
            if self._is_clear(_along(legs), stance.posture, state):
                return replace(stance, via=via)
        return None

    def _via(self, q: Array, raised: float) -> tuple[Array, ...]:
        """Arm angles halfway home, changed by so much in the direction that lifts the hand most."""
        if raised == 0.0:
            return ()
        middle = 0.5 * (self.home + q)
        nudge = 1e-4
        _, p_WP = self.mount.palm(np.vstack([middle, middle + nudge * np.eye(7)]))
        uphill = (p_WP[1:, 2] - p_WP[0, 2]) / nudge
        via = middle + raised * uphill / np.linalg.norm(uphill)
        return (np.clip(via, -arm.LIMITS + _LIMIT_MARGIN, arm.LIMITS - _LIMIT_MARGIN),)

    def _is_clear(self, q: Array, posture: Posture, state: WorldState) -> bool:
        """Whether hand and arm keep their distance from objects and table in all arm poses."""
        R_WP, p_WP = self.mount.palm(q)
        whole = np.vstack([spheres.hand_spheres(posture), spheres.tip_spheres(posture)])
        hand = spheres.placed(whole, R_WP, p_WP)
        return _are_clear(hand, state) and _are_clear(self._arm(q), state)

    def _arm(self, q: Array) -> Array:
        """The arm's spheres in W, shape (n, k, 4)."""
        return spheres.placed(spheres.arm_spheres(q), self.mount.R_WA, self.mount.p_WA)


def _along(legs: Array) -> Array:
    """Arm poses along straight legs in joint space, close enough to be checked one by one."""
    poses = []
    for start, end in itertools.pairwise(legs):
        n = int(np.ceil(np.abs(end - start).max() / _CHECK_STEP)) + 1
        poses.append(start + np.linspace(0.0, 1.0, n)[:, None] * (end - start))
    return np.vstack(poses)


def _are_clear(robot: Array, state: WorldState) -> bool:
    """Whether spheres in W, shape (..., 4), keep their distance from objects and table."""
    if spheres.height_above_table(robot).min() < TABLE_CLEARANCE:
        return False
    seen = state.objects.values()
    return all(_distance_to(robot, each).min() > OBJECT_CLEARANCE for each in seen)


def _distance_to(robot: Array, seen: SeenObject) -> Array:
    R_WB, p_WB = seen.pose.R_WB, seen.pose.p_WB
    in_B = spheres.placed(robot, R_WB.T, -R_WB.T @ p_WB)
    return spheres.distance_to_prism(in_B, seen.model.outline, seen.model.top)


def _clear_hands(
    hands: _Hands, way: Way, state: WorldState, push: Push
) -> tuple[_Hands, frozenset[str]]:
    """The hands that stay clear of everything during the push, and what stops the others."""
    clear = np.zeros(len(hands), dtype=bool)
    stopped: set[str] = set()
    R_WP = way.R_WD @ hands.R_DP
    for number, posture in enumerate(hands.postures):
        mine = hands.which == number
        clear[mine], names = _clear(posture, R_WP[mine], way, state, push)
        stopped |= names
    return hands[clear], frozenset(stopped)


def _clear(
    posture: Posture, R_WP: Array, way: Way, state: WorldState, push: Push
) -> tuple[NDArray[np.bool_], set[str]]:
    ok, stopped = np.ones(len(R_WP), dtype=bool), set()

    def require(free: NDArray[np.bool_], name: str) -> None:
        if ok.any() and not (ok & free).any():
            stopped.add(name)
        ok[~free] = False

    whole, p_PT = spheres.hand_spheres(posture), posture.tips.mean(axis=0)
    points, turns = way.points(way.checks), way.turns(way.checks)
    for number, (point, turned) in enumerate(zip(points, turns, strict=True)):
        R = rot_z(turned) @ R_WP
        placed = spheres.placed(whole, R, point - R @ p_PT)
        require(spheres.height_above_table(placed).min(axis=-1) > TABLE_CLEARANCE, "table")
        for name, seen in state.objects.items():
            pushed = name == push.object
            if pushed and number > 1:
                continue  # the object moves ahead of the hand
            room = _FACE_CLEARANCE if pushed else OBJECT_CLEARANCE
            require(_distance_to(placed, seen).min(axis=-1) > room, name)
    return ok, stopped


def _no(reason: str, message: str, blocker: str | None = None) -> ReachAnswer:
    return ReachAnswer(ok=False, reason=reason, message=message, blocker=blocker)


def _blocked(push: Push, stopped: frozenset[str]) -> ReachAnswer:
    others = sorted(stopped - {"table", push.object})
    if others:
        return _no("obstacle", f"the hand would hit the {others[0]}", others[0])
    if "table" in stopped and push.object not in stopped:
        return _no("table", "the hand would hit the table")
    return _no("object", f"the hand would hit the {push.object} with more than its fingertips")

"""The search for a stance: a hand, an arm pose for every point of its way, and a way to get there.

Model: the palm keeps its orientation to the push's frame, which turns where the object is to be
turned. Hands are taken best first, a few at a time. What costs least sorts out first: a hand too
low over the table or too far from the shoulder, then one whose spheres come too near an object
anywhere on the way, the pushed object moving along. For the rest the arm is asked
(`sim.motion.ik_search`). Where it is clear of everything as a whole, and a free way leads there
from home (`sim.motion.roadmap`), is a stance; the search ends with the first that has room enough.

Frames: see `sim.motion.arm_configuration`.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planner.types.actions import Push
from planner.types.robot import ReachAnswer
from planner.types.world_state import TableState
from sim.collision.collision_scene import (
    TABLE_CLEARANCE,
    CollisionScene,
    Obstacle,
)
from sim.hands.hand_model import PostureSet
from sim.hands.mount import Mount
from sim.motion.approach_clearance import FACE_CLEARANCE, Approach
from sim.motion.arm_configuration import ArmConfiguration
from sim.motion.ik_search import ENOUGH_MARGIN, IkSolutions, PushIkSearch, descent_points, in_range
from sim.motion.roadmap import (
    LIMIT_MARGIN,
    free_path,
    interpolate_joints,
    sample_configurations,
)
from sim.motion.search_effort import Effort
from sim.motion.sweep_clearance import Sweep, first_obstacles
from sim.motion.transit_clearance import TransitClearance
from sim.paths.fingertip_path import BACK, FingertipPath
from sim.rotations import Array, rot_z

_OVER = 0.47  # height of T in places over the table [m]
_RAISED = (0.4, 0.8, 1.2)  # how far the arm swings up halfway [rad]

_AT_ONCE, _ASKED = 48, 12  # hands of a unit of work, and the arm is asked for together
_FEW = 6  # arm poses that are looked at together first
_MOST_AT_ONCE = 768  # hands that are looked at together
_BEGUN, _LOOKED, _ROAD = 1, 2, 1  # units of work: to begin, of some hands, of some arm poses
_BACK_POINTS = 4  # places on the way back from a turned face that are looked at
_BACK_STEP = 0.015  # between those on the way straight back [m]
_BRUSH = 0.03  # by which a hand may reach through what it pushed as it goes back [m]


@dataclass(frozen=True, eq=False)
class _Found:
    """A stance without the way from home: arm angles above the start, room, strength [N]."""

    stance: ArmConfiguration
    above: Array
    room: float
    strength: float

    def with_path(self, via: tuple[Array, ...]) -> _Found:
        """The same with a way."""
        return replace(self, stance=replace(self.stance, via=via))


class PushMotionSearch:
    """The search for one push among what stands on a table.

    Attributes:
        postures: of the hand that were looked at.
        stopped_by: names of the other objects that stopped a hand or an arm, or may have.
    """

    def __init__(
        self,
        mount: Mount,
        push: Push,
        way: FingertipPath,
        table: TableState,
        scenery: CollisionScene,
        effort: Effort,
    ) -> None:
        self._work = _BEGUN
        self.postures = 0
        self.stopped_by: set[str] = set()
        self._effort = effort
        self._mount = mount
        self._push = push
        self._way = way
        self._points = way.points_at()
        self._R_WD = rot_z(way.turns_at()) @ way.R_WD
        self._arms = PushIkSearch(mount, push, self._points, self._R_WD)
        self._centre = 0.5 * np.array([table.x_min + table.x_max, table.y_min + table.y_max])
        self._scenery = scenery
        self._approach = Approach.to_object(
            self._scenery.pushed, self._points[:2], self._R_WD[0], mount.hand,
            push.fingers, push.spread, fine=effort.fine, pressing=push.press > 0.0,
        )  # fmt: skip

    @functools.cached_property
    def _pushed(self) -> list[Obstacle]:
        """The pushed object at the points: from the touch on it goes where the fingertips do."""
        touch = self._points[1]
        return [
            self._scenery.pushed.after_motion(touch, self._points[max(k, 1)], float(turn))
            for k, turn in enumerate(self._way.turns_at())
        ]

    @property
    def work(self) -> int:
        """Units of work done so far."""
        return self._work + self._arms.work

    def best_configuration(
        self, hands: PostureSet
    ) -> tuple[ArmConfiguration, ReachAnswer] | ReachAnswer:
        """The best stance in one of some hands, or why there is none."""
        self._stopped: set[str] = set()
        self._hindered: list[Array] = []
        self._arms.too_weak = False
        high = self._points[:, 2].min() + hands.lowest_points > TABLE_CLEARANCE
        if not high.any():
            return ReachAnswer(False, "table", "the hand would hit the table")
        hands = hands[high]
        best: _Found | None = None
        blocked: list[_Found] = []
        asked = 0
        for some in self._clear_hands(
            hands[in_range(self._mount, hands, self._R_WD, self._points)]
        ):
            asked += len(some)
            least = LIMIT_MARGIN if best is None else best.room
            stances = filter(self._reaches_bent, self._configurations(some, least))
            for found in itertools.islice(stances, self._effort.most_transits):
                via = self._way_there(found, self._transit_places(found))
                if via is not None:
                    best = found.with_path(via)
                    break
                blocked.append(found)
            if best is not None and best.room >= ENOUGH_MARGIN:
                break
            if asked >= self._effort.most_hands:
                break
        for found in blocked[: self._effort.last_resorts] if best is None else ():
            via = self._way_there(found, sample_configurations(self._mount.home, found.above))
            if via is not None:
                best = found.with_path(via)
                break
        if best is None:
            return self._failure_answer(asked, blocked)
        numbers = {"strength": best.strength}
        stiffness = best.stance.push_stiffness(np.array(self._push.direction_W))
        return best.stance, ReachAnswer(
            True, margin=best.room, numbers=numbers, stiffness=stiffness
        )

    def _reaches_bent(self, found: _Found) -> bool:
        """True if the arm reaches all of the way with a finger that is bent by pressing."""
        pressing = self._push.press * self._way.inward
        drawing = pressing + self._push.force_limit * np.array(self._push.direction_W)
        bent = found.stance.reaches_bent
        return not self._push.press or bent(self._points[1:], (pressing, drawing))

    def _failure_answer(self, asked: int, blocked: list[_Found]) -> ReachAnswer:
        """Why no stance was found."""
        if not asked and self._stopped:
            return _blocked_answer(self._push, self._stopped)
        hindered = [
            f.stance.robot_spheres(interpolate_joints(self._mount.home, f.above))
            for f in blocked[:1]
        ]
        hindered = hindered or self._hindered[:1]
        if hindered:
            name = self._scenery.hit_by(hindered[0])
            what = name or f"{self._push.object} or the table"
            message = f"the arm has no free way to the contact: it would hit the {what}"
            return ReachAnswer(False, "obstacle" if name else "approach", message, name)
        if self._arms.too_weak:
            force = self._push.force_limit
            message = f"the arm's joints do not bear {force:.0f} N there"
            return ReachAnswer(False, "torque", message, numbers={"force": force})
        return ReachAnswer(
            False, "kinematics", "the arm does not reach along the whole way of the push"
        )

    # -- hands ----------------------------------------------------------------------------------

    def _clear_hands(self, hands: PostureSet) -> Iterator[PostureSet]:
        """The hands that stay clear of everything during the push, a few at a time."""
        off = self._way_off.points if self._way.turn else self._points[:0]
        places = np.vstack([self._points, off])
        near = self._scenery.obstacles_near(places, hands.horizontal_size)
        sweep = Sweep.along(self._points, self._R_WD)
        first, together = 0, _AT_ONCE
        while first < len(hands):
            some = hands[first : first + together]
            self.postures += len(some)
            clear = self._approach.clear_hands(some)
            stopped_by = np.full(len(some), -1)
            stopped_by[clear] = first_obstacles(some[clear], near, sweep)
            free = clear & (stopped_by < 0)
            if self._way.turn:
                (turned,) = np.nonzero(free)
                free[turned], stopped_by[turned] = self._turned_hands(some[turned], near)
            self.stopped_by |= {near[k].name for k in set(stopped_by.tolist()) if k >= 0}
            block, before = np.arange(len(some)) // _AT_ONCE, self._work
            for each in sorted(set(block[free].tolist())):
                self._work = before + (each + 1) * _LOOKED
                (chosen,) = np.nonzero(free & (block == each))
                yield from (some[chosen[k : k + _ASKED]] for k in range(0, len(chosen), _ASKED))
            self._work = before + (int(block[-1]) + 1) * _LOOKED
            self._note_stopping(block, clear, free, stopped_by, near)
            first += len(some)
            # Where the best hands will not do, many are looked at.
            together = min(4 * together, _MOST_AT_ONCE)

    def _note_stopping(
        self, block: NDArray[np.intp], clear: NDArray[np.bool_], free: NDArray[np.bool_],
        stopped_by: NDArray[np.intp], near: tuple[Obstacle, ...],
    ) -> None:  # fmt: skip
        """Takes note of what stops all hands of a block."""
        last = np.full(int(block[-1]) + 1, -1)
        np.maximum.at(last, block, stopped_by)
        last[block[free]] = len(near)
        names = [*(each.name for each in near), None, self._push.object]
        touched = np.logical_or.reduceat(clear, np.arange(0, len(block), _AT_ONCE))
        last[~touched] = len(near) + 1
        self._stopped |= {name for k in set(last.tolist()) if (name := names[k]) is not None}

    # -- arms -----------------------------------------------------------------------------------

    def _configurations(self, hands: PostureSet, least: float) -> Iterator[_Found]:
        """Configurations that are reachable, strong enough and free at the object, the best first.

        Args:
            hands: that are clear.
            least: only what has more room than this to the joint limits [rad].
        """
        for solved in self._arms.solutions_along(hands, least):
            # Mostly one of the first few will do.
            for few in (slice(_FEW), slice(_FEW, None)):
                if len(solved[few]):
                    yield from self._free_stances(hands, solved[few])

    def _free_stances(self, hands: PostureSet, solved: IkSolutions) -> Iterator[_Found]:
        """Those of some solutions that are free at the object."""
        self.stopped_by |= {each.name for each in self._scenery.others}
        unhindered = solved[self._are_unhindered(hands, solved)]
        free = unhindered[self._come_off(hands, unhindered)]
        for k, hand in enumerate(free.hand.tolist()):
            stance = ArmConfiguration(
                mount=self._mount,
                posture=hands.posture_at(hand),
                R_WP=self._R_WD[0] @ hands.R_DP[hand],
                elbow=float(free.elbow[k]),
                branch=int(free.branch[k]),
                lift=float(free.lift[k]),
            )
            strength = self._push.fingers * float(hands.strength[hand])
            self._arms.work = int(free.work[k])
            yield _Found(stance, free.descent[k, 0], float(free.room[k]), strength)

    # -- whole arms -----------------------------------------------------------------------------

    def _are_unhindered(self, hands: PostureSet, solved: IkSolutions) -> NDArray[np.bool_]:
        """Which arms stay clear of everything on the way down and while they push, shape (k,)."""
        arms = self._mount.arm_spheres(np.concatenate([solved.descent, solved.q], axis=1))
        if not self._hindered:
            self._hindered += [arms[0]]
        free = np.asarray(self._scenery.is_clear_of_others(arms).all(axis=1))
        down = solved.descent.shape[1]
        pushed = [self._scenery.pushed] * down + self._pushed
        for k, each in enumerate(pushed):
            if free.any():
                free[free] = each.is_clear(arms[free, k])
        if free.any():
            free[free] = self._come_down(hands, solved[free])
        return free

    def _come_down(self, hands: PostureSet, solved: IkSolutions) -> NDArray[np.bool_]:
        """Which hands are clear of everything on the way down, shape (k,)."""
        ways, way = np.unique(
            np.column_stack([solved.hand, solved.lift]), axis=0, return_inverse=True
        )
        down = descent_points(self._points[0], ways[:, 1])
        R_WD = np.broadcast_to(self._R_WD[0], (down.shape[1], 3, 3))
        robot = hands[ways[:, 0].astype(int)].spheres_along(R_WD, down)
        free = np.asarray(self._scenery.is_free(robot).all(axis=1))
        return np.asarray(free[way.ravel()])

    def _way_there(self, found: _Found, places: Array) -> tuple[Array, ...] | None:
        """Arm poses between home and above the start; None if no free way was found."""
        stance, scenery = found.stance, self._scenery
        hand = self._mount.hand.whole_spheres(stance.posture)
        # The hand comes back the same way, when the object is where it was pushed.
        standing = scenery.pushed, self._pushed[-1]
        clearance = TransitClearance(self._mount, hand, scenery, standing)

        def spend() -> None:
            self._work += _ROAD

        arm, home = self._mount.arm, self._mount.home
        return free_path(arm, home, found.above, places, clearance.are_free, spend)

    def _come_off(self, hands: PostureSet, solved: IkSolutions) -> NDArray[np.bool_]:
        """Which arms also get off the face at the end, and back to the start, shape (k,)."""
        if not len(solved):
            return np.ones(0, dtype=bool)
        if not self._way.turn:
            return self._draw_back(hands, solved)
        R_WD, points = self._way_off
        R_AF, p_AF = self._mount.flange_poses(*hands[solved.hand].palms_along(R_WD, points))
        # Of all solutions of the arm, the one that it keeps.
        n, elbow, branch = len(points), solved.elbow, solved.branch[:, None]
        q, valid = self._mount.arm.inverse(
            R_AF.reshape(-1, 3, 3), p_AF.reshape(-1, 3), elbow.repeat(n), branch.repeat(n, axis=0)
        )
        free = np.asarray(valid.reshape(-1, n).all(axis=1))
        arms = self._mount.arm_spheres(q.reshape(len(solved), n, -1)[free, 1:])
        clear = self._pushed[-1].is_clear(arms, FACE_CLEARANCE).all(axis=1)
        for each in self._scenery.others_near(arms):
            clear &= each.is_clear(arms).all(axis=1)
        free[free] = clear
        return free

    @functools.cached_property
    def _way_off(self) -> Sweep:
        """The way from where the fingertips let go of a turned face back to the start."""
        end, turned = self._points[-1], self._way.turn
        off = end - BACK * rot_z(turned) @ self._way.inward
        shares = np.linspace(0.0, 1.0, _BACK_POINTS)[:, None]
        points = np.vstack([end, off + shares * (self._points[0] - off)])
        return Sweep(rot_z(turned * np.append(1.0, 1.0 - shares)) @ self._R_WD[0], points)

    def _turned_hands(
        self, hands: PostureSet, near: tuple[Obstacle, ...]
    ) -> tuple[NDArray[np.bool_], NDArray[np.intp]]:
        """Which get off a face that they have turned, and what stops each, −1 if nothing near."""
        off = Sweep(self._way_off.R_WD[1:], self._way_off.points[1:])
        stopped_by = first_obstacles(hands, near, off)
        clear = stopped_by < 0
        robot = hands[clear].spheres_along(np.eye(3)[None], np.zeros((1, 3)))[:, 0]
        clear[clear] = self._pushed[-1].is_clear_along(robot, *off, FACE_CLEARANCE)
        return clear, stopped_by

    def _draw_back(self, hands: PostureSet, solved: IkSolutions) -> NDArray[np.bool_]:
        """Which hands leave what they have pushed where it is, going straight back, shape (k,).

        They came to it over a few centimetres alone: what reaches beyond it would take it along.
        One that only brushes it is better than none.
        """
        if self._push.ends_on != "stroke" or self._push.press > 0.0:
            return np.ones(len(solved), dtype=bool)
        off = self._points[-1] - BACK * self._way.inward
        far = float(np.linalg.norm(self._points[0] - off))
        shares = np.linspace(0.0, 1.0, 2 + int(far / _BACK_STEP))[:, None]
        points = off + shares * (self._points[0] - off)
        which, hand = np.unique(solved.hand, return_inverse=True)
        robot = hands[which].spheres_along(np.eye(3)[None], np.zeros((1, 3)))[:, 0]
        R_WD = np.broadcast_to(self._R_WD[0], (len(points), 3, 3))
        for clearance in (FACE_CLEARANCE, -_BRUSH):
            clear = self._pushed[-1].is_clear_along(robot, R_WD, points, clearance)
            if clear.any():
                break
        return np.asarray(clear[hand])

    def _transit_places(self, found: _Found) -> Array:
        """Arm poses over which a way may lead: swung up halfway, and high over the table."""
        middle, nudge = 0.5 * (self._mount.home + found.above), 1e-4
        _, p_WP = self._mount.palm_poses(np.vstack([middle, middle + nudge * np.eye(len(middle))]))
        uphill = (p_WP[1:, 2] - p_WP[0, 2]) / nudge
        swings = middle + np.outer(_RAISED, uphill / np.linalg.norm(uphill))
        start = self._points[0, :2]
        over = [[*xy, _OVER] for xy in (start, 0.5 * (start + self._centre), self._centre)]
        stance = found.stance
        p_WP = np.array(over) - stance.R_WP @ stance.posture.tip_midpoint
        R_WP = np.broadcast_to(stance.R_WP, (len(over), 3, 3))
        elbow = np.full(len(over), stance.elbow)
        q, valid = self._mount.arm.inverse(
            *self._mount.flange_poses(R_WP, p_WP), elbow, [stance.branch]
        )
        return np.vstack([swings, q[valid]])


def _blocked_answer(push: Push, stopped: set[str]) -> ReachAnswer:
    others = sorted(stopped - {push.object})
    if others:
        message = f"the hand would hit the {others[0]}"
        return ReachAnswer(False, "obstacle", message, others[0], crowded=True)
    return ReachAnswer(
        False, "object", f"the hand would hit the {push.object} with more than its fingertips"
    )

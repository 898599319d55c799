"""Clearance of hand and arm: on the approach, while pushing, while holding, on the way there.

Frames: W is the world, B the pushed or held object, D the frame of the push, P the palm, T as in
`sim.robots.hand`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.rotations import Array, rot_z, yaw_of
from objectmodels.safety_figure import SafetyFigure
from planner.types.actions import PourOut, SetOn
from planner.types.robot import ReachAnswer
from planner.types.world_state import PlanarPose
from sim.motion.collision_scene import LEAST_CLEARANCE, CollisionScene, Obstacle
from sim.motion.held_object_path import HeldObject, HeldSegment
from sim.motion.roadmap import free_path
from sim.robots.collision_spheres import (
    TABLE_CLEARANCE,
    height_above_table,
    place_spheres,
    sphere_parts,
    surface_spheres,
)
from sim.robots.hand import GraspPosture, Hand, Mount, PostureSet

FACE_CLEARANCE: SafetyFigure = 0.0005
"""Least distance of all but the fingertips from the pushed face [m]."""

_ROUNDING = 1e-9  # so that none is left out that touches [m]
_HELD_CLEARANCE: SafetyFigure = 0.004  # of what is held from what it is poured or put into [m]
_OPEN_CLEARANCE: SafetyFigure = 0.002  # of the open hand from what it is about to hold [m]
_OWNER_CLEARANCE: SafetyFigure = 0.0023  # of the hand from the object whose lid it holds [m]
_LID_CLEARANCE: SafetyFigure = 0.0015  # of a hand that puts a lid aside from the table [m]
_TILTED_CLEARANCE: SafetyFigure = 0.002  # of what is tilted over the table from it [m]
_SINKS = 0.001  # what stands on another object into that, at most [m]
_UNKNOWN, _HIT, _CLEAR = -1, 0, 1


@dataclass(frozen=True)
class Approach:
    """The approach to a contact, which hands make that touch the object with fingertips alone.

    Model: the hand stands before the face, then at it. Seen from the object that is the same
    wherever the object stands, so it is found once for each contact, told apart to a nanometre, and
    kept.

    Attributes:
        hand: that pushes.
        fingers: how many fingertips do.
        spread: distance between two of them [m].
        fine: whether the palm may lean by small angles and large ones.
        pressing: whether it comes from above to press.
        outline: the object's corners in B, one after the other [m].
        height, radius: of the object; see `Obstacle` [m].
        points: of T in B before the face and at it, one after the other [m].
        heading: of D in B [rad].
    """

    hand: Hand
    fingers: int
    spread: float
    fine: bool
    pressing: bool
    outline: tuple[float, ...]
    height: float
    radius: float
    points: tuple[float, ...]
    heading: float

    @classmethod
    def to_object(
        cls,
        pushed: Obstacle,
        points: Array,
        R_WD: Array,
        hand: Hand,
        fingers: int,
        spread: float,
        *,
        fine: bool,
        pressing: bool = False,
    ) -> Approach:
        """The approach along two points of T in W, shape (2, 3) [m], with D at R_WD."""
        return cls(
            hand=hand,
            fingers=fingers,
            spread=spread,
            fine=fine,
            pressing=pressing,
            outline=tuple(pushed.outline.ravel().tolist()),
            height=pushed.height,
            radius=pushed.radius,
            points=_rounded((points - pushed.p_WB) @ pushed.R_WB),
            heading=_rounded(yaw_of(pushed.R_WB.T @ R_WD))[0],
        )

    def clear_hands(self, hands: PostureSet) -> NDArray[np.bool_]:
        """Which of some hands do not hit the object, shape (n,)."""
        known = _known_hands(self)
        new = known[hands.number] == _UNKNOWN
        if new.any():
            some = hands[new]
            known[some.number] = _CLEAR
            # What stays behind the face's plane cannot hit what is beyond it.
            if not self.pressing:
                some = some[some.fronts >= self._room_ahead]
            known[some.number] = _HIT
            points, R_BD = np.reshape(self.points, (2, 3)), rot_z([self.heading, self.heading])
            for part in sphere_parts(some.spheres.shape[1] - self.fingers):
                robot = some.spheres_in_D(part)
                some = some[self._object.is_clear_along(robot, R_BD, points, FACE_CLEARANCE)]
            known[some.number] = _CLEAR
        return np.asarray(known[hands.number] == _CLEAR)

    @property
    def _room_ahead(self) -> float:
        """Distance ahead of T up to which nothing comes too near to the object [m]."""
        inward = np.array([np.cos(self.heading), np.sin(self.heading)])
        face = -self.radius if self.radius else float((self._object.outline @ inward).min())
        ahead = np.reshape(self.points, (2, 3))[:, :2] @ inward
        return face - float(ahead.max()) - FACE_CLEARANCE - _ROUNDING

    @cached_property
    def _object(self) -> Obstacle:
        outline = np.reshape(self.outline, (-1, 2))
        return Obstacle.at_origin(outline, self.height, self.radius)


def _rounded(array: Array) -> tuple[float, ...]:
    return tuple(np.round(array, 9).ravel().tolist())


@lru_cache(maxsize=2048)  # some 10 kB each at most
def _known_hands(approach: Approach) -> NDArray[np.int8]:
    """What is known of each of all hands by now."""
    hand = approach.hand
    if approach.pressing:
        return np.full(len(hand.pressing_postures()), _UNKNOWN, dtype=np.int8)
    every = hand.pushing_postures(approach.fingers, approach.spread, fine=approach.fine)
    return np.full(len(every), _UNKNOWN, dtype=np.int8)


@dataclass(frozen=True, eq=False)
class WaySamples:
    """Poses of the held object at which a way is looked at.

    Attributes:
        R_WB, p_WB: shapes (w, 3, 3) and (w, 3) [m].
        free: where the hand is open, shape (w,).
        last: where it withdraws, shape (w,).
    """

    R_WB: Array
    p_WB: Array
    free: NDArray[np.bool_]
    last: NDArray[np.bool_]

    @classmethod
    def along(cls, legs: tuple[HeldSegment, ...]) -> WaySamples:
        """Those of some legs."""
        none = cls(np.zeros((0, 3, 3)), np.zeros((0, 3)), np.zeros(0, bool), np.zeros(0, bool))
        found = [none]
        for leg in legs:
            R_WB, p_WB = leg.poses_at(leg.sample_shares())
            free, last = (np.full(len(p_WB), x) for x in (leg.free, leg.phase == "retreat"))
            found.append(cls(R_WB, p_WB, free, last))
        return cls.of_ways(found)

    @classmethod
    def of_ways(cls, ways: Sequence[WaySamples]) -> WaySamples:
        """Those of some ways, one after the other."""
        columns = ((way.R_WB, way.p_WB, way.free, way.last) for way in ways)
        return cls(*map(np.concatenate, zip(*columns, strict=True)))

    def __getitem__(self, some: NDArray[np.bool_]) -> WaySamples:
        return WaySamples(self.R_WB[some], self.p_WB[some], self.free[some], self.last[some])


class HoldClearance:
    """A hold of a plan among the objects on the table; `spare` [m] as of `CollisionScene`.

    What may be in the way is that of the hand and of what it holds; no arm is looked at. What
    happens while it holds the object does not depend on how the open hand gets on and off, so that
    it is looked at once for all ways to withdraw.

    Attributes:
        scenery: everything on the table, as the hand may come near to it.
        about: obstacle about which the hand closes, where it is taken.
        R_BP, p_BP: the palm as it holds the object, shapes (3, 3) and (3,) [m].
    """

    def __init__(
        self,
        hand: Hand,
        handled: HeldObject,
        grip: GraspPosture,
        carried: WaySamples,
        spare: float = 0.0,
    ) -> None:
        self._hand, self._handled, self._spare = hand, handled, spare
        self._holding = carried[~carried.free]
        self._plan, self._owner = handled.plan, handled.owner
        self._closed, self._open = grip.posture_at(), grip.posture_at(grip.opening)
        self.R_BP, self.p_BP = handled.palm_at(grip.middle)
        self.about = handled.grasped_obstacle
        self.scenery = self._around_it(
            CollisionScene.from_state(handled.state, self._plan.object, spare)
        )

    def _around_it(self, scenery: CollisionScene) -> CollisionScene:
        """The scene for the hand, which may come near to a lid's object, and into a sturdy box."""
        objects = self._handled.state.objects
        near = {
            name: LEAST_CLEARANCE - self._spare
            for name in self._lower
            if objects[name].model.inside is not None and not objects[name].fragile
        }
        if self._owner is not None:
            near[self._owner] = _OWNER_CLEARANCE - self._spare
        others = (
            replace(each, clearance=near[each.name]) if each.name in near else each
            for each in scenery.others
        )
        lifted = np.array([0.0, 0.0, self._handled.height if self._owner else 0.0])
        pushed = replace(scenery.pushed, p_WB=scenery.pushed.p_WB + lifted)
        return CollisionScene(pushed, tuple(others))

    @property
    def _lower(self) -> set[str]:
        """Names of what the held object stood on at first, and is put on or into."""
        found = {step.onto for step in self._plan.steps if isinstance(step, SetOn)}
        on = self._handled.held.on
        return found if on is None else found | {on}

    def blocked_along(self, way: WaySamples, stood: Obstacle) -> ReachAnswer | None:
        """The answer if something is in the way of hand or held object along a way; else None.

        `stood` is what is held, where it stands in the end.
        """
        free = way[way.free]
        hand = self._hand_along(free, is_open=True)
        blocked = self._hand_meets(hand) or self._closed_hand_blocked
        if blocked is not None:
            return blocked
        own = {"object": self._plan.object}
        for last, one in zip(free.last, hand, strict=True):
            stands = stood if last else self.about
            if (stands.distance_to(one) < _OPEN_CLEARANCE).any():
                return ReachAnswer(False, "object", "open_hand_hits", words=own)
        return self.blocked_hold

    @cached_property
    def _closed_hand_blocked(self) -> ReachAnswer | None:
        """The answer if something is in the way of the hand while it holds the object."""
        return self._hand_meets(self._hand_along(self._holding, is_open=False))

    @cached_property
    def blocked_hold(self) -> ReachAnswer | None:
        """The answer if this hold does not do, however the open hand gets on and off."""
        inside = self._hand.spheres(self._closed)
        about = place_spheres(inside, self.R_BP, self.p_BP)
        if (in_itself(self.about).distance_to(about) < 0.0).any():
            own = {"object": self._plan.object}
            return ReachAnswer(False, "object", "hand_hits_object", words=own)
        return self._closed_hand_blocked or self._held_blocked()

    def left_standing(self, R_WB: Array, p_WB: Array) -> Obstacle:
        """What was held, let go in a pose of shapes (3, 3) and (3,) [m]."""
        held = self._handled.held
        if R_WB[2, 2] < 1.0 - 1e-9:
            rest = held.model.resting_face(R_WB)
            R_WN, p_WN = rest.lying_pose(R_WB, p_WB)
            there = PlanarPose(float(p_WN[0]), float(p_WN[1]), float(yaw_of(R_WN)))
            return Obstacle.from_seen(replace(held, pose=there, model=rest.model), 0.0)
        turned = R_WB @ self.about.R_WB.T
        angle = float(np.arctan2(turned[1, 0], turned[0, 0]))
        return self.about.after_motion(self.about.p_WB, p_WB, angle)

    def palm_poses(self, way: WaySamples) -> tuple[Array, Array]:
        """R_WP, shape (w, 3, 3), and p_WP, shape (w, 3) [m], along a way."""
        return way.R_WB @ self.R_BP, way.p_WB + way.R_WB @ self.p_BP

    def _hand_along(self, way: WaySamples, *, is_open: bool) -> Array:
        """Spheres of the hand in W along a way, shape (w, k, 4)."""
        return place_spheres(self.hand_spheres(is_open=is_open), *self.palm_poses(way))

    def _hand_meets(self, hand: Array) -> ReachAnswer | None:
        """The answer if table or others are in the way of the hand's spheres; else None."""
        low = height_above_table(hand).min(initial=np.inf)
        # A lid is put aside flat.
        if low < (TABLE_CLEARANCE if self._owner is None else _LID_CLEARANCE):
            return ReachAnswer(False, "table", "low_hand", words={"height": float(low)})
        name = self.scenery.hit_by(hand)
        return None if name is None else ReachAnswer(False, "obstacle", "hand_hits_other", name)

    def hand_spheres(self, *, is_open: bool) -> Array:
        """Spheres of the hand in P, with its fingertips."""
        hand, posture = self._hand, self._open if is_open else self._closed
        # Fingers about a knob are near to what it stands on.
        return hand.whole_spheres(posture) if self._owner is None else hand.thin_spheres(posture)

    def _held_blocked(self) -> ReachAnswer | None:
        """The answer if something is in the way of the held object; else None."""
        way, pushed = self._holding, self.scenery.pushed
        body = place_spheres(surface_spheres(pushed.outline, pushed.height), way.R_WB, way.p_WB)
        own = {"object": self._plan.object}
        # What is set down in the end comes down to the table, on whatever face that may be.
        level = np.maximum(way.R_WB[:, 2, 2], way.R_WB[:, 2] @ way.R_WB[-1, 2])
        tilted = level < 1.0 - 1e-9
        low = height_above_table(body[tilted]).min(initial=np.inf)
        if low < _TILTED_CLEARANCE:
            return ReachAnswer(False, "table", "low_tilt", words=own)
        kept = dict(self._plan.limits.clear_of)
        into = {step.into for step in self._plan.steps if isinstance(step, PourOut)}
        for each in self.scenery.others:
            if each.name == self._owner:
                continue
            clearance = _HELD_CLEARANCE - self._spare if each.name in into else each.clearance
            clearance = max(clearance, kept.get(each.name, 0.0) - self._spare)
            if each.name in self._lower:
                carries = np.abs(way.p_WB[[0, -1], 2] - each.top).min() < _SINKS
                clearance = -_SINKS if carries else _HELD_CLEARANCE - self._spare
            # What stands close already is not hit by being lifted.
            near = each.distance_to(body[:1]).min(initial=np.inf)
            if not each.is_clear(body, min(clearance, max(0.0, 0.9 * near))).all():
                return ReachAnswer(False, "obstacle", "object_hits_other", each.name, words=own)
        return None


def in_itself(held: Obstacle) -> Obstacle:
    """The held object in its own frame."""
    return replace(held, R_WB=np.eye(3), p_WB=np.zeros(3))


class Sweep(NamedTuple):
    """Where the hand is looked at on the way of its fingertips; the palm turns about the vertical.

    Attributes:
        R_WD: frame of the push at each place, shape (w, 3, 3).
        points: of T in W, shape (w, 3) [m].
    """

    R_WD: Array
    points: Array

    @classmethod
    def along(cls, points: Array, R_WD: Array) -> Sweep:
        """The sweep along a way: the start, the touch, and on to the end of the stroke.

        Args:
            points: of T there, shape (w, 3) [m].
            R_WD: frame of the push at each of them, shape (w, 3, 3).
        """
        before, after = points[1:-1], points[2:]
        apart = np.linalg.norm(after - before, axis=1).max()
        n = max(1, int(np.ceil(apart / 0.025)))
        t = np.arange(n)[:, None] / n
        stroke = (before[:, None] + t * (after - before)[:, None]).reshape(-1, 3)
        which = np.array([0, *np.repeat(np.arange(1, len(before) + 1), n), -1])
        return cls(R_WD[which], np.vstack([points[:1], stroke, points[-1:]]))


def first_obstacles(
    hands: PostureSet, others: tuple[Obstacle, ...], sweep: Sweep
) -> NDArray[np.intp]:
    """The first of some obstacles that each hand comes too near to; −1 if none, shape (n,).

    Circles about hands and obstacles, as seen from above, sort out most pairs; spheres are placed
    for the others.
    """
    together = 384  # hands whose spheres a processor keeps at hand
    stopped_by = np.full(len(hands), -1)
    if not others or not len(hands):
        return stopped_by
    near = _obstacles_near(hands.circles, others, sweep)
    (beside,) = np.nonzero(near.any(axis=1))
    spheres = hands[beside].spheres_in_D()
    parts = [spheres[:, part] for part in sphere_parts(spheres.shape[1])]
    for number, each in enumerate(others):
        (close,) = np.nonzero(near[beside, number] & (stopped_by[beside] < 0))
        for k in range(0, len(close), together):
            clear = some = close[k : k + together]
            for part in parts if len(some) > 24 else (spheres,):
                clear = clear[each.is_clear_along(part[clear], *sweep, each.clearance)]
            stopped_by[beside[some]] = number
            stopped_by[beside[clear]] = -1
    return stopped_by


def _obstacles_near(
    circles: Array, others: tuple[Obstacle, ...], sweep: Sweep
) -> NDArray[np.bool_]:
    """Which of o obstacles each hand may come too near to, shape (n, o).

    Args:
        circles: about the hands, shape (n, 3); see `PostureSet`.
        others: the obstacles.
        sweep: of the hands.
    """
    R_WD, points = sweep
    middles = np.array([each.middle for each in others])
    kept = np.array([each.around + each.clearance for each in others])
    # Seen from D, shape (w, o, 2).
    middles_D = (middles - points[:, None, :2]) @ R_WD[:, :2, :2]
    apart = middles_D[:, None] - circles[:, None, :2]
    near = apart[..., 0] ** 2 + apart[..., 1] ** 2 < (circles[:, 2:] + kept) ** 2
    return np.asarray(near.any(axis=0))


@dataclass(frozen=True, eq=False)
class TransitClearance:
    """Clearance of arm and hand from all that stands on the table, between home and a motion.

    Model: most of arm and hand is higher than everything that stands there, so only the spheres
    that come below that height are placed.

    Attributes:
        mount: of the arm.
        hand: spheres of the hand in P, shape (h, 4) [m].
        scenery: what stands there, but for what is moved.
        standing: that, in all places where it is by then.
    """

    mount: Mount
    hand: Array
    scenery: CollisionScene
    standing: Sequence[Obstacle]

    def are_free(self, q: Array) -> NDArray[np.bool_]:
        """Which arm poses, shape (n, joints), keep clear of everything, shape (n,)."""
        spheres, pose = self._low_spheres(q)
        hit = ~self.scenery.is_clear_of_others(spheres[:, None])
        for each in self.standing:
            hit |= each.hits(spheres, each.clearance)
        free = np.ones(len(q), dtype=bool)
        free[pose[hit]] = False
        return free

    def path_from_home(
        self, q: Array, places: Array, spend: Callable[[], None]
    ) -> tuple[Array, ...] | None:
        """Arm poses between home and a pose, shape (joints,) [rad]; see `free_path`."""
        return free_path(self.mount.arm, self.mount.home, q, places, self.are_free, spend)

    def _low_spheres(self, q: Array) -> tuple[Array, NDArray[np.intp]]:
        """Spheres in W that are not above everything, shape (m, 4), and the pose of each, (m,)."""
        tops = [each.top + each.clearance for each in (*self.scenery.others, *self.standing)]
        height = max([TABLE_CLEARANCE, *tops]) + _ROUNDING
        at, radius = self.hand[:, :3], self.hand[:, 3]
        R_WP, p_WP = self.mount.palm_poses(q)
        pose, which = np.nonzero(R_WP[:, 2] @ at.T + p_WP[:, 2:] - radius < height)
        placed = np.empty((len(pose), 4))
        placed[:, :3] = (R_WP[pose] @ at[which, :, None])[..., 0] + p_WP[pose]
        placed[:, 3] = radius[which]
        arm = self.mount.arm_spheres(q)
        low = arm[..., 2] - arm[..., 3] < height
        return np.vstack([placed, arm[low]]), np.append(pose, np.nonzero(low)[0])

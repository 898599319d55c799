"""Obstacles of a hand that holds something, and of what it holds; no arm is looked at.

What happens while it holds the object does not depend on how the open hand gets on and off, so that
it is looked at once for all ways to withdraw.

Frames: see `sim.paths.held_object_path`; P is the palm.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from planner.types.actions import PourOut, SetOn
from planner.types.robot import ReachAnswer
from planner.types.world_state import PlanarPose
from sim.collision.collision_scene import (
    LEAST_CLEARANCE,
    TABLE_CLEARANCE,
    CollisionScene,
    Obstacle,
)
from sim.collision.collision_spheres import height_above_table, place_spheres, surface_spheres
from sim.hands.hand_model import GraspPosture, Hand
from sim.paths.held_object_path import HeldObject
from sim.paths.held_segment import HeldSegment
from sim.rotations import Array, yaw_of

_HELD_CLEARANCE = 0.004  # of what is held from what it is poured or put into [m]
_OWNER_CLEARANCE = 0.0023  # of the hand from the object whose lid it holds [m]
_LID_CLEARANCE = 0.0015  # of a hand that puts a lid aside from the table [m]
_FACE_CLEARANCE = 0.002  # of the open hand from what it is about to hold [m]
_OFF_TABLE = 0.002  # of what is tilted over the table [m]
_SINKS = 0.001  # what stands on another object into that, at most [m]


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

    @property
    def open_hand(self) -> WaySamples:
        """Those at which the hand is open."""
        return self._chosen(self.free)

    @property
    def holding(self) -> WaySamples:
        """Those at which the hand holds the object."""
        return self._chosen(~self.free)

    def _chosen(self, some: NDArray[np.bool_]) -> WaySamples:
        return WaySamples(self.R_WB[some], self.p_WB[some], self.free[some], self.last[some])


class HoldClearance:
    """A hold of a plan among the objects on the table; `spare` [m] as of `CollisionScene`.

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
        self._hand, self._handled, self._carried, self._spare = hand, handled, carried, spare
        self._plan, self._owner = handled.plan, handled.owner
        self._closed, self._open = grip.posture_at(), grip.posture_at(grip.opening)
        self.R_BP, self.p_BP = handled.palm_at(grip.middle)
        self.about = handled.grasped_obstacle
        self.scenery = self._around_it(
            CollisionScene.from_state(handled.state, self._plan.object, spare)
        )

    def _around_it(self, scenery: CollisionScene) -> CollisionScene:
        """The scene for the hand, which may come near to the object of a lid, and into a box."""
        near = dict.fromkeys(self._open_boxes, LEAST_CLEARANCE - self._spare)
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

    @property
    def _open_boxes(self) -> Iterator[str]:
        """Names of the open boxes among these; a fragile one is kept away from."""
        objects = self._handled.state.objects
        return (
            name
            for name in self._lower
            if objects[name].model.inside is not None and not objects[name].fragile
        )

    def blocked_along(self, way: WaySamples, stood: Obstacle) -> ReachAnswer | None:
        """The answer if something is in the way of hand or held object along a way; else None.

        `stood` is what is held, where it stands in the end.
        """
        free = way.open_hand
        hand = self._hand_along(free, is_open=True)
        blocked = self._hand_meets(hand) or self._closed_hand_blocked
        if blocked is not None:
            return blocked
        for last, one in zip(free.last, hand, strict=True):
            stands = stood if last else self.about
            if (stands.distance_to(one) < _FACE_CLEARANCE).any():
                what = f"the open hand does not get around the {self._plan.object}"
                return ReachAnswer(False, "object", what)
        return self.blocked_hold

    @cached_property
    def _closed_hand_blocked(self) -> ReachAnswer | None:
        """The answer if something is in the way of the hand while it holds the object."""
        return self._hand_meets(self._hand_along(self._carried.holding, is_open=False))

    @cached_property
    def blocked_hold(self) -> ReachAnswer | None:
        """The answer if this hold does not do, however the open hand gets on and off."""
        inside = self._hand.spheres(self._closed)
        own = place_spheres(inside, self.R_BP, self.p_BP)
        if (in_itself(self.about).distance_to(own) < 0.0).any():
            what = f"the hand would hit the {self._plan.object} with more than its fingertips"
            return ReachAnswer(False, "object", what)
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
        if low < (TABLE_CLEARANCE if self._owner is None else _LID_CLEARANCE):
            up = 1e3 * float(low)
            return ReachAnswer(False, "table", f"the hand would come to {up:.0f} mm over the table")
        for each in self.scenery.others_near(hand):
            if not each.is_clear(hand).all():
                return _blocked_answer(each.name, "the hand")
        return None

    def hand_spheres(self, *, is_open: bool) -> Array:
        """Spheres of the hand in P, with its fingertips."""
        hand, posture = self._hand, self._open if is_open else self._closed
        # Fingers about a knob are near to what it stands on.
        return hand.whole_spheres(posture) if self._owner is None else hand.thin_spheres(posture)

    def _held_blocked(self) -> ReachAnswer | None:
        """The answer if something is in the way of the held object; else None."""
        way, pushed = self._carried.holding, self.scenery.pushed
        body = place_spheres(surface_spheres(pushed.outline, pushed.height), way.R_WB, way.p_WB)
        what = f"the {self._plan.object}"
        # What is set down in the end comes down to the table, on whatever face that may be.
        level = np.maximum(way.R_WB[:, 2, 2], way.R_WB[:, 2] @ way.R_WB[-1, 2])
        tilted = level < 1.0 - 1e-9
        low = height_above_table(body[tilted]).min(initial=np.inf)
        if low < _OFF_TABLE:
            return ReachAnswer(False, "table", f"{what} would hit the table while it is tilted")
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
                return _blocked_answer(each.name, what)
        return None


def in_itself(held: Obstacle) -> Obstacle:
    """The held object in its own frame."""
    return replace(held, R_WB=np.eye(3), p_WB=np.zeros(3))


def _blocked_answer(name: str, what: str) -> ReachAnswer:
    return ReachAnswer(False, "obstacle", f"{what} would hit the {name}", name)

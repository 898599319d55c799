"""The search for a way of arm and hand through a whole handling plan.

Model: the hand goes rigidly with what it holds, so every leg says where the palm is. The arm keeps
the redundancy angle and one of its solutions all along; they are tried together, the ones with
room to the joint limits first. Where something is held already, the elbow swings there first while
the hand stays. Hand and held object do not depend on the arm and are looked at once for all arms;
then comes the arm, and the way from home and back. What is held is its own obstacle
before it is touched and after it was let go.

Frames: see `sim.paths.held_object_path`; P is the palm.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planner.types.robot import ReachAnswer
from sim.collision.collision_scene import (
    OBJECT_CLEARANCE,
    TABLE_CLEARANCE,
    CollisionScene,
    Obstacle,
)
from sim.collision.collision_spheres import height_above_table, place_spheres
from sim.hands.hand_model import GraspPosture
from sim.hands.mount import Mount
from sim.motion.hold_clearance import HoldClearance, WaySamples, in_itself
from sim.motion.ik_search import best_solutions
from sim.motion.roadmap import LIMIT_MARGIN, free_path, sample_configurations
from sim.motion.transit_clearance import TransitClearance
from sim.paths.held_object_path import (
    HeldObject,
    free_segments,
    step_segments,
    withdrawal_vectors,
)
from sim.paths.held_segment import HeldSegment
from sim.rotations import Array

_LARGEST_STEP = 0.6  # more change of a joint between poses that are looked at is a jump [rad]
_HOMESICK = 0.1  # room to the limits that a joint's being one radian nearer to home is worth
_MOST_ARMS, _MOST_TRANSITS = 40, 4
_SAME = 0.15  # a joint's change up to which an arm is in the pose in which it was left [rad]
_BEGUN, _SOLVED, _FOLLOWED, _ROAD = 4, 5, 2, 1  # units of work of the parts of a search
_SWING = 5.0  # between elbow angles while it swings [degrees]
_OUT_OF_REACH = ReachAnswer(
    False, "kinematics", "the arm does not reach along the whole way of the hand"
)
_RAISED = (0.10, 0.20, 0.30)  # of places above the first pose of the hand [m]


@dataclass(frozen=True, eq=False)
class GraspMotion:
    """A way of arm and hand through a plan.

    Attributes:
        mount: of the arm.
        grip: of the hand.
        R_BP, p_BP: the palm as it holds the object, shapes (3, 3) and (3,) [m].
        legs: of the approach, of each step, and of the way back.
        elbow: redundancy angle of the arm [rad].
        branch: which of the arm's solutions.
        there, back: arm poses between home and the first pose, and between the last one and home;
            with something held already, `there` is how the elbow swings to its angle.
        room: least room to the joint limits [rad].
        work: units of work behind it.
    """

    mount: Mount
    grip: GraspPosture
    R_BP: Array
    p_BP: Array
    legs: tuple[tuple[HeldSegment, ...], ...]
    elbow: float
    branch: int
    there: tuple[Array, ...] = ()
    back: tuple[Array, ...] = ()
    room: float = 0.0
    work: int = 1

    def joint_angles(self, R_WB: Array, p_WB: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Arm angles for object poses, shape (n, joints), and which of them are reached, (n,)."""
        n = len(p_WB)
        R_AF, p_AF = self.mount.flange_poses(R_WB @ self.R_BP, p_WB + R_WB @ self.p_BP)
        q, valid = self.mount.arm.inverse(R_AF, p_AF, np.full(n, self.elbow), [self.branch])
        return q[:, 0], valid[:, 0]


class GraspMotionSearch:
    """The search for one plan; `spare` [m] as of `CollisionScene.from_state`.

    Attributes:
        work: units of work done so far.
    """

    def __init__(
        self, mount: Mount, handled: HeldObject, grip: GraspPosture, spare: float = 0.0
    ) -> None:
        self.work = 0
        self._mount = mount
        self._bare_grip = grip
        self._handled = handled
        self._spare = spare
        plan, state = handled.plan, handled.state
        self._plan = plan
        self._is_held = handled.grasp.held
        already = state.held if self._is_held else None
        self._at = np.array(already.arm) if already is not None and already.arm else None
        self._legs: tuple[tuple[HeldSegment, ...], ...] = ()

    @functools.cached_property
    def _grip(self) -> GraspPosture:
        """The hand, as its outer fingers press on the sides."""
        grip = self._bare_grip
        tip_radius = self._mount.hand.tip_radius
        return replace(grip, press=self._handled.outer_press(grip.grip.contacts, tip_radius))

    @functools.cached_property
    def _steps(self) -> tuple[tuple[HeldSegment, ...], ...]:
        return step_segments(self._handled)

    @functools.cached_property
    def _carried(self) -> WaySamples:
        """The way of the object, from where it is taken to where it is let go."""
        return WaySamples.along(tuple(leg for legs in self._steps for leg in legs))

    @functools.cached_property
    def _hold(self) -> HoldClearance:
        hand = self._mount.hand
        return HoldClearance(hand, self._handled, self._grip, self._carried, self._spare)

    @property
    def _scenery(self) -> CollisionScene:
        return self._hold.scenery

    def best_motion(self) -> GraspMotion | ReachAnswer:
        """The best way, or why there is none, by the first way of the open hand off the object."""
        # Most that is out of reach is so where it is taken.
        lacks = self._range_excess(*self._handled.start_pose) or self._range_excess(
            self._carried.R_WB, self._carried.p_WB
        )
        if lacks > 0.0:
            self.work += _BEGUN
            message = f"{_OUT_OF_REACH.message}: it lacks {1e3 * lacks:.0f} mm"
            return replace(_OUT_OF_REACH, message=message, numbers={"lacks": lacks})
        first: ReachAnswer | None = None
        for off in withdrawal_vectors(self._handled.grasp, self._handled.held):
            self.work += _BEGUN
            if first is not None and self._hold.blocked_hold is not None:
                continue  # however the hand gets off
            self._withdraw_by(off)
            found = self._motion_of_way()
            if isinstance(found, GraspMotion):
                return found
            first = first or found
        assert first is not None, "there is a way off everything"
        return first

    def _range_excess(self, R_WB: Array, p_WB: Array) -> float:
        """How far the wrist cannot get to where it holds the object, at worst; 0 if it may [m]."""
        R_BP, p_BP = self._handled.palm_at(self._bare_grip.middle)
        p_WW = p_WB + R_WB @ (p_BP + R_BP @ self._mount.p_PW)
        p_AW = (p_WW - self._mount.p_WA) @ self._mount.R_WA
        return float(self._mount.arm.range_excess(p_AW, LIMIT_MARGIN).max(initial=0.0))

    def _withdraw_by(self, off: Array) -> None:
        """Takes the open hand to and off the object by a vector in W, shape (3,) [m]."""
        before, after = free_segments(self._handled, off, self._steps)
        self._legs = (before, *self._steps, after)
        ends = [WaySamples.along(legs) for legs in (before, after)]
        self._way = WaySamples.of_ways([ends[0], self._carried, ends[1]])
        # Where it stands in the end, for the hand that lets go of it there.
        self._stood = self._hold.about
        if self._way.last.any():
            k = int(np.flatnonzero(self._way.last)[0])
            self._stood = self._hold.left_standing(self._way.R_WB[k], self._way.p_WB[k])

    def _motion_of_way(self) -> GraspMotion | ReachAnswer:
        """The best way with these legs, or why there is none."""
        blocked = self._hold.blocked_along(self._way, self._stood)
        if blocked is not None:
            return blocked
        self.work += _SOLVED
        q, elbow, branch, room = self._arm_solutions()
        if not len(q):
            return _OUT_OF_REACH
        hindered: str | None = None
        tried = 0
        for k in range(min(len(q), _MOST_ARMS)):
            self.work += _FOLLOWED
            what = self._arm_blocked(q[k])
            if what is not None:
                hindered = hindered or what
                continue
            way = GraspMotion(
                self._mount, self._grip, self._hold.R_BP, self._hold.p_BP, self._legs,
                float(elbow[k]), int(branch[k]), room=float(room[k]),
            )  # fmt: skip
            found = self._from_home(way, q[k])
            if found is not None:
                return found
            tried += 1
            hindered = hindered or self._plan.object
            if tried >= _MOST_TRANSITS:
                break
        own = hindered in {self._plan.object, "table"}
        return ReachAnswer(
            False,
            "approach" if own else "obstacle",
            f"the arm has no free way to the hand's places: it would hit the {hindered}",
            None if own else hindered,
        )

    # -- arms -----------------------------------------------------------------------------------

    def _arm_solutions(self) -> tuple[Array, Array, NDArray[np.intp], Array]:
        """Arm angles along the whole way, elbow angles, branches and room; the best first."""
        R_WP, p_WP = (
            self._way.R_WB @ self._hold.R_BP,
            self._way.p_WB + self._way.R_WB @ self._hold.p_BP,
        )
        elbows = self._mount.arm.redundancy_samples
        # Few poses sort out most elbows.
        some = np.unique(np.linspace(0, len(p_WP) - 1, 6).astype(int))
        _, good, _ = self._follow_path(R_WP[some], p_WP[some], elbows, np.inf)
        elbows = elbows[good.any(axis=1)]
        q, good, room = self._follow_path(R_WP, p_WP, elbows, _LARGEST_STEP)
        off = q[:, 0] - (self._mount.home if self._at is None else self._at)
        row, branch = best_solutions(good, room, off, _HOMESICK, good.size)
        return q[row, :, branch], elbows[row], branch, room[row, branch]

    def _follow_path(
        self, R_WP: Array, p_WP: Array, elbows: Array, largest: float
    ) -> tuple[Array, NDArray[np.bool_], Array]:
        """Angles of all arms along palm poses, shape (e, w, branches, joints).

        Returns:
            Besides, which arms are good and their room to the joint limits, shape (e, branches).
        """
        mount, e = self._mount, len(elbows)
        q, usable = mount.solve_palm(
            np.broadcast_to(R_WP, (e, *R_WP.shape)), np.broadcast_to(p_WP, (e, *p_WP.shape)), elbows
        )
        room = mount.arm.joint_room(q)
        steady = np.abs(np.diff(q, axis=1)).max(axis=(1, 3), initial=0.0) < largest
        good = usable & (room > LIMIT_MARGIN)
        return q, np.asarray(good.all(axis=1) & steady), room.min(axis=1)

    def _arm_blocked(self, q: Array) -> str | None:
        """Name of the object that the arm would hit on the way; None if there is none."""
        robot = self._mount.arm_spheres(q)
        if (height_above_table(robot) < TABLE_CLEARANCE).any():
            return "table"
        for each in self._scenery.others_near(robot):
            if not each.is_clear(robot).all():
                return each.name
        held = in_itself(self._scenery.pushed)
        R_BW = np.swapaxes(self._way.R_WB, -1, -2)
        in_B = place_spheres(robot, R_BW, -(R_BW @ self._way.p_WB[..., None])[..., 0])
        if (held.distance_to(in_B) < OBJECT_CLEARANCE).any():
            return self._plan.object
        return None

    # -- transits -------------------------------------------------------------------------------

    def _from_home(self, way: GraspMotion, q: Array) -> GraspMotion | None:
        """The same way with those from home and back; None if they are not free."""
        there: tuple[Array, ...] | None = ()
        back: tuple[Array, ...] | None = ()
        if self._at is not None:
            there = self._swing_elbow(way)
        elif not self._is_held:
            there = self._transit_path(
                way, q[0], self._way.p_WB[0], self._way.R_WB[0], self._scenery.pushed
            )
        if there is not None and self._way.last.any():
            back = self._transit_path(
                way, q[-1], self._way.p_WB[-1], self._way.R_WB[-1], self._stood
            )
        if there is None or back is None:
            return None
        return replace(way, there=there, back=back[::-1])

    def _swing_elbow(self, way: GraspMotion) -> tuple[Array, ...] | None:
        """Arm poses from where it was left to the way's elbow angle, the hand still."""
        assert self._at is not None, "something is held"
        steps = np.radians(np.arange(0.0, 360.0, _SWING))
        here = [replace(way, elbow=float(e)) for e in way.elbow + steps]
        poses = [one.joint_angles(self._way.R_WB[:1], self._way.p_WB[:1]) for one in here]
        q = np.array([one[0] for one, _ in poses])
        good = np.array([bool(valid[0]) for _, valid in poses])
        good &= self._mount.arm.joint_room(q) > LIMIT_MARGIN
        near = np.where(good, np.abs(q - self._at).max(axis=1), np.inf)
        start = int(np.argmin(near))
        if near[start] > _SAME:
            return None
        for way_round in (np.arange(start, -1, -1), np.arange(start, len(q) + 1) % len(q)):
            swing = q[way_round]
            steady = np.abs(np.diff(swing, axis=0)).max(initial=0.0) < _LARGEST_STEP
            if good[way_round].all() and steady and self._is_clear(swing):
                return tuple(swing)
        return None

    def _is_clear(self, q: Array) -> bool:
        """True if the arm keeps clear of the table and of all others."""
        robot = self._mount.arm_spheres(q)
        high = height_above_table(robot).min() >= TABLE_CLEARANCE
        near = self._scenery.others_near(robot)
        return bool(high and all(each.is_clear(robot).all() for each in near))

    def _transit_path(
        self, way: GraspMotion, q: Array, p_WB: Array, R_WB: Array, stands: Obstacle
    ) -> tuple[Array, ...] | None:
        """Arm poses between home and a pose of the open hand."""
        open_hand = self._hold.hand_spheres(is_open=True)
        clearance = TransitClearance(self._mount, open_hand, self._scenery, (stands,))

        def spend() -> None:
            self.work += _ROAD

        arm, home = self._mount.arm, self._mount.home
        up = np.array([[0.0, 0.0, height] for height in _RAISED])
        raised, valid = way.joint_angles(np.broadcast_to(R_WB, (len(up), 3, 3)), p_WB + up)
        raised = raised[valid]
        places = np.vstack([raised, 0.5 * (home + q), 0.5 * (home + raised)])
        for some in (places, sample_configurations(home, q)):
            found = free_path(arm, home, q, some, clearance.are_free, spend)
            if found is not None:
                return found
        return None


def best_grasp_motion(
    mount: Mount, handled: HeldObject, grip: GraspPosture, spare: float = 0.0
) -> GraspMotion | ReachAnswer:
    """The best way through a plan with a grasp, or why there is none; see `GraspMotionSearch`."""
    search = GraspMotionSearch(mount, handled, grip, spare)
    return replace(search.best_motion(), work=search.work)

"""Searches for motions of arm and hand: of a push, of a grasp, of the flip of a lid.

Each ends with a stance: a hand, an arm pose for every point of its way, and a way to get there.

Frames: see `sim.motion.inverse_kinematics`.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.rotations import Array, rot_y, rot_z
from objectmodels.safety_figure import SafetyFigure
from planner.types.actions import FlipOver, Push
from planner.types.robot import ReachAnswer
from planner.types.world_state import TableState, WorldState
from sim.motion.clearance import (
    FACE_CLEARANCE,
    Approach,
    HoldClearance,
    Sweep,
    TransitClearance,
    WaySamples,
    first_obstacles,
    in_itself,
)
from sim.motion.collision_scene import LEAST_CLEARANCE, OBJECT_CLEARANCE, CollisionScene, Obstacle
from sim.motion.fingertip_path import BACK, FingertipPath
from sim.motion.held_object_path import (
    HeldObject,
    HeldSegment,
    free_segments,
    step_segments,
    withdrawal_vectors,
)
from sim.motion.inverse_kinematics import (
    ENOUGH_MARGIN,
    ArmConfiguration,
    IkSolutions,
    PushIkSearch,
    UnreachableError,
    best_solutions,
    descent_points,
    in_range,
)
from sim.motion.roadmap import LIMIT_MARGIN, free_path, interpolate_joints, sample_configurations
from sim.robots.collision_spheres import TABLE_CLEARANCE, height_above_table, place_spheres
from sim.robots.hand import FlipPostureSet, GraspPosture, Mount, PostureSet
from sim.robots.lid_path import LidShape, hinge_pose, lid_shape

_DESCENT = np.linspace(1.0, 0.0, 5)  # of a hand to a lid, shares of its lift
_BODY_CLEARANCE: SafetyFigure = 0.002  # of the hand from the object and its lid on its way down [m]
_LARGEST_STEP = 0.6  # more change of a joint between poses of a held object is a jump [rad]
_AT_ONCE = 48  # hands that are looked at for one unit of work
_LOOKED = 2  # units of work: to look at so many
_OUT_OF_REACH = ReachAnswer(False, "kinematics", "hand_out_of_reach")


@dataclass(frozen=True, eq=False)
class FlipConfiguration:
    """Arm and hand while they flip a lid.

    Attributes:
        stance: at the start.
        hands: the one hand, with its path.
        lid: that is flipped.
        R_WE, p_WE: of the hinge, as it was seen.
    """

    stance: ArmConfiguration
    hands: FlipPostureSet
    lid: LidShape
    R_WE: Array
    p_WE: Array

    def joint_angles(self, p_ET: Array, share: float) -> Array:
        """Arm angles, shape (joints,), with T at a point of E and the palm turned by a share.

        Raises:
            UnreachableError: the arm does not get there in this stance.
        """
        R_EP = self.hands.R_EP[0]
        whole = R_EP[self.hands.path.touching.stop - 1] @ R_EP[0].T
        palm_turn = float(np.arctan2(whole[0, 2], whole[0, 0]))
        R_WP = self.R_WE @ rot_y(share * palm_turn) @ R_EP[0]
        return replace(self.stance, R_WP=R_WP).joint_angles(self.R_WE @ p_ET + self.p_WE)


class FlipMotionSearch:
    """The search for a stance that flips the lid of an object.

    Model: hands that are clear of the lid and its object wherever that stands are sorted out by
    what else stands about; for the rest the arm's solutions are looked at over a ring of redundancy
    angles, at the ends and the middle of the way first, then all along it. What is continuous,
    clear of everything and has a free way from home is a stance; room to the joint limits and
    nearness to home count.

    Frames: E and L as in `sim.robots.lid_path`, P the palm, T the fingertip's centre.
    """

    def __init__(self, mount: Mount, step: FlipOver, name: str, state: WorldState) -> None:
        self._mount = mount
        self._name = name
        target = state.objects[name]
        self._lid = lid_shape(step, target, mount.hand.tip_radius)
        self._R_WE, self._p_WE = hinge_pose(target)
        # The lid is looked at where it is, not as what rises above the object.
        bare = {**state.objects, name: replace(target, lid=None)}
        self._scenery = CollisionScene.from_state(replace(state, objects=bare), name)
        self._hands = mount.hand.flip_postures(self._lid)
        # How far over the start the hand comes down [m]; behind an open lid it is above everything.
        self._lift = 0.12 if self._lid.is_opening else 0.03
        self._stopped: set[str] = set()

    def best_configuration(self) -> tuple[FlipConfiguration, ReachAnswer] | ReachAnswer:
        """The best stance, or why there is none."""
        if not len(self._hands):
            return ReachAnswer(False, "object", "hand_hits_lid", words={"object": self._name})
        hands = self._clear_hands()
        if not len(hands):
            return ReachAnswer(False, "obstacle", "hand_hits_beside_lid", min(self._stopped))
        met: list[Array] = []
        ways = 3  # stances for which a way from home is looked for
        found = itertools.islice(self._configurations(hands), ways)
        for tried, (stance, above, room) in enumerate(found, start=1):
            via = self._way_there(stance, above, thorough=tried == ways)
            if via is not None:
                whole = replace(stance, stance=replace(stance.stance, via=via))
                return whole, ReachAnswer(ok=True, margin=room)
            met.append(stance.stance.robot_spheres(interpolate_joints(self._mount.home, above)))
        own = {"object": self._name}
        if met and (hit := self._scenery.hit_by(met[0])):
            return ReachAnswer(False, "obstacle", "no_way_to_lid_past", hit)
        if met:
            return ReachAnswer(False, "approach", "no_way_to_lid", words=own)
        return ReachAnswer(False, "kinematics", "lid_out_of_reach", words=own)

    def _clear_hands(self) -> FlipPostureSet:
        """Hands that hit nothing else on their way."""
        every = self._hands
        # So many at most, evenly among all.
        hands = every[np.unique(np.linspace(0, len(every) - 1, 240).astype(int))]
        near = self._scenery.obstacles_near(self._p_WE[None], 0.45)
        if not near:
            return hands
        robot = place_spheres(hands.path_spheres, self._R_WE, self._p_WE)
        free = np.ones(len(hands), dtype=bool)
        for each in near:
            if free.any():
                free[free] = each.is_clear(robot[free]).all(axis=1)
                if not free.all():
                    self._stopped.add(each.name)
        return hands[np.flatnonzero(free)]

    def _configurations(
        self, hands: FlipPostureSet
    ) -> Iterator[tuple[FlipConfiguration, Array, float]]:
        """Stances, the arm's pose above their start, and their room to the joint limits."""
        hand, elbow, branch = self._at_a_glance(hands)
        together = 48  # solutions that are followed together
        for first in range(0, len(hand), together):
            few = slice(first, first + together)
            at, q, room = self._follow_path(hands, hand[few], elbow[few], branch[few])
            for k, q_above, most in zip(first + at, q[:, 0], room.tolist(), strict=True):
                one = hands[hand[k : k + 1]]
                stance = ArmConfiguration(
                    mount=self._mount,
                    posture=one.postures[0],
                    R_WP=self._R_WE @ one.R_EP[0, 0],
                    elbow=float(elbow[k]),
                    branch=int(branch[k]),
                    lift=self._lift,
                )
                yield (
                    FlipConfiguration(stance, one, self._lid, self._R_WE, self._p_WE),
                    q_above,
                    most,
                )

    def _solve_poses(
        self, hands: FlipPostureSet, at: list[int], lift: Array, elbow: Array
    ) -> tuple[Array, NDArray[np.bool_]]:
        """Arm angles of n hands at some points of their way, shape (n, w, branches, joints)."""
        points = hands.path.points[at] + lift[:, None] * [0.0, 0.0, 1.0]
        R_EP = hands.R_EP[:, at]
        p_EP = points - (R_EP @ hands.tips[:, None, :, None])[..., 0]
        q, usable = self._mount.solve_palm(
            self._R_WE @ R_EP, p_EP @ self._R_WE.T + self._p_WE, elbow
        )
        return q, usable & (self._mount.arm.joint_room(q) > LIMIT_MARGIN)

    def _at_a_glance(
        self, hands: FlipPostureSet
    ) -> tuple[NDArray[np.intp], Array, NDArray[np.intp]]:
        """Hands, elbow angles and branches that reach the ends of the way, the best first."""
        arc, elbows = hands.path.touching, self._mount.arm.redundancy_samples[::2]
        hand, elbow = np.repeat(np.arange(len(hands)), len(elbows)), np.tile(elbows, len(hands))
        at = [0, (arc.start + arc.stop) // 2, arc.stop - 1]
        q, usable = self._solve_poses(hands[hand], at, np.zeros(3), elbow)
        room = self._mount.arm.joint_room(q).min(axis=1)
        off = q[:, 0] - self._mount.home
        row, branch = best_solutions(
            np.asarray(usable.all(axis=1)), room, off, homesick=0.2, most=480
        )
        return hand[row], elbow[row], branch

    def _follow_path(
        self, hands: FlipPostureSet, hand: NDArray[np.intp], elbow: Array, branch: NDArray[np.intp]
    ) -> tuple[NDArray[np.intp], Array, Array]:
        """Solutions that are continuous and free all along the path, from above the start on.

        Returns:
            Which of them, shape (k,), their arm angles, the first above the start, shape
            (k, w, joints) [rad], and their room to the joint limits, shape (k,) [rad].
        """
        some, d = hands[hand], len(_DESCENT) - 1
        at = [0] * d + list(range(len(some.path.points)))
        lift = np.append(self._lift * _DESCENT[:-1], np.zeros(len(at) - d))
        q, usable = self._solve_poses(some, at, lift, elbow)
        rows = np.arange(len(hand))
        q, usable = q[rows, :, branch], usable[rows, :, branch]
        # More change of a joint between points of the way is a jump.
        steady = np.abs(np.diff(q, axis=1)).max(axis=(1, 2)) < 1.2
        good = np.flatnonzero(usable.all(axis=1) & steady)
        good = good[self._are_free(some[good], q[good])]
        return good, q[good], self._mount.arm.joint_room(q[good]).min(axis=1)

    def _are_free(self, hands: FlipPostureSet, q: Array) -> NDArray[np.bool_]:
        """Which arms keep clear of everything, and their hands on the way down, shape (n,)."""
        arms = self._mount.arm_spheres(q)
        free = np.asarray(self._scenery.is_free(arms).all(axis=1))
        free &= self._is_off_lid(arms, self._lid.start).all(axis=1)
        free &= self._is_off_lid(arms, self._lid.end).all(axis=1)
        lifts = self._lift * _DESCENT[:, None] * np.array([0.0, 0.0, 1.0])
        down = hands.path_spheres[:, :1] + np.pad(lifts, ((0, 0), (0, 1)))[:, None]
        robot = place_spheres(down, self._R_WE, self._p_WE)
        for each in self._scenery.others:
            free &= each.is_clear(robot).all(axis=1)
        free &= self._scenery.pushed.is_clear(robot, _BODY_CLEARANCE).all(axis=1)
        return free & self._is_off_lid(robot, self._lid.start).all(axis=1)

    def _is_off_lid(self, robot: Array, angle: float) -> NDArray[np.bool_]:
        """Which poses of spheres in W, shape (..., k, 4), keep off the lid, shape (...)."""
        in_E = place_spheres(robot, self._R_WE.T, -self._R_WE.T @ self._p_WE)
        distance = self._lid.distance_to_lid(in_E, np.full(in_E.shape[:-2], angle))
        return np.asarray((distance > _BODY_CLEARANCE).all(axis=-1))

    def _way_there(
        self, found: FlipConfiguration, above: Array, *, thorough: bool
    ) -> tuple[Array, ...] | None:
        """Arm poses between home and above the start; None if no free way was found."""

        def is_free(q: Array) -> NDArray[np.bool_]:
            robot = found.stance.robot_spheres(q)
            off = np.asarray(self._scenery.pushed.is_clear(robot, _BODY_CLEARANCE))
            off &= self._is_off_lid(robot, self._lid.start)
            off &= self._is_off_lid(robot, self._lid.end)
            for each in self._scenery.others:
                off &= each.is_clear(robot)
            height = height_above_table(robot).min(axis=-1)
            return np.asarray(off & (height >= TABLE_CLEARANCE))

        middle = 0.5 * (self._mount.home + above)
        places = (
            np.vstack([middle, sample_configurations(self._mount.home, above)])
            if thorough
            else middle[None]
        )
        return free_path(self._mount.arm, self._mount.home, above, places, is_free)


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
    """The search for a way through one plan; `spare` [m] as of `CollisionScene.from_state`.

    Model: the hand goes rigidly with what it holds, so every leg says where the palm is. The arm
    keeps the redundancy angle and one of its solutions all along; they are tried together, the ones
    with room to the joint limits first. Where something is held already, the elbow swings there
    first while the hand stays. Hand and held object do not depend on the arm and are looked at once
    for all arms; then comes the arm, and the way from home and back. What is held is its own
    obstacle before it is touched and after it was let go.

    Frames: see `sim.motion.held_object_path`; P is the palm.

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
        self._plan = handled.plan
        already = handled.state.held if handled.grasp.held else None
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
            self.work += 4
            return replace(_OUT_OF_REACH, code="hand_lacks", numbers={"lacks": lacks})
        first: ReachAnswer | None = None
        for off in withdrawal_vectors(self._handled.grasp, self._handled.held):
            self.work += 4
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
        self.work += 5
        q, elbow, branch, room = self._arm_solutions()
        if not len(q):
            return _OUT_OF_REACH
        hindered: str | None = None
        tried = 0
        for k in range(min(len(q), 40)):  # arms that are looked at, at most
            self.work += 2
            what = self._arm_blocked(q[k])
            if what is not None:
                hindered = hindered or what
                continue
            way = GraspMotion(
                self._mount,
                self._grip,
                self._hold.R_BP,
                self._hold.p_BP,
                self._legs,
                float(elbow[k]),
                int(branch[k]),
                room=float(room[k]),
            )
            found = self._from_home(way, q[k])
            if found is not None:
                return found
            hindered = hindered or self._plan.object
            tried += 1
            if tried >= 4:  # ways from home that are looked for, at most
                break
        if hindered in {self._plan.object, "table"}:
            return ReachAnswer(False, "approach", "no_way_to_hold", words={"met": hindered})
        return ReachAnswer(False, "obstacle", "no_way_to_hold_past", hindered)

    def _arm_solutions(self) -> tuple[Array, Array, NDArray[np.intp], Array]:
        """Arm angles along the whole way, elbow angles, branches and room; the best first."""
        R_WP, p_WP = self._hold.palm_poses(self._way)
        elbows = self._mount.arm.redundancy_samples
        # Few poses sort out most elbows.
        some = np.unique(np.linspace(0, len(p_WP) - 1, 6).astype(int))
        _, good, _ = self._follow_path(R_WP[some], p_WP[some], elbows, np.inf)
        elbows = elbows[good.any(axis=1)]
        q, good, room = self._follow_path(R_WP, p_WP, elbows, _LARGEST_STEP)
        off = q[:, 0] - (self._mount.home if self._at is None else self._at)
        row, branch = best_solutions(good, room, off, homesick=0.1, most=good.size)
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
        what = self._standing_hit_by(robot)
        if what is not None:
            return what
        held = in_itself(self._scenery.pushed)
        R_BW = np.swapaxes(self._way.R_WB, -1, -2)
        in_B = place_spheres(robot, R_BW, -(R_BW @ self._way.p_WB[..., None])[..., 0])
        if (held.distance_to(in_B) < OBJECT_CLEARANCE).any():
            return self._plan.object
        return None

    def _standing_hit_by(self, robot: Array) -> str | None:
        """Name of what is in the way of the robot's spheres, the table or another; else None."""
        if (height_above_table(robot) < TABLE_CLEARANCE).any():
            return "table"
        return self._scenery.hit_by(robot)

    def _from_home(self, way: GraspMotion, q: Array) -> GraspMotion | None:
        """The same way with those from home and back; None if they are not free."""
        there: tuple[Array, ...] | None = ()
        back: tuple[Array, ...] | None = ()
        if self._at is not None:
            there = self._swing_elbow(way)
        elif not self._handled.grasp.held:
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
        steps = np.radians(np.arange(0.0, 360.0, 5.0))
        here = [replace(way, elbow=float(e)) for e in way.elbow + steps]
        poses = [one.joint_angles(self._way.R_WB[:1], self._way.p_WB[:1]) for one in here]
        q = np.array([one[0] for one, _ in poses])
        good = np.array([bool(valid[0]) for _, valid in poses])
        good &= self._mount.arm.joint_room(q) > LIMIT_MARGIN
        near = np.where(good, np.abs(q - self._at).max(axis=1), np.inf)
        start = int(np.argmin(near))
        if near[start] > 0.15:  # it is not the pose in which the arm was left
            return None
        for way_round in (np.arange(start, -1, -1), np.arange(start, len(q) + 1) % len(q)):
            swing = q[way_round]
            steady = np.abs(np.diff(swing, axis=0)).max(initial=0.0) < _LARGEST_STEP
            possible = good[way_round].all() and steady
            if possible and self._standing_hit_by(self._mount.arm_spheres(swing)) is None:
                return tuple(swing)
        return None

    def _transit_path(
        self, way: GraspMotion, q: Array, p_WB: Array, R_WB: Array, stands: Obstacle
    ) -> tuple[Array, ...] | None:
        """Arm poses between home and a pose of the open hand."""
        open_hand = self._hold.hand_spheres(is_open=True)
        clearance = TransitClearance(self._mount, open_hand, self._scenery, (stands,))

        def spend() -> None:
            self.work += 1

        home = self._mount.home
        up = np.array([[0.0, 0.0, height] for height in (0.10, 0.20, 0.30)])
        raised, valid = way.joint_angles(np.broadcast_to(R_WB, (len(up), 3, 3)), p_WB + up)
        raised = raised[valid]
        places = np.vstack([raised, 0.5 * (home + q), 0.5 * (home + raised)])
        for some in (places, sample_configurations(home, q)):
            found = clearance.path_from_home(q, some, spend)
            if found is not None:
                return found
        return None


@dataclass(frozen=True)
class Effort:
    """Length of the search for a push, and how near the hand may come to things.

    Attributes:
        clearance: of hand and arm from what is neither pushed nor fragile [m].
        fine: whether the palm may lean to its sides by small angles and large ones.
        most_hands: that are clear and for which the arm is asked.
        most_transits: stances of some hands for which a way from home is looked for.
        last_resorts: stances of all hands for which it is looked for among more places.
    """

    clearance: float
    fine: bool
    most_hands: int
    most_transits: int
    last_resorts: int


USUAL = Effort(OBJECT_CLEARANCE, fine=False, most_hands=60, most_transits=2, last_resorts=3)
THOROUGH = Effort(LEAST_CLEARANCE, fine=True, most_hands=600, most_transits=10, last_resorts=10)


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

    Model: the palm keeps its orientation to the push's frame, which turns where the object is to be
    turned. Hands are taken best first, a few at a time. What costs least sorts out first: a hand
    too low over the table or too far from the shoulder, then one whose spheres come too near an
    object anywhere on the way, the pushed object moving along. For the rest the arm is asked
    (`sim.motion.inverse_kinematics`). Where it is clear of everything as a whole, and a free way
    leads there from home (`sim.motion.roadmap`), is a stance; the search ends with the first that
    has room enough.

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
        self._work = 1  # units, here and wherever it grows
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
            self._scenery.pushed,
            self._points[:2],
            self._R_WD[0],
            mount.hand,
            push.fingers,
            push.spread,
            fine=effort.fine,
            pressing=push.press > 0.0,
        )

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
            return ReachAnswer(False, "table", "hand_hits_table")
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
        if not self._push.press:
            return True
        pressing = self._push.press * self._way.inward
        drawing = pressing + self._push.force_limit * np.array(self._push.direction_W)
        try:
            for force in (pressing, drawing):
                for point in self._points[1:] + found.stance.bend(force):
                    found.stance.joint_angles(point)
        except UnreachableError:
            return False
        return True

    def _failure_answer(self, asked: int, blocked: list[_Found]) -> ReachAnswer:
        """Why no stance was found."""
        own = {"object": self._push.object}
        if not asked and self._stopped:
            others = sorted(self._stopped - {self._push.object})
            if others:
                return ReachAnswer(False, "obstacle", "hand_hits_other", others[0], crowded=True)
            return ReachAnswer(False, "object", "hand_hits_object", words=own)
        hindered = [
            f.stance.robot_spheres(interpolate_joints(self._mount.home, f.above))
            for f in blocked[:1]
        ]
        hindered = hindered or self._hindered[:1]
        if hindered and (hit := self._scenery.hit_by(hindered[0])):
            return ReachAnswer(False, "obstacle", "no_way_to_contact_past", hit)
        if hindered:
            return ReachAnswer(False, "approach", "no_way_to_contact", words=own)
        if self._arms.too_weak:
            numbers = {"force": self._push.force_limit}
            return ReachAnswer(False, "torque", "weak_arm", numbers=numbers)
        return ReachAnswer(False, "kinematics", "push_out_of_reach")

    def _clear_hands(self, hands: PostureSet) -> Iterator[PostureSet]:
        """The hands that stay clear of everything during the push, a few at a time."""
        off = self._way_off.points if self._way.turn else self._points[:0]
        places = np.vstack([self._points, off])
        near = self._scenery.obstacles_near(places, float(hands.extents.max(initial=0.0)))
        sweep = Sweep.along(self._points, self._R_WD)
        first, together, asked = 0, _AT_ONCE, 12  # of these the arm is asked for so many together
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
                yield from (some[chosen[k : k + asked]] for k in range(0, len(chosen), asked))
            blocks = int(block[-1]) + 1
            self._work = before + blocks * _LOOKED
            # What stops all hands of a block is told where none is found.
            last = np.full(blocks, -1)
            np.maximum.at(last, block, stopped_by)
            last[block[free]] = len(near)
            touched = np.logical_or.reduceat(clear, np.arange(0, len(block), _AT_ONCE))
            last[~touched] = len(near) + 1
            names = [*(each.name for each in near), None, self._push.object]
            self._stopped |= {name for k in set(last.tolist()) if (name := names[k]) is not None}
            first += len(some)
            # Where the best hands will not do, many are looked at.
            together = min(4 * together, 768)

    def _configurations(self, hands: PostureSet, least: float) -> Iterator[_Found]:
        """Configurations that are reachable, strong enough and free at the object, the best first.

        Args:
            hands: that are clear.
            least: only what has more room than this to the joint limits [rad].
        """
        for solved in self._arms.solutions_along(hands, least):
            # Mostly one of the first few will do.
            for few in (slice(6), slice(6, None)):
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
            # Hands come down from few heights, so that each way is looked at once.
            ways, way = np.unique(
                np.column_stack([solved.hand[free], solved.lift[free]]), axis=0, return_inverse=True
            )
            points = descent_points(self._points[0], ways[:, 1])
            R_WD = np.broadcast_to(self._R_WD[0], (points.shape[1], 3, 3))
            robot = hands[ways[:, 0].astype(int)].spheres_along(R_WD, points)
            clear = np.asarray(self._scenery.is_free(robot).all(axis=1))
            free[free] = clear[way.ravel()]
        return free

    def _way_there(self, found: _Found, places: Array) -> tuple[Array, ...] | None:
        """Arm poses between home and above the start; None if no free way was found."""
        stance, scenery = found.stance, self._scenery
        hand = self._mount.hand.whole_spheres(stance.posture)
        # The hand comes back the same way, when the object is where it was pushed.
        standing = scenery.pushed, self._pushed[-1]
        clearance = TransitClearance(self._mount, hand, scenery, standing)

        def spend() -> None:
            self._work += 1

        return clearance.path_from_home(found.above, places, spend)

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
        shares = np.linspace(0.0, 1.0, 4)[:, None]
        points = np.vstack([end, off + shares * (self._points[0] - off)])
        return Sweep(rot_z(turned * np.append(1.0, 1.0 - shares)) @ self._R_WD[0], points)

    def _turned_hands(
        self, hands: PostureSet, near: tuple[Obstacle, ...]
    ) -> tuple[NDArray[np.bool_], NDArray[np.intp]]:
        """Which get off a face that they have turned, and what stops each, −1 if nothing near."""
        off = Sweep(self._way_off.R_WD[1:], self._way_off.points[1:])
        stopped_by = first_obstacles(hands, near, off)
        clear = stopped_by < 0
        robot = hands[clear].spheres_in_D()
        clear[clear] = self._pushed[-1].is_clear_along(robot, *off, FACE_CLEARANCE)
        return clear, stopped_by

    def _draw_back(self, hands: PostureSet, solved: IkSolutions) -> NDArray[np.bool_]:
        """Which hands leave what they have pushed where it is, going straight back, shape (k,).

        They came to it over a few centimetres alone: what reaches beyond it would take it along.
        One that only brushes it, reaching 3 cm through it, is better than none.
        """
        if self._push.ends_on != "stroke" or self._push.press > 0.0:
            return np.ones(len(solved), dtype=bool)
        off = self._points[-1] - BACK * self._way.inward
        far = float(np.linalg.norm(self._points[0] - off))
        shares = np.linspace(0.0, 1.0, 2 + int(far / 0.015))[:, None]  # 15 mm apart at most
        points = off + shares * (self._points[0] - off)
        which, hand = np.unique(solved.hand, return_inverse=True)
        robot = hands[which].spheres_in_D()
        R_WD = np.broadcast_to(self._R_WD[0], (len(points), 3, 3))
        for clearance in (FACE_CLEARANCE, -0.03):
            clear = self._pushed[-1].is_clear_along(robot, R_WD, points, clearance)
            if clear.any():
                break
        return np.asarray(clear[hand])

    def _transit_places(self, found: _Found) -> Array:
        """Arm poses over which a way may lead: swung up halfway, and high over the table."""
        middle, nudge = 0.5 * (self._mount.home + found.above), 1e-4
        _, p_WP = self._mount.palm_poses(np.vstack([middle, middle + nudge * np.eye(len(middle))]))
        uphill = (p_WP[1:, 2] - p_WP[0, 2]) / nudge
        swings = middle + np.outer([0.4, 0.8, 1.2], uphill / np.linalg.norm(uphill))
        start = self._points[0, :2]
        over = [[*xy, 0.47] for xy in (start, 0.5 * (start + self._centre), self._centre)]
        stance = found.stance
        p_WP = np.array(over) - stance.R_WP @ stance.posture.tip_midpoint
        R_WP = np.broadcast_to(stance.R_WP, (len(over), 3, 3))
        elbow = np.full(len(over), stance.elbow)
        q, valid = self._mount.arm.inverse(
            *self._mount.flange_poses(R_WP, p_WP), elbow, [stance.branch]
        )
        return np.vstack([swings, q[valid]])

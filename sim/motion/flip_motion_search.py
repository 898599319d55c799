"""The search for a stance that flips a lid: a hand, arm poses along its way, a way from home.

Model: hands that are clear of the lid and its object wherever that stands are
sorted out by what else stands about; for the rest the arm's solutions are looked at over a
ring of redundancy angles, at the ends and the middle of the way first, then all along it. What is
continuous, clear of everything and has a free way from home is a stance; room to the joint limits
and nearness to home count.

Frames: W the world, E and L as in `sim.paths.lid_arc_path`, P the palm, T the fingertip's centre.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planner.types.actions import FlipOver
from planner.types.robot import ReachAnswer
from planner.types.world_state import WorldState
from sim.collision.collision_scene import TABLE_CLEARANCE, CollisionScene
from sim.collision.collision_spheres import height_above_table, place_spheres
from sim.hands.hand_model import FlipPostureSet
from sim.hands.mount import Mount
from sim.motion.arm_configuration import ArmConfiguration, unreachable_answer
from sim.motion.ik_search import best_solutions
from sim.motion.roadmap import (
    LIMIT_MARGIN,
    free_path,
    interpolate_joints,
    sample_configurations,
)
from sim.paths.lid_arc_path import LidShape, hinge_pose, lid_shape
from sim.rotations import Array, rot_y

_HANDS = 240  # that are looked at, evenly among all
_FOLLOWED, _SOLVED = 48, 480  # solutions that are followed together, and in all
_WAYS = 3  # stances for which a way from home is looked for
_LARGEST_STEP = 1.2  # more change of a joint between points of the way is a jump [rad]
_HOMESICK = 0.2  # as for pushes, see `sim.motion.ik_search`
_LIFT = {True: 0.12, False: 0.03}  # how far over the start the hand comes down [m]
_DESCENT = np.linspace(1.0, 0.0, 5)
_BODY_CLEARANCE = 0.002  # of the hand from the object and its lid on its way down [m]


@dataclass(frozen=True, eq=False)
class FlipConfiguration:
    """Arm and hand while they flip a lid.

    Attributes:
        stance: at the start.
        hands: the one hand, with its path.
        lid: that is flipped.
        lift: how far over the start of the way the hand comes down [m].
        R_WE, p_WE: of the hinge, as it was seen.
    """

    stance: ArmConfiguration
    hands: FlipPostureSet
    lid: LidShape
    lift: float
    R_WE: Array
    p_WE: Array

    def joint_angles(self, p_ET: Array, share: float) -> Array:
        """Arm angles, shape (joints,), with T at a point of E and the palm turned by a share.

        Raises:
            UnreachableError: the arm does not get there in this stance.
        """
        R_WP = self.R_WE @ rot_y(share * self._palm_turn) @ self.hands.R_EP[0, 0]
        return replace(self.stance, R_WP=R_WP).joint_angles(self.R_WE @ p_ET + self.p_WE)

    @property
    def _palm_turn(self) -> float:
        """Turn of the palm about E's y axis [rad]."""
        R_EP = self.hands.R_EP[0]
        whole = R_EP[self.hands.path.touching.stop - 1] @ R_EP[0].T
        return float(np.arctan2(whole[0, 2], whole[0, 0]))


@dataclass(frozen=True, eq=False)
class _Solved:
    """Arm poses along the way, best first: hand, elbow, branch, angles, above the start, room."""

    hand: NDArray[np.intp]
    elbow: Array
    branch: NDArray[np.intp]
    q: Array
    room: Array


class FlipMotionSearch:
    """The search for one flip.

    Args:
        mount: of the arm.
        home: arm angles from which it comes, shape (joints,) [rad].
        step: what is to be done.
        name: of the object with the lid.
        state: what is believed.
    """

    def __init__(
        self, mount: Mount, home: Array, step: FlipOver, name: str, state: WorldState
    ) -> None:
        self._mount = mount
        self._home = home
        self._name = name
        target = state.objects[name]
        self._lid = lid_shape(step, target, mount.hand.tip_radius)
        self._R_WE, self._p_WE = hinge_pose(target)
        # The lid is looked at where it is, not as what rises above the object.
        bare = {**state.objects, name: replace(target, lid=None)}
        self._scenery = CollisionScene.from_state(replace(state, objects=bare), name)
        self._hands = mount.hand.flip_postures(self._lid)
        # Behind an open lid it is above everything before.
        self._lift = _LIFT[self._lid.is_opening]
        self._stopped: set[str] = set()

    def best_configuration(self) -> tuple[FlipConfiguration, ReachAnswer] | ReachAnswer:
        """The best stance, or why there is none."""
        if not len(self._hands):
            return unreachable_answer(
                "object", f"the hand would hit the {self._name} with more than a fingertip"
            )
        hands = self._clear_hands()
        if not len(hands):
            other = min(self._stopped)
            return unreachable_answer(
                "obstacle", f"the hand would hit the {other} beside the lid", other
            )
        met: list[Array] = []
        for tried, found in enumerate(self._configurations(hands)):
            stance, above, room = found
            via = self._way_there(stance, above, thorough=tried == _WAYS - 1)
            if via is not None:
                whole = replace(stance, stance=replace(stance.stance, via=via))
                return whole, ReachAnswer(ok=True, margin=room)
            met.append(self._robot_spheres(stance, interpolate_joints(self._home, above)))
            if tried == _WAYS - 1:
                break
        if met:
            hit = self._scenery.hit_by(met[0])
            what = hit or f"{self._name} or the table"
            message = f"the arm has no free way to the lid: it would hit the {what}"
            return unreachable_answer("obstacle" if hit else "approach", message, hit)
        return unreachable_answer(
            "kinematics", f"the arm does not reach along the lid of the {self._name}"
        )

    def _clear_hands(self) -> FlipPostureSet:
        """Hands that hit nothing else on their way."""
        every = self._hands
        hands = every[np.unique(np.linspace(0, len(every) - 1, _HANDS).astype(int))]
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

    # -- arms -----------------------------------------------------------------------------------

    def _configurations(
        self, hands: FlipPostureSet
    ) -> Iterator[tuple[FlipConfiguration, Array, float]]:
        """Stances, the arm's pose above their start, and their room to the joint limits."""
        hand, elbow, branch = self._at_a_glance(hands)
        for first in range(0, len(hand), _FOLLOWED):
            few = slice(first, first + _FOLLOWED)
            solved = self._follow_path(hands, hand[few], elbow[few], branch[few])
            for k in range(len(solved.hand)):
                one = hands[solved.hand[k : k + 1]]
                stance = ArmConfiguration(
                    mount=self._mount,
                    posture=one.postures[0],
                    R_WP=self._R_WE @ one.R_EP[0, 0],
                    elbow=float(solved.elbow[k]),
                    branch=int(solved.branch[k]),
                    lift=self._lift,
                )
                found = FlipConfiguration(
                    stance, one, self._lid, self._lift, self._R_WE, self._p_WE
                )
                yield found, solved.q[k, 0], float(solved.room[k])

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
        off = q[:, 0] - self._home
        row, branch = best_solutions(np.asarray(usable.all(axis=1)), room, off, _HOMESICK, _SOLVED)
        return hand[row], elbow[row], branch

    def _follow_path(
        self, hands: FlipPostureSet, hand: NDArray[np.intp], elbow: Array, branch: NDArray[np.intp]
    ) -> _Solved:
        """Solutions that are continuous and free all along the path, from above the start on."""
        some = hands[hand]
        w, d = len(some.path.points), len(_DESCENT)
        at, lift = (
            [0] * (d - 1) + list(range(w)),
            np.append(self._lift * _DESCENT[:-1], np.zeros(w)),
        )
        q, usable = self._solve_poses(some, at, lift, elbow)
        rows = np.arange(len(hand))
        q, usable = q[rows, :, branch], usable[rows, :, branch]
        steady = np.abs(np.diff(q, axis=1)).max(axis=(1, 2)) < _LARGEST_STEP
        good = usable.all(axis=1) & steady
        good[good] = self._are_free(some[np.flatnonzero(good)], q[good])
        room = self._mount.arm.joint_room(q).min(axis=1)
        return _Solved(hand[good], elbow[good], branch[good], q[good], room[good])

    # -- what is in the way ---------------------------------------------------------------------

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
            robot = self._robot_spheres(found, q)
            off = np.asarray(self._scenery.pushed.is_clear(robot, _BODY_CLEARANCE))
            off &= self._is_off_lid(robot, self._lid.start)
            off &= self._is_off_lid(robot, self._lid.end)
            for each in self._scenery.others:
                off &= each.is_clear(robot)
            height = height_above_table(robot).min(axis=-1)
            return np.asarray(off & (height >= TABLE_CLEARANCE))

        middle = 0.5 * (self._home + above)
        places = (
            np.vstack([middle, sample_configurations(self._home, above)])
            if thorough
            else middle[None]
        )
        return free_path(self._mount.arm, self._home, above, places, is_free)

    def _robot_spheres(self, found: FlipConfiguration, q: Array) -> Array:
        """Spheres of hand and arm in W, shape (n, k, 4)."""
        hand = self._mount.hand.whole_spheres(found.stance.posture)
        return self._mount.robot_spheres(hand, q)

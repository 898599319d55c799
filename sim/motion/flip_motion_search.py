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
from sim.motion.arm_configuration import ArmConfiguration
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
        R_WP = self.R_WE @ rot_y(share * self._palm_turn) @ self.hands.R_EP[0, 0]
        return replace(self.stance, R_WP=R_WP).joint_angles(self.R_WE @ p_ET + self.p_WE)

    @property
    def _palm_turn(self) -> float:
        """Turn of the palm about E's y axis [rad]."""
        R_EP = self.hands.R_EP[0]
        whole = R_EP[self.hands.path.touching.stop - 1] @ R_EP[0].T
        return float(np.arctan2(whole[0, 2], whole[0, 0]))


class FlipMotionSearch:
    """The search for one flip of the lid of an object."""

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
        # Behind an open lid it is above everything before.
        self._lift = _LIFT[self._lid.is_opening]
        self._stopped: set[str] = set()

    def best_configuration(self) -> tuple[FlipConfiguration, ReachAnswer] | ReachAnswer:
        """The best stance, or why there is none."""
        if not len(self._hands):
            return ReachAnswer(
                False, "object", f"the hand would hit the {self._name} with more than a fingertip"
            )
        hands = self._clear_hands()
        if not len(hands):
            other = min(self._stopped)
            return ReachAnswer(
                False, "obstacle", f"the hand would hit the {other} beside the lid", other
            )
        met: list[Array] = []
        for tried, found in enumerate(self._configurations(hands)):
            stance, above, room = found
            via = self._way_there(stance, above, thorough=tried == _WAYS - 1)
            if via is not None:
                whole = replace(stance, stance=replace(stance.stance, via=via))
                return whole, ReachAnswer(ok=True, margin=room)
            met.append(stance.stance.robot_spheres(interpolate_joints(self._mount.home, above)))
            if tried == _WAYS - 1:
                break
        if met:
            hit = self._scenery.hit_by(met[0])
            what = hit or f"{self._name} or the table"
            message = f"the arm has no free way to the lid: it would hit the {what}"
            return ReachAnswer(False, "obstacle" if hit else "approach", message, hit)
        return ReachAnswer(
            False, "kinematics", f"the arm does not reach along the lid of the {self._name}"
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
        row, branch = best_solutions(np.asarray(usable.all(axis=1)), room, off, _HOMESICK, _SOLVED)
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
        steady = np.abs(np.diff(q, axis=1)).max(axis=(1, 2)) < _LARGEST_STEP
        good = np.flatnonzero(usable.all(axis=1) & steady)
        good = good[self._are_free(some[good], q[good])]
        return good, q[good], self._mount.arm.joint_room(q[good]).min(axis=1)

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

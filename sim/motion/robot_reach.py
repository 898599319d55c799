"""Can the hand get there? The answer to the planner's question.

The way: home, over obstacles where needed, a point above the start, down to 3 cm before the face,
to the face, the stroke; and back the same way, which is known to be free. How a stance of arm and
hand is found for it stands in `sim.motion.motion_planner`.

Only hands push whose finger joints bear the force of the push.

Frames: see `sim.motion.inverse_kinematics`. Objects are where and what the robot believes, never
what is true.
"""

from __future__ import annotations

import functools
from collections import deque
from dataclasses import replace

import numpy as np

from objectmodels.geometry.rotations import Array, rot_z
from planner.types.actions import FlipOver, Push
from planner.types.plan import Plan
from planner.types.robot import Grip, ReachAnswer, ReachEffort, RobotLimits
from planner.types.world_state import WorldState
from sim.motion.collision_scene import CollisionScene
from sim.motion.fingertip_path import FingertipPath
from sim.motion.held_object_path import HeldObject
from sim.motion.inverse_kinematics import ArmConfiguration, in_range, solve_poses
from sim.motion.motion_planner import (
    THOROUGH,
    USUAL,
    Effort,
    FlipConfiguration,
    FlipMotionSearch,
    GraspMotion,
    GraspMotionSearch,
    PushMotionSearch,
)
from sim.robots.arm import ArmKinematics
from sim.robots.cell_description import CellDescription, RobotMount
from sim.robots.collision_spheres import TABLE_CLEARANCE
from sim.robots.hand import Hand, Mount

CELL = 0.04
"""Length of a cell along each axis [m]."""

TURNS = 24
"""Headings in a full turn."""

MOST_CELLS = 100_000
"""Cells of a map that are kept, about 25 MB."""


def lowest_contact(hand: Hand) -> float:
    """Least height above the table at which a hand may push [m]."""
    return hand.tip_radius + 0.015  # of a fingertip over the table [m]


class ReachabilityMap:
    """A map of where the arm brings the hand, for questions that need no certainty.

    Model: at the middle of a cell of place, height and heading, the room to the joint limits that
    the arm has with the best of some hands, an empty table taken for granted. A sample of the hands
    and every other elbow angle tell that. Cells are looked at when they are first asked for, and
    kept for all robots mounted alike; what is kept changes the time of an answer, never the answer.
    """

    def __init__(self, mount: Mount) -> None:
        self._mount = mount
        self._kept: dict[tuple[int, ...], float] = {}

    def room_at(self, fingers: int, spread: float, point: Array, heading: float) -> float:
        """Room to the joint limits at about a place; 0 if none of the hands gets there [rad].

        Args:
            fingers: how many push.
            spread: distance between the outer fingertips [m].
            point: of T in W, shape (3,) [m].
            heading: of the normal into the touched face [rad].
        """
        i, j, k = np.floor(point / CELL).astype(int).tolist()
        turn = round(heading * TURNS / (2.0 * np.pi)) % TURNS
        cell = (fingers, round(1e6 * spread), i, j, k, turn)
        if cell not in self._kept:
            if len(self._kept) >= MOST_CELLS:
                self._kept.clear()
            middle = CELL * (np.array([i, j, k]) + 0.5)
            R_WD = rot_z(turn * 2.0 * np.pi / TURNS)
            self._kept[cell] = self._best_room(fingers, spread, middle, R_WD)
        return self._kept[cell]

    def _best_room(self, fingers: int, spread: float, point: Array, R_WD: Array) -> float:
        arm = self._mount.arm
        every = self._mount.hand.pushing_postures(fingers, spread)
        near = in_range(self._mount, every, R_WD[None], point[None])
        near &= point[2] + every.lowest_points > TABLE_CLEARANCE
        if not near.any():
            return 0.0
        some = np.flatnonzero(near)
        some = some[np.linspace(0, len(some) - 1, min(32, len(some))).astype(int)]
        elbows = arm.redundancy_samples[::2]
        sampled = every[np.repeat(some, len(elbows))]
        angles = np.tile(elbows, len(some))
        q, usable = solve_poses(self._mount, sampled, R_WD[None], point[None], angles)
        room = np.where(usable, arm.joint_room(q), 0.0)
        return float(room.max())


@functools.lru_cache(maxsize=16)
def reachability_map(robot: RobotMount, arm: ArmKinematics, hand: Hand) -> ReachabilityMap:
    """The map of an arm with a hand that is mounted somewhere; always the same one."""
    return ReachabilityMap(Mount.from_cell(robot, arm, hand))


class ArmHandReach:
    """Arm and hand of a cell, as the planner asks for them (`planner.types.robot.Robot`).

    Attributes:
        limits: figures of arm and hand.
        mount: where they stand.
    """

    def __init__(
        self, cell: CellDescription, arm: ArmKinematics, hand: Hand, effort: Effort = USUAL
    ) -> None:
        self._cell, self._effort = cell, effort
        self.mount = Mount.from_cell(cell.robot, arm, hand)
        self.limits = RobotLimits(
            fingertip_radius=hand.tip_radius,
            finger_spreads=hand.finger_spreads,
            max_force=float(hand.pushing_postures(1, 0.0).strength.max()),
            force_skew=hand.force_skew,
            lowest_height=lowest_contact(hand),
            grasp_widths=hand.grasp_widths,
            lowest_grasp=arm.link_radius + TABLE_CLEARANCE,
        )
        self._map = reachability_map(cell.robot, arm, hand)
        # For who asks again about a push that was chosen.
        self._answers: deque[
            tuple[tuple[object, ...], tuple[ArmConfiguration, ReachAnswer] | ReachAnswer]
        ] = deque(maxlen=16)
        self._last_scenery: tuple[tuple[str, WorldState, float], CollisionScene] | None = None

    @property
    def max_press(self) -> float:
        """Largest force with which one fingertip can press on a level face [N]."""
        # Few plans ask for it, and working out in which hands a fingertip presses takes long.
        return float(self.mount.hand.pressing_postures().strength.max(initial=0.0))

    def reach(self, push: Push, state: WorldState, effort: ReachEffort = "usual") -> ReachAnswer:
        """Answer whether the whole way of a push is reachable and free."""
        robot = self.thorough_reach if effort == "thorough" else self
        answer = robot.push_configuration(push, state)
        return answer if isinstance(answer, ReachAnswer) else answer[1]

    def estimate_reach(self, push: Push, state: WorldState) -> float:
        """Room to the joint limits on an empty table, at a glance [rad].

        For the order in which pushes are asked for; a push without room may still be possible.
        """
        way = self.fingertip_path(push, state)
        heading = float(np.arctan2(way.inward[1], way.inward[0]))
        ends = (way.touch, way.end)
        return min(self._map.room_at(push.fingers, push.spread, end, heading) for end in ends)

    def fingertip_path(self, push: Push, state: WorldState) -> FingertipPath:
        """Path of the fingertips of a push."""
        return FingertipPath.from_push(
            push, state.objects[push.object], self.limits.fingertip_radius
        )

    @functools.cached_property
    def thorough_reach(self) -> ArmHandReach:
        """The same, which looks at more hands and lets them pass nearer."""
        return ArmHandReach(self._cell, self.mount.arm, self.mount.hand, THOROUGH)

    def grasp(self, width: float, *, pinch: bool = False, depth: float = 0.0) -> Grip | None:
        """Grip of the hand about a width [m], or about a knob or a cap; None if there is none."""
        found = self.mount.hand.grasp_posture(width, pinch=pinch, depth=depth)
        return None if found is None else found.grip

    def reach_plan(self, plan: Plan, state: WorldState) -> ReachAnswer:
        """Answer whether arm and hand can carry out a plan, all of its way free."""
        if plan.grasp is None:
            (step,) = plan.steps
            assert isinstance(step, FlipOver), "an empty hand only flips lids"
            flip = self.flip_configuration(step, plan.object, state)
            return flip if isinstance(flip, ReachAnswer) else flip[1]
        found = self.grasp_motion(plan, state)
        if isinstance(found, ReachAnswer):
            return found
        numbers = {"strength": found.grip.grip.strongest}
        return ReachAnswer(ok=True, margin=found.room, numbers=numbers, work=found.work)

    def flip_configuration(
        self, step: FlipOver, name: str, state: WorldState
    ) -> tuple[FlipConfiguration, ReachAnswer] | ReachAnswer:
        """The best stance that flips the lid of an object, or why there is none."""
        return FlipMotionSearch(self.mount, step, name, state).best_configuration()

    def grasp_motion(
        self, plan: Plan, state: WorldState, spare: float = 0.0
    ) -> GraspMotion | ReachAnswer:
        """The best way of arm and hand through a plan, or why there is none.

        Each of the others may be away by so much less than its clearance as is to spare [m].
        """
        if plan.grasp is None:
            return ReachAnswer(False, "kinematics", "no_hold")
        hand, grasp = self.mount.hand, plan.grasp
        grip = hand.grasp_posture(grasp.width, pinch=grasp.part != "body", depth=grasp.depth)
        if grip is None:
            least, most = hand.grasp_widths
            numbers = {"width": grasp.width, "narrowest": least, "widest": most}
            return ReachAnswer(False, "width", "hold_width", numbers=numbers)
        if grasp.squeeze > grip.grip.strongest:
            numbers = {"strength": grip.grip.strongest, "force": grasp.squeeze}
            return ReachAnswer(False, "torque", "weak_hold", numbers=numbers)
        handled = HeldObject.from_plan(plan, state)
        search = GraspMotionSearch(self.mount, handled, grip, spare)
        return replace(search.best_motion(), work=search.work)

    def push_configuration(
        self, push: Push, state: WorldState, spare: float = 0.0
    ) -> tuple[ArmConfiguration, ReachAnswer] | ReachAnswer:
        """The best stance for a push, or why there is none; `spare` as of `grasp_motion`."""
        if not push.press and push.p_BC[2] < self.limits.lowest_height - 1e-9:
            return ReachAnswer(False, "table", "low_finger", words={"height": push.p_BC[2]})
        asked = ([getattr(push, name) for name in Push.model_fields], state, spare)
        for known, answered in self._answers:
            if known == asked:
                return answered
        way = self.fingertip_path(push, state)
        scenery = self._scenery(push.object, state, spare)
        search = PushMotionSearch(self.mount, push, way, state.table, scenery, self._effort)
        found = self._best_configuration(push, search)
        if isinstance(found, ReachAnswer):
            found = replace(
                found,
                work=search.work,
                postures=search.postures,
                stopped_by=frozenset(search.stopped_by),
            )
        else:
            answer = replace(found[1], work=search.work, postures=search.postures)
            found = found[0], answer
        self._answers.append((asked, found))
        return found

    def _scenery(self, pushed: str, state: WorldState, spare: float) -> CollisionScene:
        """What is in the way of pushes of an object; that of the last push is kept."""
        asked = pushed, state, spare
        if self._last_scenery is None or self._last_scenery[0] != asked:
            scenery = CollisionScene.from_state(state, pushed, spare, self._effort.clearance)
            self._last_scenery = asked, scenery
        return self._last_scenery[1]

    def _best_configuration(
        self, push: Push, search: PushMotionSearch
    ) -> tuple[ArmConfiguration, ReachAnswer] | ReachAnswer:
        """The best stance that bears the force of a push, or why there is none."""
        hand = self.mount.hand
        if push.press:
            every = hand.pressing_postures()
            strong = every.strength >= push.press
        else:
            every = hand.pushing_postures(push.fingers, push.spread, fine=self._effort.fine)
            strong = every.strength * push.fingers >= push.force_limit
        found = search.best_configuration(every[strong])
        if strong.all() or not isinstance(found, ReachAnswer):
            return found
        weak = np.flatnonzero(~strong)
        weaker = search.best_configuration(
            every[weak[np.argsort(-every.strength[weak], kind="stable")]]
        )
        if not isinstance(weaker, ReachAnswer):
            force = push.press or push.force_limit
            numbers = {"strength": weaker[1].numbers["strength"], "force": force}
            return ReachAnswer(False, "torque", "weak_hands", numbers=numbers)
        return replace(found, crowded=found.crowded and weaker.crowded) if strong.any() else weaker

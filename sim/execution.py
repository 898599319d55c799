"""Carries out a plan in the simulated world: look, go there, touch, push, come back.

The push is the paper's interface to its arm: a movement vector, a force magnitude and a largest
speed. The fingertips advance along the vector while less than the force is felt, no faster than
the speed, and end on the stroke, the force, the speed or a guard. Arm and hand are joint
impedances throughout; what is commanded is where their springs rest.

The robot knows what its ports tell it: joint angles, finger torques and late, noisy camera frames.
Frames: W is the world, T the midpoint of the pushing fingertips' centres.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from planner.plan import Plan
from planner.reach import ReachAnswer
from planner.state import SeenObject, WorldState
from sim.attractor import attracted
from sim.hand import RESTING
from sim.push import EarlyEndError, PushControl
from sim.reach import ArmReach, Way
from sim.recorder import Recorder
from sim.rotations import Array
from sim.stance import Stance, UnreachableError
from sim.trace import EndReason, Trace

if TYPE_CHECKING:
    from objectmodels.model import ObjectModel
    from sim.world import DrakeWorld

Progress = Callable[[str, float, str], None]

LOOK = 1.0
"""Time over which camera frames are averaged before the hand moves [s]."""

JOINT_SPEED, JOINT_ACCELERATION = 1.2, 3.0
"""Of the arm in free motion, over all joints together [rad/s], [rad/s²]."""

HAND_SPEED, HAND_ACCELERATION = 0.20, 0.6
"""Of the hand near objects [m/s], [m/s²]."""

BACK = 0.03
"""Distance by which the fingertips leave the face [m]."""

SETTLE = {"stroke": 0.5, "toppled": 1.5}
"""Time that an object gets to come to rest [s]."""


def execute(
    plan: Plan,
    world: DrakeWorld,
    models: Mapping[str, ObjectModel],
    *,
    reach: ArmReach | None = None,
    progress: Progress | None = None,
) -> Trace:
    """Carries out a plan.

    Args:
        plan: what to do.
        world: where; it moves on.
        models: what the robot believes of every object, by its name in the scene.
        reach: of the world's robot, if there is one already.
        progress: told of the phase, the simulated time [s] and what happens.

    Returns:
        What happened, also if it ended early.
    """
    run = _Run(plan, world, models, reach or ArmReach(world.scene), progress or _silent)
    try:
        end, detail = run.push()
    except EarlyEndError as early:
        end, detail = early.end, early.detail
    except UnreachableError as error:
        end, detail = "unreachable", str(error)
    run.come_home(end)
    return run.recorder.trace(plan.push, end=end, detail=detail)


def _silent(phase: str, time: float, text: str) -> None:
    """Progress that nobody asked for."""


class _Run:
    def __init__(
        self,
        plan: Plan,
        world: DrakeWorld,
        models: Mapping[str, ObjectModel],
        reach: ArmReach,
        progress: Progress,
    ) -> None:
        self.plan = plan
        self.world = world
        self.models = models
        self.reach = reach
        self.tell = progress
        self.recorder = Recorder(world, reach.mount, np.array(plan.push.normal_W))
        self.descent: list[Array] = []  # arm angles from above the start down to it
        self.way_home: list[Array] = []  # arm angles between home and there, in order

    def push(self) -> tuple[EndReason, str]:
        """Looks, goes there and pushes; returns how that ended."""
        state = self._look()
        stance, way = self._stance(state)
        self._approach(stance, way)
        self.tell("touch", self.world.time, "feeling for the face")
        control = PushControl(self.plan, self.recorder, stance, way, state, self.tell)
        try:
            control.touch()
            return control.push()
        finally:
            self._leave(stance, control.commanded, way)

    def _look(self) -> WorldState:
        self.tell("look", self.world.time, "looking where everything stands")
        self.recorder.phase = "look"
        poses = self.recorder.look(LOOK)
        return WorldState(
            {name: SeenObject.lying(name, pose, self.models[name]) for name, pose in poses.items()}
        )

    def _stance(self, state: WorldState) -> tuple[Stance, Way]:
        push = self.plan.push
        answer = self.reach.stance(push, state)
        if isinstance(answer, ReachAnswer):
            raise EarlyEndError("unreachable", answer.message)
        return answer[0], Way.of(push, state.objects[push.object])

    def _approach(self, stance: Stance, way: Way) -> None:
        """Free motion: over the start, then down to it."""
        self.tell("transit", self.world.time, f"moving the hand ({stance.posture.name})")
        above = np.array([*way.start[:2], stance.lift])
        self.recorder.phase = "transit"
        self.recorder.fingers = stance.posture.pushing
        for q in (*stance.via, stance.joints(above)):
            self.way_home.append(self.world.commanded[0])
            self._move_joints(q, stance.posture.joints)
        self.tell("approach", self.world.time, "down to the object")
        self.recorder.phase = "approach"
        for point in self._line(above, way.start):
            self._go(stance, point)
            self.descent.append(self.world.commanded[0])

    def _leave(self, stance: Stance, tip: Array, way: Way) -> None:
        """Off the face, and back along the way that was free."""
        self.recorder.phase = "retreat"
        self.recorder.force_limit = 0.0
        self.tell("retreat", self.world.time, "leaving the object")
        off = tip - BACK * way.inward
        for start, target in ((tip, off), (off, way.start)):
            for point in self._line(start, target):
                self._go(stance, point)

    def come_home(self, end: EndReason) -> None:
        """Back home, and a while for everything to come to rest."""
        self.recorder.phase = "retreat"
        for q in reversed(self.descent):
            self.recorder.step(q, self.world.commanded[1])
        for q in reversed(self.way_home):
            last = q is self.way_home[0]
            self._move_joints(q, RESTING.joints if last else self.world.commanded[1])
        self.tell("settle", self.world.time, "letting everything come to rest")
        self.recorder.phase = "settle"
        for _ in range(round(SETTLE.get(end, SETTLE["stroke"]) / self.world.period)):
            self.recorder.step(*self.world.commanded)

    def _line(self, start: Array, target: Array) -> list[Array]:
        return list(
            attracted(
                start,
                target,
                speed=HAND_SPEED,
                acceleration=HAND_ACCELERATION,
                period=self.world.period,
            )
        )

    def _go(self, stance: Stance, tip: Array) -> None:
        self.recorder.step(stance.joints(tip), stance.posture.joints)

    def _move_joints(self, q_arm: Array, q_hand: Array) -> None:
        """Free motion of the arm, the hand opening or closing on the way."""
        start_arm, start_hand = self.world.commanded
        length = float(np.linalg.norm(q_arm - start_arm))
        for q in attracted(
            start_arm,
            q_arm,
            speed=JOINT_SPEED,
            acceleration=JOINT_ACCELERATION,
            period=self.world.period,
        ):
            share = 1.0 - float(np.linalg.norm(q_arm - q)) / length
            self.recorder.step(q, start_hand + share * (q_hand - start_hand))

"""Planning over the object model beside random shooting with roll-outs, for the same goals.

    python -m benchmarks.rollouts [--seeds 3] [--budget 400] [--repetitions 5]

MuJoCo is optional; without it its rows are left out.
"""

from __future__ import annotations

import math
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks.commands import run_command
from benchmarks.engines.single_pushes import HAS_MUJOCO, WITHOUT_MUJOCO
from benchmarks.worlds.drake import DrakeBench
from benchmarks.worlds.strokes import (
    Array,
    Bench,
    Generator,
    Stroke,
    heading_of,
    random_stroke,
    towards,
    upright,
)
from nlcontrol import Registry
from nlcontrol.batches.drawn_scenes import scene_of
from nlcontrol.session.controller import Controller
from planner.types.actions import Push
from planner.types.plan import Plan
from planner.types.robot import ReachAnswer, ReachEffort
from planner.types.world_state import WorldState
from sim.motion.robot_reach import ArmHandReach
from sim.robots.cell_description import Vision
from sim.robots.robots import ARM, HAND
from sim.simulated_executor import simulation
from sim.truth.object_truth import truth_as_believed
from sim.truth.scene_file import Pose, Scene, SceneObject

OBJECT = "ice tea box"
START = Pose(x_m=0.55, y_m=-0.08)
SPEED = 0.10
"""Of strokes [m/s]; the planner's pushes are slower, which costs a planner nothing."""
NEAR, TURNED = 0.005, math.radians(2.0)
"""A plan is as good as asked if the box ends so near to its goal [m, rad]."""
ROUND = 30
"""Strokes in a round; one ends earlier if it is as good."""


@dataclass(frozen=True)
class Goal:
    """What is asked, in words and as a place.

    Attributes:
        text: the sentence.
        moved: from the start, in W [m].
        turned: from the start [rad].
    """

    text: str
    moved: tuple[float, float]
    turned: float

    def off(self, before: Array, after: Array) -> tuple[float, float]:
        """Distance [m] and angle [rad] from where the box should be."""
        off = math.dist(after[4:6], before[4:6] + np.array(self.moved))
        angle = heading_of(after) - heading_of(before) - self.turned
        return off, abs(math.remainder(angle, math.tau))


GOALS = (
    Goal(f"push the {OBJECT} 15 cm to the left without turning it", (0.0, 0.15), 0.0),
    Goal(f"turn the {OBJECT} 45 degrees counterclockwise", (0.0, 0.0), math.radians(45.0)),
)


@dataclass(frozen=True)
class Shot:
    """A search by roll-outs.

    Attributes:
        seconds: that it took.
        rolled: strokes that were rolled out.
        off, angle: how good the best sequence is [m, rad].
    """

    seconds: float
    rolled: int
    off: float
    angle: float

    @property
    def found(self) -> bool:
        """Whether it is as good as asked."""
        return self.off <= NEAR and self.angle <= TURNED


class Everywhere(ArmHandReach):
    """A hand that gets everywhere, so that no time goes into the arm's kinematics."""

    def reach(self, push: Push, state: WorldState, effort: ReachEffort = "usual") -> ReachAnswer:
        """Yes."""
        return ReachAnswer(ok=True, margin=1.0)


def world() -> Scene:
    """The box alone, as believed, under a perfect camera."""
    truth = truth_as_believed(Registry.built_in().get(OBJECT))
    item = SceneObject(name=OBJECT, model=OBJECT, pose=START, truth=truth)
    return scene_of("one box", [item], Vision(position_noise_m=0.0, angle_noise_deg=0.0))


def planned(goal: Goal, repetitions: int, *, kinematics: bool) -> tuple[list[float], str]:
    """Times of planning [s], the first one included, and why there is no plan, if so."""
    controller = Controller(world(), registry=Registry.built_in())
    if not kinematics:
        executor = simulation(controller.executor)
        executor._robot = Everywhere(executor.cell, ARM, HAND)
    (frame,) = controller.resolve(controller.parse(goal.text)).frames
    state, _ = controller.look(), controller.robot
    times, why = [], ""
    for _ in range(repetitions):
        start = time.perf_counter()
        made = controller.plan(frame, state)
        times.append(time.perf_counter() - start)
        if not isinstance(made, Plan):
            why = getattr(made, "message", "")
    return times, why


def shot(bench: Bench, goal: Goal, budget: int, rng: Generator) -> Shot:
    """Random shooting until a sequence is good enough, or so many strokes were rolled out.

    Args:
        bench: freshly built.
        goal: where the box should be.
        budget: most roll-outs.
        rng: to draw from.
    """
    start, before = time.perf_counter(), bench.poses()[OBJECT]
    rolled, near = 0, goal.off(before, before)
    while rolled < budget and _cost(*near) > 1.0:
        state, here = bench.keep(), bench.poses()[OBJECT]
        best, least, after, reached = None, math.inf, state, near
        for k in range(min(ROUND, budget - rolled)):
            stroke = _drawn(k, best, goal, before, here, rng)
            bench.back(state)
            end = bench.roll(stroke, SPEED).poses[OBJECT][-1]
            rolled += 1
            off = goal.off(before, end)
            cost = _cost(*off) if upright(end) else math.inf
            if cost < least:
                best, least, after, reached = stroke, cost, bench.keep(), off
            if least <= 1.0:
                break
        # A round that leads farther away is no step; the next one starts from the same place.
        better = least < _cost(*near)
        bench.back(after if better else state)
        near = reached if better else near
    return Shot(time.perf_counter() - start, rolled, *near)


def _drawn(
    k: int, best: Stroke | None, goal: Goal, before: Array, here: Array, rng: Generator
) -> Stroke:
    """The next stroke of a round: random, along what is left of the way, or a variation."""
    model = Registry.built_in().get(OBJECT)
    if k % 3 == 2 and best is not None:
        return best.varied(rng)
    if k % 3 == 1:
        left = before[4:6] + np.array(goal.moved) - here[4:6]
        length = float(np.hypot(*left) * rng.uniform(0.5, 1.2))
        return towards(OBJECT, model, here, math.atan2(left[1], left[0]), length, rng)
    return random_stroke(OBJECT, model, here, rng)


def _cost(off: float, angle: float) -> float:
    """How far from good enough; 1 or less is."""
    return max(off / NEAR, angle / TURNED)


def rollouts(seeds: int = 3, budget: int = 400, repetitions: int = 5) -> None:
    """Planning over the object model beside random shooting with roll-outs, for the same goals.

    One box stands alone, exactly as the registry believes. The planner gets the sentence; the
    search gets where the box should stand at the end, and rolls strokes of a fingertip out, in
    Drake and in MuJoCo (`benchmarks.worlds.strokes`), until one sequence of them ends within `NEAR`
    and `TURNED` of it, or `budget` strokes were rolled out. It goes by rounds, each from the best
    stroke of the round before. A third of a round's strokes is drawn at random, a third along what
    is left of the way, and a third are variations of the best one. No arm is in either: neither
    kinematics nor obstacles are searched for by roll-outs, while the planner is timed without the
    arm's kinematics and with them. Times are told beside that of planning without kinematics.
    """
    engines: dict[str, Callable[[Scene], Bench]] = {
        "Drake": lambda scene: DrakeBench(scene, OBJECT)
    }
    if HAS_MUJOCO:
        from benchmarks.worlds.mujoco import MujocoBench

        engines["MuJoCo"] = MujocoBench
    for goal in GOALS:
        print(f"“{goal.text}”\n{'':34} {'median s':>9} {'first s':>9} {'×':>8}")
        base = None
        for kinematics in (False, True):
            times, why = planned(goal, repetitions, kinematics=kinematics)
            middle = statistics.median(times)
            base = base or (None if why else middle)
            name = f"planner, {'with' if kinematics else 'without'} kinematics"
            print(f"{name:34} {middle:9.4f} {times[0]:9.4f} {_ratio(middle, base):>8}")
            if why:
                print(f"  no plan: {why}")
        for name, engine in engines.items():
            drawn = map(np.random.default_rng, range(seeds))
            shots = [shot(engine(world()), goal, budget, rng) for rng in drawn]
            middle = statistics.median(each.seconds for each in shots)
            row = f"random shooting in {name}"
            print(f"{row:34} {middle:9.2f} {'':9} {_ratio(middle, base):>8}")
            found = sum(each.found for each in shots)
            best = ", ".join(f"{1e3 * s.off:.1f} mm {math.degrees(s.angle):.1f}°" for s in shots)
            counts = ", ".join(str(each.rolled) for each in shots)
            print(f"  {found} of {seeds} as good; {counts} roll-outs; ended at {best}", flush=True)
    if not HAS_MUJOCO:
        print(WITHOUT_MUJOCO)


def _ratio(seconds: float, base: float | None) -> str:
    return f"{seconds / base:,.3g}" if base else "-"


if __name__ == "__main__":
    sys.exit(run_command(rollouts))

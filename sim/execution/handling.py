"""Carries out a plan of the whole hand.

Arm and hand are joint impedances throughout. A guard that stops a plan makes the hand go back the
way it came, which was free, and set down what it holds where it took it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from planner.types.plan import Plan
from planner.types.robot import ReachAnswer
from sim.collision.collision_scene import SPARE
from sim.control.grasping.flip_control import flip_over
from sim.control.pushing.guarded_touch import EarlyEndError
from sim.control.trace_recorder import Recorder
from sim.execution.grasp_execution import HandTrip
from sim.execution.lid_execution import LidTrip
from sim.execution.push_execution import Progress, look_around
from sim.motion.robot_reach import ArmHandReach
from sim.paths.held_object import HeldObject
from sim.traces.trace import EndReason, Trace

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel
    from sim.worlds.drake.drake_world import DrakeWorld


def handle(
    plan: Plan,
    world: DrakeWorld,
    models: Mapping[str, ObjectModel],
    reach: ArmHandReach,
    tell: Progress,
) -> Trace:
    """Carries out a plan of the whole hand.

    Args:
        plan: what to do.
        world: where; it moves on.
        models: what the robot believes of every object, by its name in the scene.
        reach: of the world's robot.
        tell: progress.

    Returns:
        What happened, also if it ended early. What the hand holds then is `world.holding`.
    """
    if plan.grasp is None:
        return flip_over(plan, world, models, reach, tell)
    recorder = Recorder(world, reach.mount, -np.array(plan.grasp.approach_W))
    state = look_around(recorder, models, tell)
    way = reach.grasp_motion(plan, state, SPARE)
    end: EndReason = "handled"
    detail = "all steps were made"
    if isinstance(way, ReachAnswer):
        end, detail = "unreachable", way.message
    else:
        handled = HeldObject.of(plan, state)
        make = HandTrip if handled.owner is None else LidTrip
        trip = make(handled, recorder, way, tell)
        try:
            trip.carry_out(reach.home)
        except EarlyEndError as early:
            end, detail = early.end, early.detail
            tell("retreat", world.time, detail)
            trip.give_up()
    return recorder.trace(plan.object, np.array(plan.grasp.approach_W), end=end, detail=detail)

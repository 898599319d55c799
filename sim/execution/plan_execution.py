"""Carries out a plan in the simulated world: look, go there, touch, push, come back.

What the whole hand does is carried out by `sim.handling`.

The push is the paper's interface to its arm: a movement vector, a force magnitude and a largest
speed. The fingertips advance along the vector while less than the force is felt, no faster than
the speed, and end on the stroke, the force, the speed or a guard. Arm and hand are joint
impedances throughout; what is commanded is where their springs rest.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from planner.types.plan import Plan
from sim.control.pushing.force_control import Errand, PlannedControl
from sim.control.pushing.guarded_touch import EarlyEndError
from sim.control.pushing.push_control import PushControl
from sim.control.pushing.tilt_control import TiltControl
from sim.control.pushing.turn_control import TurnControl
from sim.control.trace_recorder import Recorder
from sim.execution.handling import handle
from sim.execution.push_execution import Progress, Trip, silent
from sim.motion.arm_configuration import UnreachableError
from sim.motion.robot_reach import ArmHandReach
from sim.standard_robot import ARM, HAND
from sim.traces.trace import EndReason, Trace

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel
    from sim.worlds.drake.drake_world import DrakeWorld

_CONTROLS: dict[str, type[PlannedControl]] = {
    "tilted": TiltControl,
    "turned": TurnControl,
}
"""What controls a push, by what it ends on."""

SETTLE = {"stroke": 0.5, "toppled": 1.5}
"""Time that an object gets to come to rest [s]."""


def execute(
    plan: Plan,
    world: DrakeWorld,
    models: Mapping[str, ObjectModel],
    *,
    reach: ArmHandReach | None = None,
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
    tell, reach = progress or silent, reach or ArmHandReach(world.scene.cell, ARM, HAND)
    if not plan.pushes:
        return handle(plan, world, models, reach, tell)
    trip = Trip(plan.push, world, models, reach, tell)
    try:
        end, detail = _push(plan, trip, tell)
    except EarlyEndError as early:
        end, detail = early.end, early.detail
    except UnreachableError as error:
        end, detail = "unreachable", str(error)
    trip.come_home(SETTLE.get(end, SETTLE["stroke"]))
    push = plan.push
    return trip.recorder.trace(push.object, np.array(push.direction_W), end=end, detail=detail)


def watch(world: DrakeWorld, name: str, reach: ArmHandReach, seconds: float) -> Trace:
    """A look at the table during which nothing is done.

    Args:
        world: where; it moves on.
        name: of the object that it is about.
        reach: of the world's robot.
        seconds: how long to look [s].
    """
    ahead = np.array([1.0, 0.0, 0.0])
    recorder = Recorder(world, reach.mount, -ahead)
    recorder.look(seconds)
    return recorder.trace(name, ahead, end="reached", detail="there was nothing to be done")


def _push(plan: Plan, trip: Trip, tell: Progress) -> tuple[EndReason, str]:
    """Looks, goes there and pushes; returns how that ended."""
    state = trip.look()
    stance, way = trip.stance(state)
    trip.approach(stance, way)
    tell("touch", trip.recorder.world.time, "feeling for the face")
    make = _CONTROLS.get(plan.push.ends_on, PushControl)
    control = make(Errand(plan, trip.recorder, stance, way, state, tell))
    try:
        control.touch()
        return control.act()
    finally:
        trip.leave(stance, control.commanded, way, control.turned)

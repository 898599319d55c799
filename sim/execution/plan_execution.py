"""Carries out a plan in the simulated world: look, go there, touch, push, come back.

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
from planner.types.robot import ReachAnswer
from sim.collision.collision_scene import SPARE
from sim.control.free_motion import look_around
from sim.control.pushing.drag_control import DragControl
from sim.control.pushing.force_control import ExecutionContext, ForceController
from sim.control.pushing.push_control import PushControl
from sim.control.pushing.tilt_control import TiltControl
from sim.control.pushing.turn_control import TurnControl
from sim.control.trace_recorder import EarlyEndError, TraceRecorder
from sim.execution.grasp_execution import GraspExecution
from sim.execution.lid_execution import LidExecution, flip_over
from sim.execution.push_execution import PushExecution
from sim.motion.arm_configuration import UnreachableError
from sim.paths.held_object_path import HeldObject
from sim.traces.trace import EndReason, Trace

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel
    from sim.control.free_motion import RobotSetup
    from sim.supervision import Progress

_CONTROLS: dict[str, type[ForceController]] = {
    "tilted": TiltControl,
    "turned": TurnControl,
}
"""What controls a push, by what it ends on."""

SETTLE = {"stroke": 0.5, "toppled": 1.5}
"""Time that an object gets to come to rest [s]."""


def execute(
    plan: Plan,
    setup: RobotSetup,
    models: Mapping[str, ObjectModel],
    progress: Progress | None = None,
) -> Trace:
    """Carries out a plan.

    Args:
        plan: what to do.
        setup: the robot.
        models: what the robot believes of every object, by its name in the scene.
        progress: called while something happens; a `Monitor` also says when to stop.

    Returns:
        What happened, also if it ended early.
    """
    if not plan.pushes:
        return _execute_by_hand(plan, setup, models, progress)
    execution = PushExecution(plan.push, setup, models, progress)
    try:
        end, detail = _push(plan, execution)
    except EarlyEndError as early:
        end, detail = early.end, early.detail
    except UnreachableError as error:
        end, detail = "unreachable", str(error)
    execution.come_home(SETTLE.get(end, SETTLE["stroke"]))
    push = plan.push
    return execution.recorder.trace(push.object, np.array(push.direction_W), end=end, detail=detail)


def _push(plan: Plan, execution: PushExecution) -> tuple[EndReason, str]:
    """Looks, goes there and pushes; returns how that ended."""
    state = execution.look()
    stance, way = execution.stance(state)
    execution.approach(stance, way)
    execution.recorder.report("touch", "feeling for the face")
    make = DragControl if plan.push.press else _CONTROLS.get(plan.push.ends_on, PushControl)
    control = make(ExecutionContext(plan, execution.recorder, stance, way, state))
    try:
        control.touch()
        return control.act()
    finally:
        execution.leave(stance, control.commanded, way, control.turned)


def _execute_by_hand(
    plan: Plan, setup: RobotSetup, models: Mapping[str, ObjectModel], progress: Progress | None
) -> Trace:
    """Carries out a plan of the whole hand; what it holds then is `setup.holding`.

    A guard that stops it makes the hand go back the way it came, which was free, and set down what
    it holds where it took it.
    """
    if plan.grasp is None:
        return flip_over(plan, setup, models, progress)
    approach = np.array(plan.grasp.approach_W)
    recorder = setup.recorder(-approach, progress)
    try:
        end, detail = _handle(plan, setup, models, recorder)
    except EarlyEndError as early:
        end, detail = early.end, early.detail
    return recorder.trace(plan.object, approach, end=end, detail=detail)


def _handle(
    plan: Plan, setup: RobotSetup, models: Mapping[str, ObjectModel], recorder: TraceRecorder
) -> tuple[EndReason, str]:
    """Looks and makes all steps; returns how that ended."""
    state = look_around(recorder, models, setup.held)
    way = setup.reach.grasp_motion(plan, state, SPARE)
    if isinstance(way, ReachAnswer):
        return "unreachable", way.message
    handled = HeldObject.from_plan(plan, state)
    make = GraspExecution if handled.owner is None else LidExecution
    execution = make(handled, recorder, way, setup.holding)
    try:
        execution.carry_out(setup.reach.mount.home)
    except EarlyEndError as early:
        recorder.report("retreat", early.detail)
        execution.give_up()
        raise
    finally:
        setup.holding = execution.holding
    return "handled", "all steps were made"

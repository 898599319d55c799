"""A press of which nobody says beforehand what it does: the robot's half of the paper's Fig. 7.

The fingertip presses straight in and gives way along the face, so that the force stays normal to
it, until it has gone so far that something has moved. Whether that was a slide or a tilt is for
others to see. The hand stays where it is then: a press is the last thing done in its world.
"""

from __future__ import annotations

from planner.touch_experiments import Experiment
from planner.types.world_state import WorldState
from sim.control.pushing.guarded_touch import PAUSE, EarlyEndError
from sim.execution.push_execution import Trip, silent
from sim.exploration.probe_control import ProbeControl
from sim.exploration.touch_recording import Recording
from sim.motion.arm_configuration import UnreachableError
from sim.motion.robot_reach import ArmHandReach
from sim.standard_robot import ARM, HAND
from sim.traces.trace import EndReason
from sim.worlds.drake.drake_world import DrakeWorld


def press(
    experiment: Experiment,
    world: DrakeWorld,
    state: WorldState,
    *,
    reach: ArmHandReach | None = None,
) -> Recording:
    """Carries out one press.

    Args:
        experiment: where.
        world: where; it moves on, and the hand stays at the object.
        state: what is believed, from a look since which nothing has moved.
        reach: of the world's robot, if there is one already.

    Returns:
        What the robot felt; no samples if the hand did not get there, and the reason.
    """
    models = {name: seen.model for name, seen in state.objects.items()}
    trip = Trip(
        experiment.push, world, models, reach or ArmHandReach(world.scene.cell, ARM, HAND), silent
    )
    before = state.objects[experiment.push.object].pose
    try:
        stance, way = trip.stance(state)
        trip.approach(stance, way)
        control = _PressControl(experiment, trip.recorder, stance, way, silent)
        return control.recording(*control.run(), before)
    except EarlyEndError as early:
        return Recording.nothing(experiment, early.end, early.detail, before)
    except UnreachableError as error:
        return Recording.nothing(experiment, "unreachable", str(error), before)


class _PressControl(ProbeControl):
    """One press, from before the face until something has moved."""

    pause = PAUSE
    # What a sticking fingertip drags along the face would add to the force: percents of it.
    gives_way = 0.03

    def run(self) -> tuple[EndReason, str]:
        self._begin()
        command, step = self.commanded, self.experiment.push.speed * self._period
        while True:
            command = command + step * self._u
            self._press(command)
            ended = self._ended()
            if ended is not None:
                return ended

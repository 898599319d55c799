"""Whether another push would bring an object nearer to its aim, as far as the camera can tell.

Where it came to differs from where it was by what two looks tell, whose constant errors are equal;
but the hand goes to a place that is off by all of that error, so that small pushes end anywhere
within it. What is nearer than that, and well within what is asked, is left as it is; so is what is
within what is asked and was brought no nearer by the last push.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from planner.problem.directions import angle_between
from planner.types.defaults import Defaults
from planner.types.plan import Plan
from sim.robots.cell_description import LOOK, Vision

if TYPE_CHECKING:
    from planner.types.world_state import PlanarPose, WorldState

_WELL = 0.5  # share of a tolerance within which is well within it


LEFT_SO = "it is left there: another push would bring it no nearer that the camera sees"
"""Note of a result that was not corrected any further."""


class Corrections:
    """Pushes by which one frame is corrected.

    Args:
        vision: data sheet of the camera.
        defaults: tolerances.
    """

    def __init__(self, vision: Vision, defaults: Defaults) -> None:
        looks = math.sqrt(2.0 / max(vision.rate_hz * LOOK, 1.0))
        self._known = math.hypot(looks * vision.position_noise_m, vision.position_bias_m)
        noise, bias = vision.angle_noise_deg, vision.angle_bias_deg
        self._known_angle = math.radians(math.hypot(looks * noise, bias))
        self._defaults = defaults
        self._before: PlanarPose | None = None
        self._nearest = math.inf

    def begin_at(self, before: PlanarPose) -> None:
        """Takes the pose from which the frame begins."""
        self._before = before

    def are_worth(self, made: Plan, state: WorldState) -> bool:
        """Return False if the pushes of a plan would bring the object no nearer to its aim."""
        aim, before, d = made.aim, self._before, self._defaults
        if aim is None or before is None or not made.pushes:
            return True
        pose = state.objects[made.object].pose
        way = math.dist((aim.x, aim.y), (before.x, before.y))
        off = math.dist((aim.x, aim.y), (pose.x, pose.y))
        tolerance = _tolerance(d.distance_tolerance, way)
        # 0.7: share of the tolerance of a direction.
        aside = 0.7 * way * math.tan(d.direction_tolerance) or math.inf
        turn = asked = 0.0
        if aim.yaw is not None:
            turn = abs(angle_between(aim.yaw, pose.yaw))
            asked = abs(angle_between(aim.yaw, before.yaw))
        turn_tolerance = _tolerance(d.turn_tolerance, asked)
        if off > tolerance or turn > turn_tolerance:
            return True
        share = max(off / tolerance, turn / turn_tolerance)
        bettered, self._nearest = share < self._nearest, min(share, self._nearest)
        well = min(max(d.aim_position, self._known), _WELL * tolerance, aside)
        well_turned = min(max(d.aim_angle, self._known_angle), _WELL * turn_tolerance)
        return bettered and (off > well or turn > well_turned)


def _tolerance(usual: float, amount: float) -> float:
    """The tolerance of an amount: less than the usual one of a small amount, but for none."""
    # A tolerance is at most a third of the amount.
    return min(usual, (1.0 / 3.0) * amount) or usual


def spent_text(made: Plan, times: int) -> str:
    """Remark that a frame's budget is used up."""
    what, several = ("push", "pushes") if made.pushes else ("try", "tries")
    return f"this may take {times} {what if times == 1 else several} at most"

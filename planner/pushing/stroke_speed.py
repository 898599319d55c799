"""Speeds that strokes come to, and sentences that ask for more than that."""

from __future__ import annotations

from collections.abc import Sequence

from planner.problem.planning_problem import PushProblem
from planner.refusals.refusal_builder import no_plan
from planner.types.actions import Push
from planner.types.speed_profile import reached_speed

_ASKING = ("speed", "min_speed", "fast")
_SURELY = 0.5  # share of the tolerance of a speed: pushes in the simulator are off by 0.4 at most


def require_speed(problem: PushProblem, pushes: Sequence[Push]) -> None:
    """Make sure that one of some pushes comes to the speed that the sentence asks for.

    Only strokes count: how fast the finger becomes while something falls or turns is not foreseen.

    Raises:
        NoPlanError: all strokes are too short.
    """
    asking = [clause for clause in problem.frame.constraints if clause.kind in _ASKING]
    strokes = [push for push in pushes if push.ends_on == "stroke"]
    if not asking or not strokes or problem.previous is not None:
        return
    asked, best = problem.motion.speed, max(reached_speed(p.speed, p.stroke) for p in strokes)
    if best < asked - _SURELY * problem.defaults.speed_tolerance:
        longest = max(push.stroke for push in strokes)
        what = f"over {1e3 * longest:.0f} mm the fingertips come to"
        numbers = {"speed": asked, "most": best, "stroke": longest}
        raise no_plan("too_fast", numbers, spans=asking[0].spans, what=what)

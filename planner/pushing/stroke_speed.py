"""Speeds that strokes come to, and sentences that ask for more than that.

Model: what is round catches on the table now and then. A mug in the simulator lost up to a tenth of
its speed at once, before the command changed; boxes did not. Fingertips of stiffness k that an
object of mass m meets with Δv then press with Δv √(k m) more. If that takes them beyond the force
limit less its band, the command falls back and the speed is lost. So a push keeps a speed v if

    σ v √(k m) ≤ (1 − band) F_limit − F_onset,    σ = 0.1
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from objectmodels.geometry.base_shapes import Disc
from planner.problem.planning_problem import PushProblem
from planner.refusals.refusal_builder import no_plan
from planner.types.actions import PushAction
from planner.types.robot import ReachEffort
from planner.types.speed_profile import FORCE_BAND, reached_speed

_ASKING = ("speed", "min_speed", "fast")
_SURELY = 0.5  # share of the tolerance of a speed: pushes in the simulator are off by 0.4 at most
_CATCH = 0.1  # share of its speed that a round object loses at once, σ


def require_speed(problem: PushProblem, pushes: Sequence[PushAction]) -> None:
    """Make sure that one of some pushes comes to the speed that the sentence asks for.

    Only strokes count: how fast the finger becomes while something falls or turns is not foreseen.
    The force limits the first push alone: in which posture later ones are made is not known yet.

    Raises:
        NoPlanError: all strokes are too short, or the force limit is too near.
    """
    asking = [clause for clause in problem.frame.constraints if clause.kind in _ASKING]
    strokes = [push for push in pushes if push.ends_on == "stroke"]
    if not asking or not strokes or problem.previous is not None:
        return
    asked = problem.motion.speed
    longest = max(strokes, key=lambda push: push.stroke)
    reached = {push: reached_speed(push.speed, push.stroke) for push in strokes}
    what = f"over {1e3 * longest.stroke:.0f} mm the fingertips come to"
    first = pushes[0]
    if first in reached and (kept := kept_speed(problem, first)) < reached[first]:
        reached[first] = kept
        what = f"with at most {first.force_limit:.2f} N the fingertips keep"
    best = max(reached.values())
    if best < asked - _SURELY * problem.defaults.speed_tolerance:
        numbers = {"speed": asked, "most": best, "stroke": longest.stroke}
        raise no_plan("too_fast", numbers, spans=asking[0].spans, what=what)


def kept_speed(problem: PushProblem, push: PushAction) -> float:
    """Speed that a push made now keeps within its force limit [m/s]; inf if nothing limits it."""
    if not isinstance(problem.target.model.base, Disc):
        return math.inf
    effort: ReachEffort = "thorough" if problem.effort.thorough else "usual"
    stiffness = problem.robot.reach(push, problem.state, effort).stiffness
    if stiffness == 0.0:
        return math.inf
    spare = (1.0 - FORCE_BAND) * push.force_limit - push.prediction.onset
    return max(spare, 0.0) / (_CATCH * math.sqrt(stiffness * problem.target.model.mass))

"""Why a lid is neither opened nor closed, with the forces that decide."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from planner.refusals.grasp_refusals import mm, refused

if TYPE_CHECKING:
    from objectmodels.containers.lid_forces import FlipArc, Loosening
    from planner.problem.planning_problem import GraspProblem
    from planner.types.dead_ends import NoPlanError


def no_lid(problem: GraspProblem) -> NoPlanError:
    """There is nothing to open."""
    return refused("impossible", f"the {problem.target.name} has no lid", ())


def lid_not_seen(problem: GraspProblem) -> NoPlanError:
    """Nobody knows where its lid lies."""
    return refused("impossible", f"the lid of the {problem.target.name} is not seen anywhere", ())


def thread(problem: GraspProblem) -> NoPlanError:
    """The cap is off."""
    name = problem.target.name
    return refused(
        "unsupported",
        f"the cap of the {name} is off, and this hand cannot set it on its thread again: it takes "
        "off caps, and closes those that are still on the thread",
        (),
    )


def too_weak(problem: GraspProblem, needed: float) -> NoPlanError:
    """The sentence does not allow as much force as the lid takes."""
    allowed = problem.force.max
    return refused(
        "impossible",
        f"{problem.goal.doing} the {problem.target.name} takes up to {needed:.1f} N at the tab; "
        f"{allowed:.1f} N are allowed",
        problem.force.spans,
        f"allow {math.ceil(2.0 * needed) / 2.0:g} N",
        needed_force=needed,
        allowed_force=allowed,
    )


def gives_way(problem: GraspProblem, arc: FlipArc) -> NoPlanError:
    """The standing object would slide or topple before its lid moves all the way."""
    return refused(
        "impossible",
        f"{_over_the_arc(problem, arc)}; {problem.defaults.lid_reserve:.1f} times as much as the "
        "lid takes is asked",
        (),
        "fix it in a holder",
        **_forces(arc),
        margin=arc.least_margin,
    )


def may_give_way(problem: GraspProblem, arc: FlipArc) -> NoPlanError:
    """It may, since weight, friction or the lid are not known well enough."""
    asked = problem.effort.probability
    return refused(
        "too_uncertain",
        f"{_over_the_arc(problem, arc)}; it opens with a probability of {arc.probability:.2f}, and "
        f"{asked:.2f} is asked",
        (),
        f"find out the weight of the {problem.target.name} first",
        **_forces(arc),
        probability=arc.probability,
        asked_probability=asked,
    )


def _over_the_arc(problem: GraspProblem, arc: FlipArc) -> str:
    near, name = arc.weakest_index, problem.target.name
    slides = bool(arc.slide[near] < arc.topple[near])
    verb, limit = ("slides", arc.slide) if slides else ("tips", arc.topple)
    return (
        f"{problem.goal.doing} the {name} takes {arc.force[near]:.2f} N at the tab with the lid at "
        f"{math.degrees(arc.angles[near]):.0f}°; the standing {name}, "
        f"{problem.target.model.mass:.2f} kg, {verb} at {limit[near]:.2f} N there"
    )


def _forces(arc: FlipArc) -> dict[str, float]:
    near = arc.weakest_index
    found = {
        "lid_force": float(arc.force[near]),
        "largest_lid_force": arc.largest_force,
        "slide_force": float(arc.slide[near]),
        "topple_force": float(arc.topple[near]),
        "angle": float(arc.angles[near]),
    }
    return {name: value for name, value in found.items() if math.isfinite(value)}


def comes_along(problem: GraspProblem, found: Loosening) -> NoPlanError:
    """The object would be lifted or turned with its lid."""
    return refused("impossible", _both(problem, found), (), "fix it in a holder", **_numbers(found))


def may_come_along(problem: GraspProblem, found: Loosening) -> NoPlanError:
    """It may, since friction, weight or the lid are not known well enough."""
    asked = problem.effort.probability
    return refused(
        "too_uncertain",
        f"{_both(problem, found)}; it stays with a probability of {found.probability:.2f}, and "
        f"{asked:.2f} is asked",
        (),
        f"find out how slippery the {problem.target.name} is first",
        "fix it in a holder",
        **_numbers(found),
        probability=found.probability,
        asked_probability=asked,
    )


def _both(problem: GraspProblem, found: Loosening) -> str:
    name = problem.target.name
    assert problem.target.model.lid is not None, "only lids are loosened"
    if problem.target.model.lid.kind == "screw":
        return (
            f"turning the cap of the {name} takes {found.needed:.3f} N·m; the standing {name} "
            f"turns along at {found.held:.3f} N·m"
        )
    return (
        f"pulling the lid off the {name} takes {found.needed:.1f} N; the {name} itself is lifted "
        f"at {found.held:.1f} N"
    )


def _numbers(found: Loosening) -> dict[str, float]:
    return {"needed": found.needed, "held": found.held, "margin": found.margin}


def no_room_aside(problem: GraspProblem, radius: float) -> NoPlanError:
    """There is no free place for the lid."""
    return refused(
        "blocked",
        f"there is no free place near the {problem.target.name} for its lid, "
        f"{mm(2.0 * radius)} wide",
        (),
        "move something away first",
        width=2.0 * radius,
    )

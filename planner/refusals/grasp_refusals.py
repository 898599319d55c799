"""Why a hand does not hold, lift or place something: a sentence with the numbers that decide."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from planner.refusals.push_refusals import unsupported
from planner.types.dead_ends import NoPlanError
from planner.types.refusal import Refusal

if TYPE_CHECKING:
    from collections.abc import Sequence

    from objectmodels.models.object_parts import Graspable
    from planner.grasping.grasp_sampling import Candidate
    from planner.problem.planning_problem import ContactLimits, GraspProblem
    from planner.types.plan import Plan
    from planner.types.refusal import RefusalReason
    from planner.types.robot import ReachAnswer
    from planner.types.world_state import SeenObject

Spans = tuple[tuple[int, int], ...]


def refused(
    reason: RefusalReason,
    message: str,
    spans: Spans,
    *suggestions: str,
    **numbers: float,
) -> NoPlanError:
    """A refusal because of some words, or of none, with its numbers by their names."""
    return NoPlanError(
        Refusal(
            reason=reason, message=message, numbers=numbers, spans=spans, suggestions=suggestions
        )
    )


def mm(length: float) -> str:
    """A length as people read it."""
    return f"{1e3 * length:.0f} mm"


# -- where it may be held -----------------------------------------------------------------------


def not_graspable(target: SeenObject) -> NoPlanError:
    """Nobody has said where it may be held."""
    return unsupported(
        f"holding the {target.name}",
        f"the model of the {target.name} does not say where a hand may hold it",
        (),
        "push it",
        "add a `grasp` block to its model",
    )


def not_that_wide(
    target: SeenObject, widths: Sequence[float], held: tuple[float, float], part: str = "body"
) -> NoPlanError:
    """The hand does not close about it."""
    what = f"the {target.name}" if part == "body" else f"the {target.name}'s lid"
    if not widths:
        return refused("impossible", f"{what} has no two sides that a hand could hold", ())
    width, (narrowest, widest) = min(widths), held
    if width > widest:
        opens = f"the hand opens to {mm(widest)}"
    else:
        width = max(widths)
        opens = f"the hand closes to {mm(narrowest)}"
    return refused(
        "impossible",
        f"{what} is {mm(width)} wide, {opens}",
        (),
        "push it",
        width=width,
        widest=widest,
        narrowest=narrowest,
    )


def low_lid(target: SeenObject, tall: float, needed: float) -> NoPlanError:
    """The fingers find no room about what its lid is held by."""
    return refused(
        "impossible",
        f"the {target.name}'s lid can be held over {mm(tall)} of its height, the fingers need "
        f"{mm(needed)}",
        (),
        height=tall,
        needed=needed,
    )


def no_such_height(target: SeenObject, graspable: Graspable, asked: ContactLimits) -> NoPlanError:
    """The sentence leaves no height at which it may be held."""
    return refused(
        "impossible",
        f"the {target.name} may be held between {mm(graspable.lowest)} and "
        f"{mm(graspable.highest)} above its base, not {asked.region}",
        asked.spans,
        "leave out where to hold it",
        lowest=graspable.lowest,
        highest=graspable.highest,
    )


def no_room(target: SeenObject, low: float, high: float, asked: ContactLimits) -> NoPlanError:
    """The fingers, one beside the other, find no place on it."""
    return refused(
        "impossible",
        f"the fingers side by side find no room on the {target.name} between {mm(low)} and "
        f"{mm(high)} above its base",
        asked.spans,
        *(("leave out where to hold it",) if asked.region else ()),
        lowest=low,
        highest=high,
    )


# -- how hard it must be held -------------------------------------------------------------------


def too_heavy(problem: GraspProblem, candidate: Candidate, wanted: float, mu: float) -> NoPlanError:
    """It takes more squeeze than there is."""
    force, model = problem.force, problem.target.model
    has = candidate.grip.strongest
    bears = math.inf if model.grasp is None or candidate.part == "lid" else model.grasp.crush
    numbers = {"needed_force": wanted, "strongest": has, "friction": mu}
    what = f"{problem.goal.doing} the {problem.target.name}"
    needs = f"{what} needs {wanted:.1f} N of squeeze with μ {mu:.2f}; "
    if force.max <= min(has, bears):
        return refused(
            "impossible",
            f"{needs}{force.max:.1f} N are allowed",
            force.spans,
            f"allow {math.ceil(2.0 * wanted) / 2.0:g} N",
            allowed_force=force.max,
            **numbers,
        )
    if bears < has:
        return refused("impossible", f"{needs}it bears {bears:.1f} N", (), crush=bears, **numbers)
    at = f"the fingers have {has:.1f} N at {mm(candidate.width)}"
    return refused("impossible", f"{needs}{at}", (), "push it instead", **numbers)


def may_slip(
    problem: GraspProblem, squeeze: float, probability: float, learn: str, then: float
) -> NoPlanError:
    """It may slip, since weight or friction are not known well enough."""
    asked = problem.effort.probability
    return refused(
        "too_uncertain",
        f"squeezed with {squeeze:.1f} N the {problem.target.name} holds with a probability of "
        f"{probability:.2f}, and {asked:.2f} is asked",
        (),
        learn,
        squeeze=squeeze,
        probability=probability,
        probability_then=then,
        asked_probability=asked,
    )


def unlikely(problem: GraspProblem, made: Plan) -> NoPlanError:
    """Each part of a plan is likely enough, but not all of them together."""
    asked = problem.effort.probability
    return refused(
        "too_uncertain",
        f"{problem.goal.doing} the {problem.target.name} succeeds with a probability of "
        f"{made.probability:.2f}, and {asked:.2f} is asked",
        (),
        f"find out the weight of the {problem.target.name} first",
        probability=made.probability,
        asked_probability=asked,
    )


def no_reach(problem: GraspProblem, answers: Sequence[ReachAnswer]) -> NoPlanError:
    """There are ways, but the hand cannot make them."""
    blockers = [a for a in answers if a.reason == "obstacle" and a.blocker]
    last = (blockers or answers)[0]
    ways = "one way" if len(answers) == 1 else f"{len(answers)} ways"
    other = f"move the {blockers[0].blocker}" if blockers else "move it to another place"
    if problem.state.held is not None:
        other = f"put the {problem.target.name} down, then it may be held otherwise"
    return refused(
        "blocked" if blockers else "out_of_reach",
        f"there {'is' if len(answers) == 1 else 'are'} {ways} of {problem.goal.doing} the "
        f"{problem.target.name}, but the hand does not get there: {last.message}",
        (),
        other,
        **{"ways": float(len(answers)), **last.numbers},
    )


# -- what the hand holds, and where things stand ------------------------------------------------


def holds_nothing() -> NoPlanError:
    """There is nothing to be set down."""
    return refused("impossible", "the hand holds nothing that could be put down", ())


def is_fixed(problem: GraspProblem) -> NoPlanError:
    """A holder keeps it where it is."""
    return refused(
        "impossible",
        f"the {problem.target.name} is fixed in a holder; {problem.goal.doing} it would tear "
        "it out",
        (),
    )


def not_while(problem: GraspProblem, spans: Spans, forbidden: str) -> NoPlanError:
    """The sentence asks for something and forbids what that takes."""
    return refused(
        "impossible", f"{problem.goal.doing} the {problem.target.name} {forbidden}", spans
    )


def no_place(problem: GraspProblem, what: str, blocker: str | None) -> NoPlanError:
    """Where it should stand there is no room."""
    met = "the table ends there" if blocker is None else f"the {blocker} stands there"
    return refused(
        "impossible" if blocker is None else "blocked",
        f"{what} cannot be put there: {met}",
        (),
        *(() if blocker is None else (f"move the {blocker} first",)),
    )

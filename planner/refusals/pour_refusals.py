"""Why nothing is poured, with the volumes that decide."""

from __future__ import annotations

from typing import TYPE_CHECKING

from planner.refusals.grasp_refusals import Spans, refused

if TYPE_CHECKING:
    from planner.grasping.pour_amounts import Amount
    from planner.grasping.pour_planner import Motion
    from planner.problem.planning_problem import GraspProblem
    from planner.types.dead_ends import NoPlanError
    from planner.types.world_state import SeenObject


def ml(volume: float) -> str:
    """A volume as people read it."""
    return f"{1e6 * volume:.0f} ml"


def into_nothing(problem: GraspProblem, spans: Spans) -> NoPlanError:
    """It would land on the table."""
    return refused(
        "impossible",
        f"pouring from the {problem.target.name} needs something to pour into",
        spans,
        "say what it is to be poured into",
    )


def into_itself(problem: GraspProblem, spans: Spans) -> NoPlanError:
    """Both are the same object."""
    return refused("impossible", f"the {problem.target.name} cannot be poured into itself", spans)


def no_container(seen: SeenObject) -> NoPlanError:
    """It is solid, as far as is known."""
    return refused("impossible", f"the {seen.name} is no container", ())


def lies(seen: SeenObject) -> NoPlanError:
    """It does not stand, so that it holds nothing."""
    return refused("impossible", f"the {seen.name} lies on its side", (), "set it upright first")


def is_closed(seen: SeenObject) -> NoPlanError:
    """Its lid is in the way."""
    message = f"the {seen.name} is closed"
    return refused("impossible", message, (), f"open the {seen.name} first")


def is_empty(problem: GraspProblem) -> NoPlanError:
    """There is nothing in it."""
    return refused("impossible", f"the {problem.target.name} is empty", (), contents=0.0)


def does_not_fit(
    into: SeenObject, wanted: float, room: float, has: float, spans: Spans
) -> NoPlanError:
    """It would run over, whether or not there is so much."""
    fits = min(max(room, 0.0), has)
    most = f"pour up to {ml(fits)}" + ("" if has > room else ", which is all there is to pour")
    return refused(
        "impossible",
        f"{ml(wanted)} do not fit into the {into.name}: it has room for {ml(max(room, 0.0))}",
        spans,
        *((most,) if fits > 0.0 else ()),
        volume=wanted,
        room=max(room, 0.0),
        contents=has,
    )


def not_so_much(problem: GraspProblem, wanted: float, has: float, spans: Spans) -> NoPlanError:
    """There is less in it."""
    return refused(
        "impossible",
        f"{ml(wanted)} are asked; {ml(has)} are in the {problem.target.name}",
        spans,
        f"pour up to {ml(has)}",
        volume=wanted,
        contents=has,
    )


def wrong_side(problem: GraspProblem) -> NoPlanError:
    """Held as it can be, or is, it does not lean to where its opening is."""
    held = problem.state.held is not None
    as_it_is = "is held" if held else "can be held"
    return refused(
        "impossible",
        f"as it {as_it_is}, the {problem.target.name} does not lean to the side of its opening",
        (),
        *((f"put the {problem.target.name} down, then pour from it",) if held else ()),
    )


def may_spill(
    problem: GraspProblem, into: SeenObject, wanted: Amount, motion: Motion
) -> NoPlanError:
    """Too much may miss or run over, or too little run out."""
    mean = {name: float(value) for name, value in motion.poured.mean_volumes().items()}
    asked = problem.effort.probability
    return refused(
        "too_uncertain",
        f"of {ml(wanted.volume)} the {into.name}, with room for {ml(wanted.room)}, receives "
        f"{ml(mean['received'])} and {ml(mean['spilled'])} are spilled; that it goes well has a "
        f"probability of {motion.probability:.2f}, and {asked:.2f} is asked",
        (),
        f"find out the weight of the {problem.target.name} first",
        "pour less",
        volume=wanted.volume,
        room=wanted.room,
        **mean,
        probability=motion.probability,
        asked_probability=asked,
    )

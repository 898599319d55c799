"""Whether something stands where it is to be put on another object, or into it.

Model: `objectmodels.mechanics.standing_balance`, with the place of what is put down known
as well as hands put things down. Frame: W.
"""

from __future__ import annotations

from grammar.frames import command as g
from objectmodels.geometry.base_shapes import Polygon
from objectmodels.mechanics.standing_balance import stack_margins, standing_probability
from planner.geometry.stacks import level_top, stack_with, stacked_bodies
from planner.problem.place_regions import region
from planner.problem.places_in_boxes import WALL_ROOM, InBox
from planner.problem.planning_problem import GraspProblem
from planner.refusals.refusal_builder import no_plan
from planner.types.stack_actions import SetOn, StandPrediction
from planner.types.world_state import SeenObject

PLACED = 0.003
"""Standard deviation of where a hand puts something, along each axis [m]."""


def require_level_top(lower: SeenObject) -> None:
    """Make sure that something may stand on an object.

    Raises:
        NoPlanError: its top is not level, or it has a lid.
    """
    if level_top(lower) is None:
        is_open = lower.attitude is None and lower.model.inside is not None
        instead = (f"put it into the {lower.name}",) if is_open else ()
        raise no_plan("no_level_top", other=lower.name, instead=instead)


def require_room_inside(problem: GraspProblem, box: SeenObject) -> None:
    """Make sure that an object finds a place in another one.

    Raises:
        NoPlanError: that one is no open box, or too small, or full.
    """
    goal, own = problem.frame.goal, problem.target
    assert isinstance(goal, g.Place), "it is put there"
    place = region(goal, problem.state, problem.defaults, own)
    if not isinstance(place, InBox) or box.attitude is not None:
        raise no_plan("not_open", object=own.name, other=box.name)
    if (excess := place.excess(own)) > 0.0:
        numbers = {"excess": excess, "room": WALL_ROOM}
        raise no_plan("too_long_for_box", numbers, object=own.name, other=box.name)
    if not place.spots(own):
        inside = [seen.name for seen in place.contents if seen.name != own.name]
        raise no_plan("box_is_full", object=own.name, box=box.name, other=inside[0])


def step_onto(problem: GraspProblem, there: SeenObject) -> SetOn:
    """The step that puts an object on another one, with what is predicted of it.

    Args:
        problem: whose object it is.
        there: the object, where it is to stand.

    Raises:
        NoPlanError: it falls into that one, or the stack does not surely stand.
    """
    assert there.on is not None, "it is put on something"
    lower = problem.state.objects[there.on]
    name = there.name
    if not _covers_opening(there, lower):
        raise no_plan("falls_in", object=name, other=lower.name)
    bodies = stacked_bodies(stack_with(there, problem.state.objects), name, PLACED)
    margin, stands = float(stack_margins(bodies).min()), standing_probability(bodies)
    if margin < 0.0:
        raise no_plan("overhangs", {"margin": margin, "beyond": -margin}, object=name,
                      other=lower.name)  # fmt: skip
    asked = problem.effort.probability
    if stands < asked:
        numbers = {"margin": margin, "probability": stands, "asked_probability": asked}
        raise no_plan("may_fall_off", numbers, object=name, other=lower.name)
    prediction = StandPrediction(margin=margin, stands=stands)
    inside = lower.model.inside is not None
    return SetOn(onto=lower.name, height=there.pose.z, inside=inside, prediction=prediction)


def _covers_opening(there: SeenObject, lower: SeenObject) -> bool:
    """Return True if the base of an object covers the opening of the one below, if that has one."""
    container = lower.model.container
    if container is None:
        return True
    x, y = container.opening.centre
    middle = lower.pose.p_WB + lower.pose.R_WB @ [x, y, 0.0]
    at = (middle - there.pose.p_WB) @ there.pose.R_WB
    base = Polygon.convex(there.model.base.corners)
    return bool((base.normals @ at[:2] + container.opening.radius < base.offsets).all())

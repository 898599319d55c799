"""The true reason of a refusal: what would have to be otherwise for a plan.

A search that finds nothing has met obstacles, any of which may be beside the point. So it is asked
what would be planned without them: an obstacle is named only if there is a plan once it is gone.
Where there is none even then, what stands in its way then is the reason. What is out of reach is
moved towards the middle of the table until there is a plan, which tells by how much it is.

What a sentence tells a place by is never in the way; nor is what carries the object, which has
refusals of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Collection

import numpy as np

from grammar.frames import command as g
from planner.clearing import obstacles
from planner.problem.places import object_at
from planner.problem.planning_problem import places_told_by
from planner.refusals.no_plan import refusal as refusal_of
from planner.types.plan import PlanningResult
from planner.types.refusal import Refusal
from planner.types.world_state import ObstacleMark, WorldState, obstacle_mark

PlanFrom = Callable[[WorldState], PlanningResult]

REASON_WORK = 0.15
"""Work of each plan by which a reason is tried, in that of the plan that was refused."""

_FACTS = frozenset({"carries", "stands_on", "contains", "stands_in", "in_the_way_so_far"})
"""Codes of refusals whose obstacle is a fact about a stack, or leaves room that is measured."""
_BEYOND = frozenset({"no_push_reached", "no_grasp_reached"})
"""Codes of refusals that name nothing but the hand's reach."""
_HALVINGS = 4  # of the way to the middle of the table


def true_refusal(
    refusal: Refusal, frame: g.Frame, state: WorldState, plan_from: PlanFrom
) -> Refusal:
    """The refusal with its true reason.

    Args:
        refusal: what the search for a plan ended in.
        frame: that is refused.
        state: what is believed.
        plan_from: plans the frame from another belief.
    """
    assert frame.object is not None, "what is about no object is not refused by reach"
    name = frame.object.id or ""
    spared = places_told_by(frame.goal) | _held_up_by(name, state)
    if refusal.code in _FACTS:
        return refusal
    if any(each not in spared for each in obstacles(refusal)):
        refusal = _without_obstacles(refusal, name, state, spared, plan_from)
    if refusal.code in _BEYOND and not obstacles(refusal):
        return _with_distance(refusal, name, state, spared, plan_from)
    if refusal.reason == "blocked" and (kept := [n for n in obstacles(refusal) if n in spared]):
        found = refusal_of(
            "no_way_past", refusal.numbers, spans=refusal.spans, object=name, other=kept[0]
        )
        marks = tuple(mark for mark in refusal.marks if not isinstance(mark, ObstacleMark))
        return found.model_copy(update={"marks": marks})
    return refusal


def _without_obstacles(
    refusal: Refusal, name: str, state: WorldState, spared: Collection[str], plan_from: PlanFrom
) -> Refusal:
    """The refusal by the obstacles that block, or what stays in the way without any."""
    gone: list[str] = []
    met: list[Refusal] = []
    made: PlanningResult = refusal
    while isinstance(made, Refusal):
        if gone and made.code == "work_used_up":
            return _hemmed_in(refusal, name)
        met.append(made)
        left = [each for each in obstacles(made) if each not in spared and each not in gone]
        if not left:
            return made
        if len(gone) == 3:  # Obstacles that are taken away together
            others = [each for each in state.objects if each != name and each not in spared]
            made = plan_from(_state_without(others, state))
            if isinstance(made, Refusal) and made.code != "work_used_up":
                return made
            return _hemmed_in(refusal, name)
        gone.append(left[0])
        made = plan_from(_state_without(gone, state))
    needed = list(gone)
    for each in gone[:-1]:  # without the last of them there was none
        fewer = [other for other in needed if other != each]
        if not isinstance(plan_from(_state_without(fewer, state)), Refusal):
            needed = fewer
    named = met[gone.index(needed[0])]
    marks = [mark for mark in named.marks if not isinstance(mark, ObstacleMark)]
    first = f"move {' and '.join(f'the {each}' for each in needed)} first"
    own = [each for each in named.suggestions if not each.startswith("move the ")]
    changes = {
        "marks": (*marks, *map(obstacle_mark, needed)),
        "suggestions": (first, *own),
    }
    return named.model_copy(update=changes)


def _hemmed_in(refusal: Refusal, name: str) -> Refusal:
    """The refusal since it was not found which of the things about an object are in the way."""
    found = refusal_of("hemmed_in", refusal.numbers, spans=refusal.spans, object=name)
    return found.model_copy(update={"marks": refusal.marks})


def _with_distance(
    refusal: Refusal, name: str, state: WorldState, spared: Collection[str], plan_from: PlanFrom
) -> Refusal:
    """The refusal with how far the object is from the nearest place that would do, if one does."""
    target, table = state.objects[name], state.table
    if state.held is not None or target.on is not None or state.carried_by(name):
        return refusal
    lone = _state_without([n for n in state.objects if n != name and n not in spared], state)
    here = np.array([target.pose.x, target.pose.y])
    way = table.middle - here
    length = float(np.linalg.norm(way))

    def is_planned(share: float) -> bool:
        moved = object_at(target, here + share * way)
        made = plan_from(WorldState({**lone.objects, name: moved}, table))
        return not isinstance(made, Refusal)

    if length < 0.02 or not is_planned(1.0):  # it stands in the middle as it is
        return refusal
    none, some = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (none + some)
        none, some = (none, middle) if is_planned(middle) else (middle, some)
    x, y = (here + some * way).tolist()
    off = some * length
    told = f"; {1e3 * off:.0f} mm nearer to the middle of the table, at x {1e3 * x:.0f} mm, "
    return refusal.model_copy(
        update={
            "message": f"{refusal.message}{told}y {1e3 * y:.0f} mm, it would do",
            "suggestions": (
                f"put it there by hand: x {x:.2f} m, y {y:.2f} m",
                *refusal.suggestions,
            ),
            "numbers": {**refusal.numbers, "nearer": off, "nearest_x": x, "nearest_y": y},
        }
    )


def _held_up_by(name: str, state: WorldState) -> frozenset[str]:
    """Names of what an object stands on, down to the table."""
    found: set[str] = set()
    on = state.objects[name].on if name in state.objects else None
    while on is not None and on not in found:
        found.add(on)
        on = state.objects[on].on
    return frozenset(found)


def _state_without(names: Collection[str], state: WorldState) -> WorldState:
    """The belief without some objects, and without what stands on them."""
    gone = set(names)
    kept = {n: s for n, s in state.objects.items() if not (_held_up_by(n, state) | {n}) & gone}
    return WorldState(kept, state.table, state.held)

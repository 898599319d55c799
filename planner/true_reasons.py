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
from dataclasses import replace

import numpy as np

from grammar.frames import command as g
from planner.problem.places import object_at
from planner.problem.planning_problem import places_told_by
from planner.refusals.blocked import Blocked, dead_end
from planner.types.cure import move
from planner.types.plan import Plan, Reached
from planner.types.world_state import WorldState

OutcomeFrom = Callable[[WorldState], Plan | Reached | Blocked]

REASON_WORK = 0.15
"""Work of each plan by which a reason is tried, in that of the plan that was refused."""

_FACTS = frozenset({"carries", "stands_on", "contains", "stands_in", "in_the_way_so_far"})
"""Codes of refusals whose obstacle is a fact about a stack, or leaves room that is measured."""
_BEYOND = frozenset({"no_push_reached", "no_grasp_reached"})
"""Codes of refusals that name nothing but the hand's reach."""
_HALVINGS = 4  # of the way to the middle of the table


def true_reason(
    why: Blocked, frame: g.Frame, state: WorldState, outcome_from: OutcomeFrom
) -> Blocked:
    """The true reason of a refusal.

    Args:
        why: what the search for a plan ended in.
        frame: that is refused.
        state: what is believed.
        outcome_from: of planning the frame from another belief.
    """
    assert frame.object is not None, "what is about no object is not refused by reach"
    name = frame.object.id or ""
    spared = places_told_by(frame.goal) | _held_up_by(name, state)
    if why.code in _FACTS:
        return why
    if any(each not in spared for each in why.obstacles):
        why = _without_obstacles(why, name, state, spared, outcome_from)
    if why.code in _BEYOND and not why.obstacles:
        return _with_distance(why, name, state, spared, outcome_from)
    if why.reason == "blocked" and (kept := [n for n in why.obstacles if n in spared]):
        return dead_end(
            "no_way_past", why.numbers, spans=why.spans, marks=why.marks, object=name, other=kept[0]
        )
    return why


def _without_obstacles(
    why: Blocked, name: str, state: WorldState, spared: Collection[str], outcome_from: OutcomeFrom
) -> Blocked:
    """The reason with the obstacles that block, or what stays in the way without any."""
    gone: list[str] = []
    met: list[Blocked] = []
    made: Plan | Reached | Blocked = why
    while isinstance(made, Blocked):
        if gone and made.code == "work_used_up":
            return _hemmed_in(why, name)
        met.append(made)
        left = [each for each in made.obstacles if each not in spared and each not in gone]
        if not left:
            return made
        if len(gone) == 3:  # Obstacles that are taken away together
            others = [each for each in state.objects if each != name and each not in spared]
            made = outcome_from(_state_without(others, state))
            if isinstance(made, Blocked) and made.code != "work_used_up":
                return made
            return _hemmed_in(why, name)
        gone.append(left[0])
        made = outcome_from(_state_without(gone, state))
    needed = list(gone)
    for each in gone[:-1]:  # without the last of them there was none
        fewer = [other for other in needed if other != each]
        if not isinstance(outcome_from(_state_without(fewer, state)), Blocked):
            needed = fewer
    named = met[gone.index(needed[0])]
    own = (cure for cure in named.cures if cure.kind != "move")
    first = move(" and ".join(f"the {each}" for each in needed))
    return replace(named, obstacles=tuple(needed), cures=(first, *own))


def _hemmed_in(why: Blocked, name: str) -> Blocked:
    """It was not found which of the things about an object are in the way."""
    met = why.obstacles
    return dead_end(
        "hemmed_in", why.numbers, spans=why.spans, marks=why.marks, obstacles=met, object=name
    )


def _with_distance(
    why: Blocked, name: str, state: WorldState, spared: Collection[str], outcome_from: OutcomeFrom
) -> Blocked:
    """The reason with how far the object is from the nearest place that would do, if one does."""
    target, table = state.objects[name], state.table
    if state.held is not None or target.on is not None or state.carried_by(name):
        return why
    lone = _state_without([n for n in state.objects if n != name and n not in spared], state)
    here = np.array([target.pose.x, target.pose.y])
    way = table.middle - here
    length = float(np.linalg.norm(way))

    def is_planned(share: float) -> bool:
        moved = object_at(target, here + share * way)
        made = outcome_from(WorldState({**lone.objects, name: moved}, table))
        return not isinstance(made, Blocked)

    if length < 0.02 or not is_planned(1.0):  # it stands in the middle as it is
        return why
    none, some = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (none + some)
        none, some = (none, middle) if is_planned(middle) else (middle, some)
    x, y = (here + some * way).tolist()
    return why.with_fact("nearer", {"nearer": some * length, "nearest_x": x, "nearest_y": y})


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

"""From a frame to actions whose predicted outcome satisfies it, or to a refusal with numbers.

What takes a whole hand (lifting, pouring, opening) is planned in `planner.handling`, if the robot
has one; what is to be placed is lifted where it can be, and pushed where not. All else is pushed.

What is asked (`planner.asked`) is a fall or a tilt (`planner.falls`), or an aim on the table, to
which the object goes by several pushes (`planner.journey`). All pushes together must be likely
enough. Where the hand does not get to what would do, it is asked once more, to look thoroughly.

Frames: W is the world, B the object.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, overload

from grammar import frames as g
from planner import refusals
from planner.asked import Asked, read
from planner.defaults import DEFAULTS, Defaults
from planner.falls import fall, fall_otherwise
from planner.handling.planning import handle, is_handled
from planner.journey import Journey
from planner.plan import Aim, Plan, Push, Reached, Refusal
from planner.reach import GivenUpError, Patient
from planner.refusals import RefusedError
from planner.relations import region

if TYPE_CHECKING:
    from collections.abc import Iterator

    from planner.handling.plan import HandlingPlan
    from planner.handling.reach import HandReach
    from planner.onepush import Found
    from planner.reach import Reach
    from planner.state import SeenObject, WorldState


@overload
def plan(
    frame: g.Frame,
    state: WorldState,
    reach: Reach,
    *,
    defaults: Defaults = DEFAULTS,
    before: Plan | None = None,
) -> Plan | Reached | Refusal: ...


@overload
def plan(
    frame: g.Frame,
    state: WorldState,
    reach: Reach,
    *,
    hand: HandReach | None,
    defaults: Defaults = DEFAULTS,
    before: Plan | None = None,
) -> Plan | HandlingPlan | Reached | Refusal: ...


def plan(
    frame: g.Frame,
    state: WorldState,
    reach: Reach,
    *,
    hand: HandReach | None = None,
    defaults: Defaults = DEFAULTS,
    before: Plan | None = None,
) -> Plan | HandlingPlan | Reached | Refusal:
    """Finds what satisfies a frame: pushes, or what a whole hand does.

    Args:
        frame: what is asked, its objects resolved to names in `state`.
        state: what the robot believes; the object's heading counts whole turns after a plan before.
        reach: whether the hand gets somewhere with its fingertips.
        hand: what it can hold; None of a robot that only pushes.
        defaults: what a clause means when the sentence does not say more.
        before: the plan whose first push was made last; its aim is kept.

    Returns:
        A plan; that nothing is left to be done; or the reason why there is no plan.
    """
    if hand is None or before is not None or not is_handled(frame):
        return _pushes(frame, state, reach, defaults, before)
    if not isinstance(frame.goal, g.Place):
        return handle(frame, state, hand, defaults)
    # What is nearly there is moved least by a push.
    handled = None if _is_there(frame, state, defaults) else handle(frame, state, hand, defaults)
    if state.held is not None and isinstance(handled, Refusal):
        return handled
    if handled is not None and not isinstance(handled, Refusal):
        return handled
    return _pushes(frame, state, reach, defaults, before)


def _is_there(frame: g.Frame, state: WorldState, defaults: Defaults) -> bool:
    """Whether what is to be placed stands in its place already."""
    assert isinstance(frame.goal, g.Place)
    assert frame.object is not None
    target = state.objects[frame.object.id or ""]
    there = None if frame.goal.fraction is not None else region(frame.goal, state, defaults)
    return state.held is None and there is not None and there.holds(target)


def _pushes(
    frame: g.Frame, state: WorldState, reach: Reach, defaults: Defaults, before: Plan | None
) -> Plan | Reached | Refusal:
    try:
        asked = read(frame, state, defaults)
        assert frame.object is not None
        assert frame.object.id is not None
        target = state.objects[frame.object.id]
        if state.held is not None:
            raise RefusedError(refusals.holds(state.held.name))
        if target.lies_on != "bottom":
            raise RefusedError(refusals.lies(target))
    except RefusedError as refused:
        return refused.refusal
    return _persistently(asked, target, state, reach, defaults, before)


def _persistently(
    asked: Asked,
    target: SeenObject,
    state: WorldState,
    reach: Reach,
    defaults: Defaults,
    before: Plan | None,
) -> Plan | Reached | Refusal:
    """As usual; then thoroughly, less surely if it has begun, last in ways of less precision."""
    looks, effort = Patient(reach, defaults.most_looks, state), defaults
    made = _patiently(asked, target, state, looks, effort, before)
    denied = looks.denied
    if isinstance(made, Refusal) and denied:
        looks = looks.thorough(defaults.most_looks_last)
        effort = replace(defaults, most_contacts=defaults.most_contacts_last)
        again = _patiently(asked, target, state, looks, effort, before)
        # A search that was given up says less than one that came to its end.
        if not isinstance(again, Refusal) or again.reason != "out_of_time":
            made = again
    if isinstance(made, Refusal) and made.reason == "too_uncertain" and before is not None:
        bold = replace(effort, probability=min(defaults.probability, defaults.probability_on))
        made = _patiently(asked, target, state, looks.again(), bold, before)
    hurried = asked.limits.duration is not None
    if isinstance(made, Refusal) and (denied or hurried or not asked.aims):
        thorough = Patient(reach, defaults.most_looks, state).thorough()
        if asked.aims:
            found = _steeply(asked, target, state, thorough, defaults, before)
        else:
            found = _otherwise(asked, target, state, thorough, defaults)
        if found is not None:
            why = f"another way, since {made.message}"
            return found.model_copy(update={"notes": (why, *found.notes)})
    return made


def _patiently(
    asked: Asked,
    target: SeenObject,
    state: WorldState,
    reach: Patient,
    defaults: Defaults,
    before: Plan | None,
) -> Plan | Reached | Refusal:
    try:
        return _planned(asked, target, state, reach, defaults, before)
    except GivenUpError as given_up:
        return refusals.given_up(target, given_up.answers)


def _steeply(
    asked: Asked,
    target: SeenObject,
    state: WorldState,
    reach: Patient,
    defaults: Defaults,
    before: Plan | None,
) -> Plan | None:
    """One push straight to an aim, steep to the face, if two fingertips may make it."""
    if 2 not in asked.fingers or asked.rotates:
        return None
    steep = replace(asked, steep=True, fingers=(2,))
    made = _patiently(steep, target, state, reach, defaults, before)
    return made if isinstance(made, Plan) else None


def _otherwise(
    asked: Asked, target: SeenObject, state: WorldState, reach: Patient, defaults: Defaults
) -> Plan | None:
    """The fall of what does not fall square to the side where it stands, if there is one."""
    try:
        found = fall_otherwise(asked, target, state, reach, defaults)
    except GivenUpError:
        return None
    made = None if found is None else _together(found, asked, None, target, defaults)
    return made if isinstance(made, Plan) else None


def _planned(
    asked: Asked,
    target: SeenObject,
    state: WorldState,
    reach: Reach,
    defaults: Defaults,
    before: Plan | None,
) -> Plan | Reached | Refusal:
    foreseen = () if before is None else tuple(move.push for move in before.later)
    if not asked.aims:
        found = fall(asked, target, state, reach, defaults, foreseen)
        if isinstance(found, Refusal):
            return found
        return _together(found, asked, None, target, defaults)
    aims = asked.aims if before is None or before.aim is None else (before.aim,)
    return _to_an_aim(asked, aims, target, state, reach, defaults, foreseen)


def _to_an_aim(
    asked: Asked,
    aims: tuple[Aim, ...],
    target: SeenObject,
    state: WorldState,
    reach: Reach,
    defaults: Defaults,
    foreseen: tuple[Push, ...],
) -> Plan | Reached | Refusal:
    """The plan to the first aim for which there is one."""
    refusal: Refusal | None = None
    for aim in aims:
        found = Journey(asked, aim, target, state, reach, defaults, foreseen).pushes()
        if isinstance(found, Reached):
            return found
        if not isinstance(found, Refusal):
            made = _together(found, asked, aim, target, defaults)
            if isinstance(made, Plan):
                return made
            found = made
        refusal = refusal or found
    assert refusal is not None, "there is an aim"
    return refusal


def _together(
    found: list[Found], asked: Asked, aim: Aim | None, target: SeenObject, defaults: Defaults
) -> Plan | Refusal:
    """Pushes one after another as a plan, if they are likely enough together."""
    if asked.limits.duration is not None and len(found) > 1:
        return refusals.several_pushes(asked, target, len(found))
    first, *later = (each.move for each in found)
    # At least so likely, however the outcomes hang together; those of equal pushes are equal.
    doubts: dict[tuple[object, ...], float] = {}
    for each in found:
        doubt = 1.0 - each.move.prediction.probability
        doubts[each.event] = max(doubt, doubts.get(each.event, 0.0))
    probability = max(1.0 - sum(doubts.values()), 0.0)
    if probability < defaults.probability:
        return refusals.unlikely(target, len(found), probability, defaults)
    # What must be done in time is pushed faster than by default.
    quick = any(move.push.speed != asked.speed for move in (first, *later))
    return Plan(
        push=first.push,
        prediction=first.prediction,
        margins=first.margins,
        displacement=found[0].displacement,
        aim=aim,
        later=tuple(later),
        probability=probability,
        defaults=tuple(d for d in asked.defaults if d.name != "speed" or not quick),
        considered=sum(each.considered for each in found),
        satisfying=sum(each.satisfying for each in found),
        notes=tuple(_notes(found)),
    )


def _notes(found: list[Found]) -> Iterator[str]:
    """How each push was chosen; of several with the number of the push."""
    for number, each in enumerate(found, start=1):
        for note in each.notes:
            yield note if len(found) == 1 else f"push {number}: {note}"

"""Frames whose objects stand to each other in the end: in a row, stacked, in each other's place.

What such a frame asks depends on where its objects stand when the sentence is said. So here it
becomes a frame that says where: at a point, or next to one of them; so does "back". Objects in a
row keep their place along it, and go across to a line through the middle one, or through what they
join; where they would stand too close, the row is longer. Of objects that are put together the one
that was named last stays; of those that are stacked the one with the largest level top is lowest.

Frames: W, its table plane [m].
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import groupby, pairwise

import numpy as np

from grammar.frames import command as g
from nlcontrol.errors import error, whole_span
from planner.problem.footprints import footprint
from planner.problem.places import region
from planner.problem.stacks import level_top
from planner.types.defaults import Defaults
from planner.types.world_state import SeenObject, WorldState

_MUTUAL = ("in_row", "together", "stacked", "place_of", "back")
_ROOM = 0.06
"""Gap between the objects of a row, in which a finger has room [m]."""


def arranged_frames(
    frames: Sequence[g.Frame], look: Callable[[], WorldState]
) -> tuple[g.Frame, ...]:
    """The frames with places in place of how their objects stand to each other.

    Args:
        frames: of one command, their objects resolved.
        look: at what stands where; asked only if a frame needs it.

    Raises:
        ControlError: `unknown_object` if there is one object where it takes several.
    """
    found: list[g.Frame] = []
    for mutual, group in groupby(frames, _arrangement):
        if mutual is None:
            found += group
        else:
            once = {frame.object.id: frame for frame in group if frame.object is not None}
            found += _placed_frames(mutual, list(once.values()), look())
    return tuple(found)


def frames_to_clear(
    frames: Sequence[g.Frame], look: Callable[[], WorldState], defaults: Defaults
) -> Sequence[g.Frame]:
    """The frames of what is not clear yet; where all is, one that finds that out.

    Args:
        frames: resolved ones of one clause; those that clear nothing are all returned.
        look: at what stands where; asked only if a frame clears something.
        defaults: how far off is clear.
    """
    goal = frames[0].goal
    if not isinstance(goal, g.Place) or goal.relation != "clear_of" or not goal.reference:
        return frames
    state, found = look(), []
    told = {ref.id for ref in goal.reference if isinstance(ref, g.ObjectRef)}
    for frame in frames:
        place = region(goal, state, defaults)
        name = frame.object.id if frame.object is not None else None
        if place is None or name is None or not (name in told or place.holds(state.objects[name])):
            found.append(frame)
    others = [frame for frame in frames if frame.object is None or frame.object.id not in told]
    return found or others[:1] or frames[:1]


def _arrangement(frame: g.Frame) -> g.Place | None:
    """What a frame and others beside it have in common, if their objects are arranged."""
    goal = frame.goal
    asked = frame.query in (None, "possible")
    if asked and isinstance(goal, g.Place) and goal.relation in _MUTUAL:
        return goal.model_copy(update={"spans": ()})
    return None


def _placed_frames(
    mutual: g.Place, frames: Sequence[g.Frame], state: WorldState
) -> Iterator[g.Frame]:
    """The frames of one arrangement, each with the place of its object."""
    own = [state.objects[f.object.id or ""] for f in frames if f.object is not None]
    assert isinstance(mutual.reference, tuple), "objects stand to objects"
    others = [state.objects[ref.id or ""] for ref in mutual.reference]
    if len(own) + len(others) < 2 and mutual.relation != "back":
        ref = frames[0].object
        raise error(
            "unknown_object",
            f"it takes two or more objects, and the {own[0].name} is one",
            span=whole_span(ref.spans) if ref is not None else None,
            suggestions=("name the others, too",),
        )
    if mutual.relation == "together" and not others:
        own, others, frames = own[:-1], own[-1:], frames[:-1]
    if mutual.relation == "stacked":
        order = sorted(range(len(own)), key=lambda k: -_room_on(own[k]))
        own, frames = [own[k] for k in order], [frames[k] for k in order]
        own, others, frames = own[1:], own[:-1], frames[1:]
    for frame, place in zip(frames, _places(mutual.relation, own, others), strict=True):
        spans = frame.goal.spans
        yield frame.model_copy(update={"goal": place.model_copy(update={"spans": spans})})


def _places(
    relation: str, own: Sequence[SeenObject], others: Sequence[SeenObject]
) -> list[g.Place]:
    """The place of each object."""
    if relation == "stacked":
        below = [g.ObjectRef(text=each.name, id=each.name) for each in others]
        return [g.Place(relation="on", reference=(ref,)) for ref in below]
    if relation == "together":
        beside = g.ObjectRef(text=others[0].name, id=others[0].name)
        return [g.Place(relation="next_to", reference=(beside,)) for _ in own]
    if relation == "in_row":
        return [_at(*spot) for spot in _spots_of_row(own, others)]
    exchanged = [*own[1:], own[0]] if relation == "place_of" else own
    there = others if others else exchanged
    return [_at(seen.pose.x, seen.pose.y) for seen in there]


def _room_on(seen: SeenObject) -> float:
    """Area on which something may stand [m²]."""
    top = level_top(seen)
    return 0.0 if top is None else top.area


def _at(x: float, y: float) -> g.Place:
    return g.Place(relation="at", reference=g.Point(x=round(float(x), 4), y=round(float(y), 4)))


def _spots_of_row(own: Sequence[SeenObject], others: Sequence[SeenObject]) -> np.ndarray:
    """Places of objects in one line with others, (n, 2); along the axis on which they are spread.

    Others stay where they are.
    """
    seen = [*own, *others]
    at = np.array([(each.pose.x, each.pose.y) for each in seen])
    along = int(np.argmax(np.ptp(at, axis=0)))
    across = 1 - along
    at[:, across] = np.median(at[len(own) :, across] if others else at[:, across])
    half = np.array([np.ptp(footprint(each)[:, along]) / 2.0 for each in seen])
    order = np.argsort(at[:, along], kind="stable")
    middle = at[:, along].mean()
    for before, after in pairwise(order):
        least = at[before, along] + half[before] + _ROOM + half[after]
        at[after, along] = max(at[after, along], least)
    if not others:
        at[:, along] += middle - at[:, along].mean()  # as far to the one side as to the other
    return at[: len(own)]

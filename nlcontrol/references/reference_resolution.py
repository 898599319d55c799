"""From what a sentence names to objects of the scene: every reference gets its `id`.

What "it" means depends on where it stands. As the object of a clause it is what was last spoken
of, in the clause before or in the dialogue. In a goal ("push the mug to it") it is that as well,
but never the object itself; in a constraint ("without touching it") it is the goal's other object
if there is one, else the object. "Its" in a length is always the object.

Lengths measured in objects ("twice its width") become metres: of the believed model, as the object
lies. Width and length are the shorter and the longer side of the rectangle around its footprint
along B's axes, height is that of its top; a side that is not said is the width.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import groupby, pairwise
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from pydantic import BaseModel

from grammar.frames import command as g
from grammar.frames.command import (
    Command,
    Direction,
    Displace,
    Frame,
    Goal,
    NoGoal,
    ObjectRef,
    Parameters,
    Place,
    Query,
    RelativeLength,
    SetDown,
    Topple,
)
from grammar.words.plurals import singular
from nlcontrol.errors import error, whole_span
from nlcontrol.references.object_names import Candidate
from nlcontrol.references.reference_search import (
    Context,
    Surroundings,
    find_object,
    find_several,
    matching_objects,
    no_group_error,
    with_number,
)
from planner.problem.footprints import footprint
from planner.problem.places import region
from planner.problem.stacks import level_top
from planner.types.defaults import DEFAULTS, Defaults
from planner.types.world_state import SeenObject, WorldState

if TYPE_CHECKING:
    from objectmodels import ObjectModel


# Frames whose objects stand to each other in the end: in a row, stacked, in each other's place.
#
# What such a frame asks depends on where its objects stand when the sentence is said. So here it
# becomes a frame that says where: at a point, or next to one of them; so does "back". Objects in
# a row keep their place along it, and go across to a line through the middle one, or through what
# they join; where they would stand too close, the row is longer. Of objects that are put together
# the one that was named last stays; of those that are stacked the one with the largest level top
# is lowest.
#
# Frames: W, its table plane [m].


_MUTUAL = ("in_row", "together", "stacked", "place_of", "back")


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
        # In a gap of 60 mm between the objects of a row a finger has room.
        least = at[before, along] + half[before] + 0.06 + half[after]
        at[after, along] = max(at[after, along], least)
    if not others:
        at[:, along] += middle - at[:, along].mean()  # as far to the one side as to the other
    return at[: len(own)]


Part = TypeVar("Part", bound=BaseModel)


NOTHING_SAID = Context()

_WAYS: Mapping[Direction, tuple[float, float]] = {
    "away": (1.0, 0.0),
    "toward": (-1.0, 0.0),
    "left": (0.0, 1.0),
    "right": (0.0, -1.0),
}
"""Directions along x and y of W."""

_THIS = re.compile(r"\b(?:this|that|the same) $", re.IGNORECASE)

_ALONE: frozenset[Query | None] = frozenset({"value", "affordances", "predict"})
"""Questions that concern the model more than the table."""


def resolve_references(
    command: Command,
    on_table: Sequence[Candidate],
    known: Sequence[ObjectModel],
    look: Callable[[], WorldState],
    context: Context = NOTHING_SAID,
    defaults: Defaults = DEFAULTS,
) -> Command:
    """The command with the `id` of every object filled in, and every length in metres.

    The `id` is a name of the scene. The object of a question that can be answered for one that
    stands alone may get the name of a model that is known instead. A frame about several objects
    becomes one for each; how they are to stand to each other becomes a place for each. The robot
    looks once, and only if names do not decide.

    Raises:
        ControlError: `unknown_object`, `ambiguous_object`, `not_on_table` or `no_antecedent`.
    """
    around = Surroundings(on_table, known, cache(look))
    spoken = context.last
    frames: list[Frame] = []
    for frame in command.frames:
        latest = tuple(n for f in frames for n in objects_spoken_of(f)) or context.latest
        it = _pronoun_meanings(frame, spoken, context.held)
        doubt = None if frames or it != spoken else context.doubt
        own = dict.fromkeys(f.object.id for f in frames if f.object and f.object.id)
        group = tuple(own) if len(own) > 1 else context.group
        before = replace(
            context, last=it, other=it[:1], held=None, latest=latest, group=group, doubt=doubt
        )
        about = _with_this_one(frame, command.text, around, before)
        each = [
            _resolve_frame(f, around, before) for f in _frames_of_several(about, around, before)
        ]
        for resolved in frames_to_clear(each, around.look, defaults):
            frames.append(resolved)
            said = objects_spoken_of(resolved)
            spoken = (*said, *(name for name in spoken if name not in said))
    return command.model_copy(update={"frames": arranged_frames(frames, around.look)})


def _with_this_one(frame: Frame, text: str, around: Surroundings, spoken: Context) -> Frame:
    """A frame about "this box" of several boxes: the one that was spoken of last, if it is one."""
    ref = frame.object
    if ref is None or ref.pronoun or ref.id or ref.quantifier or not ref.spans or spoken.doubt:
        return frame
    start = ref.spans[0][0]
    if not spoken.last or not _THIS.search(text[:start]) or ref.text not in text[start:].casefold():
        return frame
    fitting = [each.name for each in matching_objects(ref, around, spoken)]
    if len(fitting) < 2 or spoken.last[0] not in fitting:
        return frame
    return frame.model_copy(update={"object": ref.model_copy(update={"id": spoken.last[0]})})


def _pronoun_meanings(frame: Frame, spoken: tuple[str, ...], held: str | None) -> tuple[str, ...]:
    """Meanings of a pronoun, the likeliest first: what is put or poured is what the hand holds."""
    is_held = frame.action in ("place", "pour") and frame.object and frame.object.pronoun
    if held is None or not is_held:
        return spoken
    return (held, *(name for name in spoken if name != held))


def objects_spoken_of(frame: Frame) -> tuple[str, ...]:
    """Names of the objects that a resolved frame speaks of: its own first, then its goal's."""
    refs = ([frame.object] if frame.object else []) + _references_in(frame.goal)
    return tuple(dict.fromkeys(ref.id for ref in refs if ref.id is not None))


def names_together(frame: Frame) -> tuple[str, ...]:
    """Names of what a resolved frame handles or compares, without the places that it speaks of."""
    than = frame.goal.than if isinstance(frame.goal, Parameters) else ()
    refs = ([frame.object] if frame.object else []) + list(than)
    return tuple(ref.id for ref in refs if ref.id is not None)


def parts_within(part: BaseModel) -> Iterator[BaseModel]:
    """A frame or a part of one, and all parts within it, each before its own parts."""
    yield part
    for key in type(part).model_fields:
        value = getattr(part, key)
        for inner in value if isinstance(value, tuple) else (value,):
            if isinstance(inner, BaseModel):
                yield from parts_within(inner)


def _references_in(part: BaseModel) -> list[ObjectRef]:
    values = [getattr(part, key) for key in type(part).model_fields]
    parts = [v for value in values for v in (value if isinstance(value, tuple) else (value,))]
    return [part for part in parts if isinstance(part, ObjectRef)]


def _frame_of_pair(frame: Frame, spoken: Context) -> Frame:
    """A question about "the two" as one about the first and the second of them.

    Those that were compared last, or handled together, come before those that were moved last.

    Raises:
        ControlError: `no_antecedent`, if it asks how far apart things are that were not named.
    """
    goal, ref = frame.goal, frame.object
    if not isinstance(goal, Parameters) or ref is None or ref.reference:
        return frame
    if goal.which == ("distance",) and [each.text for each in goal.than] == ["robot"]:
        return frame.model_copy(update={"goal": goal.model_copy(update={"than": ()})})
    if goal.than:
        return frame
    several = ref.quantifier is not None or singular(ref.text) != ref.text
    if goal.which == ("distance",) and not several:
        return frame  # how far one thing is, it is from the robot
    apart = goal.which == ("distance",)
    compares = frame.query == "compare" and ref.text.endswith("er")
    if not (apart or compares):
        return frame
    if apart and not (ref.pronoun or ref.quantifier or ref.text.endswith("s")):
        there = goal.model_copy(update={"which": ("position",)})  # "how far away is the mug?"
        return frame.model_copy(update={"goal": there})
    moved = tuple(dict.fromkeys(reversed(spoken.moved)))[:2]
    may = (spoken.latest, spoken.group) if apart else (spoken.group, spoken.last)
    pair = next((set(names) for names in (*may, moved) if len(set(names)) == 2), None)
    if pair is None and apart:
        raise no_group_error(ref, spoken)
    if pair is None:
        return frame
    one, other = (ObjectRef(text=name, spans=ref.spans, id=name) for name in sorted(pair))
    goal = goal.model_copy(update={"than": (other,)})
    return frame.model_copy(update={"object": one, "goal": goal})


def _frames_of_several(frame: Frame, around: Surroundings, spoken: Context) -> list[Frame]:
    """A frame for each of its objects: first what is foremost on the way, which would be hit."""
    frame = _frame_of_pair(frame, spoken)
    ref = frame.object
    if ref is not None and frame.query in (None, "possible"):
        ref = with_number(ref, around)
    if ref is None or ref.quantifier in (None, "any"):
        return [frame]
    binder = _Binder(around, spoken)
    names = find_several(binder.fill_part(ref), around, spoken)
    if ref.quantifier in ("all", "rest"):  # "put everything into the bin", but not the bin
        beside = {other.id for other in _named_beside(frame, binder)}
        names = [name for name in names if name not in beside] or names
    if len(names) > 1:
        u, v = _way_of(frame)
        seen = around.look().objects
        names.sort(key=lambda name: -(seen[name].pose.x * u + seen[name].pose.y * v))
    refs = [ObjectRef(text=name, spans=ref.spans, id=name) for name in names]
    return [frame.model_copy(update={"object": each}) for each in refs]


def _way_of(frame: Frame) -> tuple[float, float]:
    """Where things go on the table, as far as the frame says; away from the robot if it does not.

    What is taken with the hand comes nearest first.
    """
    goal = frame.goal
    if isinstance(goal, Displace) and goal.heading is not None:
        return math.cos(goal.heading), math.sin(goal.heading)
    said: Direction | tuple[Direction, ...] | None = getattr(goal, "direction", None)
    if said is None and frame.action == "pull":
        said = "toward"
    if said is None:
        return (1.0, 0.0) if isinstance(goal, Displace | NoGoal | Topple) else (-1.0, 0.0)
    ways = [_WAYS[way] for way in ((said,) if isinstance(said, str) else said)]
    return sum(u for u, _ in ways), sum(v for _, v in ways)


def _resolve_frame(frame: Frame, around: Surroundings, before: Context) -> Frame:
    """A frame whose objects are bound, given what was spoken of before it."""
    spoken = before.last
    unnamed = frame.object is None or frame.object.pronoun
    if (frame.dialogue in {"undo", "stop"} and unnamed) or frame.query == "capable":
        return frame  # "them", "the boxes": which ones, the answer says
    binder = _Binder(around, before)
    target = frame.object
    if target is not None:
        if target.pronoun:  # "push it next to the mug" is not about the mug
            beside = {ref.id for ref in _named_beside(frame, binder)}
            it = tuple(name for name in spoken if name not in beside)
            doubt = before.doubt and tuple(name for name in before.doubt if name not in beside)
            if doubt and len(doubt) == 1:
                it, doubt = doubt, None
            binder = replace(binder, spoken=replace(before, last=it, doubt=doubt))
        asked = replace(binder, prefers_open=_is_about_inside(frame.goal))
        target = asked.bind_reference(target, alone=_answered_alone(frame))
    own = (target.id,) if target is not None and target.id is not None else ()
    others = tuple(name for name in spoken if name not in own)
    last = own or spoken[:1]
    around_goal = replace(before, last=others, other=last)
    inside = _is_about_inside(frame.goal)
    goal_binder = replace(binder, own=own, spoken=around_goal, prefers_open=inside)
    goal = goal_binder.fill_part(frame.goal)
    named = tuple(ref.id for ref in _references_in(goal) if ref.id is not None)
    said = (*named, *own)
    about = replace(around_goal, last=(*said, *others), doubt=None if said else before.doubt)
    within = replace(binder, own=own, spoken=about)
    constraints = tuple(within.fill_part(clause) for clause in frame.constraints)
    return frame.model_copy(update={"object": target, "goal": goal, "constraints": constraints})


def _is_about_inside(goal: Goal) -> bool:
    """Return True if a goal speaks of what something is in."""
    if isinstance(goal, Place):
        return goal.relation in ("in", "out_of")
    return isinstance(goal, Parameters) and "fill" in goal.which


def _named_beside(frame: Frame, binder: _Binder) -> list[ObjectRef]:
    """The objects that a frame names besides its own, bound."""
    beside = [ref for part in (frame.goal, *frame.constraints) for ref in _references_in(part)]
    plain = [ref for ref in beside if not ref.pronoun and ref.quantifier is None]
    return [binder.bind_reference(ref) for ref in plain]


def _answered_alone(frame: Frame) -> bool:
    """True if a question can be answered for an object that is not on the table.

    It cannot if it asks where the object is, or speaks of others, which would have to stand by.
    """
    goal = frame.goal
    if isinstance(goal, SetDown) or (isinstance(goal, Parameters) and "position" in goal.which):
        return False
    parts = [goal, *frame.constraints, *([frame.object] if frame.object else [])]
    return frame.query in _ALONE and not any(_references_in(part) for part in parts)


@dataclass(frozen=True)
class _Binder:
    """Fills in references and lengths.

    Attributes:
        around: where objects are looked up.
        spoken: what pronouns mean.
        own: object of the frame, if it is known by now.
        prefers_open: whether of several that fit an open box is meant, if there is one.
    """

    around: Surroundings
    spoken: Context
    own: tuple[str, ...] = ()
    prefers_open: bool = False

    def fill_part(self, part: Part) -> Part:
        """A copy of any part of a frame."""
        values = {key: getattr(part, key) for key in type(part).model_fields}
        return part.model_copy(
            update={key: self._fill_value(value) for key, value in values.items()}
        )

    def _fill_value(self, value: object) -> object:
        match value:
            case ObjectRef():
                return self.bind_reference(value)
            case RelativeLength():
                model = self.around.model(self._measuring_object(value.of))
                shorter, longer = sorted(model.extents[:2])
                side = {"length": longer, "width": shorter, "height": model.top}[
                    value.side or "width"
                ]
                return value.value * side
            case BaseModel():
                return self.fill_part(value)
            case tuple():
                return tuple(filled for item in value for filled in self._fill_item(item))
        return value

    def _fill_item(self, item: object) -> tuple[object, ...]:
        """One of several values; of two objects that are named at once, both."""
        if not isinstance(item, ObjectRef) or item.quantifier in (None, "any"):
            return (self._fill_value(item),)
        names = find_several(self.fill_part(item), self.around, self.spoken)
        return tuple(ObjectRef(text=name, spans=item.spans, id=name) for name in names)

    def bind_reference(self, ref: ObjectRef, *, alone: bool = False) -> ObjectRef:
        """A reference with its id, and with those of the objects that it is beside."""
        ref = self.fill_part(ref)
        name = self._open_box(ref) or find_object(ref, self.around, self.spoken, alone=alone)
        return ref.model_copy(update={"id": name})

    def _open_box(self, ref: ObjectRef) -> str | None:
        """The one open box among several that a reference may mean; None if none is looked for."""
        if not self.prefers_open or ref.id is not None or ref.pronoun:
            return None
        names = [c.name for c in matching_objects(ref, self.around, self.spoken)]
        if len(names) < 2:
            return None
        opened = [name for name in names if self.around.model(name).inside is not None]
        return opened[0] if len(opened) == 1 else None

    def _measuring_object(self, ref: ObjectRef) -> str:
        """The object that a length is measured in: the frame's own, wherever that fits."""
        ref = self.fill_part(ref)
        if self.own and ref.id is None and (ref.pronoun or self._fits_own(ref)):
            return self.own[0]
        return find_object(ref, self.around, self.spoken, alone=True)

    def _fits_own(self, ref: ObjectRef) -> bool:
        found = matching_objects(ref, self.around, self.spoken)
        return len(found) > 1 and self.own[0] in [c.name for c in found]

"""A frame with what a remark says in the place of what was: another object, direction, force.

What is kept of an earlier sentence loses its spans, which point into that sentence, and calls each
object by its name in the scene, since "it" may mean another one by now.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar, cast

from pydantic import BaseModel

from grammar.frames import command as g
from grammar.frames.conflicts import FORBIDS, FORBIDS_BELOW, HOW_FAR, SAME_MATTER
from nlcontrol.errors import error

Part = TypeVar("Part", bound=BaseModel)
Rename = Callable[[g.ObjectRef], g.ObjectRef]

_WHERE = ("direction", "heading", "toward", "away_from")
FAR_FIELDS = ("distance", "angle", "height", "above", "bound", "fraction", "amount")
_POURED = ("amount", "fraction", "volume", "fill")
_TURNS = {"left": "ccw", "right": "cw"}
_BESIDE_ON = {"left": "left_of", "right": "right_of", "away": "behind", "toward": "in_front_of"}
_BESIDE = frozenset({"next_to", *_BESIDE_ON.values()})


# --- what is kept ----------------------------------------------------------------------------


def by_name(ref: g.ObjectRef) -> g.ObjectRef:
    """A resolved object by its name in the scene; any other as it is."""
    return ref if ref.id is None else g.ObjectRef(text=ref.id, noun=ref.id, id=ref.id)


def _asks_which(frame: g.Frame) -> bool:
    """Check for "which is the biggest?", whose object is the answer."""
    goal = frame.goal
    return frame.query == "compare" and isinstance(goal, g.Parameters) and not goal.than


def _as_asked(ref: g.ObjectRef) -> g.ObjectRef:
    """What a question looks for as it was asked, without its answer."""
    return ref.model_copy(update={"id": None, "spans": ()})


def without_spans(part: Part, rename: Rename = by_name) -> Part:
    """A copy of a part of an earlier sentence: no spans, and each object renamed.

    What `rename` puts in is of the new sentence and stays as it is.
    """
    if isinstance(part, g.ObjectRef):
        other = rename(part)
        if other is not part:
            return cast("Part", other)
    if isinstance(part, g.Frame) and _asks_which(part) and rename is by_name:
        rename = _as_asked
    changed: dict[str, object] = {}
    for key in type(part).model_fields:
        value = getattr(part, key)
        if key == "spans":
            changed[key] = ()
        elif isinstance(value, BaseModel):
            changed[key] = without_spans(value, rename)
        elif isinstance(value, tuple) and any(isinstance(v, BaseModel) for v in value):
            changed[key] = tuple(without_spans(v, rename) for v in value)
    return part.model_copy(update=changed)


def without_fields(goal: Any, fields: Sequence[str]) -> Any:
    """A goal that leaves some fields open."""
    there = type(goal).model_fields
    return goal.model_copy(update={k: there[k].get_default() for k in fields if k in there})


def are_alike(frames: Sequence[g.Frame]) -> bool:
    """Check for frames that say the same of different objects."""
    first, *others = (without_spans(f.model_copy(update={"object": None})) for f in frames)
    return all(other == first for other in others)


# --- what is put in its place ----------------------------------------------------------------


def merge_frames(last: g.Frame, said: g.Frame) -> g.Frame:
    """A frame with everything that a remark says put in the place of what was."""
    goal = _merged_goal(last.goal, said)
    fresh = set(stated_fields(said.goal))
    new = {c.kind for c in said.constraints if c.kind != "no_touch"}
    dropped = new.union(*(matter for matter in SAME_MATTER if matter & new))
    if fresh & set(FAR_FIELDS):
        dropped |= HOW_FAR
    if goal.kind != last.goal.kind:
        dropped |= _dropped_by(goal)
    kept = [c for c in last.constraints if c.kind not in dropped]
    if fresh & set(_WHERE):
        kept = [c for c in map(_without_face, kept) if c is not None]
    carried = isinstance(last.goal, g.Lift) and isinstance(goal, g.Place)
    action = "place" if carried else last.action  # "lift it", "behind the mug"
    return last.model_copy(
        update={
            "action": said.action or action,
            "object": said.object or last.object,
            "goal": goal,
            "constraints": (*kept, *said.constraints),
            "event": said.event or last.event,
            "spans": said.spans,
        }
    )


def _dropped_by(goal: g.Goal) -> frozenset[str]:
    """Constraints that a new goal of another kind cannot keep, those of the distance left out."""
    _, limit = FORBIDS_BELOW.get(goal.kind, ("", ""))
    return FORBIDS.get(goal.kind, frozenset()) | {limit} - HOW_FAR


def _without_face(clause: g.Constraint) -> g.Constraint | None:
    """A contact without its face, which belongs to the direction that was said with it."""
    if not isinstance(clause, g.ContactRegion) or clause.face is None:
        return clause
    if clause.region is None and clause.height is None:
        return None
    return clause.model_copy(update={"face": None})


def _merged_goal(last: g.Goal, said: g.Frame) -> g.Goal:
    new = said.goal
    if new.kind == "none":
        return last
    share = stated_fields(new).get("fraction")
    if share is not None and len(stated_fields(new)) == 1 and said.action is None:
        return _share_of(last, share)
    if new.kind != last.kind and said.action is None:
        new = _as_kind_of(last, new)
    if isinstance(new, g.Displace) and isinstance(last, g.Displace) and said.action is None:
        beside = place_beside(last)  # "not so close, leave 10 cm between them"
        if beside and new.distance and (place := _farther_from(beside, stated_fields(new))):
            return place
    if new.kind != last.kind or isinstance(new, g.Place):
        return new
    fresh = set(stated_fields(new))
    update: dict[str, object] = {"spans": new.spans}
    for group in (_WHERE, FAR_FIELDS, _POURED, *((key,) for key in type(new).model_fields)):
        if fresh & set(group):
            update |= {key: getattr(new, key) for key in group if key in type(new).model_fields}
    return last.model_copy(update=update)


def _share_of(last: g.Goal, share: float) -> g.Goal:
    """The goal with a share of the length, the angle or the volume that was said.

    Raises:
        ControlError: `nothing_before`, if none was.
    """
    said = {key: getattr(last, key, None) for key in ("distance", "angle", "height", "volume")}
    if whole := {key: value for key, value in said.items() if isinstance(value, float)}:
        return last.model_copy(update={key: share * value for key, value in whole.items()})
    way = (isinstance(last, g.Displace) and last.toward) or isinstance(last, g.Pour)
    if not way or share > 1.0:
        raise error(
            "nothing_before",
            "how far was not said before, so there is nothing to take a part of",
            suggestions=("say how far, as “5 cm”",),
        )
    return last.model_copy(update={"fraction": share})


def stated_fields(goal: g.Goal) -> dict[str, Any]:
    """The fields of a goal that are not left open."""
    fields = type(goal).model_fields
    return {
        key: getattr(goal, key)
        for key, field in fields.items()
        if key not in ("kind", "spans") and getattr(goal, key) != field.get_default()
    }


def _as_kind_of(last: g.Goal, new: g.Goal) -> g.Goal:
    """Bare words ("to the left", "30 degrees") taken as they are meant for the last goal's kind."""
    values = stated_fields(new)
    if isinstance(last, g.Rotate) and "direction" in values:
        values["sense"] = _TURNS.get(str(values.pop("direction")))
    if isinstance(last, g.Lift) and "distance" in values:
        values["height"] = values.pop("distance")
    if isinstance(new, g.Pour):
        raise error(
            "nothing_before",
            "nothing was poured, so it is not clear what that much is",
            suggestions=("say what to pour, as “pour 50 ml of the water into the mug”",),
        )
    if isinstance(values.get("direction"), tuple) or None in values.values():
        return new
    if (beside := place_beside(last)) and "away_from" in values:
        return _farther_from(beside, values) or new
    if isinstance(last, g.Place) and values.keys() == {"direction"} and last.relation in _BESIDE:
        return last.model_copy(update={"relation": _BESIDE_ON[values["direction"]]})
    if not set(values) <= set(type(last).model_fields):
        if isinstance(last, g.HandOver | g.Open | g.Close | g.Pour) and isinstance(new, g.Displace):
            raise error(
                "nothing_before",
                "nothing was moved along the table, so it is not clear what that is about",
                suggestions=("say what to move, as “push the mug to the left”",),
            )
        return new
    if isinstance(last, g.Place):
        return last.model_copy(update=values)
    return type(last)(**values, spans=new.spans)


def place_beside(last: g.Goal) -> g.Place | None:
    """The place beside something that a goal is about: what is to touch it, or to get nearer."""
    if isinstance(last, g.Place):
        if last.relation == "touching":
            return last.model_copy(update={"relation": "next_to"})
        return last if last.relation in _BESIDE else None
    if isinstance(last, g.Displace) and isinstance(last.toward, g.ObjectRef):
        return g.Place(relation="next_to", reference=(last.toward,))
    return None


def _farther_from(last: g.Place, values: dict[str, Any]) -> g.Place | None:
    """A place beside something, "10 cm away from it"; None if it is of another thing.

    Raises:
        ControlError: `nothing_before`, if it does not say how far.
    """
    away = values.get("away_from")
    if not (isinstance(away, g.ObjectRef) and away.pronoun):
        return None
    if not isinstance(values.get("distance"), float):
        raise error(
            "nothing_before",
            "it was put beside something, and how far from it is not said",
            suggestions=("say how far, as “10 cm away from it”",),
        )
    return last.model_copy(update={"distance": values["distance"]})

"""Aims of remarks: the frames and objects that they are about, and what is made of them.

Which frames a remark is about: those asked last or those done, one of them or all.

"Slowly" is about all that was said; "6 cm" too, if the same was said of each object; where several
went different ways, it is asked back.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar, cast

from pydantic import BaseModel

from grammar import paraphrase
from grammar.frames import command as g
from grammar.frames.constraints import FORBIDS, FORBIDS_BELOW, HOW_FAR, SAME_MATTER
from grammar.words.lexicon_plugins import installed_lexicon
from nlcontrol.errors import error, whole_span
from nlcontrol.references.object_names import find_by_name, name_words, names_on_table
from nlcontrol.references.reference_resolution import names_together, parts_within
from nlcontrol.references.reference_search import Context
from nlcontrol.text_format import join_words

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from nlcontrol.session.remarks.undo_frames import UndoEntry
    from objectmodels import ObjectModel
    from sim.robots.cell_description import CellDescription


# A frame with what a remark says in the place of what was: another object, direction, force.
#
# What is kept of an earlier sentence loses its spans, which point into that sentence, and calls
# each object by its name in the scene, since "it" may mean another one by now.


Part = TypeVar("Part", bound=BaseModel)
Rename = Callable[[g.ObjectRef], g.ObjectRef]

_WHERE = ("direction", "heading", "toward", "away_from")
FAR_FIELDS = ("distance", "angle", "height", "above", "bound", "fraction", "amount")
_POURED = ("amount", "fraction", "volume", "fill")
_BESIDE_ON = {"left": "left_of", "right": "right_of", "away": "behind", "toward": "in_front_of"}
_PLACES_BESIDE = frozenset({"next_to", *_BESIDE_ON.values()})


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


def merge_frames(last: g.Frame, said: g.Frame) -> g.Frame:
    """A frame with everything that a remark says put in the place of what was."""
    goal = _merged_goal(last.goal, said)
    fresh = set(stated_fields(said.goal))
    new = {c.kind for c in said.constraints if c.kind != "no_touch"}
    dropped = new.union(*(matter for matter in SAME_MATTER if matter & new))
    if fresh & set(FAR_FIELDS):
        dropped |= HOW_FAR
    if goal.kind != last.goal.kind:
        _, limit = FORBIDS_BELOW.get(goal.kind, ("", ""))
        dropped |= FORBIDS.get(goal.kind, frozenset()) | {limit} - HOW_FAR
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
        values["sense"] = {"left": "ccw", "right": "cw"}.get(str(values.pop("direction")))
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
    if (
        isinstance(last, g.Place)
        and values.keys() == {"direction"}
        and last.relation in _PLACES_BESIDE
    ):
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
        return last if last.relation in _PLACES_BESIDE else None
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


def nothing_before(message: str) -> NoReturn:
    """Refuse a remark on what was not said or done.

    Raises:
        ControlError: `nothing_before`.
    """
    raise error(
        "nothing_before", message, suggestions=("say first what to do, as “push the box away”",)
    )


def followed_frames(
    said: g.Frame, asked: Sequence[g.Frame], done: Sequence[g.Frame]
) -> Sequence[g.Frame]:
    """The frames that a remark is about, given those said last and those of the last command."""
    told = [frame for frame in asked if frame.action]
    if said.dialogue == "do":
        told = [frame for frame in told if frame.query] or told
        return told or (done if says_something(said) else [])
    if said.query == "compare":  # "and than the mug?"
        return [frame for frame in asked if frame.query == "compare"]
    if said.query is not None:
        return told or done
    if said.dialogue == "correct":
        if not asked:  # what was not understood may have been about another object
            return done if said.object and not said.object.pronoun else asked
        return asked if _can_correct(asked[-1], said) else done
    about_deeds = said.action or said.dialogue in ("same", "reverse", "more")
    # Questions with which nothing else can be asked the same.
    answered = [frame for frame in asked if frame.query not in ("why", "did", "seen")]
    if said.goal.kind != "none":  # to ask how it stands is not to ask where it goes
        answered = [each for each in answered if each.action or each.goal.kind == "parameters"]
    if said.dialogue == "same" and not done and said.goal.kind == "none":  # "the same with the jar"
        return [frame for frame in answered if frame.query == "value"]
    return done if about_deeds else answered or done


def reply_to(command: g.Command, said: Result | None) -> str | None:
    """What there is to say to a remark that has nothing done; None to any other."""
    (frame, *others) = command.frames
    if frame.dialogue == "thank" and not others:
        return "Gladly."
    if frame.dialogue == "stop" and not others:
        # Sentences are carried out before the next one is read, so there is nothing to stop.
        return "Nothing is being done."
    if only_agrees(command) and _is_all_done(said):
        return "That is done already; “again” does it once more."
    return None


def _is_all_done(said: Result | None) -> bool:
    """Check for a command of which nothing is left to do."""
    return said is not None and said.status == "done" and not any(f.query for f in said.frames)


def only_agrees(command: g.Command) -> bool:
    """Check for "yes", "go ahead" and nothing besides."""
    (frame, *others) = command.frames
    return frame.dialogue == "do" and not says_something(frame) and not others


def _can_correct(last: g.Frame, said: g.Frame) -> bool:
    """Check for a frame in which what a remark says can take the place of something."""
    if last.action is not None:
        return last.query is None or said.action is None
    asks = last.query == "value" and last.goal.kind == "parameters"  # not how it came to stand
    return asks and said.goal.kind == "none" and not said.constraints


def frames_about(before: Sequence[g.Frame], said: g.Frame) -> list[g.Frame]:
    """The frames that a remark is about: the last, and those before it that say the same.

    If it names an action, those with that action; "slowly" is about all of them. Where several
    objects went different ways, it does not say which of them is meant.

    Raises:
        ControlError: `nothing_before`.
    """
    same = [frame for frame in before if frame.action == said.action] or list(before)
    fitting = [frame for frame in same if frame.goal.kind == said.goal.kind] or same
    if said.object is not None or said.query is not None or len(fitting) == 1:
        return fitting[-1:]
    if are_alike(same) or (said.goal.kind == "none" and said.constraints):
        return same
    objects = {frame.object.id: None for frame in fitting if frame.object and frame.object.id}
    if len(objects) > 1:
        nothing_before(f"it is not clear whether {join_words([*objects], 'or')} is meant")
    return fitting[-1:]


def without_announced(command: g.Command) -> g.Command:
    """The command without "let us measure it", if what is measured is said behind it."""
    first, *others = command.frames
    if len(others) != 1 or not command.text.casefold().lstrip("so, ").startswith("let"):
        return command
    announces = first.action == others[0].action == "explore" and first.object
    measured = isinstance(first.goal, g.Parameters) and not first.goal.which
    named = others[0].object and not others[0].object.pronoun
    if announces and announces.pronoun and measured and named:
        update = {"frames": tuple(others), "paraphrase": paraphrase(others)}
        return command.model_copy(update=update)
    return command


def with_near_thing(command: g.Command, done: Result | None) -> g.Command:
    """The command, in which "a bit closer" is closer to what something was put beside."""
    frame, last = command.frames[0], frames_said(done)[-1:]
    goal, beside = frame.goal, place_beside(last[0].goal) if last else None
    if len(command.frames) > 1 or not frame.dialogue or frame.action or frame.object:
        return command
    if beside is None or not isinstance(goal, g.Displace) or goal.direction != "toward":
        return command
    said = [command.text[start:end].casefold() for start, end in goal.spans]
    things = beside.reference if isinstance(beside.reference, tuple) else ()
    if len(things) != 1 or not any(
        words.split()[-1:] in (["closer"], ["nearer"]) for words in said
    ):
        return command
    nearer = goal.model_copy(update={"direction": None, "toward": by_name(things[0])})
    frame = frame.model_copy(update={"goal": nearer, "action": "move"})
    return command.model_copy(update={"frames": (frame,)})


def frames_said(result: Result | None, first: int = 0) -> list[g.Frame]:
    """The frames that were said, from one of a result's on; not what was moved out of the way."""
    return [each for each in result.frames[first:] if each not in result.aside] if result else []


def is_remark(command: g.Command) -> bool:
    """Check for what is said of a sentence before: "slower", "again", "no, the mug", "the mug?"."""
    remarks = (f for f in command.frames if f.dialogue not in (None, "undo", "stop", "thank"))
    return any(not (f.action and f.object and not f.object.pronoun) for f in remarks)


def asks_first(command: g.Command) -> bool:
    """Check for "what did you do first?"."""
    words = command.text.casefold().rstrip(" .!?").split()
    return "first" in words


def joins_last(command: g.Command) -> bool:
    """Check for a remark about one more object: "and the mug too"."""
    first = command.frames[0]
    return first.dialogue in ("same", "repeat") and first.object is not None


def corrects_object(command: g.Command) -> bool:
    """Check for "no, the mug", which is no whole command as "no, push the mug away" is."""
    first = command.frames[0]
    said = first.object is not None and not first.object.pronoun and first.goal.kind != "none"
    return first.dialogue == "correct" and bool(first.object) and not (first.action and said)


def says_something(said: g.Frame) -> bool:
    """Check for a remark that names an object, a goal, a way of doing it, or an action."""
    return bool(said.object or said.constraints or said.action) or said.goal.kind != "none"


def asked_of_last(command: g.Command, said: Result | None, done: Result | None) -> g.Command:
    """The question "why to the left?" with the command that it is about.

    Raises:
        ControlError: `nothing_before`.
    """
    (frame,) = command.frames
    last = [each for each in (*frames_said(done), *frames_said(said)) if each.action]
    if not last:
        nothing_before("there is nothing before that this could be about")
    plain = frame.model_copy(update={"query": None})
    merged = merge_frames(without_spans(last[-1]), plain)
    told = without_spans(last[-1].model_copy(update={"spans": ()}))
    if frame.object is None and without_spans(merged) != told:
        nothing_before("that was not said before, so it has no reason")
    asked = {"query": "why", "negated": frame.negated, "dialogue": None}
    return command.model_copy(update={"frames": (merged.model_copy(update=asked),)})


# What was spoken of up to a sentence, and whether "it" would be clear after that.
#
# A pronoun is in doubt where it has more than one honest meaning: after several objects that were
# handled alike, after an answer that names several, and after a name that was refused, for which
# an object that was spoken of before would be a guess.


_ONE = ("one", "ones")
_TELLING = frozenset({"left", "right", "other", "first", "last", "big", "small"})
_WORDS = re.compile(r"[^\s\-_,.;:!?]+|[,.;:!?]")
_DETERMINERS = frozenset({"her", "his", "my", "our", "that", "the", "their", "this", "your"})
_NO_OBJECT = frozenset({"direction", "side", "way"})
_REQUEST = re.compile(r"\b(?:would|could|will) you (?:please |kindly |do |mind )")
_WHICH = frozenset({"which", "what", "who"})
_NOT_FOUND = ("ambiguous_object", "no_antecedent", "not_on_table", "unknown_object")


def context_after(
    context: Context, result: Result, *, joins: bool = False, corrects: bool = False
) -> Context:
    """What was spoken of once a sentence is done or refused.

    Args:
        context: objects and results mentioned before.
        result: result of the sentence.
        joins: whether its objects join those of the sentence before ("and the mug too").
        corrects: whether they take the place of some that were not meant ("no, the mug").
    """
    frames = result.frames
    parts = (part for frame in reversed(frames) for part in parts_within(frame))
    names = [ref.id for ref in parts if isinstance(ref, g.ObjectRef) and ref.id is not None]
    asks = not _WHICH.isdisjoint(result.text.casefold().replace("'", " ").split())
    told = result.answer.objects if result.answer and asks else ()
    group = tuple(dict.fromkeys(name for frame in frames for name in names_together(frame)))
    if joins:
        group = tuple(dict.fromkeys((*context.group, *group)))
    elif len(told) > 1:
        group = told
    elif set(group) <= set(context.group):
        group = context.group
    before = [name for name in context.last if not (corrects and name in context.latest)]
    last = tuple(dict.fromkeys((*(told if len(told) == 1 else ()), *names, *before)))
    doubt, ranked = _doubt_after(result, told), _ranking_of(result)
    return replace(context, last=last, latest=tuple(names), group=group, doubt=doubt, ranked=ranked)


def _ranking_of(result: Result) -> tuple[str, ...]:
    """The property of which an answer told which of two objects has more, and both, that first."""
    told, frame = result.answer, next(iter(result.frames), None)
    if told is None or frame is None or not isinstance(frame.goal, g.Parameters):
        return ()
    both = [ref.id for ref in (frame.object, *frame.goal.than) if ref and ref.id]
    if told.query != "compare" or len(both) != 2:
        return ()
    return (frame.goal.which[0], *sorted(both, key=lambda name: name not in told.objects))


def context_of(context: Context, told: tuple[str, ...]) -> Context:
    """What was spoken of once an answer named an object."""
    return replace(context, last=tuple(dict.fromkeys((*told, *context.last)))) if told else context


def with_moved(context: Context, past: Iterable[UndoEntry], deeds: Iterable[Result]) -> Context:
    """What was moved, in that order; where nothing was done but planned, what would have been."""
    planned = (frame for deed in deeds if deed.status == "planned" for frame in deed.frames)
    names = [frame.object.id for frame in planned if frame.object and frame.object.id]
    return replace(context, moved=tuple(push.object for push in past) or tuple(names))


def with_objects_of(context: Context, command: g.Command) -> Context:
    """What was spoken of once a resolved command was asked about."""
    named = [frame.object.id for frame in command.frames if frame.object and frame.object.id]
    return replace(context, last=tuple(dict.fromkeys((*named, *context.last))), doubt=None)


def _doubt_after(result: Result, told: tuple[str, ...]) -> tuple[str, ...] | None:
    if result.status == "not_understood" and _misses_its_object(result):
        may = result.error.suggestions if result.error else ()
        return tuple(each.removeprefix("the ") for each in may if each.startswith("the "))
    done = [frame for frame in result.frames if frame not in result.aside]
    handled = tuple(dict.fromkeys(f.object.id for f in done if f.object and f.object.id))
    if len(told) > 1:
        return told
    return handled if len(handled) > 1 and are_alike(done) else None


def _misses_its_object(result: Result) -> bool:
    """Check for a refusal of what a sentence was about, and of no place beside it."""
    refused = result.error
    told = [frame for frame in result.frames if frame.object]
    if refused is not None and refused.code == "unknown_object":  # a question moves nothing
        told = [frame for frame in told if frame.query is None]
    parts = (part for frame in told if frame.object for part in parts_within(frame.object))
    spans = [whole_span(part.spans) for part in parts if isinstance(part, g.ObjectRef)]
    return refused is not None and refused.code in _NOT_FOUND and refused.span in spans


def asks(text: str) -> bool:
    """Check for a question that is no request, as "would you push the mug away?" is one."""
    return text.rstrip().endswith("?") and not _REQUEST.search(text.casefold())


def asks_which(text: str) -> bool:
    """Check for a question whose answer would be an object."""
    first, second = [*name_words(text), "", ""][:2]
    return text.rstrip().endswith("?") and first == "which" and second not in _NO_OBJECT


def tells_of_one(text: str) -> bool:
    """Check for "the right one", "heaviest thing", which mean something without its name."""
    words, (lexicon, _) = name_words(text), installed_lexicon()
    if not lexicon.words_of("SUPERLATIVE").keys().isdisjoint(words):
        return True
    return any(word in _ONE and i and words[i - 1] in _TELLING for i, word in enumerate(words))


def names_said(text: str, cell: CellDescription, models: Mapping[str, ObjectModel]) -> list[str]:
    """The objects that a text names as what it is about, the last first.

    "The mug" is one if it fits one object only; "that tall box" may be any of several; "a nice cup"
    is none.
    """
    known = names_on_table(cell.objects, models)
    names = {name_words(name) for each in known for name in each.names}
    vocabulary = {word for name in names for word in name}
    adjectives = installed_lexicon()[0].adjectives
    words = _WORDS.findall(text.casefold())
    told = list[str]()
    for start, end in _runs(words, vocabulary):
        run, before = words[start:end], words[:start]
        while before and before[-1] in adjectives:
            before.pop()
        found = find_by_name(" ".join(run), known)
        named = tuple(run) in names or not _DETERMINERS.isdisjoint(before[-2:])
        pointed = bool(before) and before[-1] in _DETERMINERS
        if named and (len(found) == 1 or pointed) and not _is_beside(" ".join([*before, ""])):
            told[:0] = [each.name for each in found]
    return list(dict.fromkeys(told))


def _runs(words: list[str], vocabulary: set[str]) -> Iterator[tuple[int, int]]:
    """Places of the longest runs of words of names; "of" may stand within one."""
    start = 0
    while start < len(words):
        end = start
        while end < len(words) and (
            words[end] in vocabulary or (end > start and words[end] == "of")
        ):
            end += 1
        last = end - (end > start and words[end - 1] == "of")
        if last > start:
            yield start, last
        start = max(end, start + 1)


def _is_beside(before: str) -> bool:
    """Check for words behind which something stands that a sentence is not about."""
    # Words before the name of something that a sentence is not about: "how far is it from the mug".
    return before.removesuffix("the ").endswith(
        ("than ", "from ", "to ", "of ", "behind ", "beside ", "near ", "touches ")
    )

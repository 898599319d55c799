"""Frames that a remark makes of those before it: again, a bit more, no, I meant the other one.

What is done with them is `nlcontrol.session.conversation`'s matter.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from grammar import paraphrase
from grammar.clauses.consistency import first_contradiction
from grammar.frames import command as g
from grammar.frames.constraints import HOW_FAR
from grammar.words.lexicon_plugins import installed_lexicon
from nlcontrol.errors import error, whole_span
from nlcontrol.references.object_names import name_words
from nlcontrol.references.reference_resolution import parts_within
from nlcontrol.session.remarks.follow_up_targets import (
    FAR_FIELDS,
    Rename,
    are_alike,
    by_name,
    followed_frames,
    frames_about,
    frames_said,
    merge_frames,
    nothing_before,
    says_something,
    stated_fields,
    without_fields,
    without_spans,
)
from nlcontrol.session.remarks.undo_frames import reversed_goal

if TYPE_CHECKING:
    from nlcontrol.results.result import Result

_WITHOUT_WAY = ("open", "close", "pour", "hand_over", "parameters")
_NOT_MEANT = re.compile(
    r"(?:not|instead of|rather than) (?:the|my|your) ([a-z ]+?)(?= but |,|\.|;|!| - |: |$)"
)
"""What a correction says is not meant."""

_AS_COMMAND = {"query": None, "event": None, "negated": False}


def meant_command(
    command: g.Command,
    said: Result | None,
    done: Result | None,
    exchange: g.Command | None = None,
) -> g.Command:
    """The command with each remark replaced by the frames that it means.

    Args:
        command: the present command.
        said: result of the last sentence; None if it was not understood.
        done: result of the last command.
        exchange: that command, if things changed places; see `exchange_of`.

    Raises:
        ControlError: `nothing_before`.
    """
    if exchange is not None and _repeats_plainly(command):
        return exchange.model_copy(update={"text": command.text})
    frames: list[g.Frame] = []
    for frame in (_with_kind_before(f, said) if f.dialogue else f for f in command.frames):
        match frame.dialogue:
            case None:
                frames.append(frame)
            case "correct":
                frames += _corrected_frames(frame, said, done, command.text)
            case "more":
                frames += _continued_frames(frame, frames, said, done)
            case remark:
                last = frames or followed_frames(frame, frames_said(said), frames_said(done))
                if frame.dialogue == "same" and _says_all(frame, last):
                    frames.append(frame.model_copy(update={"dialogue": None, "action": "move"}))
                    continue  # "the mug 10 cm to the right", "the mug next to the jar"
                last = last or nothing_before("there is nothing before that this could be about")
                frames += _FOLLOW_UPS[remark](last, frame)
    if tuple(frames) == command.frames:
        return command
    words = _words_of(frames, command.paraphrase)
    return command.model_copy(update={"frames": tuple(frames), "paraphrase": words})


def _with_kind_before(frame: g.Frame, said: Result | None) -> g.Frame:
    """A remark on "the one on the right" with the noun of what was said last."""
    ref, before = frame.object, [f.object for f in frames_said(said) if f.object]
    if ref is None or ref.text.casefold() not in ("one", "ones") or not before:
        return frame
    noun = before[-1].noun
    if not noun or noun == before[-1].id:  # called by its own name, which no other has
        return frame
    return frame.model_copy(update={"object": ref.model_copy(update={"text": noun, "noun": noun})})


def _continued_frames(
    said: g.Frame, frames: Sequence[g.Frame], asked: Result | None, done: Result | None
) -> tuple[g.Frame, ...]:
    before = frames or frames_said(done)
    if not before and said.action and said.object and stated_fields(said.goal):
        return (said.model_copy(update={"dialogue": None}),)  # "further to the left"
    if not before:  # "can you push it?", "a bit more"
        possible = [frame for frame in frames_said(asked) if frame.query == "possible"]
        before = [frame.model_copy(update=_AS_COMMAND) for frame in possible]
    before = before or nothing_before("nothing was done that could go on")
    meant, heading = frames_about(before, said), None
    moved = {last.object.id for last in meant if last.object}
    if not frames and done and done.plan and moved == {done.plan.object}:
        heading = done.steps[-1].heading
    if heading is None and any(isinstance(last.goal, g.Place) for last in meant):
        nothing_before("nothing was pushed there yet, so there is no direction to go on in")
    return tuple(continue_frame(last, said, heading) for last in meant)


def _corrected_frames(
    frame: g.Frame, said: Result | None, done: Result | None, text: str
) -> tuple[g.Frame, ...]:
    followed = followed_frames(frame, frames_said(said), frames_said(done))
    last = said if followed == frames_said(said) else done
    if last is None or not last.frames:
        if frame.action is None or frame.object is None:
            nothing_before("there is no sentence before that could be corrected")
        return (frame.model_copy(update={"dialogue": None}),)
    unresolved = last.error is not None and last.status == "not_understood"
    wrong = last.error.span if last.error and unresolved else None
    stopped = last.steps[-1].frame if last.steps else 0
    before = frames_said(last, stopped)
    if last.error is None and frame.object and len(before) > 1 and are_alike(before):
        before = before[-1:]  # "just the left one", after both
    if last.error is None and frame.object is None:
        return tuple(merge_frames(without_spans(f), frame) for f in frames_about(before, frame))
    if isinstance(frame.goal, g.Place):  # "take it and put it there", "rather in front of it"
        while len(before) > 1 and isinstance(before[0].goal, g.Lift):
            before.pop(0)
    return _with_other_named(before, frame, text) or correct_frame(before, frame, wrong)


def _with_other_named(before: Sequence[g.Frame], said: g.Frame, text: str) -> tuple[g.Frame, ...]:
    """The frames with what is meant in the place of what is not, where that is not their object.

    "Not the jar, the cup" after "put the mug next to the jar".

    Raises:
        ControlError: `nothing_before`, if what is not meant was not named.
    """
    instead, told = said.object, _NOT_MEANT.search(text.casefold())
    if instead is None or told is None:
        return ()
    wrong = set(name_words(told[1]))
    if any(frame.object and _is_called(frame.object, wrong) for frame in before):
        return ()

    def in_place(ref: g.ObjectRef) -> g.ObjectRef:
        return instead if _is_called(ref, wrong) else by_name(ref)

    said = said.model_copy(update={"object": None})
    renamed = tuple(without_spans(frame, in_place) for frame in before)
    if renamed == tuple(without_spans(frame) for frame in before):
        nothing_before(f"“{told[1]}” was not named before")
    return (merge_frames(renamed[0], said), *renamed[1:])


def _is_called(ref: g.ObjectRef, words: set[str]) -> bool:
    """Check for an object that some words may name, by what it was called or is called."""
    return words <= set(name_words(ref.text)) or words <= set(name_words(ref.id or ""))


def repeat_frames(before: Sequence[g.Frame], said: g.Frame) -> tuple[g.Frame, ...]:
    """The frames before once more, or one of them with what is said besides ("push it again").

    Raises:
        ControlError: `nothing_before`, if both together contradict each other.
    """
    if not (said.query or says_something(said)):
        return tuple(map(without_spans, before))
    if said.object and said.object.quantifier == "rest" and isinstance(before[-1].goal, g.Pour):
        last = without_spans(before[-1])
        goal = without_fields(last.goal, ("amount", "fraction", "volume", "fill"))
        return (last.model_copy(update={"goal": goal}),)
    of_one = len({frame.object and frame.object.id for frame in before}) == 1
    in_turn = of_one and said.dialogue == "same" and said.goal.kind == "none" and not said.action
    meant = list(before) if in_turn else frames_about(before, said)
    places = all(isinstance(frame.goal, g.Place) for frame in meant)
    if _says_place(said) and not (said.action or places):
        nothing_before("nothing was put anywhere, so it is not clear what to do")
    merged = [merge_frames(without_spans(f, _names_for_kept(f, said)), said) for f in meant]
    if said.object and any(map(first_contradiction, merged)):  # "… with the jar", not to be touched
        nothing_before("together with what was said before, this contradicts itself")
    if said.query is None:
        return tuple(merged)
    asked = {"query": said.query, "event": said.event, "negated": said.negated}
    return tuple(frame.model_copy(update=asked) for frame in merged)


def _says_place(said: g.Frame) -> bool:
    """Check for a place at which something is to be: of "and to the mug" it is not clear what."""
    goal = said.goal
    return isinstance(goal, g.Place) and (bool(said.object) or goal.relation == "next_to")


def _says_all(said: g.Frame, before: Sequence[g.Frame]) -> bool:
    """Check for "the mug" and where to, which nothing before it has to complete."""
    if isinstance(said.goal, g.Place):
        placed = any(isinstance(frame.goal, g.Place) for frame in before)
        points = any(isinstance(p, g.ObjectRef) and p.text == "that" for p in parts_within(said))
        return said.object is not None and not (said.action or placed or points)
    other = said.object and all(frame.goal.kind in _WITHOUT_WAY for frame in before)
    return bool((not before or other) and stated_fields(said.goal)) and not said.action


def _repeats_plainly(command: g.Command) -> bool:
    """Check for "again" and nothing besides."""
    frame = command.frames[0]
    alone = len(command.frames) == 1 and frame.dialogue == "repeat" and frame.query is None
    return alone and not says_something(frame)


def exchange_of(command: g.Command) -> g.Command | None:
    """The command by itself if things change places, so that each time other places are meant."""
    goals = [frame.goal for frame in command.frames if frame.query is None]
    if not any(isinstance(goal, g.Place) and goal.relation == "place_of" for goal in goals):
        return None
    return command.model_copy(update={"frames": tuple(map(without_spans, command.frames))})


def reversed_frames(before: Sequence[g.Frame], said: g.Frame) -> tuple[g.Frame, ...]:
    """The frames that are meant the other way, as far as is said."""
    other = (
        last.model_copy(update={"goal": reversed_goal(without_spans(last.goal))})
        for last in frames_about(before, said)
    )
    return tuple(without_spans(merge_frames(last, said)) for last in other)


def asked_as_commands(asked: Sequence[g.Frame], said: g.Frame) -> tuple[g.Frame, ...]:
    """What was asked about, to be done as far as is said besides ("do it slowly")."""
    told = (merge_frames(without_spans(frame), said) for frame in asked)
    return tuple(frame.model_copy(update=_AS_COMMAND) for frame in told)


_FOLLOW_UPS: dict[str, Callable[[Sequence[g.Frame], g.Frame], tuple[g.Frame, ...]]] = {
    "repeat": repeat_frames,
    "same": repeat_frames,
    "reverse": reversed_frames,
    "do": asked_as_commands,
}
"""Remark → the frames that it makes of those before it."""


def _words_of(frames: Sequence[g.Frame], otherwise: str) -> str:
    """Frames in plain words; other words if not everything that they say has any."""
    try:
        return ", then ".join(paraphrase(frame) for frame in frames)
    except ValueError:
        return otherwise


def continue_frame(before: g.Frame, said: g.Frame, heading: float | None) -> g.Frame:
    """The same action farther: as far as is said, else as far as it goes by default.

    Args:
        before: the frame to go on with.
        said: the remark.
        heading: direction of the last push, for a goal that is a place and reached by now.
    """
    last = without_spans(before)
    goal = last.goal
    if isinstance(goal, g.Lift):  # "higher" is no place to touch it at
        how = tuple(clause for clause in said.constraints if clause.kind != "contact")
        said = said.model_copy(update={"constraints": how})
    if said.goal.kind == "none" and said.constraints:
        return merge_frames(last, said)  # "more gently" is about the manner
    if isinstance(goal, g.Place) and heading is not None:
        goal = g.Displace(heading=heading)
    kept = tuple(c for c in last.constraints if c.kind not in HOW_FAR)
    last = last.model_copy(update={"goal": without_fields(goal, FAR_FIELDS), "constraints": kept})
    return merge_frames(last, said)


def correct_frame(
    before: Sequence[g.Frame], said: g.Frame, wrong: g.Span | None
) -> tuple[g.Frame, ...]:
    """The frames with what is said in place of what was.

    Args:
        before: the frame that is corrected, and those after it.
        said: the remark.
        wrong: where the name stood that could not be resolved, if that was the matter; the object
            that is said takes its place.
    """
    first, rest = before[0], before[1:]
    if wrong is None or said.object is None:
        of_same = _names_for_kept(first, said)
        return (
            merge_frames(without_spans(first, of_same), said),
            *(without_spans(f, of_same) for f in rest),
        )
    instead, found = said.object, []

    def in_place(ref: g.ObjectRef) -> g.ObjectRef:
        if whole_span(ref.spans) == wrong:
            found.append(ref)
            return instead
        return by_name(ref)

    renamed = [without_spans(frame, in_place) for frame in before]
    if found:
        said = said.model_copy(update={"object": None})
    return (merge_frames(renamed[0], said), *renamed[1:])


def _names_for_kept(frame: g.Frame, said: g.Frame) -> Rename:
    """Names for what is kept: what stood for the frame's object ("its") now means the one said."""
    own, instead = frame.object, said.object
    if instead is None or instead.pronoun or own is None:
        return by_name

    def rename(ref: g.ObjectRef) -> g.ObjectRef:
        stands_for_it = ref.pronoun and ref.id is not None and ref.id == own.id
        return instead if ref == own or stands_for_it else by_name(ref)

    return rename


def disambiguate_back(command: g.Command, done: Result | None) -> g.Command:
    """The command, in which "back" is said of something that the last command moved.

    By an amount, it goes back on its way; without one it may be to where it was, or to the robot.

    Raises:
        ControlError: `nothing_before`.
    """
    frame, moved = command.frames[0], frames_said(done)[-1:]
    if len(command.frames) > 1 or not isinstance(frame.goal, g.Displace):
        return command
    said = [command.text[start:end].casefold() for start, end in frame.goal.spans]
    if "back" not in said or not moved or not (frame.object and frame.object.pronoun):
        return command
    last = moved[0].goal
    if not isinstance(last, g.Displace) or last.direction in ("away", None):
        return command
    told = {key: getattr(frame.goal, key) for key in ("distance", "amount", "bound", "spans")}
    if not (frame.goal.distance or frame.goal.amount):
        nothing_before("“back” may be to where it was (“undo that”), or toward the robot")
    way = without_fields(reversed_goal(without_spans(last)), FAR_FIELDS)
    goal = way.model_copy(update=told)
    back = frame.model_copy(update={"goal": goal})
    words = _words_of([back], command.paraphrase)
    return command.model_copy(update={"frames": (back,), "paraphrase": words})


def has_verb(text: str) -> bool:
    """Check for a word that may be a verb of a command."""
    lexicon, _ = installed_lexicon()
    return not lexicon.verb_words["VERB"].keys().isdisjoint(text.casefold().split())


def sole_remark(command: g.Command) -> str | None:
    """The remark that a whole sentence is; None if it is to be carried out as frames.

    Raises:
        ControlError: `not_alone`.
    """
    kinds = [frame.dialogue or frame.query for frame in command.frames]
    if len(kinds) == 1:
        return kinds[0] if kinds[0] in ("why", "undo", "did") else None
    for frame, kind in zip(command.frames, kinds, strict=True):
        if kind in ("stop", "why", "undo", "correct", "did"):
            raise error(
                "not_alone",
                f"“{kind}” is about what was said and done before, so it is a sentence of its own",
                span=frame.spans[0] if frame.spans else None,
                suggestions=("say it when the other sentence is done",),
            )
    return None


def says_all_of(frame: g.Frame, asked: g.Frame) -> bool:
    """Check for a frame that says all that is asked about."""
    frame, asked = without_spans(frame), without_spans(asked)
    wanted = asked.goal.model_dump(exclude_defaults=True)
    return (
        frame.action == asked.action
        and asked.object in (None, frame.object)
        and asked.goal.kind in ("none", frame.goal.kind)
        and wanted.items() <= frame.goal.model_dump().items()
        and set(asked.constraints) <= set(frame.constraints)
    )

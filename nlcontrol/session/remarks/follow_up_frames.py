"""Frames that a remark makes of those before it: again, a bit more, no, I meant the other one.

What is done with them is `nlcontrol.session.conversation`'s matter.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NoReturn

from grammar import paraphrase
from grammar.clauses.consistency import first_contradiction
from grammar.frames import command as g
from grammar.frames.conflicts import HOW_FAR
from grammar.words.lexicon_plugins import installed_lexicon
from nlcontrol.errors import error, whole_span
from nlcontrol.session.remarks.merged_frames import (
    FAR_FIELDS,
    Rename,
    by_name,
    merge_frames,
    stated_fields,
    without_fields,
    without_spans,
)
from nlcontrol.session.remarks.undo_frames import reversed_goal

if TYPE_CHECKING:
    from nlcontrol.results.result import Result

_ABOUT_DEEDS = ("why", "did", "seen")
"""Questions with which nothing else can be asked the same."""


def meant_command(
    command: g.Command,
    said: Result | None,
    done: Result | None,
    exchange: g.Command | None = None,
) -> g.Command:
    """The command with each remark replaced by the frames that it means.

    Args:
        command: what is said now.
        said: what came of what was said last; None if it was not understood.
        done: what came of the last command.
        exchange: that command, if things changed places; see `exchange_of`.

    Raises:
        ControlError: `nothing_before`.
    """
    if exchange is not None and _repeats_plainly(command):
        return exchange.model_copy(update={"text": command.text})
    frames: list[g.Frame] = []
    for frame in command.frames:
        match frame.dialogue:
            case None:
                frames.append(frame)
            case "correct":
                frames += _corrected_frames(frame, said, done)
            case "more":
                frames.append(_continued_frame(frame, frames, done))
            case remark:
                last = frames or followed_frames(frame, _frames(said), _frames(done))
                last = last or nothing_before("there is nothing before that this could be about")
                frames += _FOLLOW_UPS[remark](last, frame)
    if tuple(frames) == command.frames:
        return command
    words = _words_of(frames, command.paraphrase)
    return command.model_copy(update={"frames": tuple(frames), "paraphrase": words})


def _continued_frame(said: g.Frame, frames: Sequence[g.Frame], done: Result | None) -> g.Frame:
    before = frames or _frames(done)
    if not before and said.action and said.object and stated_fields(said.goal):
        return said.model_copy(update={"dialogue": None})  # "further to the left"
    before = before or nothing_before("nothing was done that could go on")
    last, heading = latest_matching(before, said), None
    if not frames and done and done.plan:
        heading = done.steps[-1].heading
    if isinstance(last.goal, g.Place) and heading is None:
        nothing_before("nothing was pushed there yet, so there is no direction to go on in")
    return continue_frame(last, said, heading)


def _corrected_frames(
    frame: g.Frame, said: Result | None, done: Result | None
) -> tuple[g.Frame, ...]:
    followed = followed_frames(frame, _frames(said), _frames(done))
    last = said if followed == _frames(said) else done
    if last is None or not last.frames:
        if frame.action is None or frame.object is None:
            nothing_before("there is no sentence before that could be corrected")
        return (frame.model_copy(update={"dialogue": None}),)
    unresolved = last.error is not None and last.status == "not_understood"
    wrong = last.error.span if last.error and unresolved else None
    stopped = last.steps[-1].frame if last.steps else 0
    return correct_frame(_frames(last, stopped), frame, wrong)


def _frames(result: Result | None, first: int = 0) -> list[g.Frame]:
    """The frames that were said, from one of a result's on; not what was moved out of the way."""
    return [each for each in result.frames[first:] if each not in result.aside] if result else []


def repeat_frames(before: Sequence[g.Frame], said: g.Frame) -> tuple[g.Frame, ...]:
    """The frames before once more, or one of them with what is said besides ("push it again").

    Raises:
        ControlError: `nothing_before`, if both together contradict each other.
    """
    if not (said.query or says_something(said)):
        return tuple(map(without_spans, before))
    last = latest_matching(before, said)
    merged = merge_frames(without_spans(last, _names_for_kept(last, said)), said)
    if said.object and first_contradiction(merged):  # "the same with the jar", not to be touched
        nothing_before("together with what was said before, this contradicts itself")
    if said.query is None:
        return (merged,)
    asked = {"query": said.query, "event": said.event, "negated": said.negated}
    return (merged.model_copy(update=asked),)


def says_something(said: g.Frame) -> bool:
    """Check for a remark that names an object, a goal, a way of doing it, or an action."""
    return bool(said.object or said.constraints or said.action) or said.goal.kind != "none"


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


def followed_frames(
    said: g.Frame, asked: Sequence[g.Frame], done: Sequence[g.Frame]
) -> Sequence[g.Frame]:
    """The frames that a remark is about, given those said last and those of the last command."""
    told = [frame for frame in asked if frame.action]
    if said.dialogue == "do":
        told = [frame for frame in told if frame.query] or told
        return told or (done if says_something(said) else [])
    if said.query is not None:
        return told or done
    if said.dialogue == "correct":
        if not asked:  # what was not understood may have been about another object
            return done if said.object and not said.object.pronoun else asked
        return asked if _can_correct(asked[-1], said) else done
    about_deeds = said.action or said.dialogue in ("same", "reverse", "more")
    answered = [frame for frame in asked if frame.query not in _ABOUT_DEEDS]
    if said.goal.kind != "none":  # to ask how it stands is not to ask where it goes
        answered = [each for each in answered if each.action or each.goal.kind == "parameters"]
    return done if about_deeds else answered or done


def _can_correct(last: g.Frame, said: g.Frame) -> bool:
    """Check for a frame in which what a remark says can take the place of something."""
    if last.action is not None:
        return last.query is None or said.action is None
    asks = last.query == "value" and last.goal.kind == "parameters"  # not how it came to stand
    return asks and said.goal.kind == "none" and not said.constraints


def reversed_frames(before: Sequence[g.Frame], said: g.Frame) -> tuple[g.Frame, ...]:
    """The last frame the other way, as far as is said."""
    last = latest_matching(before, said)
    goal = reversed_goal(without_spans(last.goal))
    merged = merge_frames(last.model_copy(update={"goal": goal}), said)
    return (without_spans(merged),)


def asked_as_commands(asked: Sequence[g.Frame], said: g.Frame) -> tuple[g.Frame, ...]:
    """What was asked about, to be done as far as is said besides ("do it slowly")."""
    plain = {"query": None, "event": None, "negated": False}
    told = (merge_frames(without_spans(frame), said) for frame in asked)
    return tuple(frame.model_copy(update=plain) for frame in told)


_FOLLOW_UPS: dict[str, Callable[[Sequence[g.Frame], g.Frame], tuple[g.Frame, ...]]] = {
    "repeat": repeat_frames,
    "same": repeat_frames,
    "reverse": reversed_frames,
    "do": asked_as_commands,
}
"""Remark → the frames that it makes of those before it."""


def nothing_before(message: str) -> NoReturn:
    """Refuse a remark on what was not said or done.

    Raises:
        ControlError: `nothing_before`.
    """
    raise error(
        "nothing_before", message, suggestions=("say first what to do, as “push the box away”",)
    )


def _words_of(frames: Sequence[g.Frame], otherwise: str) -> str:
    """Frames in plain words; other words if not everything that they say has any."""
    try:
        return ", then ".join(paraphrase(frame) for frame in frames)
    except ValueError:
        return otherwise


def latest_matching(before: Sequence[g.Frame], said: g.Frame) -> g.Frame:
    """The frame that a remark is about: the last with its action, if it names one that fits."""
    same = [frame for frame in before if frame.action == said.action]
    return (same or list(before))[-1]


def continue_frame(before: g.Frame, said: g.Frame, heading: float | None) -> g.Frame:
    """The same action farther: as far as is said, else as far as it goes by default.

    Args:
        before: the frame to go on with.
        said: the remark.
        heading: in which the object was pushed, for a goal that is a place and reached by now.
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


def leaves_object_open(command: g.Command) -> bool:
    """Check for a remark that takes its object from a sentence before, whichever that is."""
    remarks = (f for f in command.frames if f.dialogue not in (None, "undo", "stop", "thank"))
    return any(f.action is None and (f.object is None or f.object.pronoun) for f in remarks)


def has_verb(text: str) -> bool:
    """Check for a word that may be a verb of a command."""
    lexicon, _ = installed_lexicon()
    return not lexicon.verb_words["VERB"].keys().isdisjoint(text.casefold().split())


def asks_further(command: g.Command) -> bool:
    """Check for a question that goes on with one before: "and the mug?"."""
    first = command.frames[0]
    asked = command.text.rstrip().endswith("?")
    return asked and first.dialogue == "repeat" and first.query is None


def joins_last(command: g.Command) -> bool:
    """Check for a remark about one more object: "and the mug too"."""
    first = command.frames[0]
    return first.dialogue in ("same", "repeat") and first.object is not None


def sole_remark(command: g.Command) -> str | None:
    """The remark that a whole sentence is; None if it is to be carried out as frames.

    Raises:
        ControlError: `not_alone`.
    """
    kinds = [frame.dialogue or frame.query for frame in command.frames]
    if len(kinds) == 1:
        return kinds[0] if kinds[0] in ("stop", "why", "undo", "did", "thank") else None
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

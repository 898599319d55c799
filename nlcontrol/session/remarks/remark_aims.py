"""Which frames a remark is about: those asked last or those done, one of them or all.

"Slowly" is about all that was said; "6 cm" too, if the same was said of each object; where several
went different ways, it is asked back.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NoReturn

from grammar import paraphrase
from grammar.frames import command as g
from nlcontrol.errors import error
from nlcontrol.session.remarks.merged_frames import (
    are_alike,
    by_name,
    merge_frames,
    place_beside,
    without_spans,
)
from nlcontrol.text_format import enumeration

if TYPE_CHECKING:
    from nlcontrol.results.result import Result

_ABOUT_DEEDS = ("why", "did", "seen")
"""Questions with which nothing else can be asked the same."""

_NEARER = (["closer"], ["nearer"])


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
    answered = [frame for frame in asked if frame.query not in _ABOUT_DEEDS]
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
        nothing_before(f"it is not clear whether {enumeration([*objects], 'or')} is meant")
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
    if len(things) != 1 or not any(words.split()[-1:] in _NEARER for words in said):
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

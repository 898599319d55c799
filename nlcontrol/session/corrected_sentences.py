"""Whole sentences in place of one that was refused or not understood, by what its error suggests.

A suggestion is a phrase for people: "up to 69 cm would do". Here it becomes the remark that a
person would make ("no, 69 cm"), is put into the frames as a conversation does that, and the frames
are said in full: "push the ice tea box away by 69 cm". What the language has no words for is left
to people.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from typing import TYPE_CHECKING

import grammar
from nlcontrol.errors import ControlError
from nlcontrol.results.result import result_with
from nlcontrol.session.follow_up_frames import correct_frame, without_spans

if TYPE_CHECKING:
    from grammar.frames.command import Command, Frame, Span
    from nlcontrol.errors import ErrorInfo
    from nlcontrol.results.result import Result

    Parse = Callable[[str], Command]

MOST = 3
"""Sentences for one error."""

REMARKS: tuple[tuple[str, str], ...] = (
    (r"up to (.+) would do", r"no, \1"),
    (r"(at .+ cm/s)", r"no, \1"),
    (r"allow (.+ N)", r"no, with at most \1"),
    (r"allow (.+ s)", r"no, in at most \1"),
    (r"ask for no more than (.+ N)", r"no, with at least \1"),
    (r"pour up to ([^,]+ ml).*", r"no, pour \1 of it"),
    (r"say “(.+)”, or leave it out", r"no, \1"),
    (r"(?:push|pull|move|turn|tilt|topple) it (.+)", r"no, \1"),
)
"""Suggestions of a change, and the remark that asks for it."""

BEFORE = (r"(.+) first", r"(put .+ down)(?:,.*)?")
"""Suggestions of what is to be done before."""

LEFT_OUT = r"leave (?:out .+|that out)"
"""Suggestions to leave out the words that the error is about."""

_OTHER_NAMES = ("ambiguous_object", "unknown_object")


def result_with_corrections(result: Result, parse: Parse) -> Result:
    """The result with sentences that would do in place of the one that was said."""
    if result.error is None:
        return result
    say = corrected_sentences(parse, result)
    return result_with(result, error=result.error.model_copy(update={"say": say}))


def corrected_sentences(parse: Parse, result: Result) -> tuple[str, ...]:
    """Sentences that would do in place of one that led to an error; none if that is not known.

    Args:
        parse: reads a sentence; it raises a `ControlError` if it is not understood.
        result: of the sentence; what was carried out already is not said again.
    """
    info = result.error
    if info is None or len(info.suggestions) > MOST:
        return ()  # of everything that is known nothing is meant more than the rest
    begun = result.steps[-1].frame if result.steps else 0
    frames = result.frames[begun:]
    found = itertools.chain(
        _from_frames(parse, info, frames) if frames else (),
        _from_words(parse, info, result.text, is_read=bool(frames)) if not result.steps else (),
    )
    sentences = dict.fromkeys(_in_words(parse, found))
    return tuple(sentences)[:MOST]


def error_with_corrections(info: ErrorInfo, text: str, parse: Parse) -> ErrorInfo:
    """The error of a sentence that could not be read, with sentences that can."""
    found = _from_words(parse, info, text, is_read=False) if len(info.suggestions) <= MOST else ()
    sentences = dict.fromkeys(_in_words(parse, found))
    return info.model_copy(update={"say": tuple(sentences)[:MOST]})


def _in_words(parse: Parse, found: Iterable[tuple[Frame, ...]]) -> Iterator[str]:
    """The frames that the language has words for, said so that they are read again."""
    for frames in found:
        with suppress(ControlError, ValueError):
            said = grammar.paraphrase(frames)
            parse(said)
            yield said


def _from_frames(
    parse: Parse, info: ErrorInfo, frames: tuple[Frame, ...]
) -> Iterator[tuple[Frame, ...]]:
    if info.code in _OTHER_NAMES:
        yield from _with_other_names(parse, info, frames)
        return
    for suggestion in info.suggestions:
        with suppress(ControlError):
            if re.fullmatch(LEFT_OUT, suggestion):
                yield from _without_words(frames, info.span)
            elif remark := _first_match(REMARKS, suggestion):
                yield _corrected(parse, remark, frames)
            elif before := _first_match([(each, r"\1") for each in BEFORE], suggestion):
                yield (*parse(before).frames, *map(without_spans, frames))


def _with_other_names(
    parse: Parse, info: ErrorInfo, frames: tuple[Frame, ...]
) -> Iterator[tuple[Frame, ...]]:
    """The frames with the object that may be meant."""
    for suggestion in info.suggestions:
        name = _meant_words(suggestion)
        # What else stands on the table is meant only if the name fits it, or nearly so.
        if re.fullmatch(LEFT_OUT, suggestion) or (
            name == suggestion and info.code != "ambiguous_object"
        ):
            continue
        name = name.removeprefix("the ")
        with suppress(ControlError):
            yield _corrected(parse, f'no, the "{name}"', frames, info.span)


def _first_match(table: Iterable[tuple[str, str]], suggestion: str) -> str | None:
    for pattern, said in table:
        if found := re.fullmatch(pattern, suggestion):
            return found.expand(said)
    return None


def _corrected(
    parse: Parse, remark: str, frames: tuple[Frame, ...], wrong: Span | None = None
) -> tuple[Frame, ...]:
    """The frames with what a remark says in place of what was."""
    said = parse(remark).frames[0].model_copy(update={"dialogue": None})
    # "Pour 200 ml of it" is about the object that was named.
    if said.object is not None and said.object.pronoun:
        said = said.model_copy(update={"object": None})
    return correct_frame(frames, said, wrong)


def _without_words(frames: tuple[Frame, ...], span: Span | None) -> Iterator[tuple[Frame, ...]]:
    """The frames without the clauses that stand in a place of the sentence."""
    first, rest = frames[0], map(without_spans, frames[1:])
    kept = tuple(
        clause
        for clause in first.constraints
        if span is None or not any(span[0] <= a and b <= span[1] for a, b in clause.spans)
    )
    if len(kept) < len(first.constraints):
        yield (without_spans(first.model_copy(update={"constraints": kept})), *rest)


def _from_words(
    parse: Parse, info: ErrorInfo, text: str, *, is_read: bool
) -> Iterator[tuple[Frame, ...]]:
    """The sentence without the words in question, or if it is not read at all, with others."""
    if info.span is None:
        return
    start, end = info.span
    for suggestion in info.suggestions:
        left_out = re.fullmatch(LEFT_OUT, suggestion)
        if is_read and not left_out:
            continue
        instead = "" if left_out else _meant_words(suggestion)
        with suppress(ControlError):
            yield parse(f"{text[:start]}{instead}{text[end:]}").frames


def _meant_words(suggestion: str) -> str:
    """The words in quotes, if there are any: of "did you mean 'push'?" the verb."""
    quoted = re.search(r"[“\"'](.+)[”\"']", suggestion)
    return quoted[1] if quoted else suggestion

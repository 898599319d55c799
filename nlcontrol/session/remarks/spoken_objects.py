"""What was spoken of up to a sentence, and whether "it" would be clear after that.

A pronoun is in doubt where it has more than one honest meaning: after several objects that were
handled alike, after an answer that names several, and after a name that was refused, for which an
object that was spoken of before would be a guess.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from grammar.frames import command as g
from grammar.words.lexicon_plugins import installed_lexicon
from nlcontrol.errors import whole_span
from nlcontrol.references.object_names import find_by_name, name_words, names_on_table
from nlcontrol.references.reference_resolution import Context, names_together, parts_within
from nlcontrol.session.remarks.merged_frames import are_alike

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from nlcontrol.session.remarks.undo_frames import PastPush
    from objectmodels import ObjectModel
    from sim.robots.cell_description import CellDescription

_BESIDE = ("than ", "from ", "to ", "of ", "behind ", "beside ", "near ", "touches ")
"""Words before the name of something that a sentence is not about: "how far is it from the mug"."""

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
        context: what was spoken of before.
        result: what came of the sentence.
        joins: whether its objects join those of the sentence before ("and the mug too").
        corrects: whether they take the place of some that were not meant ("no, the mug").
    """
    frames = result.frames
    parts = (part for frame in reversed(frames) for part in parts_within(frame))
    names = [ref.id for ref in parts if isinstance(ref, g.ObjectRef) and ref.id is not None]
    told = _told_objects(result)
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


def with_moved(context: Context, past: Iterable[PastPush], deeds: Iterable[Result]) -> Context:
    """What was moved, in that order; where nothing was done but planned, what would have been."""
    planned = (frame for deed in deeds if deed.status == "planned" for frame in deed.frames)
    names = [frame.object.id for frame in planned if frame.object and frame.object.id]
    return replace(context, moved=tuple(push.object for push in past) or tuple(names))


def with_objects_of(context: Context, command: g.Command) -> Context:
    """What was spoken of once a resolved command was asked about."""
    named = [frame.object.id for frame in command.frames if frame.object and frame.object.id]
    return replace(context, last=tuple(dict.fromkeys((*named, *context.last))), doubt=None)


def _told_objects(result: Result) -> tuple[str, ...]:
    """What the answer to a question with "which" names."""
    asks = not _WHICH.isdisjoint(result.text.casefold().replace("'", " ").split())
    return result.answer.objects if result.answer and asks else ()


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
    return before.removesuffix("the ").endswith(_BESIDE)

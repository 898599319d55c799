"""Sense of frames that no sentence gave: they are said in words, and the parser reads those.

A frame makes sense if its words are read back as the same frame. So what the parser keeps (what
contradicts what, which clauses go together, units and ranges) holds for frames as well, and the
paraphrase that a person is shown says all that will be done.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple, TypeVar

from pydantic import BaseModel, ValidationError

from grammar.errors import ParseError
from grammar.frames.command import Frame
from grammar.paraphrasing.command_wording import paraphrase
from grammar.parser import Parser

_UNSAID = ("spans", "id")
"""Fields that words do not say: the words themselves, and the object that they mean."""

Part = TypeVar("Part", bound=BaseModel)
Path = tuple[str | int, ...]


class _Objection(NamedTuple):
    code: str
    message: str
    place: Path = ()


def sensible_frames(frames: Sequence[Frame], parser: Parser) -> tuple[Frame, ...]:
    """The frames as their words are read back, with the spans and ids that they came with.

    Raises:
        ParseError: with the `path` of what makes no sense; `bad_frame` if the language cannot say
            it, else the code that a sentence would get.
    """
    found: list[Frame] = []
    for index, frame in enumerate(frames):
        before = tuple(frames[max(0, index - 1) : index])
        read = _frame_read_back(frame, before, parser)
        if isinstance(read, _Objection):
            raise _error(read, frame, before, parser, index)
        found.append(_with_unsaid(read, frame))
    return tuple(found)


def _frame_read_back(frame: Frame, before: tuple[Frame, ...], parser: Parser) -> Frame | _Objection:
    """The frame that the words behind those of the frame before it are read as."""
    try:
        words = paraphrase((*before, frame), parser.lexicon)
    except ValueError as raised:
        return _Objection("bad_frame", str(raised))
    try:
        *others, read = parser.parse(words).frames
    except ParseError as raised:
        return _Objection(raised.code, raised.message)
    if len(others) != len(before):
        return _Objection("bad_frame", f"in words that is several commands, “{words}”")
    differences = _differences(frame.model_dump(mode="json"), read.model_dump(mode="json"))
    for place, meant in differences:
        message = f"in words that is “{words}”, where it is {_short(meant)}"
        return _Objection("bad_frame", message, place)
    return read


def _differences(given: Any, read: Any, place: Path = ()) -> Iterator[tuple[Path, Any]]:
    """Each place where two frames as JSON differ, with what is read there."""
    if isinstance(given, dict) and isinstance(read, dict) and given.keys() == read.keys():
        for key, value in given.items():
            if key in _UNSAID or (key == "noun" and value in ("", given["text"])):
                continue  # a noun says no more than its text
            yield from _differences(value, read[key], (*place, key))
    elif isinstance(given, list) and isinstance(read, list) and len(given) == len(read):
        for i, (one, other) in enumerate(zip(given, read, strict=True)):
            yield from _differences(one, other, (*place, i))
    elif _folded(given) != _folded(read):
        yield place, read


def _folded(value: Any) -> Any:
    return " ".join(value.casefold().split()) if isinstance(value, str) else value


def _with_unsaid(read: Part, given: Part) -> Part:
    """The part that was read, with what words do not say as it was given."""
    changed: dict[str, Any] = {}
    for key in type(read).model_fields:
        value, own = getattr(read, key), getattr(given, key)
        if key in _UNSAID:
            changed[key] = own
        elif isinstance(value, BaseModel):
            changed[key] = _with_unsaid(value, own)
        elif isinstance(value, tuple) and any(isinstance(v, BaseModel) for v in value):
            changed[key] = tuple(map(_with_unsaid, value, own))
    return read.model_copy(update=changed)


# --- what makes no sense -----------------------------------------------------------------------


def _error(
    objection: _Objection, frame: Frame, before: tuple[Frame, ...], parser: Parser, index: int
) -> ParseError:
    data = frame.model_dump(mode="json")
    cure = next(_cures(data, before, parser), None)
    place = ("frames", index, *(objection.place or cure or ()))
    found = _short(_value_at({"frames": {index: data}}, place))
    hint = "docs/frames.md has an example of every kind"
    if cure is not None:
        hint = f"leave out {path_text(('frames', index, *cure))}"
    return ParseError(
        objection.code,
        f"found {found}, which makes no sense there: {objection.message}",
        None,
        (hint,),
        path=path_text(place),
    )


def _cures(data: dict[str, Any], before: tuple[Frame, ...], parser: Parser) -> Iterator[Path]:
    """Each part without which a frame makes sense, the last and smallest first."""
    whole = Frame.model_validate(data)
    for place in reversed(list(_places(data))):
        rest = copy.deepcopy(data)
        *outer, last = place
        del _value_at(rest, outer)[last]
        try:
            left = Frame.model_validate(rest)
        except ValidationError:
            continue
        if left != whole and isinstance(_frame_read_back(left, before, parser), Frame):
            yield place


def _places(value: Any, place: Path = ()) -> Iterator[Path]:
    """The place of every value within a document, each before those within it."""
    inner = value.items() if isinstance(value, dict) else enumerate(value)
    for key, part in inner:
        if key not in _UNSAID:
            yield (*place, key)
            if isinstance(part, dict | list):
                yield from _places(part, (*place, key))


def _value_at(value: Any, place: Sequence[str | int]) -> Any:
    for key in place:
        value = value[key]
    return value


def path_text(place: Sequence[str | int]) -> str:
    """A place in a document, as in `frames[0].goal.distance`."""
    steps = (f"[{key}]" if isinstance(key, int) else f".{key}" for key in place)
    return "".join(steps).removeprefix(".")


def _short(value: Any) -> str:
    if isinstance(value, dict):
        value = {key: part for key, part in value.items() if part not in (None, [], "")}
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."

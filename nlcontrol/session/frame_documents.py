"""Frames that others wrote, a language model or a speech front end: from JSON to a command.

A document is what `parse --json` answers, `text` and `paraphrase` left out or not, or a list of
frames alone. The paraphrase is always made anew, since it is what a person is shown. Without a
text the paraphrase stands for it, and spans, which would be places in the text, are left out.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BaseModel, ValidationError

from grammar.frame_validation import path_text, sensible_frames
from grammar.frames.command import Command, Frame
from grammar.paraphrasing.command_wording import paraphrase
from nlcontrol.argument_types import ReadByOwnRules
from nlcontrol.errors import ControlError, ErrorInfo, known_errors_raised
from nlcontrol.json_document import SCHEMA_VERSION, is_readable
from nlcontrol.references.reference_resolution import parts_within
from nlcontrol.session.remarks.follow_up_targets import without_spans
from nlcontrol.text_format import encodable_text
from objectmodels.errors import suggest
from objectmodels.files.yaml_documents import LIMITS, classes_in, read_bytes, short_text

if TYPE_CHECKING:
    from grammar.parser import Parser

Frames = Annotated[
    Command | Mapping[str, Any] | Sequence[Frame | Mapping[str, Any]], ReadByOwnRules("frames")
]
"""Frames as a program has them: a command, its JSON, or a list of frames or of their JSON."""

MOST_FRAMES = 50


def read_frames(path: Path) -> Any:
    """JSON in a file, or in standard input for the path `-`.

    Raises:
        ControlError: `unreadable_file`, or `bad_frame` if it is no JSON.
    """
    if str(path) == "-":
        most = int(LIMITS["frames_file"].most)
        content = sys.stdin.buffer.read(most + 1)
        if len(content) > most:
            raise _bad_frame("", f"found more than {most} bytes", "say less at once")
    else:
        with known_errors_raised():
            content = read_bytes(path, "frames_file")
    return frames_of_json(content)


def frames_of_json(text: str | bytes) -> Any:
    """JSON in a text.

    Raises:
        ControlError: `bad_frame`.
    """
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as raised:
        raise _bad_frame("", f"this is no JSON document: {raised}") from raised


def text_of(said: str | Frames) -> str:
    """A sentence, or the text that came with frames; "" if none did."""
    text = said.get("text") if isinstance(said, Mapping) else getattr(said, "text", said)
    return encodable_text(text) if isinstance(text, str) else ""


def command_of(said: str | Frames, parser: Parser, before: Sequence[str] | None = None) -> Command:
    """The command that a sentence is, or that frames are once they are found to make sense.

    Args:
        said: the sentence or the frames.
        parser: parser of sentences.
        before: sentences said before, the last first; see `grammar.parser.Parser.parse`.

    Raises:
        ControlError: with the place in the document; `bad_frame` if it has not the form of frames
            or no words say it, else the code that a sentence of this sense would get.
    """
    text = text_of(said)
    if isinstance(said, str):
        with known_errors_raised():
            return parser.parse(text, before)
    try:
        command = _validated_command(_as_json(said))
        if not text:
            kept = tuple(without_spans(f, lambda ref: ref) for f in command.frames)
            command = command.model_copy(update={"frames": kept, "asides": ()})
        spans = [
            (f"frames[{index}]", span)
            for index, frame in enumerate(command.frames)
            for part in parts_within(frame)
            for span in getattr(part, "spans", ())
        ]
        for path, (start, end) in (*spans, *(("asides", span) for span in command.asides)):
            if not 0 <= start < end <= len(text):
                message = f"found span {[start, end]}, expected a place in the text"
                hint = f"spans lie within 0 and {len(text)}; they may be left out"
                raise _bad_frame(path, message, hint)
        with known_errors_raised():
            said = sensible_frames(command.frames, parser)
    except RecursionError as raised:
        raise _bad_frame("frames", "the parts stand too deep inside each other") from raised
    words = paraphrase(said, parser.lexicon)
    return Command(text=text or words, frames=said, paraphrase=words, asides=command.asides)


def _as_json(frames: Any) -> dict[str, Any]:
    """A document with nothing but what a command has."""
    if isinstance(frames, Command):
        frames = {"text": frames.text, "frames": frames.frames, "asides": frames.asides}
    elif not isinstance(frames, Mapping):
        frames = {"frames": frames}
    version = frames.get("schema_version", SCHEMA_VERSION)
    if not isinstance(version, str) or not is_readable(version):
        message = f"found {short_text(version)}, expected version {SCHEMA_VERSION}"
        raise _bad_frame("schema_version", message, "write the frames in this version's form")
    document = {key: v for key, v in frames.items() if key not in ("schema_version", "ok")}
    said = document.get("frames")
    if isinstance(said, list | tuple):
        document["frames"] = [
            frame.model_dump(mode="json") if isinstance(frame, Frame) else frame for frame in said
        ]
    for key in ("text", "paraphrase"):
        document[key] = "" if document.get(key) is None else document[key]
    return document


def _validated_command(document: dict[str, Any]) -> Command:
    try:
        command = Command.model_validate(document)
    except ValidationError as raised:
        raise _fault(raised, document) from raised
    if not 1 <= len(command.frames) <= MOST_FRAMES:
        message = f"found {len(command.frames)} frames, expected 1 to {MOST_FRAMES}"
        raise _bad_frame("frames", message, "give a frame for each thing that is to be done")
    return command


def _bad_frame(path: str, message: str, *suggestions: str) -> ControlError:
    info = ErrorInfo(
        code="bad_frame",
        message=message,
        path=path or None,
        suggestions=suggestions
        or ("docs/frames.md has every kind and field, `nlcontrol schema` their JSON schema",),
        family="sentence",
    )
    return ControlError(info)


def _fault(raised: ValidationError, document: dict[str, Any]) -> ControlError:
    """The complaint that helps most: of an unknown key, then of what lies deepest."""
    complaints = raised.errors(include_url=False)
    chosen = min(
        complaints,
        key=lambda c: (
            c["type"] != "extra_forbidden",
            -len(_place(c["loc"], document)),
            c["type"] != "literal_error",
        ),
    )
    kind, context = chosen["type"], chosen.get("ctx", {})
    place = _place(chosen["loc"], document)
    if kind == "missing":
        place = (*place, chosen["loc"][-1])
        return _bad_frame(path_text(place), "found nothing, expected this key")
    if kind == "extra_forbidden":
        known = _keys_at(chosen["loc"])
        return _not_one_of(place, str(place[-1]), known, "a key of this part")
    if kind == "union_tag_not_found":
        return _bad_frame(path_text((*place, "kind")), "found nothing, expected a kind")
    names = re.findall(r"'([^']*)'", context.get("expected_tags") or context.get("expected") or "")
    if kind == "union_tag_invalid":
        return _not_one_of((*place, "kind"), str(context["tag"]), names, "a kind")
    if names:
        return _not_one_of(place, chosen["input"], names, "one of them")
    expected = chosen["msg"].removeprefix("Value error, ").removeprefix("Input should be ")
    for python, written in (("a valid tuple", "a list"), (r"a valid dict\w*.*", "an object")):
        expected = re.sub(python, written, expected)
    found = short_text(chosen["input"])
    return _bad_frame(path_text(place), f"found {found}, expected {expected}")


def _not_one_of(
    place: tuple[str | int, ...], found: Any, names: Sequence[str], what: str
) -> ControlError:
    message = f"found {short_text(found)}, expected {what}: {', '.join(names)}"
    meant = suggest(found, names) if isinstance(found, str) else ()
    hints = tuple(f"did you mean '{name}'?" for name in meant[:1])
    return _bad_frame(path_text(place), message, *hints)


def _place(loc: tuple[str | int, ...], document: Any) -> tuple[str | int, ...]:
    """The place of a complaint in the document, without the names of unions' members."""
    place: list[str | int] = []
    for key in loc:
        try:
            document = document[key]
        except (TypeError, LookupError):
            continue
        place.append(key)
    return tuple(place)


def _keys_at(loc: tuple[str | int, ...]) -> list[str]:
    """Keys of the part in which a complaint's last key stands."""
    found: list[type[BaseModel]] = [Command]
    for key in loc[:-1]:
        named = [c for c in found if key in (c.__name__, _kind(c))]
        inner = [
            part
            for c in found
            if key in c.model_fields
            for part in classes_in(c.model_fields[str(key)].annotation)
        ]
        found = named or inner or found
    return [field.alias or name for c in found for name, field in c.model_fields.items()]


def _kind(part: type[BaseModel]) -> Any:
    return part.model_fields["kind"].default if "kind" in part.model_fields else None

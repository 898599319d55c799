"""Server-sent events in a stream of bytes, as the HTML standard says (section 9.2.6)."""

from __future__ import annotations

import codecs
import io
from collections.abc import Iterable, Iterator
from typing import NamedTuple


class StreamedEvent(NamedTuple):
    """An event of a stream.

    Attributes:
        id: the last that the stream gave, "" if none.
        event: its type.
        data: its text.
    """

    id: str
    event: str
    data: str


def streamed_events(chunks: Iterable[bytes]) -> Iterator[StreamedEvent]:
    """The events of a stream as they come; one that is cut off in its midst is none."""
    identity, kind, data = "", "", list[str]()
    for line in _lines(chunks):
        if not line:
            if data:
                yield StreamedEvent(identity, kind or "message", "\n".join(data))
            kind, data = "", []
            continue
        key, _, value = line.partition(":")
        value = value.removeprefix(" ")
        match key:
            case "id" if "\0" not in value:
                identity = value
            case "event":
                kind = value
            case "data":
                data.append(value)


def _lines(chunks: Iterable[bytes]) -> Iterator[str]:
    """Whole lines; only what the standard names ends one, and no other mark that Unicode knows."""
    text = codecs.getincrementaldecoder("utf-8-sig")("replace")
    newlines = io.IncrementalNewlineDecoder(text, translate=True)
    rest = ""
    for chunk in chunks:
        *whole, rest = (rest + newlines.decode(chunk)).split("\n")
        yield from whole

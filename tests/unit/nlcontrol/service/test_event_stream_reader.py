"""Server-sent events are read as the standard says, however the bytes are cut."""

from __future__ import annotations

import pytest

from nlcontrol.service.remote_session import StreamedEvent, streamed_events

STREAM = (
    b"\xef\xbb\xbf: heartbeat\r\n\r\n"
    b'id: 1\r\nevent: phase\r\ndata: {"a":\r\ndata: 1}\r\n\r\n'
    b"data:second\nid:2\n\n"
    b"event: nothing\n\n"
    b"retry: 100\rdata:  two  spaces\r\r"
    b"id: bad\0id\ndata\n\n"
    + "data: a\u2028b\u0085c\x0bd\x1ce\n\n".encode()
    + b"id: 9\ndata: cut off"
)
EVENTS = [
    StreamedEvent("1", "phase", '{"a":\n1}'),
    StreamedEvent("2", "message", "second"),
    StreamedEvent("2", "message", " two  spaces"),
    StreamedEvent("2", "message", ""),
    StreamedEvent("2", "message", "a\u2028b\u0085c\x0bd\x1ce"),
]


@pytest.mark.parametrize("size", [1, 2, 3, 7, 1000])
def test_events_do_not_depend_on_how_the_bytes_are_cut(size: int) -> None:
    chunks = [STREAM[at : at + size] for at in range(0, len(STREAM), size)]
    assert list(streamed_events(chunks)) == EVENTS


def test_an_event_is_told_before_the_next_bytes_come() -> None:
    def chunks() -> object:
        yield b"data: now\n\n"
        raise AssertionError("asked for more")

    assert next(streamed_events(chunks())) == StreamedEvent("", "message", "now")  # type: ignore[arg-type]

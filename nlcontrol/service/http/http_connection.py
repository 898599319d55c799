"""A connection of the server: it has so long to say what it wants, and gives way if it does not.

A connection that has not sent the whole head of a request costs a descriptor and nothing else. It
is closed when its time is over; in a full house the one that has waited longest is closed for one
that comes, so that who asks at once is always heard.
"""

from __future__ import annotations

import asyncio

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

from nlcontrol.errors import ErrorInfo
from nlcontrol.service.http.problem_documents import MEDIA_TYPE, problem_of

HEAD_TIME = 10.0
"""Time in which the head of a request has to arrive, and for which a connection may idle [s]."""


class HttpConnection(H11Protocol):
    """A connection; see `connection_class`.

    Attributes:
        most: connections at once.
        head_time: in which it has to say what it wants [s].
        waits_since: time since which no request of it is under way, on the clock of the loop [s].
    """

    most = 1000
    head_time = HEAD_TIME
    waits_since = 0.0
    _timer: asyncio.TimerHandle | None = None

    @property
    def waits(self) -> bool:
        """No request of it is under way."""
        return self.cycle is None or self.cycle.response_complete

    @property
    def is_open(self) -> bool:
        """Nobody has ended it."""
        return not self.transport.is_closing()

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Takes a place, that of another one if all are taken."""
        super().connection_made(transport)
        self._watch()
        there = [c for c in self.connections if isinstance(c, HttpConnection) and c.is_open]
        if len(there) > self.most:
            waiting = [c for c in there if c.waits]
            min(waiting, key=lambda c: c.waits_since).transport.abort()

    def data_received(self, data: bytes) -> None:
        """Reads on; with the end of a head a request is under way."""
        super().data_received(data)
        self._watch()

    def on_response_complete(self) -> None:
        """Waits for the next request."""
        super().on_response_complete()
        self._watch()

    def connection_lost(self, exc: Exception | None) -> None:
        """Gives the place back."""
        self._stop_watching()
        super().connection_lost(exc)

    def send_400_response(self, msg: str) -> None:
        """Refuses what is no HTTP, with a problem document as all else."""
        hint = "send a request of HTTP/1.1, its head within 32 kB"
        info = ErrorInfo(code="bad_request", message=msg, suggestions=(hint,))
        body = problem_of(info, status=400).model_dump_json(exclude_defaults=True).encode()
        headers = [
            ("content-type", MEDIA_TYPE),
            ("content-length", str(len(body))),
            ("connection", "close"),
        ]
        for event in (
            h11.Response(status_code=400, headers=headers, reason=b"Bad Request"),
            h11.Data(data=body),
            h11.EndOfMessage(),
        ):
            self.transport.write(self.conn.send(event) or b"")
        self.transport.close()

    def _watch(self) -> None:
        """Counts the time for which nothing is under way."""
        if not self.waits:
            self._stop_watching()
        elif self._timer is None:
            self.waits_since = self.loop.time()
            self._timer = self.loop.call_later(self.head_time, self.transport.abort)

    def _stop_watching(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None


def connection_class(most: int, head_time: float = HEAD_TIME) -> type[HttpConnection]:
    """The class of the connections of one server.

    Args:
        most: connections at once.
        head_time: in which each has to say what it wants [s].
    """
    return type("OwnConnection", (HttpConnection,), {"most": most, "head_time": head_time})

"""The web server: a socket, the application on it, and an end in order."""

from __future__ import annotations

import asyncio
import json
import logging
import socket
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from ipaddress import ip_address
from typing import TYPE_CHECKING

import h11
import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol

from nlcontrol.errors import ErrorInfo, error
from nlcontrol.interruption import SIGNALS
from nlcontrol.service.http.problem_documents import MEDIA_TYPE, problem_of
from nlcontrol.service.http.service_app import service_app

if TYPE_CHECKING:
    from nlcontrol.service.http.request_guard import BrowserLogin
    from nlcontrol.service.http.responses import HttpSettings
    from nlcontrol.service.planning_service import PlanningService


# A connection of the server: it has so long to say what it wants, and gives way if it does not.
#
# A connection that has not sent the whole head of a request costs a descriptor and nothing else. It
# is closed when its time is over; in a full house the one that has waited longest is closed for one
# that comes, so that who asks at once is always heard.


HEAD_TIME = 10.0
"""Time in which the head of a request has to arrive, and for which a connection may idle [s]."""


class HttpConnection(H11Protocol):
    """A connection; see `connection_class`.

    Attributes:
        most: connections at once.
        head_time: longest time for the head of a request [s].
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
        head_time: longest time for the head of each request [s].
    """
    return type("OwnConnection", (HttpConnection,), {"most": most, "head_time": head_time})


_BACKLOG = 128
_HEADER_BYTES = 32 * 1024


class _Server(uvicorn.Server):
    """A server whose first signal closes the service behind it, and then itself.

    Args:
        config: configuration of the server.
        close: the service; may take seconds, while its runs come to rest.
    """

    def __init__(self, config: uvicorn.Config, close: Callable[[], object]) -> None:
        super().__init__(config)
        self._close = close

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Context in which a signal asks for the end; a second one breaks it off."""
        with SIGNALS.ask_first(self._ask):
            yield

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Ends the runs, whose streams end with them, and then all connections."""
        for listening in self.servers:
            listening.close()
        await asyncio.to_thread(self._close)
        await super().shutdown(sockets)

    def _ask(self) -> None:
        self.should_exit = True


def listening_socket(host: str, port: int) -> socket.socket:
    """A socket that listens.

    Args:
        host: address or name of this machine.
        port: 0 takes a free one.

    Raises:
        ControlError: `cannot_listen`.
    """
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        listening = socket.create_server((host, port), family=family, backlog=_BACKLOG)
        # Connections inherit it; else the body of an answer waits 40 ms for the header's receipt.
        listening.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return listening
    except OSError as raised:
        raise error(
            "cannot_listen",
            f"cannot listen at {host}, port {port}: {raised.strerror or raised}",
            suggestions=("choose another --port; 0 takes a free one",),
        ) from raised


def url_of(listening: socket.socket, names: Sequence[str] = ()) -> str:
    """URL of a socket that listens; where that is at every address, by the first of some names."""
    host, port = listening.getsockname()[:2]
    if names and ip_address(host).is_unspecified:
        host = names[0]
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"


def serve(
    service: PlanningService,
    settings: HttpSettings,
    listening: socket.socket,
    login: BrowserLogin | None = None,
) -> None:
    """Answers requests until a signal comes; the service is closed then.

    Args:
        service: service that has started.
        settings: settings of the HTTP interface.
        listening: the socket.
        login: login of browsers, if the settings have a token.
    """
    # Answers that are on their way at the end have 5 s.
    config = uvicorn.Config(
        service_app(service, settings, login),
        # Beyond what is told 429, so that a flood of connections ends somewhere.
        http=connection_class(4 * (settings.requests + settings.listeners)),
        ws="none",
        lifespan="off",
        log_config=None,
        access_log=False,
        server_header=False,
        proxy_headers=False,
        backlog=_BACKLOG,
        h11_max_incomplete_event_size=_HEADER_BYTES,
        timeout_graceful_shutdown=5,
    )
    asyncio.run(_Server(config, service.close).serve([listening]))


# Logs of the service: one JSON object a line on standard error.


_LONGEST = 2000  # of a text in the log [characters]


class JsonFormatter(logging.Formatter):
    """Formatter of records as JSON objects.

    What a record bears as `fields` becomes keys of its own.
    """

    def format(self, record: logging.LogRecord) -> str:
        """The record on one line."""
        written = {
            "time": time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(record.created))
            + f".{int(record.msecs):03d}Z",
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage()[:_LONGEST],
            **getattr(record, "fields", {}),
        }
        if record.exc_info:
            written["traceback"] = self.formatException(record.exc_info)[-_LONGEST:]
        return json.dumps(written, ensure_ascii=False)


def log_as_json(level: int = logging.INFO) -> None:
    """Sends what the service and its server log to standard error."""
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(JsonFormatter())
    for name in ("nlcontrol", "uvicorn.error"):
        logger = logging.getLogger(name)
        logger.handlers = [handler]
        logger.setLevel(level)
        logger.propagate = False

"""A connection to a planning service: requests, answers as documents, problems as errors.

What a call asks, and what it makes of the answers, is a generator of requests, the same for who
waits in a thread and for who awaits. A request that is lost on its way is sent again where that
cannot do anything twice.
"""

from __future__ import annotations

import asyncio
import importlib.util
import time
import weakref
from collections.abc import AsyncIterator, Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

from pydantic import BaseModel, ValidationError

from nlcontrol.errors import ControlError, ErrorInfo, error

if TYPE_CHECKING:
    import httpx

D = TypeVar("D", bound=BaseModel)
T = TypeVar("T")

PAUSES = (0.1, 0.3, 1.0, 3.0)
"""Waits before what was lost is tried again [s]."""

CONNECT_TIME, SILENCE, KEPT = 5.0, 45.0, 2.0
"""Longest time to connect, longest silence of a stream (it has a heartbeat), and the time for which
an idle connection is kept: less than servers keep it, which would lose a request [s]."""


@dataclass(frozen=True)
class Request:
    """A request to a service.

    Attributes:
        method: HTTP method.
        path: below the service's URL.
        body: sent as JSON.
        headers: further ones.
        params: query parameters; those without a value are left out.
    """

    method: str
    path: str
    body: Any = None
    headers: dict[str, str] | None = None
    params: dict[str, Any] | None = None

    @property
    def content(self) -> dict[str, Any]:
        """All but method and path, by httpx's names."""
        return {"json": self.body, "headers": self.headers, "params": self.params}


@dataclass(frozen=True)
class Pause:
    """A wait before the next request [s]."""

    time: float


Exchange = Generator[Request | Pause, Any, T]
"""Requests and pauses of a call; each request is answered by a response, or by what was raised."""


class ServiceConnection:
    """What every connection to a planning service has: its address, and what answers mean.

    Args:
        url: address of the service.
        token: token that the service asks for, if any.
        timeout: longest wall-clock time to wait for an answer [s].
        transport: carrier of the requests, if not a network.

    Raises:
        ControlError: `missing_extra`; `usage` if the URL is none.
    """

    def __init__(
        self, url: str, *, token: str | None = None, timeout: float = 120.0, transport: Any = None
    ) -> None:
        if importlib.util.find_spec("httpx") is None:
            raise error(
                "missing_extra",
                "a client of the planning service needs httpx",
                suggestions=("install from the checkout: pip install '.[serve]'",),
            )
        import httpx

        try:
            base = httpx.URL(url)
            if base.scheme not in ("http", "https") or not base.host:
                raise ValueError
            headers = httpx.Headers(
                {} if token is None else {"Authorization": f"Bearer {token}"}, encoding="ascii"
            )
        except (httpx.InvalidURL, ValueError, TypeError) as raised:
            raise error(
                "usage",
                f"'{url}' with this token is no address of a service",
                suggestions=("give one like http://127.0.0.1:8000",),
            ) from raised
        self.url = url
        self._options: dict[str, Any] = {
            "base_url": base,
            "headers": headers,
            "timeout": httpx.Timeout(timeout, connect=CONNECT_TIME),
            "limits": httpx.Limits(keepalive_expiry=KEPT),
            "transport": transport,
            # A proxy of the environment does not lead to this machine.
            "trust_env": base.host not in ("127.0.0.1", "localhost", "::1"),
        }

    def document(self, kind: type[D], request: Request, *, repeatable: bool = True) -> Exchange[D]:
        """The answer to a request, as a document; see `response`.

        Raises:
            ControlError: also `bad_answer`, if it is no such document.
        """
        answer = yield from self.response(request, repeatable=repeatable)
        try:
            return kind.model_validate_json(answer.content)
        except ValidationError as raised:
            told = f"no {kind.__name__} came for {request.method} {request.path}"
            self._refuse_answer(told, raised)

    def response(self, request: Request, *, repeatable: bool = True) -> Exchange[httpx.Response]:
        """The answer to a request.

        Args:
            request: the request.
            repeatable: it may be sent again if it is not known whether it arrived.

        Raises:
            ControlError: that of the service; `no_service` if it cannot be reached; `bad_answer`.
        """
        import httpx

        pauses = iter(PAUSES if repeatable else ())
        while True:
            try:
                response: httpx.Response = yield request
            except httpx.TransportError as raised:
                pause = next(pauses, None)
                if pause is None or isinstance(raised, httpx.ReadTimeout):
                    self._tell_lost(raised)
                yield Pause(pause)
            else:
                self._require_success(response)
                return response

    def _stream_options(self, after: int) -> dict[str, Any]:
        import httpx

        headers = {"Accept": "text/event-stream", "Last-Event-ID": str(after)}
        return {"headers": headers, "timeout": httpx.Timeout(SILENCE, connect=CONNECT_TIME)}

    @contextmanager
    def _losses_told(self) -> Iterator[None]:
        import httpx

        try:
            yield
        except httpx.TransportError as raised:
            self._tell_lost(raised)

    def _require_success(self, response: httpx.Response) -> None:
        if response.is_success:
            return
        try:
            problem = response.json()
            known = {key: problem[key] for key in ErrorInfo.model_fields if key in problem}
            info = ErrorInfo.model_validate({"message": problem.get("detail", ""), **known})
        except (ValueError, TypeError, AttributeError) as raised:
            self._refuse_answer(f"HTTP status {response.status_code} came", raised)
        raise ControlError(info)

    def _refuse_answer(self, message: str, raised: Exception) -> NoReturn:
        raise error(
            "bad_answer",
            f"{self.url}: {message}",
            suggestions=("see that `nlcontrol serve` of this version answers there",),
        ) from raised

    def _tell_lost(self, raised: Exception) -> NoReturn:
        raise error(
            "no_service",
            f"{self.url} cannot be reached: {raised or type(raised).__name__}",
            suggestions=(f"`nlcontrol serve` starts one; see that it runs at {self.url}",),
        ) from raised


def _next_asked(exchange: Exchange[Any], reply: Any) -> Request | Pause:
    """What an exchange asks after a reply; what was raised in place of one is raised in it."""
    return exchange.throw(reply) if isinstance(reply, Exception) else exchange.send(reply)


class BlockingConnection(ServiceConnection):
    """A connection whose calls wait; threads may share it."""

    def __init__(self, url: str, **options: Any) -> None:
        super().__init__(url, **options)
        import httpx

        self._http = httpx.Client(**self._options)
        # Runs outlive the session that began them, and need it still.
        weakref.finalize(self, self._http.close)

    def run(self, exchange: Exchange[T]) -> T:
        """What comes of a call."""
        import httpx

        reply: httpx.Response | httpx.TransportError | None = None
        while True:
            try:
                asked = _next_asked(exchange, reply)
            except StopIteration as ended:
                result: T = ended.value
                return result
            reply = None
            if isinstance(asked, Pause):
                time.sleep(asked.time)
                continue
            try:
                reply = self._http.request(asked.method, asked.path, **asked.content)
            except httpx.TransportError as raised:
                reply = raised

    def stream(self, path: str, after: int = 0) -> Iterator[str]:
        """The data of the events of a stream, those after a number alone.

        Raises:
            ControlError: as in `response`; `no_service` where the stream is lost.
        """
        import httpx
        from httpx_sse import EventSource

        with (
            self._losses_told(),
            self._http.stream("GET", path, **self._stream_options(after)) as response,
        ):
            if not response.is_success:
                response.read()
            self._require_success(response)
            if response.status_code != httpx.codes.NO_CONTENT:
                yield from (event.data for event in EventSource(response).iter_sse())

    def close(self) -> None:
        """Ends the connection."""
        self._http.close()


class AwaitedConnection(ServiceConnection):
    """A connection whose calls are awaited; tasks of one loop may share it."""

    def __init__(self, url: str, **options: Any) -> None:
        super().__init__(url, **options)
        import httpx

        self._http = httpx.AsyncClient(**self._options)

    async def run(self, exchange: Exchange[T]) -> T:
        """What comes of a call; see `BlockingConnection.run`."""
        import httpx

        reply: httpx.Response | httpx.TransportError | None = None
        while True:
            try:
                asked = _next_asked(exchange, reply)
            except StopIteration as ended:
                result: T = ended.value
                return result
            reply = None
            if isinstance(asked, Pause):
                await asyncio.sleep(asked.time)
                continue
            try:
                reply = await self._http.request(asked.method, asked.path, **asked.content)
            except httpx.TransportError as raised:
                reply = raised

    async def stream(self, path: str, after: int = 0) -> AsyncIterator[str]:
        """The data of the events of a stream; see `BlockingConnection.stream`."""
        import httpx
        from httpx_sse import EventSource

        with self._losses_told():
            options = self._stream_options(after)
            async with self._http.stream("GET", path, **options) as response:
                if not response.is_success:
                    await response.aread()
                self._require_success(response)
                if response.status_code != httpx.codes.NO_CONTENT:
                    async for event in EventSource(response).aiter_sse():
                        yield event.data

    async def close(self) -> None:
        """Ends the connection."""
        await self._http.aclose()

"""A connection to a planning service: requests, answers as documents, problems as errors.

A request that is lost on its way is sent again where that cannot do anything twice.
"""

from __future__ import annotations

import importlib.util
import time
import weakref
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

from pydantic import BaseModel, ValidationError

from nlcontrol.errors import ControlError, ErrorInfo, error
from nlcontrol.service.client.event_stream_reader import StreamedEvent, streamed_events

if TYPE_CHECKING:
    import httpx

D = TypeVar("D", bound=BaseModel)

PAUSES = (0.1, 0.3, 1.0, 3.0)
"""Waits before what was lost is tried again [s]."""

CONNECT_TIME, SILENCE, KEPT = 5.0, 45.0, 2.0
"""Longest time to connect, longest silence of a stream (it has a heartbeat), and the time for which
an idle connection is kept: less than servers keep it, which would lose a request [s]."""

_OWN_MACHINE = ("127.0.0.1", "localhost", "::1")


class ServiceConnection:
    """A connection to a planning service; threads may share it.

    Args:
        url: of the service.
        token: that it asks for, if any.
        timeout: longest time to wait for an answer, by the clock on the wall [s].
        transport: of the requests, if not over a network.

    Raises:
        ControlError: `missing_extra`; `usage` if the URL is none.
    """

    def __init__(
        self,
        url: str,
        *,
        token: str | None = None,
        timeout: float = 120.0,
        transport: httpx.BaseTransport | None = None,
    ) -> None:
        _require_httpx()
        import httpx

        try:
            base = httpx.URL(url)
            if base.scheme not in ("http", "https") or not base.host:
                raise ValueError
            self._http = httpx.Client(
                base_url=base,
                headers={} if token is None else {"Authorization": f"Bearer {token}"},
                timeout=httpx.Timeout(timeout, connect=CONNECT_TIME),
                limits=httpx.Limits(keepalive_expiry=KEPT),
                transport=transport,
                # A proxy of the environment does not lead to this machine.
                trust_env=base.host not in _OWN_MACHINE,
            )
        except (httpx.InvalidURL, ValueError, TypeError) as raised:
            raise error(
                "usage",
                f"'{url}' with this token is no address of a service",
                suggestions=("give one like http://127.0.0.1:8000",),
            ) from raised
        self.url = url
        # Runs outlive the session that began them, and need it still.
        weakref.finalize(self, self._http.close)

    def document(
        self, kind: type[D], method: str, path: str, body: Any = None, **options: Any
    ) -> D:
        """The answer to a request, as a document; see `response`.

        Raises:
            ControlError: also `bad_answer`, if it is no such document.
        """
        answer = self.response(method, path, body, **options)
        try:
            return kind.model_validate_json(answer.content)
        except ValidationError as raised:
            self._refuse_answer(f"no {kind.__name__} came for {method} {path}", raised)

    def response(
        self,
        method: str,
        path: str,
        body: Any = None,
        *,
        headers: Mapping[str, str] | None = None,
        repeatable: bool = True,
    ) -> httpx.Response:
        """The answer to a request.

        Args:
            method: of HTTP.
            path: below the service's URL.
            body: to be sent as JSON.
            headers: further ones.
            repeatable: it may be sent again if it is not known whether it arrived.

        Raises:
            ControlError: that of the service; `no_service` if it cannot be reached; `bad_answer`.
        """
        import httpx

        pauses = iter(PAUSES if repeatable else ())
        while True:
            try:
                response = self._http.request(method, path, json=body, headers=headers)
            except httpx.TransportError as raised:
                pause = next(pauses, None)
                if pause is None or isinstance(raised, httpx.ReadTimeout):
                    self._tell_lost(raised)
                time.sleep(pause)
            else:
                self._require_success(response)
                return response

    def stream(self, path: str, after: int = 0) -> Iterator[StreamedEvent]:
        """The events of a stream, those after a number alone.

        Raises:
            ControlError: as in `response`; `no_service` where the stream is lost.
        """
        import httpx

        headers = {"Accept": "text/event-stream", "Last-Event-ID": str(after)}
        timeout = httpx.Timeout(SILENCE, connect=CONNECT_TIME)
        try:
            with self._http.stream("GET", path, headers=headers, timeout=timeout) as response:
                if not response.is_success:
                    response.read()
                self._require_success(response)
                yield from streamed_events(response.iter_bytes())
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


def _require_httpx() -> None:
    if importlib.util.find_spec("httpx") is None:
        raise error(
            "missing_extra",
            "a client of the planning service needs httpx",
            suggestions=("install from the checkout: pip install '.[serve]'",),
        )

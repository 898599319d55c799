"""The guard before every request: who asks, by which name, from which page, and how much.

A page of any origin that a person has open can reach a server on loopback, by an address or, once
its own name is made to point here (DNS rebinding), as its own origin. So `Host` has to be a name of
this service, and `Origin`, where a browser sends it, has to agree with it. Bodies are read here, up
to a limit and within a time, and nothing but sensible JSON gets further.
"""

from __future__ import annotations

import asyncio
import hashlib
import hmac
import logging
import secrets
import time
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager, suppress
from http import HTTPStatus
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from pydantic_core import from_json
from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import cookie_parser

from nlcontrol.errors import ControlError, ErrorInfo, error
from nlcontrol.service.http.problem_documents import (
    OF_REQUESTS,
    defect,
    problem_of,
    problem_response,
)
from nlcontrol.service.http.responses import LOOPBACK, HttpSettings

if TYPE_CHECKING:
    from starlette.responses import Response
    from starlette.types import ASGIApp, Message, Receive, Scope, Send


# Login of a browser: a cookie in the place of the token, as a page's streams bear no header.
#
# The cookie is made from the token and does not tell it. A browser gets it for the token, or for
# a code that is good once, and which stands in a link behind `#`: no request and no log bears
# that.


LONGEST_PENALTY, FORGOTTEN = 5.0, 30.0
"""Time by which a wrong guess is answered late at most, and after which one is forgotten [s]."""


class BrowserLogin:
    """The login of browsers at a service that has a token.

    Args:
        token: token of the service.
    """

    def __init__(self, token: str) -> None:
        self._token = token
        self._guesses, self._guessed_at = 0.0, time.monotonic()
        self._code: str | None = secrets.token_urlsafe(24)
        self._value = hmac.new(token.encode(), b"cookie of nlcontrol", hashlib.sha256).hexdigest()
        # Cookies do not know ports: each service on a machine has a name of its own.
        self._name = f"nlcontrol_{hashlib.sha256(self._value.encode()).hexdigest()[:12]}"

    def link(self, url: str) -> str:
        """The address that logs a browser in, once.

        Args:
            url: address of the service.
        """
        return f"{url}/#login={self._code}"

    def accepts(self, secret: str) -> bool:
        """Takes a secret: true for the token, and once for the code of the link."""
        if self._code is not None and _are_same(secret, self._code):
            self._code = None
            return True
        return self.is_token(secret)

    def penalty(self) -> float:
        """Time by which a wrong guess is answered late [s]: the more of them of late, the later."""
        now = time.monotonic()
        self._guesses = max(0.0, self._guesses - (now - self._guessed_at) / FORGOTTEN) + 1.0
        self._guessed_at = now
        return float(min(LONGEST_PENALTY, 0.1 * 2.0 ** min(self._guesses - 1.0, 10.0)))

    def is_token(self, secret: str) -> bool:
        """True for the token."""
        return _are_same(secret, self._token)

    def cookie(self, *, is_secure: bool) -> str:
        """The header that gives a browser the cookie.

        Args:
            is_secure: the page came over TLS, so that the cookie may go no other way.
        """
        rules = "Path=/; HttpOnly; SameSite=Strict" + ("; Secure" if is_secure else "")
        return f"{self._name}={self._value}; {rules}"

    def knows(self, cookies: str) -> bool:
        """True if a header of cookies bears the right one."""
        return _are_same(cookie_parser(cookies).get(self._name, ""), self._value)


def _are_same(secret: str, ours: str) -> bool:
    return hmac.compare_digest(secret.encode("utf-8", "replace"), ours.encode())


LOGGER = logging.getLogger("nlcontrol.service.http")

SECURITY_HEADERS: Mapping[str, str] = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "default-src 'none'; frame-ancestors 'none'",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}
"""Headers of every answer that does not set them itself."""

STRANGERS = 16
"""Requests without the token that may be under way where there is one: pages, and logins."""

_READING = ("GET", "HEAD")


class _CallerGone(OSError):  # noqa: N818 - it is no error
    """Raised where a caller has hung up before the whole of a request came."""


class _HeadAnswered(OSError):  # noqa: N818 - it is no error
    """Raised into an application that goes on sending a body that nobody asked for."""


class RequestGuard:
    """An application that lets through to another only what may pass.

    Args:
        app: the other.
        settings: settings of the HTTP interface.
        body_bytes: largest body of a request.
        login: login of browsers; a new one if not given and the settings have a token.

    Attributes:
        login: login of browsers; None without a token.
    """

    def __init__(
        self,
        app: ASGIApp,
        settings: HttpSettings,
        body_bytes: int,
        login: BrowserLogin | None = None,
    ) -> None:
        self._app = app
        self._settings = settings
        if login is None and settings.token is not None:
            login = BrowserLogin(settings.token)
        self.login = login
        self._body_bytes = body_bytes
        self._hosts = {*LOOPBACK, settings.host.lower(), *(name.lower() for name in settings.hosts)}
        self._owners = _Room(settings.requests)
        self._strangers = _Room(STRANGERS, gives_way=True)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answers a request; there are no sockets here."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008})
        else:
            await self._answer(scope, receive, send)

    async def _answer(self, scope: Scope, receive: Receive, send: Send) -> None:
        answer = _Answer(send, is_head=scope["method"] == "HEAD")
        try:
            headers = Headers(scope=scope)
            names = headers.getlist("host")
            if len(names) != 1 or _host_name(names[0]) not in self._hosts:
                raise error(
                    "wrong_host",
                    "the header Host does not name this service",
                    suggestions=("call it by the URL that `nlcontrol serve` has printed",),
                )
            opens_page = scope["method"] in _READING and scope["path"] in ("/", "/docs")
            _require_own_page(headers, opens_page=opens_page)
            async with self._room(scope["path"], headers).entered():
                reads = scope["method"] in _READING
                received = await self._read_body(headers, receive, reads=reads)
                asked = {**scope, "method": "GET"} if answer.is_head else scope
                await self._app(asked, received, answer.send)
        except _CallerGone:
            answer.is_done = True
        except ControlError as raised:
            if answer.status == 0:
                await problem_response(problem_of(raised.info))(scope, receive, answer.send)
        except Exception:
            if not answer.is_done:
                LOGGER.exception("a request failed")
                if answer.status == 0:
                    await problem_response(defect())(scope, receive, answer.send)
        finally:
            # Logs a request without its query, headers and body, where sentences and secrets stand.
            LOGGER.info(
                "request",
                extra={
                    "fields": {
                        "method": scope["method"],
                        "path": scope["path"][:200],
                        "status": answer.status,
                        "seconds": round(time.monotonic() - answer.began, 4),
                        "client": (scope.get("client") or ("",))[0],
                    }
                },
            )

    def _room(self, path: str, headers: Headers) -> _Room:
        """Where a request may wait: who has the token is kept out by nobody who has not.

        Raises:
            ControlError: `wrong_token`.
        """
        if self.login is None or self._bears_token(headers):
            return self._owners
        if path.startswith("/v1/") and path != "/v1/login":
            raise error(
                "wrong_token",
                "this service needs its token",
                suggestions=(
                    "send the header Authorization: Bearer with the token",
                    "in a browser, open the link that the server has printed",
                ),
            )
        return self._strangers

    def _bears_token(self, headers: Headers) -> bool:
        """It bears the token, or the cookie of a login."""
        assert self.login is not None, "there is a token"
        kind, _, token = headers.get("authorization", "").partition(" ")
        if kind.lower() == "bearer" and self.login.is_token(token.strip()):
            return True
        return self.login.knows(headers.get("cookie", ""))

    async def _read_body(self, headers: Headers, receive: Receive, *, reads: bool) -> Receive:
        body = await self._whole_body(headers, receive)
        if body and not reads:
            _require_json(headers, body)
        message: Message | None = {"type": "http.request", "body": body, "more_body": False}

        async def received() -> Message:
            nonlocal message
            told, message = message, None
            return await receive() if told is None else told

        return received

    async def _whole_body(self, headers: Headers, receive: Receive) -> bytes:
        length = headers.get("content-length", "0")
        if not length.isdecimal() or int(length) > self._body_bytes:
            raise self._too_large()
        parts: list[bytes] = []
        try:
            async with asyncio.timeout(self._settings.body_time):
                while True:
                    message = await receive()
                    if message["type"] == "http.disconnect":
                        raise _CallerGone
                    parts.append(message.get("body", b""))
                    if sum(map(len, parts)) > self._body_bytes:
                        raise self._too_large()
                    if not message.get("more_body", False):
                        return b"".join(parts)
        except TimeoutError:
            raise error(
                "slow_request",
                f"the body did not arrive within {self._settings.body_time:g} s",
                suggestions=("send it at once",),
            ) from None

    def _too_large(self) -> ControlError:
        return error(
            "too_large",
            f"the body is larger than {self._body_bytes} bytes",
            suggestions=("say less at once",),
            numbers={"body_bytes": float(self._body_bytes)},
        )


class _Room:
    """Requests that are under way, up to a number.

    Args:
        places: of them.
        gives_way: where all are taken, the one that has taken the longest makes room for the next.
    """

    def __init__(self, places: int, *, gives_way: bool = False) -> None:
        self._places, self._gives_way = places, gives_way
        self._inside: dict[asyncio.Timeout, None] = {}

    @asynccontextmanager
    async def entered(self) -> AsyncIterator[None]:
        """Context of one more; raises `too_many_requests`."""
        if len(self._inside) >= self._places:
            if not self._gives_way:
                raise self._full()
            first = next(iter(self._inside))
            del self._inside[first]
            first.reschedule(asyncio.get_running_loop().time())
        limit = asyncio.timeout(None)
        try:
            async with limit:
                self._inside[limit] = None
                yield
        except TimeoutError:
            if limit.expired():
                raise self._full() from None
            raise
        finally:
            self._inside.pop(limit, None)

    def _full(self) -> ControlError:
        return error(
            "too_many_requests",
            f"{self._places} requests are under way already",
            suggestions=("ask again in a second",),
            numbers={"retry_after": 1.0},
        )


class _Answer:
    """The answer on its way, with the headers that all answers bear.

    Attributes:
        status: status of the answer; 0 before it begins.
        is_head: the body is left out.
        is_done: nothing more is to be sent.
    """

    def __init__(self, send: Send, *, is_head: bool) -> None:
        self._send = send
        self.is_head = is_head
        self.status = 0
        self.is_done = False
        self.began = time.monotonic()

    async def send(self, message: Message) -> None:
        """Sends a part of it."""
        if message["type"] == "http.response.start":
            self.status = message["status"]
            headers = MutableHeaders(scope=message)
            is_plain = headers.get("content-type", "").startswith("text/plain")
            refusal = _refusal(self.status) if is_plain and self.status >= 400 else None
            if refusal is not None:
                message["headers"] = refusal.raw_headers
                headers = MutableHeaders(scope=message)
            for name, value in SECURITY_HEADERS.items():
                headers.setdefault(name, value)
            if self.status == 401:
                headers["WWW-Authenticate"] = "Bearer"
            await self._send(message)
            if self.is_head or refusal is not None:
                body = b"" if self.is_head or refusal is None else bytes(refusal.body)
                await self._send({"type": "http.response.body", "body": body})
                self.is_done = True
        elif not self.is_done:
            await self._send(message)
        elif message.get("more_body", False):
            raise _HeadAnswered


def _refusal(status: int) -> Response:
    """The problem document in the place of what another layer refuses in plain text."""
    if status >= 500:
        return problem_response(defect())
    code, hint = OF_REQUESTS.get(status, OF_REQUESTS[400])
    info = ErrorInfo(code=code, message=HTTPStatus(status).phrase, suggestions=(hint,))
    return problem_response(problem_of(info, status=status))


def _host_name(host: str) -> str:
    """Name in a Host header, its port left out."""
    name, colon, port = host.lower().rpartition(":")
    return name if colon and port.isdecimal() and not name.endswith(":") else host.lower()


def _require_own_page(headers: Headers, *, opens_page: bool) -> None:
    """Refuses what a browser sends for a page of another origin.

    Behind a proxy the scheme may differ from ours; the name and the port may not. A link of another
    page may open ours in its place, which moves nothing and tells the other page nothing.
    """
    asks_for = (headers.get("sec-fetch-mode"), headers.get("sec-fetch-dest"))
    if opens_page and asks_for == ("navigate", "document") and "origin" not in headers:
        return
    origin = headers.get("origin")
    site = headers.get("sec-fetch-site", "none")
    own = origin is None
    if origin is not None:
        with suppress(ValueError):
            own = urlsplit(origin).netloc.lower() == headers["host"].lower()
    if not own or site not in ("none", "same-origin"):
        raise error(
            "wrong_origin",
            "a page of another origin may not call this service",
            suggestions=("call it from a program, or from a page that this service has sent",),
        )


def _require_json(headers: Headers, body: bytes) -> None:
    kinds = {kind.partition(";")[0].strip().lower() for kind in headers.getlist("content-type")}
    if kinds != {"application/json"}:
        raise error(
            "wrong_media_type",
            "the body is not said to be JSON",
            suggestions=("send the header Content-Type: application/json",),
        )
    try:
        # Where a body may be left out, the framework takes null for one that was.
        if from_json(body, allow_inf_nan=False) is None:
            raise ValueError("found null")
    except ValueError as raised:
        raise error(
            "bad_json",
            f"the body is no JSON document: {raised}",
            suggestions=("send one JSON object, in UTF-8, and finite numbers alone",),
        ) from None

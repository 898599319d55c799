"""Answers compared with the OpenAPI document: status, type, and JSON by its schema."""

from __future__ import annotations

import gzip
import json
import re
from collections.abc import MutableMapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import jsonschema_rs

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

STREAM, PROBLEM = "text/event-stream", "application/problem+json"
LISTED = 300  # characters of an answer that differs


class Answer(NamedTuple):
    """An answer of the service.

    Attributes:
        method, path: that were asked.
        status: of HTTP.
        kind: media type, "" if there is none.
        body: of it; None of a stream, and of HEAD.
    """

    method: str
    path: str
    status: int
    kind: str
    body: bytes | None


class AnswerJudge:
    """Compares answers with the document of the service."""

    def __init__(self) -> None:
        from nlcontrol.service.http.page_routes import page_files
        from nlcontrol.service.http.service_app import routes_app

        document = routes_app().openapi()
        self._components = document["components"]
        self._files = {*page_files(), "/v1/openapi.json"}
        self._operations = [
            (re.compile(re.sub(r"\\{\w+\\}", "[^/]+", re.escape(template))), operations)
            for template, operations in document["paths"].items()
        ]
        self._valid = cache(self._validator)

    def fault(self, answer: Answer) -> str | None:
        """What the document does not have of an answer; None if it has all."""
        method = "get" if answer.method == "HEAD" else answer.method.lower()
        operation = self._operation(method, answer.path)
        if operation is None:
            if method == "get" and answer.path in self._files and answer.status in (200, 304):
                return None
            documented = {PROBLEM: {"schema": {"$ref": "#/components/schemas/Problem"}}}
            if answer.status < 400:
                return "no such operation"
        else:
            responses = operation["responses"]
            status = str(answer.status)
            found = responses.get(status) or responses.get(f"{status[0]}XX")
            if found is None:
                return "no such status"
            documented = found.get("content", {})
        return self._content_fault(answer, documented)

    def _operation(self, method: str, path: str) -> dict[str, Any] | None:
        found = [
            operations[method]
            for form, operations in self._operations
            if form.fullmatch(path) and method in operations
        ]
        return found[0] if found else None

    def _content_fault(self, answer: Answer, documented: dict[str, Any]) -> str | None:
        if not answer.kind and not documented:
            return "no body" if answer.body else None
        if answer.kind not in documented:
            return f"no such media type: {answer.kind}"
        reference = documented[answer.kind].get("schema", {}).get("$ref")
        if answer.body is None or not answer.kind.endswith("json"):
            return None
        try:
            self._valid(reference).validate(json.loads(answer.body))
        except (ValueError, jsonschema_rs.ValidationError) as raised:
            return f"not of its schema: {raised}"
        return None

    def _validator(self, reference: str | None) -> jsonschema_rs.Draft202012Validator:
        of = {"$ref": reference} if reference else {}
        return jsonschema_rs.Draft202012Validator({**of, "components": self._components})


class DocumentedApp:
    """An application whose answers are compared with the document of the service.

    Args:
        app: the application.
        faults: file to which each answer adds a line that the document does not have.
    """

    def __init__(self, app: ASGIApp, faults: Path) -> None:
        self._app, self._faults = app, faults
        self._judge = AnswerJudge()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answers as the application does."""
        start: MutableMapping[str, Any] = {}
        parts: list[bytes] = []

        async def compared(message: Message) -> None:
            if message["type"] == "http.response.start":
                start.update(message)
            parts.append(message.get("body", b""))
            is_stream = _kind(start) == STREAM
            if message["type"] == "http.response.start" if is_stream else _is_last(message):
                no_body = is_stream or scope["method"] == "HEAD"
                body = None if no_body else _unpacked(start, b"".join(parts))
                asked = (scope["method"], scope["path"])
                self._compare(Answer(*asked, start["status"], _kind(start), body))
            await send(message)

        await self._app(scope, receive, compared)

    def _compare(self, answer: Answer) -> None:
        fault = self._judge.fault(answer)
        if fault is not None:
            told = f"{answer.method} {answer.path}: {answer.status}, {fault}; {answer.body!r}"
            with self._faults.open("a", encoding="utf-8") as lines:
                lines.write(f"{told[: 2 * LISTED]}\n")


def _unpacked(start: MutableMapping[str, Any], body: bytes) -> bytes:
    packed = (b"content-encoding", b"gzip") in start.get("headers", ())
    return gzip.decompress(body) if packed else body


def _is_last(message: Message) -> bool:
    return message["type"] == "http.response.body" and not message.get("more_body", False)


def _kind(start: MutableMapping[str, Any]) -> str:
    headers = {name.lower(): value for name, value in start.get("headers", ())}
    return str(headers.get(b"content-type", b"").decode().partition(";")[0])

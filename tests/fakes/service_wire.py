"""A network on which requests of a client meet what a test says."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator, Iterator
from typing import Any

import httpx

URL = "http://127.0.0.1:8000"
SESSION = {
    "session_id": "s1", "spec": {}, "has_robot": True, "state": "idle", "expires_in": 600.0,
}  # fmt: skip
RUN = {
    "run_id": "r1", "session_id": "s1", "kind": "say", "state": "running", "text": "push the mug",
    "asked_at": 1.0,
}  # fmt: skip
RESULT = {
    "ok": True, "status": "done", "text": "push the mug", "scene": "kitchen", "seed": 0,
}  # fmt: skip
ENDED = {**RUN, "state": "ended", "events": 3, "result": RESULT}


class Wire(httpx.BaseTransport, httpx.AsyncBaseTransport):
    """A network on which each request meets what a test says, the last of it again and again."""

    def __init__(self, **answers: list[Any]) -> None:
        self.answers = {"sessions": [SESSION], **answers}
        self.requests: list[httpx.Request] = []

    def handle_request(self, request: httpx.Request) -> httpx.Response:
        self.requests.append(request)
        answers = self.answers[request.url.path.rpartition("/")[2]]
        answer = answers.pop(0) if len(answers) > 1 else answers[0]
        if isinstance(answer, type):
            raise answer("lost", request=request)
        if isinstance(answer, httpx.Response):
            return answer
        if isinstance(answer, Stream):
            headers = {"Content-Type": "text/event-stream"}
            return httpx.Response(200, headers=headers, stream=answer)
        return httpx.Response(200, json=answer)

    async def handle_async_request(self, request: httpx.Request) -> httpx.Response:
        return self.handle_request(request)

    def sent(self, call: str) -> list[httpx.Request]:
        return [each for each in self.requests if each.url.path.endswith(f"/{call}")]


class Stream(httpx.SyncByteStream, httpx.AsyncByteStream):
    """Events by their numbers; the third is the last of the run. Then the line may be lost."""

    def __init__(self, *numbers: int, lost: bool = False) -> None:
        self.numbers = numbers
        self.lost = lost

    def __iter__(self) -> Iterator[bytes]:
        yield b": heartbeat\n\n"
        for number in self.numbers:
            kind = "ended" if number == 3 else "phase"
            event = {"kind": kind, "time": 0.0, "wall_time": 0.0, "text": str(number)}
            data = json.dumps({"number": number, "event": event})
            yield f"id: {number}\nevent: {kind}\ndata: {data}\n\n".encode()
        if self.lost:
            raise httpx.ReadError("lost")

    async def __aiter__(self) -> AsyncIterator[bytes]:
        for part in self:
            yield part


def problem(status: int, **fields: Any) -> httpx.Response:
    return httpx.Response(
        status, json={"title": "Conflict", "status": status, **fields},
        headers={"Content-Type": "application/problem+json"},
    )  # fmt: skip

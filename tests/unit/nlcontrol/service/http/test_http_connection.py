"""Connections that do not say what they want: they are closed, and give way in a full house."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest
import uvicorn
from starlette.responses import PlainTextResponse
from starlette.types import Receive, Scope, Send
from uvicorn.server import ServerState

from nlcontrol.service.http.web_server import connection_class
from tests.patience import PATIENCE

REQUEST = b"GET / HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n"
HALF = b"GET / HTTP/1.1\r\nHos"


async def _app(scope: Scope, receive: Receive, send: Send) -> None:
    await PlainTextResponse("here")(scope, receive, send)


@asynccontextmanager
async def _port(most: int, head_time: float) -> AsyncIterator[int]:
    """Port of a server with so many connections."""
    config = uvicorn.Config(_app, ws="none", lifespan="off", log_config=None)
    config.load()
    connection, state = connection_class(most, head_time), ServerState()
    loop = asyncio.get_running_loop()
    server = await loop.create_server(
        lambda: connection(config, state, {}, loop), "127.0.0.1", 0
    )  # fmt: skip
    async with server:
        yield server.sockets[0].getsockname()[1]


async def _answer(port: int, sent: bytes) -> bytes:
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(sent)
    try:
        return await asyncio.wait_for(reader.read(), PATIENCE)
    except ConnectionError:
        return b""
    finally:
        writer.close()


def test_half_a_head_is_waited_for_so_long_only() -> None:
    async def asked() -> tuple[bytes, bytes]:
        async with _port(8, 0.05) as port:
            return await _answer(port, HALF), await _answer(port, REQUEST)

    half, whole = asyncio.run(asked())
    assert half == b""
    assert whole.endswith(b"here")


def test_in_a_full_house_the_one_that_has_waited_longest_gives_way() -> None:
    async def asked() -> tuple[bytes, list[bool]]:
        async with _port(3, PATIENCE) as port:
            half = [asyncio.create_task(_answer(port, HALF)) for _ in range(6)]
            while sum(task.done() for task in half) < 3:
                await asyncio.sleep(0.01)
            whole = await _answer(port, REQUEST)
            for task in half:
                task.cancel()
            return whole, [task.done() and not task.cancelled() for task in half]

    whole, _ = asyncio.run(asked())
    assert whole.endswith(b"here")


@pytest.mark.parametrize("sent", [b"\x00\x01\r\n\r\n", b"GET / HTTP/1.1\r\nno colon\r\n\r\n"])
def test_what_is_no_request_gets_a_problem_document(sent: bytes) -> None:
    async def asked() -> bytes:
        async with _port(8, PATIENCE) as port:
            return await _answer(port, sent)

    head, _, body = asyncio.run(asked()).partition(b"\r\n\r\n")
    assert b"application/problem+json" in head
    assert json.loads(body)["code"] == "bad_request"

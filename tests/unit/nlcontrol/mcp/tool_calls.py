"""Calls of tools through a client of the protocol, in this process."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import Any, TypeVar

import anyio
from mcp.client.client import Client
from mcp_types import CallToolResult, TextContent

from nlcontrol.mcp.agent_tools import AgentTools
from nlcontrol.mcp.stdio_server import tool_server

T = TypeVar("T")


def with_client(tools: AgentTools, do: Callable[[Client], Awaitable[T]]) -> T:
    """What comes of calls through a client that is connected to a server of these tools."""

    async def run() -> T:
        async with Client(tool_server(tools)) as client:
            return await do(client)

    return anyio.run(run)


def call(tools: AgentTools, name: str, **arguments: Any) -> dict[str, Any]:
    """The structured answer of one call."""
    return content_of(with_client(tools, lambda client: client.call_tool(name, arguments)))


def content_of(result: CallToolResult) -> dict[str, Any]:
    """The structured answer."""
    assert isinstance(result.structured_content, dict)
    return result.structured_content


def text_of(result: CallToolResult) -> str:
    """The summary."""
    (block,) = result.content
    assert isinstance(block, TextContent)
    return block.text

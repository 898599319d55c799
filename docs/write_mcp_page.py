"""Writes into `docs/mcp.md` the table of tools, the card of what can be said, and a dialogue.

    python docs/write_mcp_page.py

The dialogue is held over a real connection with `nlcontrol mcp`; identifiers, which are random, are
told as `plan-…` and `run-…`.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import anyio
from mcp.client.client import Client
from mcp.client.stdio import StdioServerParameters
from mcp_types import TextContent

from nlcontrol.mcp.agent_tools import TOOLS
from nlcontrol.mcp.stdio_server import grammar_card

GUIDE = Path(__file__).resolve().parent / "mcp.md"

CALLS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("look", {}),
    ("plan", {"sentence": "push the ice tea box to the left with at most 0.1 N"}),
    ("plan", {"sentence": "push the “ice tea box” to the left with at most 5 N"}),
    ("execute", {"plan_id": "…"}),
    ("execute", {"plan_id": "…"}),
    ("ask", {"question": "how hard do I have to push it to make it topple?"}),
)
"""The calls of the dialogue; a plan id is that of the plan before."""


def tools_text() -> str:
    """The table of tools."""
    return "\n".join(_tool_rows())


def _tool_rows() -> Iterator[str]:
    yield "| tool | takes | what it does |"
    yield "|---|---|---|"
    for tool in TOOLS:
        taken = ", ".join(f"`{name}`" for name in tool.arguments.model_fields) or "nothing"
        moves = " Only there with `--allow-motion`." if tool.moves else ""
        yield f"| `{tool.name}` | {taken} | {tool.description}{moves} |"


def card_text() -> str:
    """The card of what can be said, as a block."""
    return f"```text\n{grammar_card()}\n```"


def dialogue_text() -> str:
    """The dialogue as it is held now."""
    return anyio.run(_dialogue)


async def _dialogue() -> str:
    server = StdioServerParameters(
        command=sys.executable, args=["-m", "nlcontrol", "mcp", "--allow-motion"]
    )
    told, plan_id = [], "plan-0"
    async with Client(server) as client:
        for name, arguments in CALLS:
            sent = {**arguments, "plan_id": plan_id} if "plan_id" in arguments else arguments
            result = await client.call_tool(name, sent)
            plan_id = (result.structured_content or {}).get("plan_id", plan_id)
            (block,) = result.content
            assert isinstance(block, TextContent)
            asked = json.dumps(sent, ensure_ascii=False)
            told.append(f"→ {name} {asked}\n← {block.text}")
    text = re.sub(r"\b(plan|run)-[0-9a-f]{16}\b", r"\1-…", "\n\n".join(told))
    return f"```text\n{text}\n```"


def page_with(page: str, part: str, text: str) -> str:
    """The page with another text between the marks of a part."""
    begin, end = f"<!-- {part} -->\n", f"<!-- end of {part} -->"
    head, _, rest = page.partition(begin)
    return f"{head}{begin}{text}\n{end}{rest.partition(end)[2]}"


def part_of(page: str, part: str) -> str:
    """The text between the marks of a part."""
    return page.partition(f"<!-- {part} -->\n")[2].partition(f"\n<!-- end of {part} -->")[0]


if __name__ == "__main__":
    written = GUIDE.read_text(encoding="utf-8")
    for part, text in (
        ("tools", tools_text()),
        ("card", card_text()),
        ("dialogue", dialogue_text()),
    ):
        written = page_with(written, part, text)
    GUIDE.write_text(written, encoding="utf-8")

"""The pages for language models and for agents with a shell say what the program does."""

from __future__ import annotations

import contextlib
import importlib.util
import io
import json
import re
import shlex
import sys
from pathlib import Path
from types import ModuleType

import anyio
import click
import pytest
from mcp.client.client import Client
from mcp.client.stdio import StdioServerParameters

from nlcontrol.cli import run
from nlcontrol.cli.command_line import cli
from nlcontrol.errors import CODES
from tests.docs.guide_blocks import code_blocks, only_block

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "mcp.md").read_text(encoding="utf-8")
AGENTS = (ROOT / "docs" / "agents.md").read_text(encoding="utf-8")

COMMANDS = [
    shlex.split(line.removeprefix("$ "), comments=True)[1:]
    for block in code_blocks(AGENTS, "console")
    for line in block.splitlines()
]


@pytest.fixture(scope="module")
def writer() -> ModuleType:
    path = ROOT / "docs" / "write_mcp_page.py"
    spec = importlib.util.spec_from_file_location("write_mcp_page", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_tools_and_card_are_those_of_the_program(writer: ModuleType) -> None:
    for part, text in (("tools", writer.tools_text()), ("card", writer.card_text())):
        assert writer.part_of(PAGE, part) == text, "run docs/write_mcp_page.py"


@pytest.mark.slow
def test_the_dialogue_is_held_so(writer: ModuleType) -> None:
    assert writer.part_of(PAGE, "dialogue") == writer.dialogue_text(), "run docs/write_mcp_page.py"


def test_the_set_up_names_a_command_and_options_that_there_are() -> None:
    block = only_block(PAGE, "json")
    server = json.loads(block)["mcpServers"]["nlcontrol"]
    assert server["command"] == "nlcontrol"
    command = cli.get_command(click.Context(cli), server["args"][0])
    assert command is not None
    listed = set(re.findall(r"^\| `(\w+)` \|", PAGE, re.M))
    assert served_tools(server["args"]) == listed - {"execute"}
    taken = {option for parameter in command.params for option in parameter.opts}
    told = set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", PAGE))
    assert told <= taken
    assert {"--scene", "--seed", "--set", "--allow-motion", "--url", "--token-file"} == taken


def served_tools(args: list[str]) -> set[str]:
    """Names of the tools of a server that is started with these arguments."""

    async def listing() -> set[str]:
        server = StdioServerParameters(
            command=sys.executable, args=["-m", "nlcontrol", *args], cwd=ROOT
        )
        async with Client(server) as client:
            return {tool.name for tool in (await client.list_tools()).tools}

    return anyio.run(listing)


@pytest.mark.parametrize("args", [c for c in COMMANDS if c[0] != "say"], ids=" ".join)
def test_commands_for_agents(args: list[str]) -> None:
    with contextlib.redirect_stdout(io.StringIO()) as out:
        code = run(args)
    document = json.loads(out.getvalue())
    refused = "3 m away" in " ".join(args)
    assert code == (4 if refused else 0)
    if refused:
        # The next command of the page is what the refusal says.
        says = document["error"]["say"][0]
        assert ["plan", says, "--json"] in COMMANDS


def test_the_loop_names_fields_that_there_are() -> None:
    with contextlib.redirect_stdout(io.StringIO()) as out:
        run(["plan", "push the ice tea box away by 10 cm", "--json"])
        planned = json.loads(out.getvalue())
    for path in set(re.findall(r"`\.([a-z_.]+)`", AGENTS)):
        part = {**planned, "error": {"code", "message", "numbers", "say", "suggestions"},
                "answer": {"text"}}  # fmt: skip
        for name in path.split("."):
            assert name in part, path
            part = part[name] if isinstance(part, dict) else {}


def test_exit_codes_are_those_of_the_table() -> None:
    told = {int(code) for row in re.findall(r"^\| ([\d, ]+) \|", AGENTS, re.M)
            for code in row.split(",")}  # fmt: skip
    assert {status.exit for status in CODES.values()} <= told

"""The server as a client program starts it: a process whose standard output is the protocol's."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import anyio
import pytest
from mcp.client.client import Client
from mcp.client.stdio import StdioServerParameters

from nlcontrol.mcp import stdio_server
from tests.architecture.product import ROOT
from tests.fakes.counted_executor import FOLDER_VARIABLE, MOTIONS, first_poses, write_poses
from tests.patience import PATIENCE
from tests.service_process import serving_counted_robot
from tests.unit.nlcontrol.mcp.tool_calls import content_of

NOISE = ("printed by Python", "written to the descriptor", "put by a library")


@pytest.fixture
def table(tmp_path: Path) -> Path:
    write_poses(tmp_path, first_poses())
    return tmp_path


def program(table: Path, *options: str) -> StdioServerParameters:
    return StdioServerParameters(
        command=sys.executable,
        args=["-m", "tests.fakes.counted_tools", *options],
        env={FOLDER_VARIABLE: str(table), "PYTHONPATH": str(ROOT)},
        cwd=ROOT,
    )


def test_a_plan_is_made_shown_and_carried_out(table: Path) -> None:
    told: list[str | None] = []

    async def note(progress: float, total: float | None, message: str | None) -> None:
        told.append(message)

    async def talk() -> dict[str, Any]:
        async with Client(program(table, "--allow-motion")) as client:
            assert "What can be said" in (client.instructions or "")
            names = [tool.name for tool in (await client.list_tools()).tools]
            assert "execute" in names
            planned = content_of(
                await client.call_tool("plan", {"sentence": "push the mug 5 cm away"})
            )
            done = await client.call_tool(
                "execute", {"plan_id": planned["plan_id"]}, progress_callback=note
            )
            return content_of(done)

    done = anyio.run(talk)
    assert done["status"] == "done"
    assert all(verdict["ok"] for verdict in done["verdicts"])
    assert (table / MOTIONS).read_text() == "mug\n"
    assert any(message and message.startswith("phase: ") for message in told)
    assert any(message and message.startswith("verdict: ") for message in told)


def test_nothing_but_the_protocol_is_on_standard_output(table: Path) -> None:
    """Not what Python prints, nor what a library puts, nor at the end of the process."""
    parameters = program(table)
    asked: list[dict[str, Any]] = [
        {
            "id": 1,
            "method": "initialize",
            "params": {
                "protocolVersion": "2025-06-18",
                "capabilities": {},
                "clientInfo": {"name": "test", "version": "1"},
            },
        },
        {"method": "notifications/initialized"},
        {"id": 2, "method": "tools/call", "params": {"name": "look", "arguments": {}}},
        {"id": 3, "method": "tools/list"},
    ]
    with subprocess.Popen(
        [parameters.command, *parameters.args],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, **(parameters.env or {})},
        cwd=ROOT,
        text=True,
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        for message in asked:
            process.stdin.write(json.dumps({"jsonrpc": "2.0", **message}) + "\n")
        process.stdin.flush()
        answers: dict[int, Any] = {}
        while len(answers) < 3:
            answer = json.loads(process.stdout.readline())
            answers[answer["id"]] = answer
        rest, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0
    assert rest == ""
    for noise in NOISE:
        assert noise in errors
    tools = {tool["name"]: tool for tool in answers[3]["result"]["tools"]}
    assert set(tools) == {"look", "ask", "predict", "affordances", "plan", "verdict", "stop"}
    assert tools["plan"]["annotations"]["readOnlyHint"] is True
    assert tools["plan"]["inputSchema"]["additionalProperties"] is False
    assert answers[2]["result"]["structuredContent"]["status"] == "seen"


def test_sigterm_ends_it(table: Path) -> None:
    command = [sys.executable, "-m", "nlcontrol", "mcp"]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=ROOT
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(b'{"jsonrpc": "2.0", "id": 1, "method": "ping"}\n')
        process.stdin.flush()
        assert json.loads(process.stdout.readline())["id"] == 1
        process.send_signal(signal.SIGTERM)
        assert process.wait(PATIENCE) == 143


def test_the_tools_work_at_a_session_of_a_server(tmp_path: Path) -> None:
    async def talk(url: str) -> dict[str, Any]:
        server = StdioServerParameters(
            command=sys.executable,
            args=["-m", "nlcontrol", "mcp", "--url", url, "--allow-motion"],
            cwd=ROOT,
        )
        async with Client(server) as client:
            refused = content_of(
                await client.call_tool("plan", {"sentence": "push the mug 3 m away"})
            )
            assert refused["say"]
            planned = content_of(
                await client.call_tool("plan", {"sentence": "push the mug 5 cm away"})
            )
            done = await client.call_tool("execute", {"plan_id": planned["plan_id"]})
            again = await client.call_tool("execute", {"plan_id": planned["plan_id"]})
            assert content_of(again)["code"] == "used_plan"
            return content_of(done)

    with serving_counted_robot(tmp_path) as server:
        done = anyio.run(talk, server.url)
    assert done["status"] == "done"
    assert (tmp_path / MOTIONS).read_text() == "mug\n"


def test_without_the_extra_it_says_how_to_install_it() -> None:
    without = "import sys; sys.modules['mcp'] = None; from nlcontrol.cli import main; main(['mcp'])"
    told = subprocess.run(
        [sys.executable, "-c", without], capture_output=True, text=True, cwd=ROOT, check=False
    )
    assert told.returncode == 2
    assert told.stdout == ""
    assert "(missing_extra)" in told.stderr
    assert "pip install '.[mcp]'" in told.stderr
    assert "mcp" in tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"][
        "optional-dependencies"
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("line", "read"),
    [
        ('{"text": "a\\ud800b"}\n', {"text": "a\ufffdb"}),
        ('{"text": "\\ud83e\\udd16"}\n', {"text": "\U0001f916"}),
        ('{"text": "\\\\ud800"}\n', {"text": "\\ud800"}),
    ],
)
def test_half_of_a_character_is_read_as_none(line: str, read: dict[str, str]) -> None:
    """What JSON can say and UTF-8 cannot would never be answered."""
    whole = stdio_server._whole_characters(line)
    assert json.loads(whole) == read
    assert json.dumps(json.loads(whole), ensure_ascii=False).encode()

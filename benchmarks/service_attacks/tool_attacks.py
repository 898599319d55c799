"""Attacks on the tools of agents, called through a client of the protocol.

The robot counts its motions, and the clock by which plans expire is the attacker's.
"""

from __future__ import annotations

import json
import os
import random
import time
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import anyio
from mcp.client.client import Client

from benchmarks.service_attacks.attack_tally import Tally
from benchmarks.service_attacks.attacker import SENTENCES
from benchmarks.service_attacks.hostile_values import LEAKS, PATHS, near, odd_text, odd_value
from nlcontrol.errors import CODES
from nlcontrol.mcp.agent_tools import TOOLS, AgentTools
from nlcontrol.mcp.stdio_server import tool_server
from nlcontrol.service.offers import LIFE, MOST_OFFERED
from nlcontrol.service.session import Session
from tests.fakes.counted_executor import (
    FOLDER_VARIABLE,
    CountedExecutor,
    first_poses,
    motions_in,
    write_poses,
)

SEQUENCES_OF_A_SESSION = 400

UNKNOWN = ("unknown_plan", "bad_arguments")
FORBIDDEN = ("joints", "velocity", "path", "file", "scene", "motion", "force", "trajectory", "cwd")


class ToolAttacker:
    """An agent that may call the tools, and keeps account of what it may have moved.

    Args:
        client: of the tools with leave to move.
        still: of the tools without.
        elsewhere: another session, of the same robot.
        folder: of the table.
        tally: of the answers.
        seed: of the attacks.

    Attributes:
        allowed: motions that were approved in order.
        passed: time by which the clock was put forward [s].
    """

    def __init__(
        self,
        client: Client,
        still: Client,
        elsewhere: Session,
        folder: Path,
        tally: Tally,
        seed: int,
    ) -> None:
        self.client, self.still, self.elsewhere = client, still, elsewhere
        self.folder, self.tally = folder, tally
        self.rng = random.Random(seed)
        self.allowed = 0
        self.passed = 0.0

    async def send(
        self,
        attack: str,
        tool: str,
        arguments: dict[str, Any],
        expected: tuple[str, ...] = (),
        client: Client | None = None,
    ) -> dict[str, Any]:
        """The answer to a call, judged: `ok`, or the code of what is wrong."""
        result = await (client or self.client).call_tool(tool, arguments)
        answer: dict[str, Any] = dict(result.structured_content or {})
        code = "ok" if answer.get("ok") else str(answer.get("code"))
        self.tally.note(attack, code)
        told = f"{tool} {json.dumps(arguments)[:150]}: {json.dumps(answer)[:300]}"
        if answer.get("status") == "error" and code not in CODES and "span" not in answer:
            self.tally.blame("undocumented", attack, told)
        if code == "internal":
            self.tally.blame("5xx", attack, told)
        if expected and code not in expected:
            self.tally.blame("unexpected", attack, told)
        if any(leak.decode() in told for leak in LEAKS):
            self.tally.blame("leak", attack, told)
        return answer

    async def fresh_plan(self) -> str:
        """Id of a plan that waits."""
        write_poses(self.folder, first_poses())
        answer = await self.client.call_tool("plan", {"sentence": self.rng.choice(SENTENCES)})
        content = answer.structured_content or {}
        if "plan_id" not in content:
            raise RuntimeError(f"nothing is planned: {content}")
        return str(content["plan_id"])

    async def execute(self, attack: str, plan_id: str, *expected: str) -> None:
        """Tries to carry out a plan."""
        await self.send(attack, "execute", {"plan_id": plan_id}, expected)


async def try_forged_plan(a: ToolAttacker) -> None:
    """A plan id that is guessed."""
    real = await a.fresh_plan() if a.rng.random() < 0.2 else f"plan-{a.rng.getrandbits(64):016x}"
    if (forged := near(a.rng, real)) != real:
        await a.execute("tool: plan id that is guessed", forged, *UNKNOWN)


async def try_used_plan(a: ToolAttacker) -> None:
    """A plan that was carried out already."""
    plan_id = await a.fresh_plan()
    a.allowed += 1
    await a.execute("tool: fresh plan", plan_id, "ok")
    await a.execute("tool: plan that was carried out already", plan_id, "used_plan")


async def try_two_at_once(a: ToolAttacker) -> None:
    """A plan that is approved twice at once."""
    plan_id = await a.fresh_plan()
    a.allowed += 1
    async with anyio.create_task_group() as calls:
        for _ in range(2):
            calls.start_soon(
                a.execute, "tool: plan that is approved twice at once", plan_id, "ok",
                "used_plan", "busy",
            )  # fmt: skip


async def try_stale_plan(a: ToolAttacker) -> None:
    """A plan of a table on which something was moved."""
    plan_id = await a.fresh_plan()
    poses = first_poses()
    name = a.rng.choice(list(poses))
    x, y, yaw = poses[name]
    write_poses(a.folder, {**poses, name: (x, y + a.rng.uniform(0.01, 0.04), yaw)})
    await a.execute("tool: plan of a table that was changed since", plan_id, "stale_plan")
    write_poses(a.folder, poses)


async def try_expired_plan(a: ToolAttacker) -> None:
    """A plan that is too old, or after which too many were made."""
    plan_id = await a.fresh_plan()
    if a.rng.random() < 0.9:
        a.passed += LIFE + 1.0
    else:
        for _ in range(MOST_OFFERED):
            await a.fresh_plan()
    await a.execute("tool: plan that has expired", plan_id, "expired_plan")


async def try_dropped_plan(a: ToolAttacker) -> None:
    """A plan that a stop has dropped."""
    plan_id = await a.fresh_plan()
    await a.client.call_tool("stop", {})
    await a.execute("tool: plan that a stop has dropped", plan_id, "expired_plan")


async def try_foreign_plan(a: ToolAttacker) -> None:
    """A plan of another session."""
    plan_id = a.elsewhere.plan(a.rng.choice(SENTENCES)).plan_id
    await a.execute("tool: plan of another session", str(plan_id), *UNKNOWN)


async def try_without_leave(a: ToolAttacker) -> None:
    """A plan where nothing may be moved."""
    made = await a.still.call_tool("plan", {"sentence": SENTENCES[0]})
    plan_id = str((made.structured_content or {}).get("plan_id"))
    await a.send(
        "tool: plan where nothing may be moved", "execute", {"plan_id": plan_id},
        ("motion_not_allowed", "unknown_tool"), a.still,
    )  # fmt: skip


async def try_other_arguments(a: ToolAttacker) -> None:
    """Joints, velocities, paths and files, which no tool takes."""
    tool = a.rng.choice(TOOLS).name
    arguments = {a.rng.choice(FORBIDDEN): a.rng.choice((odd_value(a.rng), a.rng.choice(PATHS)))}
    if tool == "execute":
        arguments["plan_id"] = await a.fresh_plan()
    await a.send("tool: joints, velocities, paths or files", tool, arguments, ("bad_arguments",))


async def try_odd_values(a: ToolAttacker) -> None:
    """Values of other types, and too large ones."""
    tool = a.rng.choice([tool for tool in TOOLS if tool.name != "stop"])
    arguments = {name: odd_value(a.rng) for name in tool.arguments.model_fields}
    await a.send("tool: values of other types", tool.name, arguments)
    big = {"sentence": "push " * 50_000}
    await a.send("tool: sentence without end", "plan", big, ("bad_arguments",))


async def try_odd_text(a: ToolAttacker) -> None:
    """Sentences with odd characters, and such that ask for a motion in other words."""
    await a.send("tool: sentence with odd characters", "plan", {"sentence": odd_text(a.rng)})
    text = a.rng.choice((*SENTENCES, "yes, do it", "execute it", "again", odd_text(a.rng)))
    await a.send("tool: order in place of a question", "ask", {"question": text})


async def try_unknown_tool(a: ToolAttacker) -> None:
    """Tools that there are not, and runs."""
    name = a.rng.choice(("say", "move", "EXECUTE", "shell", "", "__init__", "execute "))
    await a.send("tool: one that there is not", name, {"plan_id": "x"}, ("unknown_tool",))
    arguments = {"run_id": near(a.rng, "run-0123456789abcdef")}
    await a.send(
        "tool: run that there is not", "verdict", arguments, ("unknown_run", "bad_arguments")
    )


ATTACKS: dict[Callable[[ToolAttacker], Awaitable[None]], float] = {
    try_forged_plan: 4,
    try_used_plan: 1,
    try_two_at_once: 0.5,
    try_stale_plan: 4,
    try_expired_plan: 1,
    try_dropped_plan: 3,
    try_foreign_plan: 2,
    try_without_leave: 2,
    try_other_arguments: 4,
    try_odd_values: 4,
    try_odd_text: 4,
    try_unknown_tool: 4,
}
"""The attacks, by how often they are tried."""


def attack_tools(folder: Path, sequences: int, seed: int) -> Tally:
    """Tries sequences of attacks on the tools, and counts the answers.

    Args:
        folder: for the table.
        sequences: how many.
        seed: of the attacks.
    """
    os.environ[FOLDER_VARIABLE] = str(folder)
    write_poses(folder, first_poses())
    tally = Tally({"paths": {}})
    for begun in range(0, sequences, SEQUENCES_OF_A_SESSION):
        count = min(SEQUENCES_OF_A_SESSION, sequences - begun)
        anyio.run(_attack, folder, count, seed + begun, tally)
    return tally


async def _attack(folder: Path, sequences: int, seed: int, tally: Tally) -> None:
    attacker: ToolAttacker | None = None

    def clock() -> float:
        return time.monotonic() + (attacker.passed if attacker else 0.0)

    def session() -> Session:
        return Session(executor=CountedExecutor(), approval="plan", clock=clock)

    tools = AgentTools(session(), allow_motion=True)
    still_tools = AgentTools(session(), allow_motion=False)
    async with Client(tool_server(tools)) as client, Client(tool_server(still_tools)) as still:
        attacker = ToolAttacker(client, still, session(), folder, tally, seed)
        rng = attacker.rng
        for _ in range(sequences):
            tries = rng.choices(list(ATTACKS), list(ATTACKS.values()), k=rng.randint(1, 4))
            before, attacker.allowed = motions_in(folder), 0
            for attempt in tries:
                await attempt(attacker)
            moved = motions_in(folder) - before
            if moved != attacker.allowed:
                names = ", ".join(attempt.__name__ for attempt in tries)
                tally.blame("motion", names, f"{moved} motions, {attacker.allowed} allowed")

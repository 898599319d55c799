"""Attacks on the tools of agents, called through a client of the protocol.

The robot counts its motions, and the clock by which plans expire is the attacker's.
"""

from __future__ import annotations

import json
import os
import random
import time
from pathlib import Path
from typing import Any

import anyio
from mcp.client.client import Client

from benchmarks.attacks.hostility import (
    PATHS,
    SEQUENCES_OF_A_SESSION,
    Attack,
    Attacks,
    Tally,
    near,
    odd_text,
    odd_value,
)
from benchmarks.attacks.service_attacks import SENTENCES
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

FORBIDDEN = ("joints", "velocity", "path", "file", "scene", "motion", "force", "trajectory", "cwd")


class ToolAttacker:
    """An agent that may call the tools, and keeps account of what it may have moved.

    Args:
        folder: of the table.
        tally: of the answers.
        seed: of the attacks.

    Attributes:
        tools: with leave to move.
        still: tools without.
        elsewhere: another session, of the same robot.
        allowed: motions that were approved in order.
        passed: time by which the clock was put forward [s].
    """

    client: Client
    still_client: Client

    def __init__(self, folder: Path, tally: Tally, seed: int) -> None:
        self.folder, self.tally = folder, tally
        self.rng = random.Random(seed)
        self.tools = AgentTools(self._session(), allow_motion=True)
        self.still = AgentTools(self._session(), allow_motion=False)
        self.elsewhere = self._session()
        self.allowed = 0
        self.passed = 0.0
        self._attack = ATTACKS[0]

    def _session(self) -> Session:
        def clock() -> float:
            return time.monotonic() + self.passed

        return Session(executor=CountedExecutor(), approval="plan", clock=clock)

    async def attack(self, sequences: int) -> None:
        """Tries sequences of attacks."""
        async with (
            Client(tool_server(self.tools)) as self.client,
            Client(tool_server(self.still)) as self.still_client,
        ):
            for _ in range(sequences):
                await self._try(ATTACKS.sequence(self.rng))

    async def _try(self, attacks: list[Attack[ToolAttacker]]) -> None:
        before, self.allowed = motions_in(self.folder), 0
        for self._attack in attacks:
            await self._attack.attempt(self)
        moved = motions_in(self.folder) - before
        if moved != self.allowed:
            names = ", ".join(attack.name for attack in attacks)
            self.tally.blame("motion", names, f"{moved} motions, {self.allowed} allowed")

    async def send(
        self,
        tool: str,
        arguments: dict[str, Any],
        *,
        attack: str | None = None,
        expected: tuple[str, ...] | None = None,
        client: Client | None = None,
    ) -> None:
        """Calls a tool and judges the answer.

        Args:
            tool: that is called.
            arguments: of it.
            attack: what it is counted as, if not as the attack that is tried.
            expected: codes of the answer, if not those of that attack.
            client: of the tools, if not those with leave to move.
        """
        attack = self._attack.name if attack is None else attack
        expected = self._attack.expected if expected is None else expected
        result = await (client or self.client).call_tool(tool, arguments)
        answer: dict[str, Any] = dict(result.structured_content or {})
        code = "ok" if answer.get("ok") else str(answer.get("code"))
        call, content = f"{tool} {json.dumps(arguments)[:150]}", json.dumps(answer)
        self.tally.judge(attack, expected, code, call, content)
        if answer.get("status") == "error" and code not in CODES and "span" not in answer:
            self.tally.blame("undocumented", attack, f"{call}: {content[:300]}")
        if code == "internal":
            self.tally.blame("5xx", attack, f"{call}: {content[:300]}")

    async def fresh_plan(self) -> str:
        """Id of a plan that waits."""
        write_poses(self.folder, first_poses())
        answer = await self.client.call_tool("plan", {"sentence": self.rng.choice(SENTENCES)})
        content = answer.structured_content or {}
        if "plan_id" not in content:
            raise RuntimeError(f"nothing is planned: {content}")
        return str(content["plan_id"])

    async def execute(self, plan_id: str) -> None:
        """Tries to carry out a plan."""
        await self.send("execute", {"plan_id": plan_id})


ATTACKS = Attacks[ToolAttacker]()
tried = ATTACKS.tried


@tried(4, "tool: plan id that is guessed", "unknown_plan", "bad_arguments")
async def forged_plan(a: ToolAttacker) -> None:
    real = await a.fresh_plan() if a.rng.random() < 0.2 else f"plan-{a.rng.getrandbits(64):016x}"
    if (forged := near(a.rng, real)) != real:
        await a.execute(forged)


@tried(1, "tool: plan that was carried out already", "used_plan")
async def used_plan(a: ToolAttacker) -> None:
    plan_id = await a.fresh_plan()
    a.allowed += 1
    await a.send("execute", {"plan_id": plan_id}, attack="tool: fresh plan", expected=("ok",))
    await a.execute(plan_id)


@tried(0.5, "tool: plan that is approved twice at once", "ok", "used_plan", "busy")
async def two_at_once(a: ToolAttacker) -> None:
    plan_id = await a.fresh_plan()
    a.allowed += 1
    async with anyio.create_task_group() as calls:
        calls.start_soon(a.execute, plan_id)
        calls.start_soon(a.execute, plan_id)


@tried(4, "tool: plan of a table that was changed since", "stale_plan")
async def stale_plan(a: ToolAttacker) -> None:
    plan_id = await a.fresh_plan()
    poses = first_poses()
    name = a.rng.choice(list(poses))
    x, y, yaw = poses[name]
    write_poses(a.folder, {**poses, name: (x, y + a.rng.uniform(0.01, 0.04), yaw)})
    await a.execute(plan_id)
    write_poses(a.folder, poses)


@tried(1, "tool: plan that has expired", "expired_plan")
async def expired_plan(a: ToolAttacker) -> None:
    """A plan that is too old, or after which too many were made."""
    plan_id = await a.fresh_plan()
    if a.rng.random() < 0.9:
        a.passed += LIFE + 1.0
    else:
        for _ in range(MOST_OFFERED):
            await a.fresh_plan()
    await a.execute(plan_id)


@tried(3, "tool: plan that a stop has dropped", "expired_plan")
async def dropped_plan(a: ToolAttacker) -> None:
    plan_id = await a.fresh_plan()
    await a.client.call_tool("stop", {})
    await a.execute(plan_id)


@tried(2, "tool: plan of another session", "unknown_plan", "bad_arguments")
async def foreign_plan(a: ToolAttacker) -> None:
    await a.execute(str(a.elsewhere.plan(a.rng.choice(SENTENCES)).plan_id))


@tried(2, "tool: plan where nothing may be moved", "motion_not_allowed", "unknown_tool")
async def without_leave(a: ToolAttacker) -> None:
    made = await a.still_client.call_tool("plan", {"sentence": SENTENCES[0]})
    plan_id = str((made.structured_content or {}).get("plan_id"))
    await a.send("execute", {"plan_id": plan_id}, client=a.still_client)


@tried(4, "tool: joints, velocities, paths or files", "bad_arguments")
async def other_arguments(a: ToolAttacker) -> None:
    tool = a.rng.choice(TOOLS).name
    arguments = {a.rng.choice(FORBIDDEN): a.rng.choice((odd_value(a.rng), a.rng.choice(PATHS)))}
    if tool == "execute":
        arguments["plan_id"] = await a.fresh_plan()
    await a.send(tool, arguments)


@tried(4, "tool: values of other types")
async def odd_values(a: ToolAttacker) -> None:
    """Values of other types, and too large ones."""
    tool = a.rng.choice([tool for tool in TOOLS if tool.name != "stop"])
    await a.send(tool.name, {name: odd_value(a.rng) for name in tool.arguments.model_fields})
    big = {"sentence": "push " * 50_000}
    await a.send("plan", big, attack="tool: sentence without end", expected=("bad_arguments",))


@tried(4, "tool: sentence with odd characters")
async def odd_sentence(a: ToolAttacker) -> None:
    """Sentences with odd characters, and such that ask for a motion in other words."""
    await a.send("plan", {"sentence": odd_text(a.rng)})
    text = a.rng.choice((*SENTENCES, "yes, do it", "execute it", "again", odd_text(a.rng)))
    await a.send("ask", {"question": text}, attack="tool: order in place of a question")


@tried(4, "tool: one that there is not", "unknown_tool")
async def unknown_tool(a: ToolAttacker) -> None:
    """Tools that there are not, and runs."""
    name = a.rng.choice(("say", "move", "EXECUTE", "shell", "", "__init__", "execute "))
    await a.send(name, {"plan_id": "x"})
    await a.send(
        "verdict",
        {"run_id": near(a.rng, "run-0123456789abcdef")},
        attack="tool: run that there is not",
        expected=("unknown_run", "bad_arguments"),
    )


def attack_tools(folder: Path, sequences: int, seed: int) -> Tally:
    """Tries sequences of attacks on the tools, and counts the answers.

    Args:
        folder: for the table.
        sequences: how many.
        seed: of the attacks.
    """
    os.environ[FOLDER_VARIABLE] = str(folder)
    write_poses(folder, first_poses())
    tally = Tally()
    for begun in range(0, sequences, SEQUENCES_OF_A_SESSION):
        count = min(SEQUENCES_OF_A_SESSION, sequences - begun)
        anyio.run(ToolAttacker(folder, tally, seed + begun).attack, count)
    return tally

"""An agent without a model does tasks over a real connection, by the tools' descriptions alone.

It knows what the protocol tells it: the listing of the tools and their answers. It gives a task to
the tool that takes a sentence, or a question; what is refused it says again in the words that came
with the refusal; a plan it gives to the tool that takes the identifier of a plan. So a task that is
refused first succeeds only if the refusal says a sentence that does.

    python -m tests.agents.scripted_agent [--seed 0] [--seeds 1]

A seed draws twenty tasks (`tests.agents.agent_tasks`); each has a server process and a table of its
own. The exit code is 0 if all are done: those that ask too much after a refusal, the others at
once.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import anyio
from mcp.client.client import Client
from mcp.client.stdio import StdioServerParameters, stdio_client

from tests.agents.agent_tasks import Task, tasks

MOST_TURNS = 5


class Outcome(NamedTuple):
    """What came of a task: all that was said, and the statuses of the answers."""

    task: Task
    said: tuple[str, ...]
    statuses: tuple[str, ...]
    ok: bool

    @property
    def was_refused_first(self) -> bool:
        """It was said again."""
        return len(self.said) > 1

    @property
    def as_meant(self) -> bool:
        """It was done, and refused before if that was to be, and else not."""
        return self.ok and self.was_refused_first == self.task.refused_first


class Agent:
    """An agent at a server.

    Args:
        client: of the protocol, connected.
        tools: names of the tools by an argument that they require.
    """

    def __init__(self, client: Client, tools: dict[str, str]) -> None:
        self._client, self._tools = client, tools
        self._statuses: list[str] = []

    @classmethod
    async def read_listing(cls, client: Client) -> Agent:
        """An agent that has read which tools there are."""
        listed = (await client.list_tools()).tools
        required = {
            name: tool.name for tool in listed for name in tool.input_schema.get("required", ())
        }
        return cls(client, required)

    async def do(self, task: Task) -> Outcome:
        """Says a task, again as a refusal tells it to, and carries out what is planned."""
        takes = "question" if task.text.endswith("?") else "sentence"
        said: list[str] = []
        answer: dict[str, Any] = {"say": [task.text]}
        while answer.get("say") and len(said) < MOST_TURNS:
            said.append(answer["say"][0])
            answer = await self._call(takes, said[-1])
            if "plan_id" in answer:
                answer = await self._call("plan_id", answer["plan_id"])
        done = answer["status"] in ("done", "answered") and answer["ok"]
        return Outcome(task, tuple(said), tuple(self._statuses), done)

    async def _call(self, argument: str, value: str) -> dict[str, Any]:
        result = await self._client.call_tool(self._tools[argument], {argument: value})
        assert isinstance(result.structured_content, dict)
        self._statuses.append(result.structured_content["status"])
        return result.structured_content


async def outcome_of(task: Task, *options: str) -> Outcome:
    """What comes of a task at a server of its own."""
    server = StdioServerParameters(
        command=sys.executable,
        args=["-m", "nlcontrol", "mcp", "--scene", task.scene, "--allow-motion", *options],
    )
    with open("/dev/null", "w", encoding="utf-8") as quiet:
        async with Client(stdio_client(server, errlog=quiet)) as client:
            return await (await Agent.read_listing(client)).do(task)


def outcomes(tasks: Sequence[Task]) -> Iterator[Outcome]:
    """What comes of each task, one after the other."""
    return (anyio.run(outcome_of, task) for task in tasks)


def main() -> int:
    """Do the tasks, print a line for each, and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seed", type=int, default=0, help="the first one")
    parser.add_argument("--seeds", type=int, default=1, help="how many, twenty tasks each")
    given = parser.parse_args()
    chosen = [task for seed in range(given.seed, given.seed + given.seeds) for task in tasks(seed)]
    as_meant = done = refused = 0
    begun = time.monotonic()
    for found in outcomes(chosen):
        as_meant += found.as_meant
        done += found.ok
        refused += found.was_refused_first
        mark = "✓" if found.as_meant else "✗"
        said, statuses = " → ".join(found.said), ", ".join(found.statuses)
        print(f"{mark} {found.task.scene}: {said} [{statuses}]", flush=True)
    spent = time.monotonic() - begun
    print(
        f"{as_meant} of {len(chosen)} as meant, {done} done, {refused} refused first; {spent:.0f} s"
    )
    return 0 if as_meant == len(chosen) else 1


if __name__ == "__main__":
    sys.exit(main())

"""The recipe of CONTRIBUTING, followed to the letter: a new question touches two files.

The edits are made in a copy of the packages; the question is then asked in the process, over HTTP
with and without the client, and as a tool of a language model.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.architecture.product import copy_edited
from tests.service_process import serving

ROOT = Path(__file__).parents[2]

DECLARED = '''class Spread(Document):
    """How far objects stand from another.

    Attributes:
        text: the answer in words.
        distance: to the nearest one, between their origins [m].
    """

    text: str
    distance: float


class Questions:
'''
QUESTION = '''    @question(ObjectBody, Spread, alone=at_table(ObjectBody))
    def nearest(self, name: str) -> Spread:
        """Tells how far the nearest object is."""

    @question(
        ExplainedBody,
        Offer,
'''
ANSWER = '''    def nearest(self, name: str) -> Spread:
        """Tells how far the nearest object is."""
        near = self._seen(name)
        seen = self.controller.look().objects.values()
        others = [each for each in seen if each.name != near.name]
        distance = min(
            math.hypot(each.pose.x - near.pose.x, each.pose.y - near.pose.y) for each in others
        )
        return Spread(text=f"{distance:.3f} m", distance=distance)

    def _seen('''
EDITS = [
    ("nlcontrol/service/methods.py", "class Questions:\n", DECLARED),
    (
        "nlcontrol/service/methods.py",
        "    @question(\n        ExplainedBody,\n        Offer,\n",
        QUESTION,
    ),
    ("nlcontrol/service/methods.py", "import DocumentPart,", "import Document, DocumentPart,"),
    ("nlcontrol/service/session.py", "    def _seen(", ANSWER),
    ("nlcontrol/service/session.py", "import secrets\n", "import math\nimport secrets\n"),
    (
        "nlcontrol/service/session.py",
        "from nlcontrol.service.methods import (\n",
        "from nlcontrol.service.methods import (\n    Spread,\n",
    ),
]

USED = """
import asyncio, json, sys
import httpx
from nlcontrol import AsyncClient, Client
from nlcontrol.mcp.agent_tools import TOOLS, AgentTools
from nlcontrol.service.session import Session

url = sys.argv[1]

async def awaited():
    async with AsyncClient(url) as client, await client.sessions.open() as session:
        return (await session.nearest("mug")).distance

web = httpx.Client(base_url=f"{url}/v1")
with Session() as here, Client(url).sessions.open() as there, web as http:
    tool = next(tool for tool in TOOLS if tool.name == "nearest")
    given = tool.read_arguments({"object": "mug"})
    told = {
        "here": here.nearest("mug").distance,
        "there": there.nearest("mug").distance,
        "awaited": asyncio.run(awaited()),
        "alone": http.post("/nearest", json={"object": "mug"}).json()["distance"],
        "unknown": http.post("/nearest", json={"object": "teapot"}).json()["code"],
        "tool": tool.answer(AgentTools(here), given).facts["distance"],
        "documented": sorted(
            operation["operationId"]
            for path, methods in http.get("/openapi.json").json()["paths"].items()
            for operation in methods.values()
            if "nearest" in path
        ),
    }
print(json.dumps(told))
"""


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The packages with the new question."""
    folder = tmp_path_factory.mktemp("recipe")
    copy_edited(folder, EDITS)
    return folder


def test_recipe_names_these_two_files() -> None:
    recipe = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    recipe = recipe.partition("## A new question")[2].partition("##")[0]
    files = {name for name, _, _ in EDITS}
    assert len(files) == 2
    assert all(f"`{name}`" in recipe for name in files)


@pytest.mark.slow
def test_new_question_is_asked_in_every_way(copy: Path) -> None:
    with serving(root=copy) as server:
        done = subprocess.run(
            [sys.executable, "-c", USED, server.url],
            cwd=copy, env={**os.environ, "PYTHONPATH": str(copy)},
            capture_output=True, text=True, check=False,
        )  # fmt: skip
    assert done.returncode == 0, done.stderr
    told: dict[str, Any] = json.loads(done.stdout)
    assert told["documented"] == ["nearest", "session_nearest"]
    assert told["unknown"] == "unknown_object"
    ways = ("there", "awaited", "alone", "tool")
    assert {told[way] for way in ways} == {told["here"]}

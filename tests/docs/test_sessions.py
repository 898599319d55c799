"""The guide to sessions: its code runs, its tables name what there is."""

from __future__ import annotations

import asyncio
import contextlib
import io
import re
from operator import attrgetter
from pathlib import Path
from typing import Any

import pytest

from nlcontrol import Client, Session
from nlcontrol.errors import CODES
from tests.docs.guide_blocks import code_blocks
from tests.service_process import serving

GUIDE = (Path(__file__).parents[2] / "docs" / "sessions.md").read_text(encoding="utf-8")
BLOCKS = code_blocks(GUIDE, "python")


def printed(block: str) -> str:
    told = io.StringIO()
    with contextlib.redirect_stdout(told):
        exec(block, {"Session": Session})
    return told.getvalue()


def test_a_stated_table() -> None:
    told = printed(BLOCKS[5])
    assert "stop when nothing is felt within 45 mm" in told
    assert "Plan: push the ice tea box" in told.rpartition("stop when")[2]


@pytest.mark.slow
@pytest.mark.parametrize("block", [*BLOCKS[:3], BLOCKS[4]])
def test_what_is_approved_is_done(block: str) -> None:
    told = printed(block)
    assert not told or "Done: every clause held." in told


def test_table_of_codes() -> None:
    table = GUIDE.partition("| code | HTTP |")[2].partition("\n\n")[0]
    rows = re.findall(r"^\| `(\w+)` \| (\d+) \|", table, re.MULTILINE)
    assert len(rows) == 10
    assert {code: int(status) for code, status in rows} == {
        code: CODES[code].http for code, _ in rows
    }


def test_table_of_methods() -> None:
    methods = re.findall(r"^\| `(\w+)\(", GUIDE.partition("## At a server")[0], re.MULTILINE)
    public = {name for name in dir(Session) if not name.startswith("_")}
    inner = {"answer_question"}
    assert set(methods) == public - {"has_robot"} - inner


def test_a_client_has_what_the_table_names() -> None:
    table = GUIDE.partition("| of a client | answer |")[2].partition("\n\n")[0]
    names = re.findall(r"`([\w.]+)\(", table)
    assert len(names) == 11
    with Client("http://127.0.0.1:9") as client:  # nothing is called
        found = [attrgetter(name)(client) for name in names]
    assert all(map(callable, found))


@pytest.mark.slow
def test_the_programs_at_a_server_push(capsys: pytest.CaptureFixture[str]) -> None:
    names: dict[str, Any] = {}
    exec(BLOCKS[3], names)
    with serving("--workers", "1") as server:
        names["push_at"](server.url)
        asyncio.run(names["push_at_once"](server.url))
    printed_lines = capsys.readouterr().out.splitlines()
    assert printed_lines == ["done", "['push the ice tea box 5 cm away']", "done"]

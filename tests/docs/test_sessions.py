"""The guide to sessions: its code runs, its tables name what there is."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path

import pytest

from nlcontrol.errors import CODES
from nlcontrol.service.session import Session
from tests.docs.guide_blocks import code_blocks

GUIDE = (Path(__file__).parents[2] / "docs" / "sessions.md").read_text(encoding="utf-8")
BLOCKS = code_blocks(GUIDE, "python")


def printed(block: str) -> str:
    told = io.StringIO()
    with contextlib.redirect_stdout(told):
        exec(block, {"Session": Session})
    return told.getvalue()


def test_a_stated_table() -> None:
    told = printed(BLOCKS[2])
    assert "stop when nothing is felt within 45 mm" in told
    assert "Plan: push the ice tea box" in told.rpartition("stop when")[2]


@pytest.mark.slow
@pytest.mark.parametrize("block", BLOCKS[:2])
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
    methods = re.findall(r"^\| `(\w+)\(", GUIDE, re.MULTILINE)
    public = {name for name in vars(Session) if not name.startswith("_")}
    assert set(methods) == public - {"executes"}

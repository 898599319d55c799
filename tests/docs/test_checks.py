"""The guide to checks: its defaults are there, and its program shows verdicts that held."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from nlcontrol.cli import run

GUIDE = (Path(__file__).parents[2] / "docs" / "checks.md").read_text(encoding="utf-8")


def test_the_guide_names_defaults_that_are_there(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["defaults"]) == 0
    known = set(re.findall(r"^ *(\w+) ", capsys.readouterr().out, re.M))
    table = GUIDE.partition("## What is measured")[2].partition("## What follows")[0]
    named = set(re.findall(r"`(\w+)`", table))
    assert len(named) > 15
    assert named <= known


@pytest.mark.slow
def test_the_program_of_the_guide_shows_verdicts(capsys: pytest.CaptureFixture[str]) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", GUIDE, re.S)
    exec(compile(code, "checks.md", "exec"), {})
    lines = capsys.readouterr().out.splitlines()
    assert {line.split()[1] for line in lines} >= {"displace", "no_topple", "others"}
    assert all(line.startswith("held ") for line in lines)

"""What people see at a terminal: golden files at 80 columns, wrapped at others, plain in a pipe."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nlcontrol.cli.console.console_output import lines_within
from tests.cli.terminal import COMMANDS, GOLDEN, in_terminal

SENTENCE = "push the mug 3 cm away"
SLOW = {"say": pytest.mark.slow}


def plain(text: str) -> list[str]:
    return re.sub(r"<\d*>", "", text).splitlines()


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=SLOW.get(name, ())) for name in COMMANDS]
)
def test_golden_files_at_80_columns(name: str) -> None:
    status, told = in_terminal(*COMMANDS[name])
    assert status == {"refusal": 4}.get(name, 0)
    assert told == (GOLDEN / f"{name}.txt").read_text("utf-8")
    assert max(map(len, plain(told))) <= 80


@pytest.mark.parametrize("columns", [60, 120])
def test_lines_end_at_the_width_of_the_terminal(columns: int) -> None:
    _, told = in_terminal("plan", SENTENCE, "--explain", columns=columns)
    lengths = sorted(map(len, plain(told)))
    assert columns - 20 < lengths[-1] <= columns


def test_a_pipe_takes_whole_lines_without_colours() -> None:
    command = [sys.executable, "-m", "nlcontrol", "plan", SENTENCE]
    piped = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "\x1b" not in piped.stdout + piped.stderr
    assert max(map(len, piped.stdout.splitlines())) > 120
    _, told = in_terminal("plan", SENTENCE, NO_COLOR="1")
    assert "<1>" not in told
    assert " ".join(told.split()) == " ".join(piped.stdout.split())


def test_quiet_tells_what_came_of_it_alone() -> None:
    status, told = in_terminal("plan", "-q", SENTENCE)
    lines = plain(told)
    assert (status, lines[0].startswith("Plan: ")) == (0, True)
    assert not [line for line in lines[1:] if not line.startswith("  ")]


@given(st.text("ab ✓.", max_size=300), st.integers(20, 130))
def test_wrapping_keeps_every_word(line: str, columns: int) -> None:
    pieces = lines_within(line, columns).splitlines()
    assert "".join(" ".join(pieces).split()) == "".join(line.split())
    assert all(len(piece) <= columns for piece in pieces)

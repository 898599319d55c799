"""The guide to the whole hand: its sentences are read, its runs print what it shows."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
from pathlib import Path

import pytest

from grammar import parse
from nlcontrol.cli import run
from planner.problem.planning_problem import is_handled
from planner.types.defaults import DEFAULTS
from tests.docs.guide_blocks import console_runs, only_block

GUIDE = (Path(__file__).parents[2] / "docs" / "handling.md").read_text(encoding="utf-8")
SECTIONS = dict(re.findall(r"^## (.+?)\n(.*?)(?=^## |\Z)", GUIDE, re.MULTILINE | re.DOTALL))
RUNS = console_runs(GUIDE)


@pytest.mark.parametrize(("command", "shown"), RUNS, ids=[command for command, _ in RUNS])
def test_the_guide_shows_what_is_printed(
    capsys: pytest.CaptureFixture[str], command: str, shown: str
) -> None:
    run(shlex.split(command))
    printed = capsys.readouterr()
    assert " ".join(shown.split()) in " ".join((printed.out + printed.err).split())


@pytest.mark.parametrize("text", re.findall(r"“(.*?)”", SECTIONS["What can be said"])[:-1])
def test_each_sentence_takes_a_hand(text: str) -> None:
    """The last one is a remark."""
    (frame,) = parse(text).frames
    assert is_handled(frame)


def test_the_python_of_the_guide() -> None:
    code = only_block(GUIDE, "python")
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(code, "handling.md", "exec"), {})
    assert out.getvalue().strip() == code.rstrip().rpartition("# ")[2]


def test_the_numbers_of_the_checks() -> None:
    checked = SECTIONS["What is checked"]
    d = DEFAULTS
    assert f"within {1e3 * d.lift_tolerance:.0f} mm" in checked
    assert f"{100 * d.pour_least:.0f} % or more of everything" in checked
    assert f"within {100 * d.pour_share:.0f} % or {1e6 * d.pour_margin:.0f} ml" in checked
    assert f"{100 * d.spill_tolerance:.0f} % or less is spilled" in checked
    assert f"less than {1e3 * d.stays_put:.0f} mm" in checked
    assert "three times at most (`most_tries`)" in GUIDE
    assert d.most_tries == 3

"""The guide to goals: its sentences are planned as it says, its runs print what it shows."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
from pathlib import Path
from typing import get_args

import pytest

from nlcontrol.cli import run
from nlcontrol.cli.commands.say_command import plan as plan_command
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from planner.types.defaults import DEFAULTS
from planner.types.plan import Plan
from planner.types.refusal import RefusalReason
from tests.docs.guide_blocks import code_blocks, console_runs, only_block

GUIDE = (Path(__file__).parents[2] / "docs" / "goals.md").read_text(encoding="utf-8")
PLAIN = " ".join(GUIDE.split())
SECTIONS = dict(re.findall(r"^## (.+?)\n(.*?)(?=^## |\Z)", GUIDE, re.MULTILINE | re.DOTALL))
RUNS = console_runs(GUIDE)


@pytest.fixture(scope="module")
def kitchen() -> Controller:
    return Controller("kitchen")


@pytest.mark.parametrize(("command", "shown"), RUNS, ids=[command for command, _ in RUNS])
def test_the_guide_shows_what_is_printed(
    capsys: pytest.CaptureFixture[str], command: str, shown: str
) -> None:
    run(shlex.split(command))
    printed = capsys.readouterr()
    assert " ".join(shown.split()) in " ".join((printed.out + printed.err).split())


@pytest.mark.parametrize("text", re.findall(r"^\| “(.*?)” \|", SECTIONS["Aims"], re.MULTILINE))
def test_each_aim_is_planned(kitchen: Controller, text: str) -> None:
    made = Conversation(kitchen).say(text, plan_only=True).plan
    assert made is not None
    assert made.aim is not None


@pytest.mark.parametrize("words", re.findall(r"“(.*?)”", SECTIONS["What stops a push"]))
def test_each_event_and_limit_stops_a_push(kitchen: Controller, words: str) -> None:
    made = Conversation(kitchen).say(f"push the ice tea box {words}", plan_only=True).plan
    usual = Conversation(kitchen).say("push the ice tea box away", plan_only=True).plan
    assert isinstance(made, Plan)
    assert isinstance(usual, Plan)
    # An event ends the last push of a way that takes several.
    push = made.pushes[-1]
    newtons = re.search(r"(\d+) N", words) or re.search(r"(\d+) newtons", words)
    if newtons:
        assert push.force_limit <= float(newtons[1])
        return
    assert (push.until, push.ends_on, push.limits) != (
        usual.push.until, usual.push.ends_on, usual.push.limits
    )  # fmt: skip


def test_every_reason_is_explained_and_shown() -> None:
    told = re.findall(r"^\| `(\w+)` \|", SECTIONS["What is refused"], re.MULTILINE)
    assert set(told) == set(get_args(RefusalReason))
    shown = " ".join(code_blocks(GUIDE, "console"))
    assert all(f"({code})" in shown for code in told if code != "unsupported")
    assert "Unsupported: " in shown


def test_the_stated_figures_are_those_of_the_table() -> None:
    d = DEFAULTS
    stated = [
        f"{100 * d.distance:.0f} cm nearer",
        f"{100 * d.place_gap:.0f} cm from it",
        f"{100 * d.clearance:.0f} cm from everything",
        f"{100 * d.clearance_fragile:.0f} cm from what the scene calls fragile",
        f"less than {1e3 * d.aim_position:.0f} mm and 1°",
        f"({1e3 * d.aim_drift:.0f} mm if it was only to turn)",
        f"takes {d.most_pushes} pushes at most",
        f"probability of {d.probability} at least",
    ]
    assert [text for text in stated if text not in PLAIN] == []


def test_its_options_exist() -> None:
    options = {option for parameter in plan_command.params for option in parameter.opts}
    assert {"--explain", "--scene"} <= options


@pytest.mark.slow
def test_the_python_of_the_guide() -> None:
    code = only_block(GUIDE, "python")
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(code, "goals.md", "exec"), {})
    *pushes, status = out.getvalue().splitlines()
    assert status == "done"
    assert pushes[0].endswith("1 more")
    assert pushes[1].endswith("0 more")

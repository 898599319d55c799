"""The guide to exploring: its commands, options, sentences and figures are those of the code."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
from pathlib import Path

import click
import numpy as np
import pytest

import grammar
from grammar.frames import command as g
from nlcontrol.cli.commands.explore_command import command
from nlcontrol.learning.log_fitting import NAMES
from nlcontrol.reports.exploration_report import _COLUMNS
from objectmodels.identification.belief_update import SURPRISING
from objectmodels.identification.least_squares import MOST_DROPPED, OUTLIER
from planner import touch_experiments as experiments
from planner.types.defaults import DEFAULTS
from sim.control import guarded_touch as touch
from sim.exploration import probe_control as probing
from tests.docs.guide_blocks import code_blocks

GUIDE = (Path(__file__).parents[2] / "docs" / "exploring.md").read_text(encoding="utf-8")
PLAIN = " ".join(GUIDE.split())


def test_its_commands_are_understood() -> None:
    lines = re.findall(r"(nlcontrol explore \"[^`\n]*)", GUIDE)
    assert len(lines) == 2
    for line in lines:
        program, name, *args = shlex.split(line)
        assert (program, name) == ("nlcontrol", "explore")
        assert command.make_context("explore", args).params["name"] == "ice tea box"


def test_the_example_has_a_line_for_each_parameter() -> None:
    _, _, columns, *rows = code_blocks(GUIDE, "console")[0].splitlines()
    assert re.sub(r"\s+", " ", columns).strip() == " ".join(_COLUMNS)
    assert len(rows) == len(NAMES)
    assert all(
        row.lstrip().startswith(name) for row, name in zip(rows, NAMES.values(), strict=True)
    )
    for row in rows:
        # What was found lies nearer to the truth than what was believed.
        joint, _, believed, truth = map(float, row.split()[-4:])
        assert abs(joint - truth) <= max(abs(believed - truth), 0.2)


def test_every_option_is_explained() -> None:
    options = {
        option
        for parameter in command.params
        if isinstance(parameter, click.Option)
        for option in parameter.opts
    }
    assert {option for option in options if f"`{option}" not in GUIDE} == set()


def test_the_stated_figures_are_those_of_the_code() -> None:
    stated = [
        f"for {probing.ProbeControl.pause} s",
        f"at {1e3 * probing.ProbeControl.speed:.0f} mm/s until it feels",
        f"{1e3 * touch.TOUCH_BEYOND:.0f} mm behind",
        f"Pressed {1e3 * experiments.BELOW_TOP:.0f} mm below the top "
        f"at {1e3 * experiments.SPEED['tilt']:.0f} mm/s",
        f"tilted by {np.degrees(experiments.TILT):.0f}°",
        f"{100 * experiments.TILT_SHARE:.0f} % of the angle",
        f"for {1e3 * experiments.SLIDE:.0f} mm at {1e3 * experiments.SPEED['slide']:.0f} mm/s",
        f"drawn {1e3 * experiments.RUB:.0f} mm down",
        f"known to {100 * DEFAULTS.found_to:.0f} %",
        f"known to {100 * DEFAULTS.known_to:.0f} % or better",
    ]
    assert [words for words in stated if words not in PLAIN] == []
    assert (probing.RUB_FORCE, "half of the force" in PLAIN) == (0.5, True)
    assert (DEFAULTS.most_pushes, "twelve pushes" in PLAIN) == (12, True)
    assert (SURPRISING, "three standard deviations off" in PLAIN) == (3.0, True)
    assert (OUTLIER, "more than four robust" in PLAIN) == (4.0, True)
    assert (MOST_DROPPED, "a fifth" in PLAIN) == (0.2, True)


def test_its_sentences_mean_that() -> None:
    said = code_blocks(GUIDE, "text")[0].splitlines()
    heavy, slippery = (grammar.parse(line).frames[0] for line in said)
    assert isinstance(heavy.goal, g.Parameters)
    assert isinstance(slippery.goal, g.Parameters)
    assert (heavy.action, heavy.query, heavy.goal.which) == ("explore", None, ("mass",))
    assert (slippery.query, slippery.goal.which) == ("value", ("friction",))


@pytest.mark.slow
def test_its_python_runs() -> None:
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(code_blocks(GUIDE, "python")[0], "exploring.md", "exec"), {})
    assert out.getvalue() == "1 it was moved by 12 mm\nplanned\n"

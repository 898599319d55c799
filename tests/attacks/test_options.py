"""Generated commands: whatever options are given, there is one document and a documented end.

`NLCONTROL_ATTACKS=20000` makes 500 of them in one process, and 500 as processes.
"""

from __future__ import annotations

import contextlib
import io
import json
import subprocess
import sys
from pathlib import Path

import click
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nlcontrol.cli import run
from nlcontrol.cli.command_line import cli
from nlcontrol.errors import CODES, FAMILIES
from tests.attacks.bad_files import ODD_NAMES, ROOT
from tests.attacks.test_files import attacks
from tests.patience import PATIENCE

PARAMETERS = {
    "sentence": ["push the ice tea box away", "how heavy is the mug?", "fnord", "push it " * 80],
    "name": ["mug", "ice tea box", "soup can", "crate"],
    "scene": ["counter", "kitchen", "nowhere"],
    "face": ["front", "left", "bottom", "face 1"],
    "lying_on": ["front", "bottom"],
    "at": ["0,0.05", "0,1e300", "1,2,3"],
    "direction": ["1,0,0", "0,0,0", "-1,0,0", "1e-300,0,0"],
    "settings": ["distance_m=0.12", "distance_m=1e300", "turn=3", "=", "x=nan"],
    "spacing": ["10", "3", "1e300", "1e-300"],
    "count": ["1", "7"],
    "band": ["5", "0"],
    "level": ["0.9"],
    "force": ["3", "0"],
    "friction": ["static", "kinetic"],
    "seed": ["1"],
    "outputs": ["a.png", "a.csv", "a.json"],
    "output": ["a.yaml"],
    "picture": ["a.png", "a.svg"],
    "parameters": ["mass", "mass,friction", "mas"],
}
"""Values that mean something, by the name of a parameter."""

ODD_VALUES = [
    "-1", "0", "1e300", "-1e300", "1e-320", "nan", "inf", "9" * 400, "-", "--", "=", ",", "/",
    "/proc/x.png", "/dev/null", ".", "..", "x" * 300, "x" * 250 + ".png", "a.png", "a.csv",
    "a.json", "a.yaml", "a.html", "examples/ice_tea_trials.csv", "docs/images/map.png", "README.md",
    # A byte that is no text comes as half a pair of its own range; a zero byte cannot come.
    *(n.replace("\ud800", "\udcff") for n in ODD_NAMES if "\0" not in n and len(n) < 1000),
]  # fmt: skip

FILES = [str(path) for path in sorted(ROOT.glob("examples/*"))]

# These move a robot, wait for lines, or look at the whole installation: other tests have them.
LEFT_OUT = {"say", "explore", "shell", "doctor"}


def leaves(
    group: click.Group, path: tuple[str, ...] = ()
) -> list[tuple[tuple[str, ...], click.Command]]:
    """Every command that does something, with its words."""
    found: list[tuple[tuple[str, ...], click.Command]] = []
    for name in group.list_commands(click.Context(group)):
        command = group.get_command(click.Context(group), name)
        assert command is not None
        if isinstance(command, click.Group):
            found += leaves(command, (*path, name))
        elif name not in LEFT_OUT:
            found.append(((*path, name), command))
    return found


@st.composite
def command_lines(draw: st.DrawFn) -> list[str]:
    """A command with some of its options, of which few are right."""
    words, command = draw(st.sampled_from(leaves(cli)))
    line = [*words, "--json"]
    for parameter in command.params:
        value = st.sampled_from(ODD_VALUES + FILES)
        if (good := PARAMETERS.get(parameter.name or "")) is not None:
            value = st.one_of(*3 * [st.sampled_from(good)], value)
        if isinstance(parameter, click.Argument):
            line += [draw(value)] if draw(st.integers(0, 9)) else []
        elif parameter.name not in ("as_json", "experiment", "help") and not draw(
            st.integers(0, 3)
        ):
            assert isinstance(parameter, click.Option)
            line += [parameter.opts[0]] if parameter.is_flag else [parameter.opts[0], draw(value)]
    return line


@attacks(0.025)
@given(line=command_lines())
def test_commands(line: list[str], tmp_path_factory: pytest.TempPathFactory) -> None:
    out, err = io.StringIO(), io.StringIO()
    with (
        contextlib.chdir(folder_with_examples(tmp_path_factory)),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
    ):
        status = run(line)
    require_documented_end(line, status, out.getvalue(), err.getvalue())


@pytest.mark.slow
@attacks(0.025)
@given(line=command_lines())
def test_commands_as_processes(line: list[str], tmp_path_factory: pytest.TempPathFactory) -> None:
    # What comes of a process's own start and end: streams, exit code, what libraries print.
    ended = subprocess.run(
        [sys.executable, "-m", "nlcontrol", *line],
        cwd=folder_with_examples(tmp_path_factory),
        capture_output=True,
        stdin=subprocess.DEVNULL,
        timeout=PATIENCE,
        check=False,
    )
    require_documented_end(line, ended.returncode, ended.stdout.decode(), ended.stderr.decode())


def folder_with_examples(factory: pytest.TempPathFactory) -> Path:
    folder = factory.mktemp("commands")
    (folder / "examples").symlink_to(ROOT / "examples")
    return folder


def require_documented_end(line: list[str], status: int, out: str, err: str) -> None:
    document = json.loads(out)
    assert "Traceback" not in err
    if document["ok"]:
        assert status == 0
        return
    assert status in range(1, 6)
    if line[:2] == ["objects", "validate"]:
        return  # which has an error for each file
    error = document["error"]
    assert error["code"] != "internal", error
    assert error["code"] in CODES or error["family"] in FAMILIES
    assert error["suggestions"], (line, error)

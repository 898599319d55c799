"""What the tab key offers in bash and in other shells, from the process that the shell asks."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys

import pytest

from objectmodels import Registry
from planner.types.defaults import settings
from sim.truth.scene_file import built_in_scenes

CODE = "from nlcontrol.cli import cli; cli(prog_name='nlcontrol')"


def offered(line: str, shell: str = "bash") -> list[str]:
    """Values offered for the last word of a line, which may be empty."""
    words = line.split(" ")
    asked = {"COMP_WORDS": line, "COMP_CWORD": str(len(words) - 1)}
    done = subprocess.run(
        [sys.executable, "-c", CODE],
        env=os.environ | asked | {"_NLCONTROL_COMPLETE": f"{shell}_complete"},
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    return done.stdout.splitlines()


@pytest.mark.parametrize(
    ("line", "values"),
    [
        ("nlcontrol plan --scene ", built_in_scenes()),
        ("nlcontrol scenes show pa", ("pantry",)),
        ("nlcontrol map mug --face fr", ("front",)),
        ("nlcontrol predict tin --face fr", ("front-30", "front+30")),
        ("nlcontrol objects show ", tuple(model.name for model in Registry.default())),
        ("nlcontrol affordances ice", ("ice tea", "ice tea box", "ice tea cup")),
        ("nlcontrol defaults ", tuple(each.name for each in settings())),
        ("nlcontrol plan --set tilt_d", ("tilt_deg=",)),
    ],
)
def test_names_are_completed(line: str, values: tuple[str, ...]) -> None:
    assert offered(line) == [f"plain,{shlex.quote(value)}" for value in values]


def test_other_shells_quote_by_themselves() -> None:
    told = offered("nlcontrol objects show ice", shell="zsh")
    assert told[1::3] == ["ice tea", "ice tea box", "ice tea cup"]


def test_a_scene_of_another_name_is_a_file() -> None:
    assert offered("nlcontrol plan --scene my") == ["file,my"]

"""The guide to defaults: its table is that of the code, its examples run."""

from __future__ import annotations

import contextlib
import inspect
import io
import re
import shlex
from dataclasses import fields
from pathlib import Path

import pytest

from nlcontrol.cli import run
from planner.types.defaults import DEFAULTS, Defaults, kinds, settings, with_settings
from tests.docs.guide_blocks import only_block
from tests.unit.sim.truth.test_scene_files import SCENE

GUIDE = (Path(__file__).parents[2] / "docs" / "defaults.md").read_text(encoding="utf-8")


def test_the_table_is_that_of_the_code() -> None:
    table = ["| name | value | meaning |", "| --- | --: | --- |"]
    table += [f"| `{each.name}` | {each.value:g} | {each.meaning} |" for each in settings()]
    assert [line for line in GUIDE.splitlines() if line.startswith("|")] == table


def test_every_default_is_explained_in_its_unit() -> None:
    """The one docstring says what each field means, and in which unit; the annotation agrees."""
    assert [s.name for s in settings()] == [
        field.name + kinds()[field.name].suffix for field in fields(Defaults)
    ]
    assert all(setting.meaning for setting in settings())
    told = re.findall(
        r"^ {4}(\w+): (.*(?:\n {8}.*)*)", inspect.getdoc(Defaults) or "", re.MULTILINE
    )
    unit = re.compile(r"\[(m/s|m³|m|rad/s|rad|N|s)\]")
    units = {name: unit.findall(text) for name, text in told if name in kinds()}
    assert units == {name: [kind.unit] if kind.unit else [] for name, kind in kinds().items()}


def test_the_scene_of_the_guide() -> None:
    from sim.truth.scene_file import parse_scene

    set_there = {"distance_m": 0.15, "turn_deg": 45, "speed_m_s": 0.03}
    scene = parse_scene(SCENE + only_block(GUIDE, "yaml"))
    assert scene.defaults == with_settings(DEFAULTS, set_there)


def test_the_commands_of_the_guide(capsys: pytest.CaptureFixture[str]) -> None:
    for line in only_block(GUIDE, "console").splitlines():
        assert run(shlex.split(line.removeprefix("$ "))[1:]) == 0
    told = capsys.readouterr().out
    assert "distance 120 mm (no distance said)" in told
    assert re.search(r"^turn_deg +45 ", told, re.MULTILINE)


def test_the_python_of_the_guide() -> None:
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(only_block(GUIDE, "python"), "defaults.md", "exec"), {})
    assert "value=0.12" in out.getvalue()

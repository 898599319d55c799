"""The guide to fitting: its commands, its table and its Python run; every column is explained."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
from pathlib import Path

import pytest

from nlcontrol.cli import run
from nlcontrol.learning.log_fitting import EXPERIMENTS
from objectmodels import Registry
from objectmodels.geometry.pushed_body import UNCERTAIN
from objectmodels.identification import touch_log
from tests.docs.guide_blocks import only_block

ROOT = Path(__file__).parents[2]
GUIDE = (ROOT / "docs" / "fitting.md").read_text(encoding="utf-8")


def test_the_commands_of_the_guide(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, objects_folder: Path
) -> None:
    monkeypatch.chdir(ROOT)
    lines = only_block(GUIDE, "console").splitlines()
    assert len(lines) == 3
    for line in lines:
        assert run(shlex.split(line.removeprefix("$ "))[1:]) == 0
    assert "instead of: built in" in capsys.readouterr().out
    assert (objects_folder / "ice_tea_box.yaml").is_file()


def test_the_table_of_the_guide(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text(only_block(GUIDE, "csv"), encoding="utf-8")
    trials = touch_log.read_data([path], Registry.built_in().get("ice tea box")).trials
    assert [trial.moved for trial in trials] == ["slide", "slide", "topple", "topple", "topple"]
    assert [trial.turn_rate is None for trial in trials] == [True, False, True, True, True]


def test_the_python_of_the_guide(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(only_block(GUIDE, "python"), "fitting.md", "exec"), {})
    assert out.getvalue().strip() == "0.85 kg, friction 0.32"


def test_the_python_of_the_guide_to_public_logs() -> None:
    guide = (ROOT / "docs" / "recorded_logs.md").read_text(encoding="utf-8")
    code = only_block(guide, "python")
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(code, "recorded_logs.md", "exec"), {})
    rate, drift = re.fullmatch(r"(\S+) rad/m, drift (\S+)\n", out.getvalue()).groups()  # type: ignore[union-attr]
    # Half-way the contact is 4 cm behind the middle: 7° of turn over a centimetre of travel.
    assert 5.0 < float(rate) < 20.0
    assert abs(float(drift)) < 0.5


def test_every_column_is_explained() -> None:
    rows, samples = GUIDE.split("## Recordings")
    assert {name for name in touch_log.COLUMNS if f"`{name}`" not in rows} == set()
    assert {name for name in touch_log.RECORDING_COLUMNS if f"`{name}`" not in samples} == set()


def test_the_stated_defaults_are_those_of_the_code() -> None:
    assert f"{touch_log.FORCE_SHARE:.0%}".replace("%", " %") in GUIDE
    assert GUIDE.count("Deviation 0.5° if left out") == 2
    assert pytest.approx(0.5 * 3.14159 / 180, rel=1e-5) == touch_log.ANGLE_SD


def test_every_parameter_has_an_experiment() -> None:
    assert tuple(EXPERIMENTS) == UNCERTAIN

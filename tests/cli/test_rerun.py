"""`say --bundle` writes a run into a file, `rerun` repeats it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from nlcontrol.cli import run


def test_a_bundle_is_written_and_repeated(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    bundle = tmp_path / "run.zip"
    assert run(["say", "where is the mug?", "--seed", "2", "--bundle", str(bundle), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["files"] == {"bundle": str(bundle)}
    assert run(["rerun", str(bundle), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert (report["ok"], report["found"], report["samples"]) == (True, 0, 0)
    assert run(["rerun", str(bundle)]) == 0
    assert "where is the mug?" in capsys.readouterr().out


def test_what_is_no_bundle_is_told(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "run.zip"
    assert run(["rerun", str(path), "--json"]) == 2
    assert json.loads(capsys.readouterr().out)["error"]["code"] == "unreadable_file"
    path.write_text("no bundle")
    assert run(["rerun", str(path), "--json"]) == 2
    assert json.loads(capsys.readouterr().out)["error"]["code"] == "bad_bundle"

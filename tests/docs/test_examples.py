"""The programs of `examples`, run as they stand there."""

from __future__ import annotations

import contextlib
import csv
import io
import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def printed_by(program: str, monkeypatch: pytest.MonkeyPatch, *args: str) -> str:
    monkeypatch.setattr("sys.argv", [program, *args])
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        runpy.run_path(str(ROOT / "examples" / program), run_name="__main__")
    return out.getvalue()


def test_the_tallest_safe_pushes(monkeypatch: pytest.MonkeyPatch) -> None:
    _, *rows = printed_by("tallest_safe_push.py", monkeypatch).splitlines()
    heights = {row[:16].strip(): float(row[16:].split()[0]) for row in rows}
    assert len(heights) > 8
    # A flat book slides wherever it is pushed; a level push of the box topples it from 119 mm on,
    # and one that points upwards, at the largest friction, much earlier.
    assert heights["book"] == 30.0
    assert 0.0 < heights["ice tea box"] < 119.0


def test_suggestions_lead_to_a_plan(monkeypatch: pytest.MonkeyPatch) -> None:
    told = printed_by("follow_suggestions.py", monkeypatch)
    assert [line.split(": ")[-1] for line in told.splitlines() if line.startswith("“")] == [
        "refused",
        "planned",
    ]


def test_frames_instead_of_words(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = printed_by("frames_instead_of_words.py", monkeypatch).splitlines()
    assert len(rows) == 6
    assert all(row.split()[1] == "planned" for row in rows)


def test_waypoints(monkeypatch: pytest.MonkeyPatch) -> None:
    told = printed_by("waypoints_for_my_arm.py", monkeypatch)
    lines = [line for line in told.splitlines() if not line.startswith("#")]
    before, _, end, back = csv.DictReader(lines)
    # 10 cm away, and up to 45 mm to the face before; then 30 mm straight back.
    assert 0.10 < float(end["x_m"]) - float(before["x_m"]) < 0.145
    assert float(back["x_m"]) == pytest.approx(float(end["x_m"]) - 0.03, abs=2e-3)
    assert "# stop when" in told


@pytest.mark.slow
def test_what_is_approved_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    told = printed_by("approve_then_push.py", monkeypatch, "--yes").splitlines()
    assert "done" in told
    assert any(line.startswith("held ") for line in told)
    assert not any(line.startswith("missed ") for line in told)

"""Sentences carried out in the default scene, from the words to the verdict."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import pytest

from nlcontrol.cli import run
from nlcontrol.results.result import Result
from nlcontrol.robots import Trace

pytestmark = pytest.mark.slow

SENTENCES = [
    "topple the ice tea box",
    "push the cereal box away 15 cm without turning it",
    "gently push the coffee box to the right",
    "knock over the cereal box",
    "slide the coffee box towards me a little",
]


def _say(capsys: pytest.CaptureFixture[str], *args: str) -> tuple[int, Result, str]:
    status = run(["say", *args, "--json"])
    told = capsys.readouterr()
    return status, Result.model_validate(json.loads(told.out)), told.err


@pytest.mark.parametrize("sentence", SENTENCES)
def test_carried_out_and_satisfied(capsys: pytest.CaptureFixture[str], sentence: str) -> None:
    status, result, _ = _say(capsys, sentence)
    assert [c for c in result.checks if not c.ok] == []
    assert result.checks
    assert (status, result.status) == (0, "done")


def test_the_first_sentence(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    replay, trace = tmp_path / "run.html", tmp_path / "run.npz"
    sentence = "push the ice tea box away without toppling it"
    status, result, narration = _say(
        capsys, sentence, "--replay", str(replay), "--trace", str(trace)
    )
    assert status == 0
    assert result.execution is not None
    assert result.files == {"replay": str(replay), "trace": str(trace)}
    assert Trace.load(trace).displacement("ice tea box")[0] == result.execution.displacement[0]
    # The default distance of 10 cm within 1 cm, upright within 5°, turned by less than 3°.
    assert result.execution.displacement[0] == pytest.approx(0.10, abs=0.01)
    assert result.execution.largest_tilt < math.radians(5)
    assert result.execution.turned is not None
    assert abs(result.execution.turned) < math.radians(3)
    assert replay.stat().st_size > 10_000
    assert "push" in narration


def test_the_same_seed_gives_the_same_result(capsys: pytest.CaptureFixture[str]) -> None:
    sentence = "push the ice tea box to the left 10 cm"
    status, result, narration = _say(capsys, sentence, "--seed", "4")
    assert (status, result.status, [c for c in result.checks if not c.ok]) == (0, "done", [])
    again = _say(capsys, sentence, "--seed", "4")
    assert again[:2] == (status, result)
    wall = re.compile(r"wall +[0-9.]+ s")
    assert wall.sub("", again[2]) == wall.sub("", narration)


@pytest.mark.parametrize(
    "sentence",
    ["push the mug away without toppling it", "push the soup can to the left 8 cm",
     "push the tea tin towards me a little without turning it"],
)  # fmt: skip
def test_round_and_six_sided_things(capsys: pytest.CaptureFixture[str], sentence: str) -> None:
    status, result, _ = _say(capsys, sentence, "--scene", "counter")
    assert [c for c in result.checks if not c.ok] == []
    assert (status, result.status) == (0, "done")

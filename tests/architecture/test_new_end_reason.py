"""The recipe of CONTRIBUTING, followed to the letter: a new reason to end touches two files.

The edits are made in a copy of the packages; the guard is then told in the guide of a plan, and
ends what it should end.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.architecture.product import ROOT, copy_edited

ROW = """    "led_aside": EndMeaning("the fingertips were led far off their line", elsewhere=True),
    "lost": EndMeaning("""
GUARD = """    yield _time_guard(push, "push")
    left = np.array([-push.direction_W[1], push.direction_W[0]])
    yield Guard(
        "led_aside",
        lambda s: abs(float(s.estimate.travel @ left)),
        0.02,
        lambda s: f"the fingertips are {1e3 * abs(s.estimate.travel @ left):.0f} mm off their line",
        text="the fingertips are 20 mm off their line",
        unit="m",
    )
"""
EDITS = [
    ("planner/types/end_reasons.py", '    "lost",\n', '    "led_aside",\n    "lost",\n'),
    ("planner/types/end_reasons.py", '    "lost": EndMeaning(', ROW),
    ("sim/control/guards.py", '    yield _time_guard(push, "push")\n', GUARD),
]

USED = """
import json
import numpy as np
from nlcontrol.checks.verdicts import PLANNED_ENDS
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from planner.types.end_reasons import END_REASONS
from sim.control.guards import Sample, Watch, push_guards
from sim.control.object_estimate import ObjectEstimate
from sim.robots.cell_description import Vision

controller = Controller("kitchen")
result = Conversation(controller).say("push the ice tea box 20 cm away", plan_only=True)
push = result.plan.push
left = np.array([-push.direction_W[1], push.direction_W[0], 0.0])

def end(aside):
    estimate = ObjectEstimate(push, controller.look(), Vision(), np.zeros(3), 0.01)
    estimate.update(0.0, aside * left, 0.0, [])
    onset = push.prediction.onset
    sample = Sample(0.0, travel=0.0, speed=0.0, felt=onset, tilt=0.0, estimate=estimate)
    return Watch(push_guards(push), 0.01).first_tripped(sample)

print(json.dumps({
    "told": [each.model_dump() for each in result.guide.stop if each.when == "led_aside"],
    "ends": [end(0.019), end(0.021)],
    "elsewhere": END_REASONS["led_aside"].elsewhere,
    "planned": "led_aside" in PLANNED_ENDS,
}))
"""


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The packages with the new reason."""
    folder = tmp_path_factory.mktemp("recipe")
    copy_edited(folder, EDITS)
    return folder


def test_recipe_names_these_two_files() -> None:
    recipe = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    recipe = recipe.partition("## A new reason to end")[2].partition("##")[0]
    files = {name for name, _, _ in EDITS}
    assert len(files) == 2
    assert all(f"`{name}`" in recipe for name in files)


def test_new_reason_is_told_and_ends_a_push(copy: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", USED],
        cwd=copy, env={**os.environ, "PYTHONPATH": str(copy)},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    (told,) = found["told"]
    assert (told["limit"], told["unit"]) == (0.02, "m")
    assert found["ends"] == [None, ["led_aside", "the fingertips are 21 mm off their line"]]
    assert found["elsewhere"]
    assert not found["planned"]

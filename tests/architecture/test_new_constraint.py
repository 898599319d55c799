"""The recipe of CONTRIBUTING, followed to the letter: a new constraint touches five files.

The edits are made in a copy of the packages; a sentence then goes from its words to its verdict.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.architecture.product import copy_edited

ROOT = Path(__file__).parents[2]

CLASS = '''class MaxHeight(BaseConstraint):
    """The object is lifted by `value` at most [m]."""

    words: ClassVar[Words] = Words(phrase="without lifting it more than {}", unit="m")
    kind: Literal["max_height"] = "max_height"
    value: Positive
    spans: Spans = ()


class NoSpill('''
LIMIT = """def _lift_at_most(problem: GraspProblem, clause: Any) -> GraspProblem:
    height = getattr(problem.frame.goal, "height", None)
    if not isinstance(height, float):
        raise unsupported_while("limiting the height", problem.goal.doing, clause.spans)
    if height > clause.value:
        raise _contradiction("it is to be lifted higher", clause.spans, max_height=clause.value)
    return problem


LIMITS: dict[str, ConstraintRule] = {
    "max_height": ConstraintRule(_keep_anyhow, _lift_at_most),"""
CHECK = """def _max_height(clause: Any, e: Evidence) -> Iterator[Check]:
    height = e.trace.poses[e.name][:, 6]
    lifted = float(height.max() - height[0])
    yield compare(clause, "at_most", "lifted at most", clause.value, lifted, 0.0, "m")


CONSTRAINTS: dict[str, Callable[..., Iterator[Check]]] = {
    "max_height": _max_height,"""

EDITS = [
    ("grammar/frames/constraints.py", "class NoSpill(", CLASS),
    (
        "grammar/frames/constraints.py",
        "| NoSpill | NoTouch",
        "| NoSpill | MaxHeight | NoTouch",
    ),
    (
        "grammar/frames/constraints.py",
        'Words("AVOIDING")\n    kind: Literal["no_lift"]',
        'Words("AVOIDING", limit="max_height")\n    kind: Literal["no_lift"]',
    ),
    (
        "grammar/frames/constraints.py",
        '    "displace": ("distance", "max_distance"),',
        '    "displace": ("distance", "max_distance"),\n    "lift": ("height", "max_height"),',
    ),
    (
        "grammar/words/lexicon.yaml",
        '"no_lift": ["lifting"]',
        '"no_lift": ["lifting", "hoisting"]',
    ),
    (
        "planner/problem/constraint_limits.py",
        "LIMITS: dict[str, ConstraintRule] = {",
        LIMIT,
    ),
    (
        "nlcontrol/checks/constraint_checks.py",
        "CONSTRAINTS: dict[str, Callable[..., Iterator[Check]]] = {",
        CHECK,
    ),
]


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The packages with the new constraint."""
    folder = tmp_path_factory.mktemp("recipe")
    copy_edited(folder, EDITS)
    return folder


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=folder, env={**os.environ, "PYTHONPATH": str(folder)},
        capture_output=True, text=True, check=False,
    )  # fmt: skip


def answer(folder: Path, command: str, text: str) -> dict[str, Any]:
    done = run(folder, "-m", "nlcontrol", command, text, "--json")
    known: dict[str, Any] = json.loads(done.stdout)
    return known


def test_recipe_names_these_four_files() -> None:
    recipe = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    recipe = recipe.partition("## A new constraint")[2].partition("##")[0]
    files = {name for name, _, _ in EDITS}
    assert len(files) == 4
    assert all(f"`{name}`" in recipe for name in files)


def test_new_constraint_is_read_and_said(copy: Path) -> None:
    text = "lift the mug by 5 cm without hoisting it more than 10 cm"
    command = answer(copy, "parse", text)
    (frame,) = command["frames"]
    (clause,) = frame["constraints"]
    assert (clause["kind"], clause["value"]) == ("max_height", 0.1)
    assert command["paraphrase"] == "lift the mug by 5 cm without lifting it more than 10 cm"


def test_new_constraint_contradicts_a_higher_lift(copy: Path) -> None:
    text = "lift the mug by 20 cm without lifting it more than 10 cm"
    assert "contradiction" in json.dumps(answer(copy, "parse", text))


def test_new_constraint_is_planned(copy: Path) -> None:
    allowed = answer(copy, "plan", "lift the mug by 5 cm without lifting it more than 10 cm")
    assert allowed["ok"]
    refused = answer(copy, "plan", "put the mug down without lifting it more than 10 cm")
    assert not refused["ok"]


def test_all_kinds_are_complete_with_it(copy: Path) -> None:
    walk = ROOT / "tests" / "unit" / "nlcontrol" / "checks" / "test_clause_kinds.py"
    shutil.copy(walk, copy)
    done = run(copy, "-m", "pytest", "-q", "-p", "no:cacheprovider", walk.name)
    assert done.returncode == 0, done.stdout


@pytest.mark.slow
def test_new_constraint_is_checked(copy: Path) -> None:
    done = answer(copy, "say", "lift the mug by 5 cm without lifting it more than 10 cm")
    assert '"lifted at most"' in json.dumps(done)
    assert done["ok"]

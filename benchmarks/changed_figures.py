"""Which numbers of the code no test notices when they are changed.

    python -m benchmarks.changed_figures --seed 0 --record F

Changes every `SafetyFigure` to 1.3 and to 0.7 times its value, and sixty other constants, drawn by
seed, to one of the two; each in a copy of the project, where the quick tests of its room run until
one fails. A room is the folder, or the module of a package, in which the constant stands; its tests
have the same place in `tests/unit`. Lists what went unnoticed; ends with 1 if a safety figure did.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from pydantic import BaseModel, ConfigDict

from benchmarks.record import Kept, carried_out

ROOT = Path(__file__).resolve().parent.parent

PACKAGES = ("nlcontrol", "objectmodels", "planner", "sim")
"""Packages whose constants are changed; the grammar's are tables of words."""

MORE, LESS = 1.3, 0.7

_COPIED = (*PACKAGES, "grammar", "tests", "examples", "docs", "benchmarks", ".ci")
_LONGEST = 900.0  # [s] a test that hangs notices, too


class Figure(BaseModel):
    """A number in the code.

    Attributes:
        path: of its file, relative to the project.
        name: of the constant, or of the class and its field.
        line, start, end: its expression's line, and first and last column in bytes.
        protects: whether it is a `SafetyFigure`.
    """

    model_config = ConfigDict(frozen=True)

    path: str
    name: str
    line: int
    start: int
    end: int
    protects: bool

    @property
    def tests(self) -> Path:
        """Tests of its room, or of a module that is in none, relative to the project.

        The tests of a room that has none of its own are those of the room around it.
        """
        at = Path(self.path)
        room = Path("tests/unit", at.parent)
        beside = room / f"test_{at.name}"
        if len(at.parts) == 2 and (ROOT / beside).exists():
            return beside
        while not (ROOT / room).exists():
            room = room.parent
        return room

    def change(self, project: Path, factor: float) -> None:
        """Writes the factor before the figure in a copy of the project."""
        file = project / self.path
        lines = file.read_bytes().split(b"\n")
        line = lines[self.line - 1]
        figure = line[self.start : self.end]
        whole = figure.isdigit()
        changed = f"max({figure.decode()} + 1, round({factor} * {figure.decode()}))"
        if factor < 1.0:
            changed = f"min({figure.decode()} - 1, round({factor} * {figure.decode()}))"
        if not whole:
            changed = f"({factor} * ({figure.decode()}))"
        lines[self.line - 1] = line[: self.start] + changed.encode() + line[self.end :]
        file.write_bytes(b"\n".join(lines))


class Change(BaseModel):
    """A figure that is changed by a factor."""

    model_config = ConfigDict(frozen=True)

    figure: Figure
    factor: float


class Noticed(Kept[Change]):
    """Whether a test failed, and which one first."""

    test: str | None


def figures() -> Iterator[Figure]:
    """All constants of modules and fields of classes that are one number on one line."""
    for package in PACKAGES:
        for file in sorted((ROOT / package).rglob("*.py")):
            tree = ast.parse(file.read_bytes())
            path = file.relative_to(ROOT).as_posix()
            yield from _of_body(tree, path, "")


def _of_body(scope: ast.Module | ast.ClassDef, path: str, of: str) -> Iterator[Figure]:
    for node in scope.body:
        if isinstance(node, ast.ClassDef):
            yield from _of_body(node, path, f"{node.name}.")
        if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
            continue
        target = node.targets[0] if isinstance(node, ast.Assign) else node.target
        if not isinstance(target, ast.Name) or not _is_number(node.value):
            continue
        annotation = ast.unparse(node.annotation) if isinstance(node, ast.AnnAssign) else ""
        if not (target.id.isupper() or annotation in {"float", "int", "SafetyFigure"}):
            continue
        value = node.value
        if value.end_lineno == value.lineno and value.end_col_offset is not None:
            yield Figure(
                path=path,
                name=of + target.id,
                line=value.lineno,
                start=value.col_offset,
                end=value.end_col_offset,
                protects=annotation == "SafetyFigure",
            )


def _is_number(value: ast.expr) -> bool:
    """True if it is computed from numbers, one of which is not zero."""
    numbers = [node.value for node in ast.walk(value) if isinstance(node, ast.Constant)]
    names = {ast.unparse(node.func) for node in ast.walk(value) if isinstance(node, ast.Call)}
    others = [node for node in ast.walk(value) if isinstance(node, ast.Tuple | ast.List | ast.Dict)]
    return (
        all(isinstance(number, int | float) and number is not True for number in numbers)
        and any(numbers)
        and names <= {"math.radians", "np.radians", "float"}
        and not others
        and all(
            node.id in {"math", "np", "float"}
            for node in ast.walk(value)
            if isinstance(node, ast.Name)
        )
    )


def notice(change: Change) -> Noticed:
    """Runs the tests of the room with the change; None if they pass."""
    with tempfile.TemporaryDirectory() as folder:
        project = Path(folder)
        for name in _COPIED:
            shutil.copytree(ROOT / name, project / name)
        for file in ROOT.iterdir():
            if file.is_file():
                shutil.copy2(file, project)
        change.figure.change(project, change.factor)
        command = [sys.executable, "-m", "pytest", "-x", "-q", "-m", "not slow", "--no-header"]
        command += ["-p", "no:cacheprovider", str(change.figure.tests)]
        environment = os.environ | {"PYTHONPATH": folder}
        try:
            ran = subprocess.run(
                command,
                cwd=project,
                env=environment,
                capture_output=True,
                text=True,
                timeout=_LONGEST,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return Noticed(job=change, test="(none ended)")
    failed = [line for line in ran.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    if ran.returncode == 0:
        return Noticed(job=change, test=None)
    return Noticed(job=change, test=failed[0] if failed else f"exit code {ran.returncode}")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--others", type=int, default=60, help="constants that are drawn")
    parser.add_argument("--under", default="", help="only files whose path begins so")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--record", type=Path)
    options = parser.parse_args()
    known = [figure for figure in figures() if figure.path.startswith(options.under)]
    others = [figure for figure in known if not figure.protects]
    chosen = random.Random(options.seed)
    drawn = chosen.sample(others, min(options.others, len(others)))
    changes = [
        Change(figure=figure, factor=factor)
        for figure in known
        if figure.protects
        for factor in (MORE, LESS)
    ]
    changes += [Change(figure=figure, factor=chosen.choice((MORE, LESS))) for figure in drawn]
    results = carried_out(
        notice,
        changes,
        Noticed,
        workers=options.workers,
        record=options.record,
        told=lambda done: print(_line(done), flush=True),
    )
    missed = [done.job for done in results.values() if done.test is None]
    guarded = sum(change.figure.protects for change in changes)
    lost = sum(change.figure.protects for change in missed)
    print(f"safety figures: {lost} of {guarded} changes unnoticed")
    print(f"others: {len(missed) - lost} of {len(changes) - guarded} unnoticed")
    return 1 if lost else 0


def _line(done: Noticed) -> str:
    figure = done.job.figure
    kind = "safety" if figure.protects else "other"
    told = done.test or "UNNOTICED"
    return f"{kind:6} {done.job.factor} {figure.path}:{figure.line} {figure.name}: {told}"


if __name__ == "__main__":
    sys.exit(main())

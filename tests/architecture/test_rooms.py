"""Rooms of a size that can be surveyed, and one name for one thing."""

from __future__ import annotations

import ast
from collections import Counter
from pathlib import Path

import pytest

from tests.architecture.product import ROOT, modules, tree

MOST_MODULES = 15
MOST_LINES = 700
# Names that every package may have.
CONVENTIONAL = {"__init__", "__main__", "errors"}

FILES = sorted(modules().values())
FOLDERS = sorted({path.parent for path in FILES})


def within(path: Path) -> str:
    return str(path.relative_to(ROOT))


@pytest.mark.parametrize("folder", FOLDERS, ids=within)
def test_no_folder_is_too_full(folder: Path) -> None:
    assert len([path for path in folder.glob("*.py") if path.stem != "__init__"]) <= MOST_MODULES


@pytest.mark.parametrize("folder", FOLDERS, ids=within)
def test_every_folder_says_what_lives_there(folder: Path) -> None:
    front = folder / "__init__.py"
    assert front.exists()
    assert ast.get_docstring(tree(front))


def test_no_file_name_twice() -> None:
    counts = Counter(path.stem for path in FILES if path.stem not in CONVENTIONAL)
    assert {name for name, count in counts.items() if count > 1} == set()


def test_files_stay_short() -> None:
    lines = {within(path): len(path.read_text("utf-8").splitlines()) for path in FILES}
    assert {path for path, count in lines.items() if count > MOST_LINES} == set()

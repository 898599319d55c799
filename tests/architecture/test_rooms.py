"""Rooms that say what lives there, functions that can be surveyed; files are warned about."""

from __future__ import annotations

import ast
import warnings
from collections import defaultdict
from pathlib import Path

import pytest

from tests.architecture.product import ROOT, imports, modules, tree

MOST_FUNCTION_LINES = 70
LONG_FILE, SHORT_FILE = 700, 60
"""Lines above which a file may be more than one noun, and below which it may be none."""

FILES = sorted(modules().values())
FOLDERS = sorted({path.parent for path in FILES})


def within(path: Path) -> str:
    return str(path.relative_to(ROOT))


def length(path: Path) -> int:
    return len(path.read_text("utf-8").splitlines())


@pytest.mark.parametrize("folder", FOLDERS, ids=within)
def test_every_folder_says_what_lives_there(folder: Path) -> None:
    front = folder / "__init__.py"
    assert front.exists()
    assert ast.get_docstring(tree(front))


def test_functions_can_be_surveyed() -> None:
    long = {
        f"{within(path)}:{node.lineno} {node.name}"
        for path in FILES
        for node in ast.walk(tree(path))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        and (node.end_lineno or node.lineno) - node.lineno >= MOST_FUNCTION_LINES
    }
    assert long == set()


def test_files_that_are_long_or_little_used_are_told() -> None:
    """A warning asks for judgement: each may be right."""
    importers = defaultdict[str, set[str]](set)
    for name, path in modules().items():
        used = imports(tree(path), modules())
        for imported in used.at_start | used.deferred:
            importers[imported].add(name)
    long = {within(path) for path in FILES if length(path) > LONG_FILE}
    lone = {
        within(path)
        for name, path in modules().items()
        if path.stem != "__init__" and length(path) < SHORT_FILE and len(importers[name]) == 1
    }
    for paths, told in ((long, f"more than {LONG_FILE} lines"), (lone, "short, one importer")):
        if paths:
            warnings.warn(f"{len(paths)} files: {told}: {', '.join(sorted(paths))}", stacklevel=1)

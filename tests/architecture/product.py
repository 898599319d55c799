"""The product's modules and their imports, read from the source without running it."""

from __future__ import annotations

import ast
import shutil
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("grammar", "objectmodels", "planner", "sim", "nlcontrol")

Graph = Mapping[str, frozenset[str]]


@dataclass(frozen=True)
class Imports:
    """What one module imports of the product, by when the import is carried out."""

    at_start: frozenset[str]
    """With the module."""
    deferred: frozenset[str]
    """Inside a function, when it is called."""
    typing: frozenset[str]
    """Under TYPE_CHECKING: never."""


def modules(root: Path = ROOT) -> dict[str, Path]:
    """Modules of the product by their dotted names; a package has the name of its folder."""
    return {
        _dotted(path.relative_to(root)): path
        for package in PACKAGES
        for path in sorted((root / package).rglob("*.py"))
    }


@cache
def tree(path: Path) -> ast.Module:
    """The syntax tree of a file; read once for all tests."""
    return ast.parse(path.read_text("utf-8"))


def _dotted(path: Path) -> str:
    parts = path.with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def room(module: str) -> str:
    """The room of a module: the first folder inside its package, or the package itself."""
    return ".".join(module.split(".")[:2])


def imports(source: ast.Module, known: Mapping[str, Path]) -> Imports:
    """The imports of one module, as names of `known` modules."""
    found: dict[str, set[str]] = {"at_start": set(), "deferred": set(), "typing": set()}
    for node, when in _import_nodes(source, "at_start"):
        found[when].update(_targets(node, known))
    return Imports(**{when: frozenset(names) for when, names in found.items()})


def _import_nodes(node: ast.AST, when: str) -> Iterator[tuple[ast.Import | ast.ImportFrom, str]]:
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.Import | ast.ImportFrom):
            yield child, when
        elif isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test):
            yield from _import_nodes(ast.Module(child.body, []), "typing")
            yield from _import_nodes(ast.Module(child.orelse, []), when)
        elif isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef):
            yield from _import_nodes(child, "deferred" if when == "at_start" else when)
        else:
            yield from _import_nodes(child, when)


def _targets(node: ast.Import | ast.ImportFrom, known: Mapping[str, Path]) -> Iterator[str]:
    if isinstance(node, ast.Import):
        names = [alias.name for alias in node.names]
    else:
        assert node.level == 0, f"relative import of {node.module}"
        assert node.module is not None
        inner = [f"{node.module}.{alias.name}" for alias in node.names]
        names = [name if name in known else node.module for name in inner]
    return (name for name in names if name in known)


def circles(graph: Graph) -> list[list[str]]:
    """Groups of two or more modules each of which reaches all others of its group."""
    names = sorted(graph)
    index = {name: i for i, name in enumerate(names)}
    edges = [(index[a], index[b]) for a in names for b in graph[a] if a != b]
    rows, columns = zip(*edges, strict=True) if edges else ((), ())
    matrix = csr_array((np.ones(len(edges)), (rows, columns)), shape=(len(names),) * 2)
    count, labels = connected_components(matrix, connection="strong")
    groups = [[names[i] for i in np.flatnonzero(labels == label)] for label in range(count)]
    return [group for group in groups if len(group) > 1]


def copy_edited(folder: Path, edits: Iterable[tuple[str, str, str]]) -> None:
    """Copies the packages into a folder, with texts of their files replaced.

    Args:
        folder: that takes them.
        edits: path of a file, a text that stands there once, and the one in its place.
    """
    for package in PACKAGES:
        shutil.copytree(ROOT / package, folder / package)
    for name, known, new in edits:
        path = folder / name
        text = path.read_text(encoding="utf-8")
        assert text.count(known) == 1, f"{name}: {known}"
        path.write_text(text.replace(known, new), encoding="utf-8")

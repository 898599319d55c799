"""Names of public functions say what is returned or done."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

import pytest

from tests.architecture.product import PACKAGES, ROOT, tree

IRREGULAR = {
    "begun", "done", "drawn", "fell", "found", "given", "held", "kept", "known", "left", "made",
    "meant", "said", "seen", "shown", "stood", "taken", "told", "withstood",
}  # fmt: skip
NOT_PARTICIPLES = {"embed", "exceed", "feed", "need", "proceed", "seed", "speed", "succeed"}
VAGUE = {"of", "read", "with"}

# Earlier names that are left; the numbers only fall.
LEFT_NAMES = {"grammar": 1, "objectmodels": 4, "planner": 2, "sim": 16, "nlcontrol": 20}

Function = ast.FunctionDef | ast.AsyncFunctionDef


@cache
def functions(package: str) -> list[tuple[Path, Function]]:
    """Functions and methods of a package, those inside functions included."""
    return [
        (path.relative_to(ROOT), node)
        for path in sorted((ROOT / package).rglob("*.py"))
        for node in ast.walk(tree(path))
        if isinstance(node, Function) and not node.name.startswith("__")
    ]


def is_bare_participle(name: str) -> bool:
    word = name.strip("_")
    regular = re.fullmatch(r"[a-z]+ed", word) is not None and word not in NOT_PARTICIPLES
    return regular or word in IRREGULAR


@pytest.mark.parametrize("package", PACKAGES)
def test_no_public_function_is_named_by_a_participle_or_a_vague_word(package: str) -> None:
    found = [
        f"{path}:{node.lineno} {node.name}"
        for path, node in functions(package)
        if not node.name.startswith("_")
        and (is_bare_participle(node.name) or node.name.strip("_") in VAGUE)
    ]
    assert len(found) <= LEFT_NAMES[package], found


@pytest.mark.parametrize("name", ["told", "_beheld_not", "asked", "speed", "goal_poses", "_held"])
def test_participles_are_found(name: str) -> None:
    assert is_bare_participle(name) == (name in {"told", "asked", "_held"})

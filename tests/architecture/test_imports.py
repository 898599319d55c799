"""No module needs one that needs it; the contracts of rooms stand in pyproject.toml."""

from __future__ import annotations

import ast

import pytest

from tests.architecture.product import Imports, circles, imports, modules, room, tree

# `Result.report()` and `.explanation_rows()` make a report of the result, with an import inside.
ALLOWED = {("nlcontrol.results.result", "nlcontrol.reports")}

MOST_MODULES_OF_A_TYPING_CIRCLE = 3


@pytest.fixture(scope="module")
def found() -> dict[str, Imports]:
    known = modules()
    return {name: imports(tree(path), known) for name, path in known.items()}


def allowed(importing: str, imported: str) -> bool:
    return (importing, room(imported)) in ALLOWED


def test_no_circle_of_imports_at_run_time(found: dict[str, Imports]) -> None:
    graph = {
        name: frozenset(
            other for other in made.at_start | made.deferred if not allowed(name, other)
        )
        for name, made in found.items()
    }
    assert circles(graph) == []


def test_circles_for_typing_stay_small_and_inside_a_room(found: dict[str, Imports]) -> None:
    graph = {
        name: frozenset(
            other
            for other in made.at_start | made.deferred | made.typing
            if not allowed(name, other)
        )
        for name, made in found.items()
    }
    wrong = [
        circle
        for circle in circles(graph)
        if len(circle) > MOST_MODULES_OF_A_TYPING_CIRCLE or len({room(m) for m in circle}) > 1
    ]
    assert wrong == []


def test_the_exception_is_needed(found: dict[str, Imports]) -> None:
    for importing, imported in ALLOWED:
        assert any(room(other) == imported for other in found[importing].deferred)
        assert not any(room(other) == imported for other in found[importing].at_start)


def test_circles_are_found() -> None:
    assert circles({"a": frozenset("b"), "b": frozenset("c"), "c": frozenset()}) == []
    graph = {"a": frozenset("b"), "b": frozenset("c"), "c": frozenset("b"), "d": frozenset("a")}
    assert circles(graph) == [["b", "c"]]


def test_imports_are_told_apart_by_when_they_happen() -> None:
    known = modules()
    source = """
import objectmodels.geometry.rotations
from typing import TYPE_CHECKING
if TYPE_CHECKING:
    from planner.types import plan
def report():
    from nlcontrol.reports import result_report
    from grammar import parse
"""
    assert imports(ast.parse(source), known) == Imports(
        at_start=frozenset({"objectmodels.geometry.rotations"}),
        deferred=frozenset({"nlcontrol.reports.result_report", "grammar"}),
        typing=frozenset({"planner.types.plan"}),
    )

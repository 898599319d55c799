"""No error can be made without a suggestion, and none is made with an empty one."""

from __future__ import annotations

import ast

import pytest

from grammar import ParseError
from objectmodels import ModelError
from sim.errors import PictureError, SceneError, SimError
from tests.architecture.product import modules, tree

KINDS: tuple[type[Exception], ...] = (
    ModelError, ParseError, PictureError, SceneError, SimError,
)  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_an_error_needs_suggestions(kind: type[Exception]) -> None:
    """`mypy` says so of every call, this of the classes."""
    with pytest.raises(TypeError, match="suggestions"):
        kind("bad_value", "something is wrong", *((None,) if kind is ParseError else ()))


def test_suggestions_are_not_empty() -> None:
    """What may come out empty (names that are near, say) has something behind an `or`."""
    empty = [
        f"{module}: line {call.lineno}"
        for module, path in modules().items()
        for call in ast.walk(tree(path))
        if isinstance(call, ast.Call)
        for argument in call.keywords
        if argument.arg == "suggestions" and _may_be_empty(argument.value)
    ]
    assert not empty


def _may_be_empty(given: ast.expr) -> bool:
    """Whether an expression is an empty tuple, or only names that are near to another."""
    if isinstance(given, ast.Tuple):
        return all(isinstance(part, ast.Starred) for part in given.elts)
    names = {node.id for node in ast.walk(given) if isinstance(node, ast.Name)}
    return "suggest" in names and not isinstance(given, ast.BoolOp)

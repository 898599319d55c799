"""No test depends on how busy the machine is: none has a limit of its own, or measures time."""

from __future__ import annotations

import ast
from collections.abc import Iterator

import pytest

from tests.architecture.product import ROOT

WAITS = {"wait", "result", "join", "communicate", "wait_for_run"}
"""Methods whose number is the longest time to wait."""

CLOCKS = {"monotonic", "perf_counter", "process_time", "time"}

ASKING = {"get", "post", "put", "delete", "request", "stream", "Client"}
"""Functions of httpx; without a limit of the caller's theirs is five seconds."""

ALLOWED = {
    "tests/patience.py": "the one limit, which ends what hangs",
    "tests/attacks/test_files.py": "of the processor's own time, a tenth of what is promised",
    "tests/physics/test_lids.py": "time of the simulated world",
    "tests/unit/sim/worlds/test_wall_clock.py": "a clock that is set by hand",
}
"""Files that may do so, each with why."""


def of_time(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """The lines of a test file that limit or measure time, and how."""
    awaited = {
        id(call)
        for block in ast.walk(tree)
        if isinstance(block, ast.With) and "TimeoutError" in ast.unparse(block.items[0])
        for call in ast.walk(block)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare) and any(map(_is_clock, ast.walk(node))):
            yield node.lineno, "compares times"
        if not isinstance(node, ast.Call) or id(node) in awaited:
            continue
        name = node.func.attr if isinstance(node.func, ast.Attribute) else ""
        named = {word.arg: word.value for word in node.keywords}
        if _is_number(named.get("timeout")):
            yield node.lineno, "has a limit of its own"
        if name in WAITS and any(map(_is_number, node.args)):
            yield node.lineno, "has a limit of its own"
        if (
            ast.unparse(node.func).startswith("httpx.")
            and name in ASKING
            and "timeout" not in named
        ):
            yield node.lineno, "has the limit of httpx"


def _is_clock(node: ast.AST) -> bool:
    if not isinstance(node, ast.Call):
        return False
    called = node.func
    if isinstance(called, ast.Attribute):
        return ast.unparse(called.value) == "time" and called.attr in CLOCKS
    return isinstance(called, ast.Name) and called.id in CLOCKS


def _is_number(node: ast.AST | None) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, int | float)


def test_tests_wait_as_long_as_it_takes() -> None:
    found = [
        f"{path.relative_to(ROOT).as_posix()}:{line} {what}"
        for path in sorted((ROOT / "tests").rglob("*.py"))
        if path.relative_to(ROOT).as_posix() not in ALLOWED
        for line, what in of_time(ast.parse(path.read_text("utf-8")))
    ]
    assert found == []


@pytest.mark.parametrize(
    "line",
    [
        "assert time.monotonic() - begun < 2.0",
        "assert process_time() - begun < 2.0",
        "process.wait(30)",
        "process.wait(timeout=30.0)",
        "service.wait_for_run(run.run_id, 20.0)",
        "httpx.get(url)",
        "with httpx.stream('GET', url) as stream:\n    pass",
        "socket.create_connection(place, timeout=10)",
    ],
)
def test_a_limit_is_noticed(line: str) -> None:
    assert list(of_time(ast.parse(line)))


def test_what_never_comes_may_be_waited_for() -> None:
    text = "with pytest.raises(TimeoutError):\n    run.result(0.1)\nrun.result(PATIENCE)\n"
    assert list(of_time(ast.parse(text))) == []

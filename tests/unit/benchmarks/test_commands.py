"""Command lines of the benchmarks: arguments of a function are its options."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from benchmarks.commands import run_command


def count(folder: Path, runs: int = 9, task: tuple[str, ...] = ("push", "turn")) -> int:
    """Counts something.

    In 100 % of the cases.
    """
    assert isinstance(folder, Path)
    return 10 * runs + len(task)


def keep_apart(write: Path | None = None) -> int:
    """Keeps something."""
    return 0 if write is None else len(write.parts)


def called(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int | None:
    monkeypatch.setattr(sys, "argv", ["program", *arguments])
    return run_command(count, keep_apart)


def test_defaults_are_those_of_the_function(monkeypatch: pytest.MonkeyPatch) -> None:
    assert called(monkeypatch, "count", "logs") == 92
    assert called(monkeypatch, "keep-apart") == 0


def test_options_have_the_kinds_of_the_arguments(monkeypatch: pytest.MonkeyPatch) -> None:
    assert called(monkeypatch, "count", "logs", "--runs", "2", "--task", "turn") == 21
    assert called(monkeypatch, "keep-apart", "--write", "a/b") == 2


@pytest.mark.parametrize("arguments", [(), ("count",), ("count", "logs", "--task", "fly")])
def test_what_is_missing_or_no_choice_is_refused(
    monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...]
) -> None:
    with pytest.raises(SystemExit, match="2"):
        called(monkeypatch, *arguments)


def test_the_texts_are_the_help(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for arguments in (("--help",), ("count", "--help")):
        with pytest.raises(SystemExit, match="0"):
            called(monkeypatch, *arguments)
    assert "100 % of the cases" in " ".join(capsys.readouterr().out.split())

"""The guide to frames: what it shows is what comes out."""

from __future__ import annotations

import io
import re
import shlex
from pathlib import Path

import pytest

from nlcontrol.cli import run

GUIDE = (Path(__file__).parents[2] / "docs" / "frames.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", GUIDE, re.MULTILINE | re.DOTALL)


def command(line: str) -> tuple[list[str], str]:
    """Arguments and standard input of a line of the guide."""
    echoed, _, last = line.rpartition(" | ")
    said = shlex.split(echoed, comments=True)
    return shlex.split(last, comments=True)[1:], said[1] if said else ""


def test_the_commands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for line in blocks("bash")[0].splitlines():
        shown, _, target = line.partition(" > ")
        args, said = command(shown)
        monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(said.encode())))
        assert run(args) == 0
        printed = capsys.readouterr().out
        if target:
            Path(target).write_text(printed)


def test_the_error(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    line, _, shown = blocks("console")[0].removeprefix("$ ").partition("\n")
    args, said = command(line)
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(said.encode())))
    assert run(args) == 3
    assert capsys.readouterr().err == shown


def test_the_python(capsys: pytest.CaptureFixture[str]) -> None:
    (code,) = blocks("python")
    found: dict[str, object] = {}
    exec(code, found)
    assert re.findall(r"print\(.*\)  # (.*)", code) == capsys.readouterr().out.splitlines()
    assert getattr(found["again"], "status") == "planned"  # noqa: B009

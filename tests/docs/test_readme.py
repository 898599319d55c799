"""The README's promises: its two commands, its Python, the files and options that it names."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
from pathlib import Path

import pytest

from nlcontrol.cli import run
from tests.docs.guide_blocks import code_blocks, console_runs, only_block

ROOT = Path(__file__).parents[2]
MOST_LINES = 120
README = (ROOT / "README.md").read_text(encoding="utf-8")


def _examples() -> list[list[str]]:
    block = only_block(README, "console")
    lines = [line.removeprefix("$ ") for line in block.splitlines()]
    return [shlex.split(line, comments=True)[1:] for line in lines]


def test_two_commands_each_doing_all_its_set_up() -> None:
    commands = code_blocks(README, "bash")
    assert len(commands) == 2
    for command in commands:
        assert command.startswith("python3 -m venv .venv && .venv/bin/pip install")
        assert command.count("\n") == 1


@pytest.mark.parametrize(
    "document",
    [
        "README.md",
        "CONTRIBUTING.md",
        "SECURITY.md",
        *(path.relative_to(ROOT).as_posix() for path in sorted((ROOT / "docs").rglob("*.md"))),
    ],
)
def test_linked_files_exist(document: str) -> None:
    path = ROOT / document
    text = path.read_text(encoding="utf-8")
    links = [link for link in re.findall(r"\]\(([^)]+)\)", text) if "://" not in link]
    missing = [link for link in links if not (path.parent / link.split("#")[0]).exists()]
    assert not missing


def test_it_is_read_in_a_few_minutes() -> None:
    assert README.count("\n") < MOST_LINES


@pytest.mark.parametrize("args", _examples(), ids=" ".join)
def test_examples_of_the_command_line(
    args: list[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    assert run(args) == 0
    assert capsys.readouterr().out


@pytest.mark.slow
def test_the_examples_of_the_guide_to_predictions(capsys: pytest.CaptureFixture[str]) -> None:
    text = (ROOT / "docs" / "predictions.md").read_text(encoding="utf-8")
    printed = ""
    for command, shown in console_runs(text):
        args = [arg for arg in shlex.split(command) if arg not in ("--output", "map.png")]
        assert run(args) == 0
        answer = capsys.readouterr().out
        assert shown in answer
        printed += answer
    first, second, *others = code_blocks(text, "python")
    exec(compile(first, "predictions.md", "exec"), {})
    printed += capsys.readouterr().out
    for code in (second, *others):
        exec(compile(code, "predictions.md", "exec"), {})
    assert "topples from 8.79 N on" in printed
    # The last lines: below the onset, the same at once, unlikely to topple, not sure over the cone.
    assert printed.splitlines()[-5:-1] == ["['none']", "['none']", "[0.]", "[False]"]


def test_the_python_of_the_readme() -> None:
    code = only_block(README, "python")
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(code, "README.md", "exec"), {})
    printed = out.getvalue()
    assert "topple" in printed.splitlines()[0]
    assert "I understood" in printed

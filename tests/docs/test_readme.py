"""The README's promises: its two commands, its Python, the files and options that it names."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
from pathlib import Path

import pytest

from nlcontrol.cli import run

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def _blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)


def _examples() -> list[list[str]]:
    (block,) = _blocks("console")
    lines = [line.removeprefix("$ ") for line in block.splitlines()]
    return [shlex.split(line, comments=True)[1:] for line in lines]


def test_two_commands_each_doing_all_its_set_up() -> None:
    commands = _blocks("bash")
    assert len(commands) == 2
    for command in commands:
        assert command.startswith("python3 -m venv .venv && .venv/bin/pip install")
        assert command.count("\n") == 1


@pytest.mark.parametrize("document", ["README.md", "CONTRIBUTING.md", "docs/models.md"])
def test_linked_files_exist(document: str) -> None:
    path = ROOT / document
    text = path.read_text(encoding="utf-8")
    links = [link for link in re.findall(r"\]\(([^)]+)\)", text) if "://" not in link]
    missing = [link for link in links if not (path.parent / link.split("#")[0]).exists()]
    assert not missing


@pytest.mark.parametrize("args", [e for e in _examples() if e[0] != "say"], ids=" ".join)
def test_examples_of_the_command_line(args: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(args) == 0
    assert capsys.readouterr().out


def test_the_python_of_the_readme() -> None:
    (code,) = _blocks("python")
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(code, "README.md", "exec"), {})
    printed = out.getvalue()
    assert "topple" in printed.splitlines()[0]
    assert "I understood" in printed


@pytest.mark.slow
def test_the_sentence_of_the_readme_is_carried_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (args,) = [e for e in _examples() if e[0] == "say"]
    replay = tmp_path / "run.html"
    assert run([*args, "--replay", str(replay)]) == 0
    assert "✗" not in capsys.readouterr().out
    page = replay.read_text(encoding="utf-8")
    # It opens without a network: nothing is loaded from elsewhere.
    assert not re.findall(r"<(?:script|link|img)[^>]+(?:src|href)=[\"']https?://", page)

"""The tutorials: each is followed as it stands there, and prints what it shows.

Blocks with a title are files; those of a console are commands with what they print, where … stands
for what is left out. Their lines are compared without regard to where they are wrapped. A block of
text after a program is what that prints.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import runpy
import shlex
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest

from nlcontrol.cli import run
from tests.service_process import serving

ROOT = Path(__file__).parents[2]
TUTORIALS = ROOT / "docs" / "tutorials"
BLOCK = re.compile(r'^```(\w+)(?: title="(\S+)")?\n(.*?)^```$', re.MULTILINE | re.DOTALL)


@pytest.fixture
def folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, objects_folder: Path
) -> Path:  # a checkout, as far as the tutorials need one
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def follow(tutorial: str) -> None:
    """Write the files of a tutorial and run its commands and programs, in their order."""
    printed = ""
    for language, title, block in blocks_of(tutorial):
        if title:
            Path(title).write_text(block, encoding="utf-8")
        if language == "console":
            follow_commands(block)
        elif language == "python":
            assert title, "a program has a name"
            printed = run_program(title)
        elif language == "text" and printed:
            assert block in printed


def blocks_of(tutorial: str) -> list[tuple[str, str, str]]:
    """Language, title and content of each block."""
    return BLOCK.findall((TUTORIALS / f"{tutorial}.md").read_text(encoding="utf-8"))


def run_program(name: str) -> str:
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        runpy.run_path(name, run_name="__main__")
    assert printed.getvalue()
    return printed.getvalue()


def follow_commands(block: str) -> None:
    for entry in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
        command, _, shown = entry.partition("\n")
        printed, told = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(told):
            status = run(shlex.split(command)[1:])
        assert status == (4 if "Refused" in shown else 0), printed.getvalue() + told.getvalue()
        parts = (" ".join(part.split()) for part in shown.split("…"))
        rest = " ".join(printed.getvalue().split())
        for part in parts:
            assert part in rest, f"{command} prints no more “{part}” in:\n{rest}"
            rest = rest.partition(part)[2] if part else rest


@pytest.mark.parametrize("tutorial", ["own_data", "own_executor"])
def test_a_tutorial(tutorial: str, folder: Path) -> None:
    follow(tutorial)


@pytest.mark.slow
def test_the_tutorial_on_scenes(folder: Path) -> None:
    follow("own_scene")


@pytest.mark.slow
@pytest.mark.parametrize("tutorial", ["first_sentence", "own_object"])
def test_a_tutorial_with_a_replay(tutorial: str, folder: Path) -> None:
    follow(tutorial)
    (replay,) = folder.glob("*.html")
    # It opens without a network: nothing is loaded from elsewhere.
    page = replay.read_text(encoding="utf-8")
    assert not re.findall(r"<(?:script|link|img)[^>]+(?:src|href)=[\"']https?://", page)


def test_the_mesh_of_the_example_is_the_one_that_its_script_writes(folder: Path) -> None:
    written = (folder / "examples" / "jar.stl").read_bytes()
    runpy.run_path(str(folder / "examples" / "make_jar.py"), run_name="__main__")
    assert (folder / "examples" / "jar.stl").read_bytes() == written


@pytest.mark.slow
def test_the_talk_in_the_shell(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (talk,) = (block for language, _, block in blocks_of("first_sentence") if language == "text")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.stdin", io.StringIO(talk))
        assert run(["shell"]) == 0
    assert capsys.readouterr().out.count("Done: every clause held.") == 3


def test_the_installation_names_extras_that_there_are() -> None:
    install, *_ = (block for language, _, block in blocks_of("first_sentence") if language == "sh")
    (extras,) = re.findall(r"pip install .*'\.\[(.*)\]'", install)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert set(extras.split(",")) <= set(project["optional-dependencies"])
    assert run(["doctor"]) == 0


@pytest.mark.slow
def test_programs_of_other_kinds(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    serve, ask = (block for language, _, block in blocks_of("another_program") if language == "sh")
    program, command, *options = shlex.split(serve)
    assert (program, command) == ("nlcontrol", "serve")
    with serving(*options, "--port", "0") as server:  # another program may have the port
        monkeypatch.setenv("URL", server.url)
        follow("another_program")
        for line in ask.splitlines():
            done = subprocess.run(
                ["bash", "-euc", line.replace("curl", "curl --fail", 1)],
                env=os.environ | {"URL": server.url},
                capture_output=True,
                check=True,
            )
            assert json.loads(done.stdout).get("error") is None

"""The tutorials: each is followed as it stands there, and prints what it shows.

Blocks with a title are files; those of a console are commands with what they print, where … stands
for what is left out. Their lines are compared without regard to where they are wrapped.
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
    text = (TUTORIALS / f"{tutorial}.md").read_text(encoding="utf-8")
    for language, title, block in BLOCK.findall(text):
        if title:
            Path(title).write_text(block, encoding="utf-8")
        if language == "console":
            follow_commands(block)
        elif language == "python":
            assert title, "a program has a name"
            run_program(title)


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


@pytest.mark.parametrize("tutorial", ["own_scene", "own_data"])
def test_a_tutorial(tutorial: str, folder: Path) -> None:
    follow(tutorial)


def test_the_executor_of_the_tutorial_ends_with_its_verdicts(folder: Path) -> None:
    follow("own_executor")
    printed = run_program("my_robot.py")
    assert "Done: every clause held." in printed
    assert "✗" not in printed


@pytest.mark.slow
@pytest.mark.parametrize("tutorial", ["first_sentence", "own_object"])
def test_a_tutorial_in_which_something_moves(tutorial: str, folder: Path) -> None:
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
def test_programs_of_other_kinds(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (TUTORIALS / "another_program.md").read_text(encoding="utf-8")
    with serving("--workers", "1", "--planners", "1") as server:
        monkeypatch.setenv("URL", server.url)
        follow("another_program")
        for line in re.findall(r"^curl .*$", text, re.MULTILINE):
            done = subprocess.run(
                ["bash", "-euc", line.replace("curl", "curl --fail", 1)],
                env=os.environ | {"URL": server.url},
                capture_output=True,
                check=True,
            )
            assert json.loads(done.stdout).get("error") is None

"""The page of errors: a section for each code, whose example ends in that error.

Programs of a part go on from the one that the part begins with; blocks with a title are files.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from nlcontrol.cli import run
from nlcontrol.errors import CODES, known_error
from tests.patience import PATIENCE
from tests.service_process import serving

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "errors.md").read_text(encoding="utf-8")
PARTS = dict(re.findall(r"^## (.*?)\n(.*?)(?=^## |\Z)", PAGE, re.M | re.S))
SLOW = {"The service": pytest.mark.slow}
BLOCK = re.compile(r'^```(\w+)(?: title="(\S+)")?\n(.*?)^```$', re.M | re.S)
SECTION = re.compile(r"^### `(\w+)`\n\n(.*?)(?=^### |\Z)", re.M | re.S)


class Example(NamedTuple):
    """What ends in an error, in the language of its block."""

    code: str
    language: str
    text: str


def _examples(section: str, code: str = "") -> Iterator[Example]:
    for language, title, text in BLOCK.findall(section):
        if not title:
            yield Example(code, language, text.strip())


SECTIONS = {code: text for part in PARTS.values() for code, text in SECTION.findall(part)}
EXAMPLES = [each for code, text in SECTIONS.items() for each in _examples(text, code)]
FILES = {title: text for _, title, text in BLOCK.findall(PAGE) if title}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with the files of the page, and the robot of the tutorial."""
    tutorial = (ROOT / "docs" / "tutorials" / "own_executor.md").read_text(encoding="utf-8")
    robot = {title: text for _, title, text in BLOCK.findall(tutorial) if title}
    for name, text in (FILES | robot).items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "README.md").write_text("# A readme\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    yield tmp_path
    for name in FILES | robot:
        sys.modules.pop(Path(name).stem, None)


def test_every_code_has_a_section_with_its_status_and_a_cure() -> None:
    assert sorted(re.findall(r"^### `(\w+)`$", PAGE, re.M)) == sorted(CODES)
    for code, section in SECTIONS.items():
        assert section.startswith(f"Exit {CODES[code].exit}, HTTP {CODES[code].http}. "), code
        assert "\nCure: " in section, code


def test_every_code_has_an_example() -> None:
    assert {each.code for each in EXAMPLES} == set(CODES)
    assert len(EXAMPLES) == len(CODES)


@pytest.mark.parametrize(
    "example", [e for e in EXAMPLES if e.language == "console"], ids=lambda e: e.code
)
def test_a_command_ends_in_the_error(
    example: Example, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    args = shlex.split(example.text.removeprefix("$ "))[1:]
    with_document = args if args[0] == "serve" else [*args, "--json"]
    assert run(with_document) == CODES[example.code].exit
    printed = capsys.readouterr()
    if args[0] == "serve":
        assert f"({example.code})" in printed.err
    else:
        assert json.loads(printed.out)["error"]["code"] == example.code


@pytest.mark.parametrize(
    "part",
    [pytest.param(part, marks=SLOW.get(name, ()), id=name) for name, part in PARTS.items()],
)
def test_the_programs_of_a_part_end_in_their_errors(part: str, folder: Path) -> None:
    names: dict[str, Any] = {"__name__": "page"}
    for each in _examples(part.partition("\n### ")[0]):
        exec(compile(each.text, "page", "exec"), names)
    for code, section in SECTION.findall(part):
        for each in _examples(section, code):
            if each.language == "python":
                assert _code_of_program(each.text, names) == code


def _code_of_program(program: str, names: dict[str, Any]) -> str:
    """Code of what a program raises, else what it prints."""
    printed = io.StringIO()
    try:
        with contextlib.redirect_stdout(printed):
            exec(compile(program, "page", "exec"), names)
    except Exception as raised:
        known = known_error(raised)
        if known is None:
            raise
        return known.code
    return printed.getvalue().strip()


@pytest.mark.slow
def test_what_a_shell_sends_ends_in_its_error(tmp_path: Path) -> None:
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    with serving("--workers", "1", "--planners", "1") as server:
        for example in (e for e in EXAMPLES if e.language == "sh"):
            done = subprocess.run(
                ["bash", "-euc", example.text],
                env=os.environ | {"URL": server.url, "PATH": path},
                cwd=tmp_path,
                capture_output=True,
                text=True,
                timeout=PATIENCE,
                check=False,
            )
            document = json.loads(done.stdout)
            assert document.get("error", document)["code"] == example.code, done.stderr

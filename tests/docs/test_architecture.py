"""The pages on the code: what they name exists, and the picture shows the rooms that are there."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = "grammar|objectmodels|planner|sim|nlcontrol"
PAGES = ("docs/architecture.md", "docs/glossary.md", "CONTRIBUTING.md")


def _text(page: str) -> str:
    return (ROOT / page).read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def drawing() -> ModuleType:
    spec = importlib.util.spec_from_file_location(
        "draw_architecture", ROOT / "docs" / "draw_architecture.py"
    )
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("page", PAGES)
def test_every_file_and_folder_that_is_named_exists(page: str) -> None:
    named = re.findall(rf"`((?:{PACKAGES}|tests|docs|benchmarks)/[\w./]*)`", _text(page))
    assert [path for path in named if not (ROOT / path).exists()] == []


def test_the_way_of_a_sentence_and_the_usual_changes_name_files() -> None:
    page = _text("docs/architecture.md")
    files = re.findall(rf"`((?:{PACKAGES})/[\w./]+\.py)`", page)
    assert {path.split("/")[0] for path in files} == set(PACKAGES.split("|"))
    assert len(set(files)) > 40


@pytest.mark.parametrize(
    "interface",
    re.findall(r"^\| ((?:`\w+`(?:, )?)+) \| `([\w/.]+)` \|", _text("docs/architecture.md"), re.M),
    ids=lambda found: found[0],
)
def test_every_interface_is_a_protocol_where_the_page_says(interface: tuple[str, str]) -> None:
    names, path = interface
    source = _text(path)
    for name in re.findall(r"`(\w+)`", names):
        assert re.search(rf"^class {name}\(.*\bProtocol\b.*\):", source, re.M), name


def test_the_picture_is_drawn_from_what_is_there(drawing: ModuleType) -> None:
    assert drawing.PICTURE.read_text("utf-8") == drawing.draw(), "run docs/draw_architecture.py"


def test_every_room_is_in_the_picture(drawing: ModuleType) -> None:
    for package in PACKAGES.split("|"):
        folders = {path.parent.name for path in (ROOT / package).glob("*/__init__.py")}
        assert set(drawing.rooms(package)) == folders


def test_the_numbers_in_the_picture_are_the_steps_of_the_table(drawing: ModuleType) -> None:
    steps = dict(re.findall(r"^\| (\d+) \| .* \| (.*) \|$", _text("docs/architecture.md"), re.M))
    assert list(steps) == [str(number) for number in range(1, 13)]
    drawn = {number for numbers in drawing.steps().values() for number in numbers.split()}
    assert drawn == set(steps)
    for room in drawing.steps():
        assert (ROOT / room.replace(".", "/")).is_dir()

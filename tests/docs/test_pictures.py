"""The pictures of the guides: drawn by the code of today, and none without a place."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from PIL import Image, ImageDraw

from docs.draw_pictures import IMAGES, LONG, QUICK, are_alike, outdated
from docs.take_replay_pictures import PICTURES

ROOT = Path(__file__).parents[2]


def test_what_is_drawn_within_seconds_is_of_today(capsys: pytest.CaptureFixture[str]) -> None:
    assert outdated() == []


def test_another_word_is_another_picture(tmp_path: Path) -> None:
    picture = Image.open(IMAGES / "explanation.png").convert("RGB")
    ImageDraw.Draw(picture).text((600, 60), "word", "black", font_size=30)
    picture.save(tmp_path / "other.png")
    assert are_alike(IMAGES / "explanation.png", IMAGES / "explanation.png")
    assert not are_alike(tmp_path / "other.png", IMAGES / "explanation.png")


def test_every_picture_is_shown_and_every_one_that_is_shown_is_there() -> None:
    pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
    shown = set(re.findall(r"images/([\w.]+)\)", "".join(p.read_text("utf-8") for p in pages)))
    assert shown == {path.name for path in IMAGES.iterdir()}
    assert set(QUICK | LONG | PICTURES) <= shown


def test_every_picture_has_a_command_that_draws_it() -> None:
    commands = "".join(path.read_text("utf-8") for path in (ROOT / "docs").glob("*.py"))
    assert [path.name for path in IMAGES.iterdir() if path.name not in commands] == []

"""The table and the drawing of the explanation: everything is there, nothing overlaps."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from nlcontrol.errors import ControlError
from nlcontrol.reports import word_explanation as drawing
from nlcontrol.reports.plan_drawing import Sheet
from nlcontrol.reports.word_explanation import groups, save_explanation, table
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from planner.plan_explanation import Row

SENTENCE = "push the ice tea box away without toppling it"
LONG = (
    "please slide the ice tea box very gently a little bit to the left with one finger at the "
    "bottom, with no more than 8 N, no faster than 3 cm/s, without toppling or turning it and "
    "without touching the coffee box"
)
SEQUENCE = "push the ice tea box a little to the left, then topple the cereal box to the left"
REFUSED = "push the ice tea box at the top without toppling it"
QUESTION = "how hard do I have to push the ice tea box to make it slide?"

Box = tuple[float, float, float, float]


class Watched(Sheet):
    """A sheet that remembers what was put where."""

    boxes: list[Box]
    texts: list[tuple[float, float, float, str]]

    def __init__(self, width: float) -> None:
        super().__init__(width)
        Watched.boxes, Watched.texts = [], []

    def box(
        self, x: float, y: float, width: float, height: float, colour: str, fill: str, **style: Any
    ) -> None:
        self.boxes.append((x, y, x + width, y + height))
        super().box(x, y, width, height, colour, fill, **style)

    def write(self, x: float, y: float, text: str, size: float, colour: str, **style: Any) -> None:
        bold = style.get("fontweight") == "bold"
        self.texts.append((x, x + self.length(text, size, bold=bold), y, text))
        super().write(x, y, text, size, colour, **style)


@pytest.fixture(scope="module")
def kitchen() -> Controller:
    return Controller("kitchen")


@pytest.mark.parametrize("sentence", [SENTENCE, LONG, SEQUENCE, REFUSED, QUESTION])
def test_nothing_overlaps_and_no_text_leaves_its_box(
    kitchen: Controller, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, sentence: str
) -> None:
    monkeypatch.setattr(drawing, "Sheet", Watched)
    result = Conversation(kitchen).say(sentence, plan_only=True)
    path = tmp_path / "words.png"
    save_explanation(result, path)
    for (a, b, c, d), (e, f, g, h) in combinations(Watched.boxes, 2):
        assert c <= e or g <= a or d <= f or h <= b
    for start, end, y, text in Watched.texts:
        around = [box for box in Watched.boxes if box[0] < start < box[2] and box[1] < y < box[3]]
        assert end <= (around[0][2] if around else drawing._WIDTH), text
    pixels = np.asarray(Image.open(path).convert("L"))
    # A blank rim: nothing is cut off at an edge of the picture.
    for rim in (pixels[:4], pixels[-4:], pixels[:, :4], pixels[:, -4:]):
        assert rim.min() > 250


def test_the_paper_s_figure_is_in_the_drawing(
    kitchen: Controller, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(drawing, "Sheet", Watched)
    save_explanation(Conversation(kitchen).say(SENTENCE, plan_only=True), tmp_path / "words.svg")
    said = {text: y for _, _, y, text in Watched.texts}
    for words, part in (
        ("push", "push controller"),
        ("ice tea box", "object model"),
        ("away", "wanted outcome"),
        ("without toppling it", "constraint"),
    ):
        assert abs(said[words] - said[part]) < 0.3  # side by side; groups are farther apart [in]


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_formats(kitchen: Controller, tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"words{suffix}"
    save_explanation(Conversation(kitchen).say(SENTENCE, plan_only=True), path)
    assert path.stat().st_size > 1000


def test_an_unknown_format(kitchen: Controller, tmp_path: Path) -> None:
    with pytest.raises(ControlError, match="cannot draw"):
        save_explanation(Conversation(kitchen).say(QUESTION), tmp_path / "words.doc")


def test_words_are_broken_where_they_do_not_fit() -> None:
    sheet = Sheet(10.0)
    text = "one two " + "x" * 100
    lines = sheet.lines_of(text, 1.0, 10.0)
    assert all(sheet.length(line, 10.0) <= 1.0 for line in lines)
    assert "".join(lines).replace(" ", "") == text.replace(" ", "")
    assert sheet.lines_of("", 1.0, 10.0) == [""]


ROWS = (
    Row(words="push", field="action: push", parameter="controller", value="push"),
    Row(words="box", field="object: box", parameter="mass", value="0.995 ± 0.038 kg"),
    Row(words="box", field="object: box", parameter="friction", value="0.378 ± 0.069"),
    Row(words="[red]away", field="goal", parameter="direction", value="away"),
    Row(words="", field="goal", parameter="distance", value="100 mm", default=True),
    Row(words="", field="controller", parameter="speed", value="50 mm/s", default=True),
    Row(words="it", field="constraint: no_tilt", parameter="", value="", problem=True),
)


def test_a_default_stays_with_the_part_that_it_completes() -> None:
    found = [(group.words, len(group.rows)) for group in groups(ROWS[:6])]
    assert found == [("push", 1), ("box", 2), ("[red]away", 2), ("", 1)]


def test_equal_parts_of_other_words_are_apart() -> None:
    twice = (ROWS[1], ROWS[1].model_copy(update={"words": "crate"}))
    assert [group.words for group in groups(twice)] == ["box", "crate"]


def test_the_table_names_each_group_of_words_once() -> None:
    text = table(ROWS)
    assert text.count("object: box") == 1
    assert "0.378 ± 0.069" in text
    assert "[red]away" in text  # no mark of the console
    assert "(not said)" in text
    assert "✗" in text

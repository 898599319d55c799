"""Results at a prompt and in a notebook: one line, and a page that loads nothing."""

from __future__ import annotations

import base64
import re

import numpy as np
import pytest

from nlcontrol import BoxModel, Controller, Result


@pytest.fixture(scope="module")
def results() -> dict[str, Result]:
    controller = Controller("kitchen", seed=0)
    sentences = {
        "planned": "push the ice tea box away without toppling it",
        "answered": "how heavy is the mug?",
        "refused": "push the mug at the top without toppling it",
        "not_understood": "<script>alert(1)</script> " + 40 * "and so on ",
    }
    return {name: controller.say(text, plan_only=True) for name, text in sentences.items()}


def test_a_result_is_one_short_line(results: dict[str, Result]) -> None:
    for status, result in results.items():
        shown = repr(result)
        assert status in shown
        assert len(shown) < 200
        assert "\n" not in shown
    assert len(repr(results["planned"].plan)) < 200
    assert len(repr(results["answered"].answer)) < 200


@pytest.mark.parametrize("count", [0, 1, 1000])
def test_thresholds_of_many_pushes_are_one_short_line(count: int) -> None:
    box = BoxModel(name="crate", size=(0.1, 0.1, 0.2), mass=1.0, friction=0.4)
    points = np.linspace([-0.05, 0.0, 0.0], [-0.05, 0.0, 0.2], count)
    found = box.predict(points, np.tile([3.0, 0.0, 0.0], (count, 1)))
    for value in (found, found.thresholds):
        assert len(repr(value)) < 200
        assert "\n" not in repr(value)


def test_a_notebook_shows_plan_picture_and_verdicts(results: dict[str, Result]) -> None:
    page = results["planned"]._repr_html_()
    (picture,) = re.findall(r'src="data:image/svg\+xml;base64,([^"]+)"', page)
    assert b"<svg" in base64.b64decode(picture)
    assert "two fingers" in page
    answer = results["answered"].answer
    assert answer is not None
    assert answer.text in results["answered"]._repr_html_()


def test_what_was_said_is_no_markup(results: dict[str, Result]) -> None:
    page = results["not_understood"]._repr_html_()
    assert "<script" not in page
    assert "&lt;script" in page

"""Results at a prompt and in a notebook: one line, and a page that loads nothing."""

from __future__ import annotations

import base64
import re
from xml.etree import ElementTree

import numpy as np
import pytest

from nlcontrol import BoxModel, Result
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.types import Check
from objectmodels.html_table import MOST_ROWS
from objectmodels.mechanics.outcome_map import COLOURS, outcome_map


@pytest.fixture(scope="module")
def results() -> dict[str, Result]:
    controller = Controller("kitchen", seed=0)
    sentences = {
        "planned": "push the ice tea box away without toppling it",
        "answered": "how heavy is the mug?",
        "refused": "push the mug at the top without toppling it",
        "not_understood": "<script>alert(1)</script> " + 40 * "and so on ",
    }
    return {
        name: Conversation(controller).say(text, plan_only=True) for name, text in sentences.items()
    }


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


def test_what_a_result_is_made_of_shows_itself(results: dict[str, Result]) -> None:
    plan = results["planned"].plan
    assert plan is not None
    page = plan._repr_html_()
    assert page.count("<tr>") == 1 + len(plan.actions)
    assert f"<td>{plan.push.force_limit:.2f}</td>" in page
    check = Check(clause="<b>", quantity="tilt", relation="at_most", expected=0.1, measured=0.05,
                  tolerance=0.01, unit="rad", verdict="held", ok=True)  # fmt: skip
    assert "&lt;b&gt;: held" in check._repr_html_()


def test_many_predictions_show_the_first_ones() -> None:
    box = BoxModel(name="crate", size=(0.1, 0.1, 0.2), mass=1.0, friction=0.4)
    points = np.linspace([-0.05, 0.0, 0.02], [-0.05, 0.0, 0.2], 1000)
    along = np.tile([1.0, 0.0, 0.0], (1000, 1))
    for found in (box.thresholds(points, along), box.predict(points, 3.0 * along)):
        page = found._repr_html_()
        assert page.count("<tr>") == 1 + MOST_ROWS + 1
        assert page.count("<td>…</td>") == 5
    assert "<td>3.92</td>" in box.thresholds(points, along)._repr_html_()  # μ m g


def test_a_map_has_a_square_for_each_contact() -> None:
    box = BoxModel(name="<crate>", size=(0.1, 0.1, 0.2), mass=1.0, friction=0.4)
    chart = outcome_map(box, box.faces()[2])
    page = chart._repr_html_()
    drawing = ElementTree.fromstring(page[page.index("<svg") :])
    squares = drawing.findall("{http://www.w3.org/2000/svg}rect")
    assert len(squares) == len(chart.force)
    for outcome in ("slide", "topple"):
        colours = [square.get("fill") for square in squares]
        assert colours.count(COLOURS[outcome]) == (chart.outcome == outcome).sum() > 10
    assert "<crate>" not in page

"""Texts for people: units, marks, quoted words."""

from __future__ import annotations

import math
from typing import Any

import pytest

from nlcontrol.answers import Answer
from nlcontrol.checks import Check
from nlcontrol.errors import ErrorInfo
from nlcontrol.report import check_line, plan_lines, report
from nlcontrol.result import Result, Step
from nlcontrol.text import error_lines, quantity, words
from planner.plan import DefaultUsed, Margins, Plan, Prediction, Push

SENTENCE = "push the ice tea box away without toppling it"


def _plan(**prediction: Any) -> Plan:
    predicted: dict[str, Any] = {
        "outcome": "slide", "onset": 3.7, "slide_force": 3.7, "topple_force": 14.2,
        "critical_height": 0.119, "critical_height_worst": 0.087, "probability": 0.9999,
        "stay_on_base_angle": 0.37, "tier": "exact", "friction": "static",
    }  # fmt: skip
    return Plan(
        push=Push(
            object="ice tea box", face="front", p_BC=(-0.045, 0.0, 0.031), normal_W=(-1, 0, 0),
            direction_W=(1, 0, 0), force_limit=6.0, speed=0.05, stroke=0.1, fingers=2,
            spread=0.054, ends_on="stroke",
        ),
        prediction=Prediction(**(predicted | prediction)),
        margins=Margins(force=4.3, height=0.056, lateral=0.018, sigmas=2.0, force_limit=1.2),
        displacement=(0.1, 0.0, 0.0),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.119, "m", "119 mm"),
        (-1e-9, "m", "0 mm"),
        (math.pi / 2, "rad", "90.0°"),
        (3.68, "N", "3.7 N"),
        (0.05, "m/s", "50 mm/s"),
        (0.378, "", "0.378"),
    ],
)
def test_quantities_are_read_in_everyday_units(value: float, unit: str, text: str) -> None:
    assert quantity(value, unit) == text


def test_words_of_several_spans() -> None:
    assert words(SENTENCE, [(0, 4), (21, 25)]) == "push … away"


def test_a_plan_says_where_how_hard_and_why() -> None:
    text = "\n".join(plan_lines(_plan()))
    for part in (
        "two fingers 54 mm apart", "front face", "31 mm above the table", "away",
        "at most 6.0 N at 50 mm/s over 100 mm", "it slides (probability over 0.999)",
        "sliding would start at 3.7 N", "toppling would start at 14.2 N", "above 119 mm",
        "87 mm in the worst case", "56 mm below where it could topple instead", "4.3 N more",
    ):  # fmt: skip
        assert part in text


def test_a_topple_is_safe_the_other_way_round() -> None:
    text = "\n".join(plan_lines(_plan(outcome="topple", probability=0.97)))
    assert "it topples (probability 0.970)" in text
    assert "56 mm above where it could slide instead" in text


def test_a_box_that_never_topples() -> None:
    never = _plan(critical_height=None, critical_height_worst=None, topple_force=None)
    assert "no push on this face topples it" in "\n".join(plan_lines(never))


@pytest.mark.parametrize(
    ("relation", "tolerance", "asked"),
    [
        ("about", 0.01, "100 mm ± 10 mm"),
        ("at_most", 0.0, "at most 100 mm"),
        ("at_least", 0.005, "at least 100 mm, tolerance 5 mm"),
    ],
)
def test_a_check_in_one_line(relation: Any, tolerance: float, asked: str) -> None:
    check = Check(
        clause="displace", spans=((21, 25),), quantity="moved", relation=relation, expected=0.1,
        measured=0.098, tolerance=tolerance, unit="m", ok=False,
    )  # fmt: skip
    assert check_line(SENTENCE, check) == f"  ✗ “away” moved: 98 mm (asked: {asked})"


def test_an_error_points_at_its_words() -> None:
    info = ErrorInfo(code="unknown_object", message="no", span=(9, 20), suggestions=("say box",))
    lines = list(error_lines(info, SENTENCE))
    assert lines == [
        "Error (unknown_object): no",
        f"  {SENTENCE}",
        "           ^^^^^^^^^^^",
        "  → say box",
    ]
    assert len(list(error_lines(info, "x" * 10_000))) == 2


def test_a_report_names_the_defaults_it_used() -> None:
    used = DefaultUsed(name="distance", value=0.1, unit="m", reason="not in the sentence")
    result = Result(
        ok=True, status="planned", text=SENTENCE, paraphrase="push it", plan=_plan(),
        defaults=(used,), scene="kitchen", seed=0,
    )  # fmt: skip
    assert "by default: distance 100 mm (not in the sentence)" in report(result)


def test_each_of_several_answers_is_told() -> None:
    steps = tuple(
        Step(frame=i, status="answered", answer=Answer(text=text))
        for i, text in enumerate(("It weighs 1 kg.", "It is 230 mm high."))
    )
    result = Result(
        ok=True, status="answered", text=SENTENCE, paraphrase="…", steps=steps,
        answer=steps[1].answer, scene="kitchen", seed=0,
    )  # fmt: skip
    text = report(result)
    assert text.index("Step 1") < text.index("1 kg") < text.index("Step 2") < text.index("230 mm")
    assert text.count("230 mm") == 1

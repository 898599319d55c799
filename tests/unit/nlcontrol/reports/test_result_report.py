"""Texts for people: units, marks, quoted words."""

from __future__ import annotations

import math
from typing import Any, get_args

import pytest

from grammar.frames import command as g
from nlcontrol.checks.verdicts import Check
from nlcontrol.errors import CODES, NO_PLAN, ErrorInfo
from nlcontrol.plan_text import plan_lines
from nlcontrol.questions.answer import Answer
from nlcontrol.reports.result_report import check_line, report
from nlcontrol.results.result import Execution, Result, Step
from nlcontrol.text_format import error_lines, quantity, words
from planner.types.actions import Aim, Limits, Margins, Prediction, Push
from planner.types.plan import DefaultUsed, Plan
from planner.types.refusal import RefusalReason
from tests.plans import changed_push, push_plan

SENTENCE = "push the ice tea box away without toppling it"


def _plan(**prediction: Any) -> Plan:
    predicted: dict[str, Any] = {
        "outcome": "slide", "onset": 3.7, "slide_force": 3.7, "topple_force": 14.2,
        "critical_height": 0.119, "critical_height_worst": 0.087, "probability": 0.9999,
        "stay_on_base_angle": 0.37, "tier": "exact", "friction": "static",
    }  # fmt: skip
    push = Push(
            object="ice tea box", face="front", p_BC=(-0.045, 0.0, 0.031), normal_W=(-1, 0, 0),
            direction_W=(1, 0, 0), force_limit=6.0, speed=0.05, stroke=0.1, fingers=2,
            spread=0.054, ends_on="stroke",
        )  # fmt: skip
    margins = Margins(force=4.3, height=0.056, lateral=0.018, sigmas=2.0, force_limit=1.2)
    return push_plan(push, Prediction(**(predicted | prediction)), margins)


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
    assert "anywhere on this face it slides before it topples" in "\n".join(plan_lines(never))


def _pushed(**changes: Any) -> str:
    return "\n".join(plan_lines(changed_push(_plan(), **changes)))


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"turn": 0.05}, "over 100 mm, turning it by 2.9° to the left"),
        ({"ends_on": "turned", "turn": -math.pi / 4}, "until it has turned by 45.0° to the right"),
        ({"ends_on": "toppled"}, "until it falls, at most over 100 mm"),
        (
            {"ends_on": "tilted", "tilt": math.radians(8)},
            "until it is tilted by 8.0°, then let it back",
        ),
        ({"ends_on": "tilted", "until": "tips"}, "until it begins to tip, then let it back"),
        ({"until": "moves"}, "until it moves, at most over 100 mm"),
        ({"until": "touching", "meets": "mug"}, "until it touches the mug, at most over 100 mm"),
        (
            {"limits": Limits(tilt=0.1, duration=4.0, clear_of=(("mug", 0.03),))},
            "stopped before it comes closer than 30 mm to the mug, tilts by more than 5.7° or "
            "has been pushed for 4.0 s.",
        ),
        ({"limits": Limits(turn=math.radians(10))}, "stopped before it turns by more than 10.0°."),
    ],
)
def test_how_far_a_push_goes_and_what_stops_it(changes: dict[str, Any], told: str) -> None:
    assert told in _pushed(**changes)


def test_a_push_without_limits_tells_none() -> None:
    assert "stopped" not in _pushed()


@pytest.mark.parametrize(
    ("end", "verb"), [("turned", "it turns"), ("tilted", "it tilts and stands again")]
)
def test_what_is_predicted_of_each_kind_of_push(end: str, verb: str) -> None:
    assert f"Predicted: {verb} (probability over 0.999)" in _pushed(ends_on=end)


def test_pushes_that_are_foreseen_and_where_they_lead() -> None:
    first = _plan()
    later = changed_push(first, face="left", direction_W=(0, -1, 0), stroke=0.05).push
    aim = Aim(x=0.55, y=-0.05, yaw=math.pi / 2)
    made = first.model_copy(
        update={"actions": (first.push, later, later), "aim": aim, "probability": 0.962}
    )
    lines = list(plan_lines(made))
    assert sum("Then, as foreseen: push the ice tea box" in line for line in lines) == 2
    assert any(line.startswith("  3. ") and "left face" in line for line in lines)
    told = "It should end at x 550 mm, y -50 mm, heading 90.0° (probability of all 3 pushes 0.962)."
    assert f"  {told}" in lines
    alone = "\n".join(plan_lines(first.model_copy(update={"aim": Aim(x=0.55, y=0.0)})))
    assert "It should end at x 550 mm, y 0 mm." in alone


def _result(**changes: Any) -> Result:
    given = {"ok": True, "text": SENTENCE, "paraphrase": "…", "scene": "kitchen", "seed": 0}
    return Result(**(given | changes))


def test_what_is_there_already() -> None:
    rest = Execution(
        end="reached", detail="", duration=1.0, displacement=(0, 0, 0), turned=0.0,
        largest_tilt=0.0, largest_force=0.0,
    )  # fmt: skip
    told = "It is there already: nothing is to be done."
    done = Step(frame=0, status="done", execution=rest)
    planned = Step(frame=0, status="planned")
    assert told in report(_result(status="done", steps=(done,), frames=(g.Frame(action="push"),)))
    for action, there in (("push", True), ("explore", False)):
        frame = g.Frame.model_validate({"action": action})
        text = report(_result(status="planned", steps=(planned,), frames=(frame,)))
        assert (told in text) is there
    assert told not in report(_result(status="planned", plan=_plan()))


def test_the_number_of_pushes_is_told() -> None:
    check = Check(
        clause="others", quantity="touched on the way", relation="is", expected="none",
        measured="none", verdict="held", ok=True,
    )  # fmt: skip
    step = Step(frame=0, status="done", plan=_plan(), plans=(_plan(),) * 3, checks=(check,))
    text = report(_result(status="done", steps=(step,)))
    assert "What happened, in 3 pushes:" in text
    assert "  ✓ touched on the way: none (asked: none)" in text
    once = step.model_copy(update={"plans": (_plan(),)})
    assert "What happened:" in report(_result(status="done", steps=(once,)))


@pytest.mark.parametrize("reason", get_args(RefusalReason))
def test_every_refusal_has_a_code_and_a_title(reason: str) -> None:
    assert CODES[reason].exit == NO_PLAN
    (line,) = error_lines(ErrorInfo(code=reason, message="no"))
    title = "Unsupported: no" if reason == "unsupported" else f"Refused ({reason}): no"
    assert line == title


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
        measured=0.098, tolerance=tolerance, unit="m", verdict="not_held", ok=False,
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

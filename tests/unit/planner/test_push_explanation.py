"""Each clause that is planned has its row, with the number that it became."""

from __future__ import annotations

import re

import pytest

from planner import Plan, plan
from planner.plan_explanation import Basis, Row, explain_push, quotation
from planner.types.defaults import DEFAULTS
from planner.types.world_state import PlanarPose
from tests.unit.planner.conftest import RuledReach, frame_of, world

STATE = world(ice_tea_box=PlanarPose(0.5, 0.0), mug=PlanarPose(0.5, 0.5))


def _rows(text: str) -> tuple[Row, ...]:
    frame = frame_of(text)
    made = plan(frame, STATE, RuledReach())
    assert isinstance(made, Plan), made
    basis = Basis.of(frame, STATE, DEFAULTS)
    assert basis is not None
    return explain_push(frame, made, text, basis)


def _of(rows: tuple[Row, ...], parameter: str, part: str | None = None) -> Row:
    (row,) = [r for r in rows if r.parameter == parameter and part in (None, r.part)]
    return row


def test_the_paper_s_sentence() -> None:
    rows = _rows("push the ice tea box away without toppling it")
    assert _of(rows, "controller").part == "push controller"
    mass = _of(rows, "mass")
    assert (mass.words, mass.part) == ("ice tea box", "object model")
    assert mass.value == "0.995 ± 0.038 kg"  # 0.0375 in the model's file
    assert _of(rows, "friction on the table").value == "0.378 ± 0.069"
    assert _of(rows, "size").value == "90 × 90 × 230 mm"
    assert _of(rows, "tips if pushed above").value == "119 mm"  # b / μ = 45 mm / 0.378
    direction = _of(rows, "direction")
    assert (direction.words, direction.part, direction.value) == ("away", "wanted outcome", "away")
    distance = _of(rows, "distance")
    assert (distance.words, distance.default) == ("", True)
    assert (distance.field, distance.value) == (direction.field, "100 mm (not said: by default)")
    margin = _of(rows, "margin")
    assert (margin.words, margin.part) == ("without toppling it", "constraint")
    assert re.match(r"\d+ mm below", margin.value)


@pytest.mark.parametrize(
    ("clause", "parameter", "value"),
    [
        ("without tilting it", "largest tilt", "5°"),
        ("without turning it", "largest turn", "10°"),
        ("without touching the mug", "free way", "10 mm or more from the mug"),
        ("with no more than 8 N", "force limit", "asked: at most 8 N"),
        ("with 6 N", "force limit", "6.0 N"),
        ("hard", "force limit", "8.0 N, ready to press with 8 N"),
        ("without tilting it more than 5 degrees", "stopped at a tilt of", "5°"),
        ("without turning it more than 5 degrees", "stopped at a turn of", "5°"),
        ("gently", "force limit", "25 % above what is needed"),
        ("gently", "largest speed", "20 mm/s (gentle, from the table of defaults)"),
        ("slowly", "largest speed", "20 mm/s (slow, from the table of defaults)"),
        ("no faster than 3 cm/s", "largest speed", "30 mm/s, asked: at most 30 mm/s"),
        ("with two fingers", "fingers", "two fingers 40 mm apart"),
        ("at the bottom", "heights allowed", "0 to 77 mm"),
        ("3 cm above the table", "heights allowed", "30 mm"),
        ("no contact above 4 cm", "heights allowed", "at most 40 mm"),
        ("at least 20 cm below the top", "heights allowed", "at most 30 mm"),
    ],
)
def test_every_clause_has_its_number(clause: str, parameter: str, value: str) -> None:
    rows = _rows(f"push the ice tea box away {clause}")
    row = _of(rows, parameter, "constraint")
    assert row.words == clause
    assert value in row.value


@pytest.mark.parametrize(
    ("words", "value", "default"),
    [
        ("a little", "50 mm (“a little”, from the table of defaults)", True),
        ("a lot", "200 mm (“a lot”, from the table of defaults)", True),
        ("15 cm", "150 mm", False),
        ("at least 15 cm", "160 mm, asked: at least 150 mm", False),
    ],
)
def test_words_for_an_amount_and_the_number_that_it_is(
    words: str, value: str, default: bool
) -> None:
    row = _of(_rows(f"push the ice tea box away {words}"), "distance")
    assert (row.words, row.value, row.default) == (f"away {words}", value, default)


def test_the_farthest_of_a_range() -> None:
    rows = _rows("push the ice tea box away, 5 to 10 cm")
    assert _of(rows, "distance", "wanted outcome").value == "60 mm, asked: at least 50 mm"
    assert "asked: at most 100 mm" in _of(rows, "distance", "constraint").value


def test_pushes_over_two_faces_are_told_with_where_they_lead() -> None:
    rows = _rows("push the ice tea box 14 cm away and to the left")
    words = "14 cm away … to the left"
    told = {p: _of(rows, p) for p in ("direction", "distance", "aim")}
    assert {row.words for row in told.values()} == {words}
    # What is asked is told, not what the first push does.
    assert told["direction"].value == "at heading 45°"
    assert told["distance"].value == "140 mm"
    assert told["aim"].value == "x 599 mm, y 99 mm, heading 0°"
    assert _of(rows, "controller").value.endswith("until it has gone 99 mm")
    pushes = _of(rows, "pushes")
    assert (pushes.words, pushes.part) == ("push", "push controller")
    assert re.fullmatch(
        r"2 foreseen; then (front|right) face, until it has gone 99 mm", pushes.value
    )


def test_a_place_is_told_with_where_it_is() -> None:
    rows = _rows("put the ice tea box 10 cm in front of the mug")
    assert _of(rows, "aim").words == "10 cm in front of the mug"
    # 40 mm of the mug, the gap, 45 mm of the box.
    assert _of(rows, "aim").value.startswith("x 315 mm, y ")
    assert "asked" not in _of(rows, "distance").value  # 10 cm is the gap


@pytest.mark.parametrize(
    ("text", "value", "default"),
    [
        ("turn the ice tea box 90 degrees to the left", "90° to the left", False),
        ("turn the ice tea box by at most 30 degrees to the right",
         "27° to the right, asked: at most 30°", False),
        ("turn the ice tea box a little to the left",
         "15° to the left (“a little”, from the table of defaults)", True),
        ("turn the ice tea box", "90° to the left (not said: by default)", True),
    ],
)  # fmt: skip
def test_turns_have_an_angle_and_no_direction(text: str, value: str, default: bool) -> None:
    rows = _rows(text)
    turn = _of(rows, "turn")
    assert (turn.value, turn.default) == (value, default)
    assert not [row for row in rows if row.parameter == "direction"]
    assert _of(rows, "outcome").value.startswith("turn, probability")
    assert "until it has turned by" in _of(rows, "controller").value
    assert "foreseen; then" in _of(rows, "pushes").value


def test_a_tilt_comes_back() -> None:
    rows = _rows("tilt the ice tea box by 5 degrees")
    assert _of(rows, "tilt").value == "5°"
    assert "until it is tilted by 5°, then let it back" in _of(rows, "controller").value
    assert not [row for row in rows if row.parameter in ("aim", "pushes", "distance")]


def test_the_event_ends_the_push() -> None:
    rows = _rows("push the ice tea box to the left until it touches the mug")
    assert _of(rows, "ends").value == "when it touches the mug"
    assert _of(rows, "ends").words == "until it touches the mug"


def test_what_is_done_in_time_is_not_done_at_the_default_speed() -> None:
    rows = _rows("push the ice tea box away within 6 s")
    speed = _of(rows, "largest speed")
    assert (speed.words, speed.default) == ("within 6 s", False)
    assert _of(rows, "stopped after").value == "6 s"


def test_what_was_not_said_is_named_as_such() -> None:
    rows = _rows("topple the ice tea box")
    assert _of(rows, "direction").default
    for parameter in ("largest speed", "contact", "force limit", "longest stroke"):
        row = _of(rows, parameter)
        assert (row.words, row.part, row.default) == ("", "left open", True)


def test_quoted_words_touch_overlap_or_stand_apart() -> None:
    text = "push the box 10 cm gently away"
    assert quotation(text, ((13, 18), (26, 30))) == "10 cm … away"
    assert quotation(text, ((19, 25), (13, 18))) == "10 cm gently"
    assert quotation(text, ((5, 12), (9, 12))) == "the box"

"""Sentences that have the robot find something out by touching."""

from __future__ import annotations

import json
import re

import pytest

import grammar
from grammar.frames import command as g
from nlcontrol.errors import ControlError
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.exploration_commands import EVERYTHING, is_unknown, requested_parameters
from objectmodels import BoxModel
from sim.simulated_executor import simulation
from tests.fakes.played_executor import played


@pytest.fixture
def kitchen() -> Controller:
    return Controller("kitchen", seed=0)


def frame(text: str) -> g.Frame:
    return grammar.parse(text).frames[0]


@pytest.mark.parametrize(
    ("text", "parameters"),
    [
        ("find out how heavy the ice tea box is", ("mass",)),
        ("weigh the ice tea box", ("mass",)),
        ("find out the friction and the weight of the ice tea box", ("friction", "mass")),
        ("find out the centre of mass of the ice tea box", ("com_x", "com_y", "com_z")),
        ("explore the ice tea box", EVERYTHING),
        ("gently explore the ice tea box without toppling it", EVERYTHING),
    ],
)
def test_the_parameters_that_a_sentence_wants(text: str, parameters: tuple[str, ...]) -> None:
    assert requested_parameters(frame(text)) == parameters


@pytest.mark.parametrize(
    ("text", "capability"),
    [
        ("find out how tall the ice tea box is", "finding out the height of objects"),
        ("explore the ice tea box with at most 1 N", "keeping max force while exploring"),
    ],
)
def test_what_touching_does_not_tell_is_said(
    kitchen: Controller, text: str, capability: str
) -> None:
    with pytest.raises(ControlError) as raised:
        requested_parameters(frame(text))
    assert raised.value.info.capability == capability
    result = Conversation(kitchen).say(text)
    assert (result.status, result.exit_status) == ("unsupported", 4)


def test_what_is_not_on_the_table_cannot_be_touched(kitchen: Controller) -> None:
    result = Conversation(kitchen).say("find out how heavy the soup can is")
    assert result.error is not None
    assert (result.error.code, result.exit_status) == ("not_on_table", 3)


@pytest.mark.parametrize(
    ("sd", "text", "expected"),
    [
        (0.20, "how slippery is the crate?", True),
        (0.05, "how slippery is the crate?", False),
        (0.20, "how heavy is the crate?", False),
        (0.20, "how tall is the crate?", False),
        (0.20, "what happens if you push the crate?", False),
    ],
)
def test_a_question_is_found_out_if_the_answer_is_not_known_well(
    sd: float, text: str, expected: bool
) -> None:
    crate = BoxModel(
        name="crate", size=(0.1, 0.1, 0.2), mass=1.0, mass_sd=0.02, friction=0.4,
        friction_sd=sd * 0.4,
    )  # fmt: skip
    assert is_unknown(frame(text), crate, 0.10) is expected


def test_a_plan_tells_what_would_be_touched_and_moves_nothing(kitchen: Controller) -> None:
    result = Conversation(kitchen).say("find out how slippery the coffee box is", plan_only=True)
    assert (result.status, result.ok, result.exit_status) == ("planned", True, 0)
    assert "would be touched (tilt and slide)" in result.notes[0]
    assert not simulation(kitchen.executor).is_built


def test_the_model_answers_a_question_and_offers_a_touch(kitchen: Controller) -> None:
    result = Conversation(kitchen).say("how slippery is the coffee box?")
    assert (result.status, simulation(kitchen.executor).is_built) == ("answered", False)
    assert result.answer is not None
    assert "0.313" in result.answer.text
    assert result.answer.numbers["friction_after_sd"] < result.answer.numbers["friction_sd"]
    assert "slide at the" in result.answer.lines[0]
    (command,) = re.findall("“(.*)”", result.answer.suggestions[0])
    assert kitchen.parse(command).frames[0].action == "explore"


def test_what_is_known_well_is_told_without_an_offer(kitchen: Controller) -> None:
    answer = Conversation(kitchen).say("how heavy is the soup can?").answer
    assert answer is not None
    assert (answer.lines, answer.suggestions) == ((), ())


def test_a_question_touches_where_the_caller_lets_it(kitchen: Controller) -> None:
    executor = played(kitchen)
    Conversation(kitchen).say("how slippery is the coffee box?", motion="never")
    assert not executor.touched
    Conversation(kitchen).say("how slippery is the coffee box?", motion="simulate")
    assert executor.touched


def test_no_motion_means_none_for_a_command_either(kitchen: Controller) -> None:
    result = Conversation(kitchen).say("push the ice tea box away", motion="never")
    assert (result.status, simulation(kitchen.executor).is_built) == ("planned", False)


@pytest.mark.slow
def test_touches_that_show_nothing_are_told(kitchen: Controller) -> None:
    executor = played(kitchen)
    result = Conversation(kitchen).say("find out how heavy the ice tea box is")
    assert (result.status, result.exit_status) == ("refused", 4)
    assert result.error is not None
    assert result.error.code == "not_explorable"
    assert "tilt at the front: the arm does not reach" in result.error.suggestions
    assert executor.touched


@pytest.mark.slow
def test_find_out_how_heavy_it_is(kitchen: Controller) -> None:
    before = kitchen.models["ice tea box"]
    result = Conversation(kitchen).say("find out how heavy the ice tea box is")
    assert (result.status, result.ok) == ("done", True)
    model, truth = kitchen.models["ice tea box"], simulation(kitchen.executor).truth("ice tea box")
    assert model.mass_sd < 0.03 * model.mass < before.mass_sd
    # Two or three touches, known to 3 %: three standard deviations.
    assert model.mass == pytest.approx(truth.mass_kg, abs=3.0 * model.mass_sd)
    assert "explored by touching" in model.provenance.source
    (step,) = json.loads(result.to_json())["steps"]
    assert {t["as_meant"] for t in step["exploration"]["touches"]} == {True}
    assert step["exploration"]["truth"] is None
    assert result.trace is not None
    assert result.trace.tilt("ice tea box").max() > 0.05
    again = Conversation(kitchen).say("how heavy is the ice tea box?", plan_only=True)
    assert f"{model.mass:.3f} kg" in str(again)

"""Questions about what a whole hand does, and about what is spilled."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from grammar.frames import command as g
from nlcontrol.errors import ControlError
from nlcontrol.learning.lessons import change_contents
from nlcontrol.questions.grasp_questions import spill_answer
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from planner.types.defaults import DEFAULTS
from planner.types.world_state import PlanarPose, WorldState
from tests.unit.planner.conftest import world


@pytest.fixture(scope="module")
def kitchen() -> Controller:
    return Controller("kitchen")


@pytest.mark.slow
def test_too_heavy_with_both_forces(kitchen: Controller) -> None:
    answer = Conversation(kitchen).say("can you lift the ice tea box?").answer
    assert answer is not None
    assert answer.yes is False
    assert answer.numbers["needed_force"] > answer.numbers["strongest"] > 0.0
    held = Conversation(kitchen).say("will the ice tea box hold if you lift it?").answer
    assert held is not None
    assert held.yes is False
    assert held.text == answer.text


def test_what_can_be_lifted_says_how(kitchen: Controller) -> None:
    answer = Conversation(kitchen).say("can you lift the ice tea?").answer
    assert answer is not None
    assert answer.yes is True
    assert answer.text.startswith("Yes: lift it by 100 mm and hold it, held from its side")
    assert answer.numbers["squeeze"] > answer.numbers["needed_squeeze"]
    held = Conversation(kitchen).say("will it hold if you lift the ice tea?").answer
    assert held is not None
    assert held.probability is not None
    assert held.probability > 0.95


def test_more_than_the_mug_holds(kitchen: Controller) -> None:
    answer = Conversation(kitchen).say("can you pour 500 ml of the ice tea into the mug?").answer
    assert answer is not None
    assert answer.yes is False
    assert answer.numbers["volume"] == pytest.approx(5e-4)
    assert answer.numbers["room"] < 5e-4


def test_how_full(kitchen: Controller) -> None:
    answer = Conversation(kitchen).say("how much is in the ice tea?").answer
    vessel = kitchen.models["ice tea"].vessel
    assert answer is not None
    assert vessel is not None
    assert answer.text.startswith("The ice tea holds 200 ml ± 70 ml, ")
    assert answer.numbers["fill"] == pytest.approx(2e-4 / vessel.capacity)


# -- what is spilled ----------------------------------------------------------------------------


def test_a_tilt_spills_what_stands_above_the_lip(kitchen: Controller) -> None:
    answer = Conversation(kitchen).say(
        "how much will spill if you tilt the ice tea to the left by 100 degrees?"
    )
    assert answer.answer is not None
    model, pose = kitchen.models["ice tea"], kitchen.look().objects["ice tea"].pose
    assert model.vessel is not None
    brim = float(model.vessel.brim(math.radians(100), math.pi / 2 - pose.yaw))
    # Both look once; the camera's noise turns the carton by less than a degree.
    assert answer.answer.numbers["spilled"] == pytest.approx(2e-4 - brim, abs=2e-6)
    assert answer.answer.yes is True
    assert " ± " in answer.answer.text


def test_a_little_tilt_spills_nothing_and_says_from_when_on(kitchen: Controller) -> None:
    answer = (
        Conversation(kitchen).say("will it spill if you tilt the ice tea by 10 degrees?").answer
    )
    assert answer is not None
    assert answer.yes is False
    assert "begins to run out at" in answer.text


def test_a_closed_lid_keeps_it_in(kitchen: Controller) -> None:
    answer = (
        Conversation(kitchen)
        .say("how much will spill if you tilt the ice tea cup by 80 degrees?")
        .answer
    )
    assert answer is not None
    assert answer.yes is False
    assert "its lid is closed" in answer.text


def test_what_topples_lies_on_its_side() -> None:
    """The opening lies above the middle then, and a little over half of the carton is full."""
    kitchen = Controller("kitchen")
    question = "how much will spill if you topple the ice tea to the left?"
    answer = Conversation(kitchen).say(question).answer
    assert answer is not None
    assert answer.push is not None
    assert 0.0 < answer.numbers["spilled"] < 10e-6
    assert answer.numbers["spilled"] == pytest.approx(2e-4 - answer.numbers["brim"])
    # With a quarter less, what is in it stays below the opening.
    kitchen.models["ice tea"] = change_contents(kitchen.models["ice tea"], -50e-6)
    answer = Conversation(kitchen).say(question).answer
    assert answer is not None
    assert answer.numbers["brim"] > answer.numbers["contents"]
    assert "on its side, it would spill nothing: it begins to run out at 9" in answer.text


def test_what_is_no_container_is_named(kitchen: Controller) -> None:
    box = g.ObjectRef(text="cereal box", id="cereal box")
    frame = g.Frame(
        query="predict", event="spills", action="tilt", object=box, goal=g.Tilt(angle=0.5)
    )
    with pytest.raises(ControlError) as raised:
        kitchen.answer(frame)
    assert raised.value.info.capability == "knowing what is in the cereal box"


@pytest.mark.slow
def test_affordances_of_a_hand(kitchen: Controller) -> None:
    found = {a.outcome: a for a in kitchen.affordances("ice tea") if not a.direction}
    assert found.keys() == {"lift", "pour"}
    assert found["lift"].can
    assert "squeezed with" in found["lift"].message


@pytest.mark.parametrize(("ml", "spills"), [(0.7, False), (1.4, True)])
def test_a_drop_is_not_spilled(ml: float, spills: bool) -> None:
    state, angle = world(ice_tea=PlanarPose(0.5, 0.0)), np.radians(60.0)
    carton = state.objects["ice tea"]
    vessel, container = carton.model.vessel, carton.model.container
    assert vessel is not None
    assert container is not None
    contents = float(vessel.brim(angle, 0.0)) + ml * 1e-6
    known = container.model_copy(update={"contents_l": 1e3 * contents, "contents_l_sd": 0.0})
    model = carton.model.model_copy(update={"container": known})
    full = WorldState({"ice tea": replace(carton, model=model)}, state.table)
    frame = g.Frame(
        query="predict", event="spills", action="tilt",
        object=g.ObjectRef(text="ice tea", id="ice tea"),
        goal=g.Tilt(angle=angle, direction="away"),
    )  # fmt: skip
    answer = spill_answer(frame, full, DEFAULTS)
    assert answer.numbers["spilled"] == pytest.approx(ml * 1e-6)
    assert answer.yes == spills

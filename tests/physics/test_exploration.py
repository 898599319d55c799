"""Explorations in the simulated world: what the robot finds, and what it cannot know."""

from __future__ import annotations

import numpy as np
import pytest

from nlcontrol.learning.exploration_session import Exploration, explore
from nlcontrol.session.controller import Controller
from objectmodels.mechanics.outcome_map import outcome_map
from sim import load_scene
from sim.exploration.exploration_run import Explorer, Touched
from tests.lone_objects import with_only

NAME = "ice tea box"
GAIN = 0.05
SEED = 3


def explored(gain: float) -> Exploration:
    """One repetition with the box of the kitchen, the force sensors off by a common factor."""
    kitchen = with_only(load_scene("kitchen"), NAME)
    sensor = kitchen.torque_sensor.model_copy(update={"gain_error": gain})
    scene = kitchen.model_copy(update={"torque_sensor": sensor})
    controller = Controller(scene, seed=SEED)
    return explore(controller.executor, controller.models, NAME, repetitions=1)


@pytest.fixture(scope="module")
def slid() -> Touched:
    """A tilt of the tea tin, which needs 0.35 of its weight where 0.28 slides it."""
    controller = Controller("counter", seed=SEED)
    name = "tea tin"
    # What the robot believes makes a tilt likely.
    model = controller.models[name].model_copy(update={"friction": 0.6})
    controller.models[name] = model
    state = controller.look()
    explorer = Explorer(name, controller.executor, lambda: state, learn=lambda _: None)
    assert not explorer.touch("tilt", "front", 0)
    return explorer.touches[0]


@pytest.mark.slow
def test_a_tilt_that_slides_is_given_up_and_tells_what_it_showed(slid: Touched) -> None:
    assert slid.recording.end == "guard"
    assert slid.recording.detail == "it slides where it should tilt"
    truth = load_scene("counter").object("tea tin").truth
    (trial,) = slid.trials
    assert trial.moved == "slide"
    # Pressed high: the finger's friction takes a tenth of the weight, and the tin creeps first.
    load = truth.mass_kg * 9.81 - trial.force[2]
    assert np.hypot(*trial.force[:2]) / load == pytest.approx(truth.friction_table, rel=0.05)
    assert not slid.as_meant


@pytest.fixture(scope="module")
def right() -> Exploration:
    return explored(0.0)


@pytest.fixture(scope="module")
def scaled() -> Exploration:
    return explored(GAIN)


@pytest.mark.slow
def test_a_robot_finds_the_parameters_in_one_repetition(right: Exploration) -> None:
    truth = load_scene("kitchen").object(NAME).truth
    # Five touches; the sensors' zeros and where the far edge lies tell forces to about half a
    # percent, and one tilt of each side does not average that out.
    assert right.model.mass == pytest.approx(truth.mass_kg, rel=0.015)
    assert right.model.friction == pytest.approx(truth.friction_table, rel=0.03)
    assert right.model.finger_friction == pytest.approx(truth.friction_finger, rel=0.03)
    np.testing.assert_allclose(right.model.com, truth.centre_of_mass, atol=0.004)
    assert all(touch.as_meant for touch in right.report.touches)


@pytest.mark.slow
def test_a_gain_error_goes_into_the_mass_alone(right: Exploration, scaled: Exploration) -> None:
    # The same noise on forces that are 5 % larger, and a hand that gives way to them a little more:
    # 0.3 % of a force.
    assert scaled.model.mass / right.model.mass == pytest.approx(1.0 + GAIN, rel=0.005)
    assert scaled.model.friction == pytest.approx(right.model.friction, rel=0.005)
    assert scaled.model.finger_friction == pytest.approx(right.model.finger_friction, rel=0.01)
    np.testing.assert_allclose(scaled.model.com, right.model.com, atol=0.001)


@pytest.mark.slow
def test_a_gain_error_changes_no_predicted_class(right: Exploration, scaled: Exploration) -> None:
    one, other = (
        outcome_map(found.model, found.model.faces()[0], spacing=0.005) for found in (right, scaled)
    )
    # Places at the rim of the band in which an outcome is undecided may enter or leave it.
    decided = (one.outcome != "undecided") & (other.outcome != "undecided")
    assert decided.mean() > 0.9
    assert set(one.outcome[decided]) == {"slide", "topple"}
    np.testing.assert_array_equal(one.outcome[decided], other.outcome[decided])
    # Every force is predicted as much too large as the sensors read it.
    np.testing.assert_allclose(other.force / one.force, 1.0 + GAIN, rtol=0.01)

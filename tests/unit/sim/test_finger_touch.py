"""One push by the robot's finger: what it feels, what the observer saw, and what it cannot do."""

from __future__ import annotations

import dataclasses
import pickle

import pytest

from nlcontrol.session.controller import Controller
from sim import face_experiment as appliedforce
from sim import load_scene
from sim.face_experiment import Contact, FingerTouch
from sim.simulated_executor import fresh_robot
from sim.truth.scene_file import Scene

SCENE = load_scene("kitchen")
BELIEVED = Controller(SCENE).models
FINGER = FingerTouch(BELIEVED, fresh_robot)
LOW = Contact("coffee box", "front", (-0.031, 0.03, 0.05), (-1.0, 0.0, 0.0), (1.0, 0.0, 0.0))
HIGH = dataclasses.replace(LOW, point=(-0.031, 0.0, 0.16))


def with_mass(mass: float) -> Scene:
    """The scene with another coffee box in it."""
    changed = [
        item.model_copy(update={"truth": item.truth.model_copy(update={"mass_kg": mass})})
        if item.name == LOW.object
        else item
        for item in SCENE.objects
    ]
    return SCENE.model_copy(update={"objects": tuple(changed)})


@pytest.mark.slow
@pytest.mark.parametrize(("contact", "outcome"), [(LOW, "slide"), (HIGH, "topple")])
def test_it_feels_what_an_applied_force_needs(contact: Contact, outcome: str) -> None:
    felt, applied = FINGER(SCENE, contact, seed=0), appliedforce.touch(SCENE, contact, seed=0)
    assert felt.outcome == applied.outcome == outcome
    # The sensors are a per cent off; what the fingertip drags along the face adds up to two.
    assert felt.force is not None
    assert felt.force == pytest.approx(applied.force, rel=0.03)


@pytest.mark.slow
def test_it_feels_what_is_true_and_not_what_is_believed() -> None:
    true = FINGER(with_mass(0.75), LOW, seed=0)
    assert true.force is not None
    assert true.force == pytest.approx(appliedforce.touch(with_mass(0.75), LOW).force, rel=0.03)


@pytest.mark.slow
def test_a_copy_elsewhere_finds_the_same() -> None:
    elsewhere = pickle.loads(pickle.dumps(FINGER))
    assert elsewhere(SCENE, LOW, seed=3) == FINGER(SCENE, LOW, seed=3)


@pytest.mark.slow
def test_what_does_not_move_under_the_finger_says_nothing() -> None:
    found = FINGER(with_mass(8.0), LOW, seed=0)
    assert (found.outcome, found.force) == (None, None)
    assert "it does not move with" in found.detail


@pytest.mark.parametrize(
    ("contact", "why"),
    [
        (dataclasses.replace(LOW, point=(-0.031, 0.0, 0.005)), "touch the table"),
        (dataclasses.replace(LOW, direction=(0.8, 0.0, 0.6)), "straight in only"),
        (dataclasses.replace(LOW, normal=(-0.8, 0.0, 0.6), direction=(0.8, 0.0, -0.6)), "upright"),
    ],
)
def test_what_the_finger_cannot_do_is_said(contact: Contact, why: str) -> None:
    found = FINGER(SCENE, contact, seed=0)
    assert (found.outcome, found.force) == (None, None)
    assert why in found.detail

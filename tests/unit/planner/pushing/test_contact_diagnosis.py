"""What leaves an outcome open, and what would settle it."""

from __future__ import annotations

import numpy as np
import pytest

from objectmodels import BoxModel
from planner import plan
from planner.pushing.contact_refusals import Touch, best_experiment, outcome_probability
from planner.types.defaults import DEFAULTS
from planner.types.plan import Plan
from planner.types.refusal import Refusal
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from tests.unit.planner.conftest import RuledReach, frame_of

NORMAL = (-1.0, 0.0, 0.0)


def box(friction_sd: float, com_sd: float) -> BoxModel:
    return BoxModel(
        name="ice tea box", size=(0.09, 0.09, 0.23), mass=1.0, friction=0.378,
        friction_sd=friction_sd, com=(0.0, 0.0, 0.115), com_sd=(com_sd, com_sd, com_sd),
        finger_friction=0.1,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("model", "parameter"),
    [
        (box(friction_sd=0.10, com_sd=0.001), "friction"),
        (box(friction_sd=0.005, com_sd=0.02), "com"),
    ],
)
def test_the_worst_known_parameter_is_to_be_found_out(model: BoxModel, parameter: str) -> None:
    # Just above the critical height of 119 mm.
    touch = Touch(np.array([-0.045, 0.0, 0.135]), NORMAL, "topple")
    before = outcome_probability(model, touch)
    learn, then = best_experiment(model, touch, DEFAULTS)
    assert learn == parameter
    assert then > before


def test_a_refusal_says_how_likely_it_is_and_what_would_help() -> None:
    model = box(friction_sd=0.12, com_sd=0.001)
    state = WorldState({"ice tea box": SeenObject("ice tea box", PlanarPose(0.5, 0.0), model)})
    text = "topple the ice tea box 15 cm above the table"
    refusal = plan(frame_of(text), state, RuledReach())
    assert isinstance(refusal, Refusal)
    assert refusal.reason == "too_uncertain"
    assert refusal.numbers["probability"] < DEFAULTS.probability
    assert refusal.suggestions[0] == "find out how slippery the ice tea box is first"
    known = model.model_copy(update={"friction_sd": DEFAULTS.found_to * model.friction})
    sure = WorldState({"ice tea box": SeenObject("ice tea box", PlanarPose(0.5, 0.0), known)})
    assert isinstance(plan(frame_of(text), sure, RuledReach()), Plan)
    assert refusal.numbers["probability_then"] >= DEFAULTS.probability


@pytest.mark.parametrize(("friction_sd", "reason"), [(0.01, "impossible"), (0.12, "too_uncertain")])
def test_only_what_is_sure_not_to_happen_is_impossible(friction_sd: float, reason: str) -> None:
    model = box(friction_sd=friction_sd, com_sd=0.001)
    state = WorldState({"ice tea box": SeenObject("ice tea box", PlanarPose(0.5, 0.0), model)})
    # Below the critical height of 119 mm, which a friction of 0.45 would bring down to 100 mm.
    refusal = plan(frame_of("topple the ice tea box 10 cm above the table"), state, RuledReach())
    assert isinstance(refusal, Refusal)
    assert refusal.reason == reason
    assert "slides before it topples below 119 mm" in refusal.message
    if reason == "too_uncertain":
        assert 1.0 - DEFAULTS.probability < refusal.numbers["probability"] < 0.5
        assert refusal.suggestions[0] == "find out how slippery the ice tea box is first"


def test_what_has_begun_goes_on_where_it_would_not_begin() -> None:
    model = box(friction_sd=0.06, com_sd=0.001)
    state = WorldState({"ice tea box": SeenObject("ice tea box", PlanarPose(0.5, 0.0), model)})
    frame = frame_of("topple the ice tea box 15 cm above the table")
    refusal = plan(frame, state, RuledReach())
    assert isinstance(refusal, Refusal)
    assert DEFAULTS.probability_on < refusal.numbers["probability"] < DEFAULTS.probability
    before = plan(frame_of("push the ice tea box away"), state, RuledReach())
    assert isinstance(before, Plan)
    made = plan(frame, state, RuledReach(), previous=before)
    assert isinstance(made, Plan)
    assert made.probability == pytest.approx(refusal.numbers["probability"], abs=0.02)

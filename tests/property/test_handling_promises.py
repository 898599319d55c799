"""Plans of a whole hand keep their promises, whatever stands where."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from objectmodels import Registry
from objectmodels.containers.lids import flip
from objectmodels.models.object_parts import FlipLid
from planner import plan
from planner.problem.footprints import footprint, gap
from planner.problem.places import object_at
from planner.types.actions import Carry, PourOut
from planner.types.defaults import DEFAULTS
from planner.types.plan import Plan, Reached
from planner.types.refusal import Refusal
from planner.types.world_state import PlanarPose, SeenObject, TableState, WorldState
from tests.unit.planner.conftest import frame_of
from tests.unit.planner.grasping.conftest import RuledHand

TEXTS = (
    "lift the ice tea",
    "lift the ice tea cup gently",
    "put the ice tea to the left of the mug",
    "pour the ice tea into the mug",
    "open the ice tea cup",
    "open the jar",
)
NAMES = ("ice tea", "mug", "ice tea cup", "jar")
PLACES = ((0.3, -0.3), (0.6, -0.3), (0.3, 0.3), (0.6, 0.3))


def _state(yaw: float, scale: float, slippery: float) -> WorldState:
    registry, objects = Registry.default(), {}
    for name, (x, y) in zip(NAMES, PLACES, strict=True):
        model = registry.get(name)
        known = {
            "mass": scale * model.mass,
            "finger_friction": slippery * model.finger_friction,
        }
        objects[name] = SeenObject(
            name, PlanarPose(x, y, yaw), model.model_copy(update=known), lid=0.0
        )
    return WorldState(objects, TableState(-0.2, 1.2, -0.8, 0.8))


@pytest.mark.slow
@settings(max_examples=30, deadline=None)
@given(
    text=st.sampled_from(TEXTS),
    yaw=st.floats(-math.pi, math.pi),
    scale=st.floats(1.0, 3.0),
    slippery=st.floats(0.5, 1.5),
    strongest=st.floats(2.0, 15.0),
)
def test_an_accepted_plan_keeps_its_promises(
    text: str, yaw: float, scale: float, slippery: float, strongest: float
) -> None:
    state, hand = _state(yaw, scale, slippery), RuledHand(strongest=strongest)
    made = plan(frame_of(text), state, hand)
    assert not isinstance(made, Reached)
    if isinstance(made, Refusal):
        assert made.message
        assert made.numbers
        return
    if not isinstance(made, Plan):
        return  # pushed there, since it is too heavy to be held
    assert made.probability >= DEFAULTS.probability
    if made.grasp is not None:
        _keeps_hold(made, state, 1.2 if "gently" in text else 1.5)
    _stands_free(made, state)
    model = state.objects[made.object].model
    if isinstance(model.lid, FlipLid) and made.task == "open":
        arc = flip(model, model.lid, end=DEFAULTS.lid_open)
        assert arc.least_margin >= DEFAULTS.lid_reserve
    for found in (step.prediction for step in made.steps if isinstance(step, PourOut)):
        assert found.spilled <= DEFAULTS.spill_tolerance * found.received


def _keeps_hold(made: Plan, state: WorldState, reserve: float) -> None:
    grasp = made.grasp
    assert grasp is not None
    assert reserve * grasp.needed <= grasp.squeeze * (1.0 + 1e-9)
    assert grasp.squeeze <= grasp.strongest * (1.0 + 1e-9)
    graspable = state.objects[made.object].model.grasp
    assert graspable is not None
    if grasp.part == "body":
        assert grasp.squeeze <= graspable.crush
        assert graspable.lowest <= grasp.p_BG[2] <= graspable.highest
    assert abs(np.linalg.norm(grasp.closing_W) - 1.0) < 1e-9
    assert abs(np.dot(grasp.closing_W, grasp.approach_W)) < 1e-9


def _stands_free(made: Plan, state: WorldState) -> None:
    """Where something is put, nothing else stands."""
    for step in made.steps:
        if isinstance(step, Carry) and made.task == "place":
            there = object_at(state.objects[made.object], np.array([step.to.x, step.to.y]))
            others = (seen for name, seen in state.objects.items() if name != made.object)
            assert all(gap(footprint(there), footprint(seen)) > 0.0 for seen in others)

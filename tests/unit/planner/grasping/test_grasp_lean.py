"""How far what is held leans: closed forms, and what is refused for it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from objectmodels import BoxModel
from objectmodels.mechanics.push_thresholds import GRAVITY
from planner.grasping.grasp_candidates import Candidate
from planner.grasping.grasp_selection import HAND_LEAN, Lean
from planner.types.defaults import DEFAULTS
from planner.types.robot import Grip
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from tests.unit.planner.grasping.conftest import CONTACTS, RuledHand, planned, refused

SHARES = np.array([1.0, 1 / 3, 1 / 3, 1 / 3])
UP = np.array([0.0, 0.0, 1.0])


def block(**changes: object) -> BoxModel:
    fields = {"name": "block", "size": (0.05, 0.12, 0.16), "mass": 0.4, "friction": 0.3,
              "finger_friction": 0.8, "com": (0.0, 0.0, 0.08)}  # fmt: skip
    return BoxModel(**{**fields, **changes})  # type: ignore[arg-type]  # fields of all types


def held(model: BoxModel, stiffness: float, *, y: float = 0.0, z: float = 0.08) -> Lean:
    grip = Grip(CONTACTS, SHARES, 11.0, (0.09, 0.04), stiffness=stiffness)
    middle = np.array([0.0, y, z])
    closing, approach = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    return Lean.of_grasp(model, Candidate("body", middle, closing, approach, 0.05, grip))


def test_a_weight_beside_the_hand_turns_it_against_the_springs() -> None:
    # At its height nothing but the springs holds it.
    found = held(block(), 1.2, y=-0.02)
    assert found.angle == pytest.approx(-0.4 * GRAVITY * 0.02 / 1.2)
    assert found.sd == pytest.approx(HAND_LEAN)
    # The moment balances: m g (e cos φ + h sin φ) = K φ, to second order in φ.
    lower = held(block(), 1.2, y=-0.02, z=0.13)
    phi = -lower.angle
    moment = 0.4 * GRAVITY * (0.02 * math.cos(phi) - 0.05 * math.sin(phi))
    assert 1.2 * phi == pytest.approx(moment, rel=phi**2)


def test_one_lift_in_six_leans_by_more_than_1_2_degrees_beyond_its_model() -> None:
    lean = held(block(), 1.2, y=-0.02)
    # Φ(1), since the other limit is seven deviations off.
    within = lean.probability_within(abs(lean.angle) + math.radians(1.2))
    assert within == pytest.approx(0.8413, abs=1e-4)


def test_what_is_not_known_of_the_weight_counts() -> None:
    unsure = block(mass_sd=0.08, com_sd=(0.001, 0.006, 0.02))
    by_place, by_mass = 0.4 * GRAVITY * 0.006 / 1.2, 0.2 * 0.4 * GRAVITY * 0.02 / 1.2
    expected = math.hypot(by_place, by_mass, HAND_LEAN)
    assert held(unsure, 1.2, y=-0.02).sd == pytest.approx(expected)


def test_a_weight_above_soft_fingers_tips() -> None:
    # m g h = 0.24 N·m per radian.
    assert math.isinf(held(block(com=(0.0, 0.0, 0.14)), 0.2).angle)
    assert held(block(com=(0.0, 0.0, 0.14)), 0.2).probability_within(1.0) == 0.0
    assert math.isfinite(held(block(com=(0.0, 0.0, 0.14)), 0.3).angle)


def test_probabilities_are_those_of_a_normal_law() -> None:
    # Φ(2) − Φ(−4), and half of it where the limit is the mean.
    assert Lean(0.01, 0.01).probability_within(0.03) == pytest.approx(0.97722, abs=1e-5)
    assert Lean(0.03, 0.001).probability_within(0.03) == pytest.approx(0.5, abs=1e-6)


@pytest.mark.parametrize(("stiffness", "holds"), [(math.inf, True), (2.0, True), (0.05, False)])
def test_what_would_hang_askew_is_not_lifted(stiffness: float, holds: bool) -> None:
    class Soft(RuledHand):
        def grasp(self, width: float, *, pinch: bool = False, depth: float = 0.0) -> Grip | None:
            found = super().grasp(width, pinch=pinch, depth=depth)
            return found and replace(found, stiffness=stiffness)

    model = block(com_sd=(0.001, 0.008, 0.005))
    state = WorldState({"block": SeenObject("block", PlanarPose(0.5, 0.0), model)})
    if holds:
        made = planned("lift the block", state, Soft())
        assert made.grasp is not None
        assert made.grasp.prediction.lean_sd >= HAND_LEAN
        assert made.probability >= DEFAULTS.probability
    else:
        assert refused("lift the block", state, Soft()).code == "hangs_askew"

"""What a plan promises holds, evaluated by the object model's plain thresholds.

Forces are drawn from the finger's friction cone, parameters within the plan's own standard
deviations; nothing of the planner's or the cone's code is used to judge.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from objectmodels import BoxModel
from planner import plan
from planner.types.defaults import DEFAULTS
from planner.types.plan import Plan
from planner.types.refusal import Refusal
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from tests.unit.planner.conftest import LIMITS, TABLE, RuledReach, frame_of

pytestmark = pytest.mark.slow

_AVERAGED = 0.04  # of a probability, averaged over few points (`mechanics.outcome_probability`)

SENTENCES = ("push the box away", "push the box to the left", "topple the box")


@st.composite
def boxes(draw: st.DrawFn) -> BoxModel:
    def number(low: float, high: float) -> float:
        return draw(st.floats(low, high, allow_nan=False))

    width, depth, height = number(0.05, 0.2), number(0.05, 0.2), number(0.08, 0.3)
    friction = number(0.2, 0.7)
    return BoxModel(
        name="box",
        size=(width, depth, height),
        mass=number(0.1, 2.0),
        friction=friction,
        finger_friction=number(0.3, 0.9),
        friction_sd=0.1 * friction,
        finger_friction_sd=0.05,
        com=(0.0, 0.0, number(0.3, 0.6) * height),
        com_sd=(0.002, 0.002, 0.02 * height),
    )


def _planned(text: str, box: BoxModel, yaw: float) -> Plan | None:
    state = WorldState({"box": SeenObject("box", PlanarPose(0.5, 0.0, yaw), box)}, TABLE)
    made = plan(frame_of(text), state, RuledReach())
    if isinstance(made, Plan):
        return made
    assert isinstance(made, Refusal)
    # A refusal always says why, with figures or with what is missing.
    assert made.message
    assert made.numbers or made.capability
    return None


@settings(max_examples=40, deadline=None)
@given(
    box=boxes(), text=st.sampled_from(SENTENCES), yaw=st.floats(-0.2, 0.2), seed=st.integers(0, 99)
)
def test_the_outcome_holds_for_forces_and_parameters_within_the_margins(
    box: BoxModel, text: str, yaw: float, seed: int
) -> None:
    made = _planned(text, box, yaw)
    if made is None:
        return
    rng, push = np.random.default_rng(seed), made.push
    c, s = math.cos(yaw), math.sin(yaw)
    R_WB = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    inward = -R_WB.T @ np.array(push.normal_W)
    across = np.cross([0.0, 0.0, 1.0], inward)
    held = any("stiffness" in note for note in made.notes)
    for _ in range(40):
        k = made.push.margins.sigmas
        shift = rng.uniform(-k, k, 5)
        drawn = box.model_copy(
            update={
                "friction": box.friction + shift[0] * box.friction_sd,
                "com": tuple(np.array(box.com) + shift[1:4] * np.array(box.com_sd)),
            }
        )
        reach = 0.35 if held else box.finger_friction + shift[4] * box.finger_friction_sd
        share, angle = reach * math.sqrt(rng.uniform()), rng.uniform(0.0, math.tau)
        # Two fingers take up what would turn the box: only forces through its middle count.
        sideways = 0.0 if push.fingers == 2 else math.cos(angle)
        force = inward + share * (math.sin(angle) * np.array([0.0, 0.0, 1.0]) + sideways * across)
        p = np.array(push.p_BC)
        if push.fingers == 2:
            p = p - (p - np.array(drawn.com)) @ across * across
        t = drawn.thresholds(p[None], (force / np.linalg.norm(force))[None])
        assert t.outcome[0] == made.push.prediction.outcome, (share, angle, made.push.margins)


@settings(max_examples=40, deadline=None)
@given(box=boxes(), text=st.sampled_from(SENTENCES), yaw=st.floats(-0.2, 0.2))
def test_the_contact_lies_on_its_face_and_numbers_are_sane(
    box: BoxModel, text: str, yaw: float
) -> None:
    made = _planned(text, box, yaw)
    if made is None:
        return
    push = made.push
    half = np.array([box.size[0] / 2, box.size[1] / 2])
    # On one of the side faces, and both fingertips on it too.
    assert np.min(np.abs(np.abs(push.p_BC[:2]) - half)) < 1e-9
    assert made.push.margins.lateral >= -1e-9
    assert LIMITS.lowest_height - 1e-9 <= push.p_BC[2] <= box.size[2] - 0.010 + 1e-9
    assert np.linalg.norm(push.direction_W) == pytest.approx(1.0)
    # The push goes into the face, at no more than the largest obliqueness.
    assert -np.dot(push.direction_W, push.normal_W) > math.cos(math.radians(17.6))
    assert push.force_limit >= made.push.prediction.onset
    assert 0.0 <= made.push.prediction.probability <= 1.0
    assert made.satisfying <= made.considered


@settings(max_examples=15, deadline=None)
@given(box=boxes(), distance=st.integers(3, 20))
def test_left_and_right_are_mirror_images(box: BoxModel, distance: int) -> None:
    centred = box.model_copy(update={"com": (0.0, 0.0, box.com[2])})
    left = _planned(f"push the box to the left {distance} cm", centred, 0.0)
    right = _planned(f"push the box to the right {distance} cm", centred, 0.0)
    # Whether a probability is enough is only as sure as the probability itself.
    for made in (left, right):
        assume(made is None or made.push.prediction.probability > DEFAULTS.probability + _AVERAGED)
    assert (left is None) == (right is None)
    if left is None or right is None:
        return
    mirrored = np.array([1.0, -1.0, 1.0])
    np.testing.assert_allclose(np.abs(right.push.p_BC), np.abs(left.push.p_BC), atol=1e-9)
    np.testing.assert_allclose(
        np.array(right.push.direction_W), mirrored * left.push.direction_W, atol=1e-9
    )
    assert right.push.force_limit == pytest.approx(left.push.force_limit)

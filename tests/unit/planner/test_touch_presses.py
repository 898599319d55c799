"""Presses and off-centre slides as they are planned: where the finger presses, and how far."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from planner.touch_experiments import PRESS, RAISED, experiments, press
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from tests.unit.planner.conftest import RuledReach, world

FRONT = np.array([-1.0, 0.0, 0.0])


def box(kitchen: WorldState) -> SeenObject:
    """A narrow one, 52 mm deep and 260 mm high."""
    return kitchen.objects["cereal box"]


def test_it_goes_straight_into_the_face_where_it_is_now(reach: RuledReach) -> None:
    turned = world(cereal_box=PlanarPose(0.6, 0.4, np.pi / 2))
    made = press(box(turned), np.array([-0.026, 0.03, 0.1]), FRONT, reach.limits)
    assert (made.push.face, made.push.p_BC) == ("right", (-0.026, 0.03, 0.1))
    assert made.push.direction_W == pytest.approx((0.0, 1.0, 0.0))
    assert made.name == "press at the right"


@pytest.mark.parametrize("height", [0.03, 0.255])
def test_whatever_moves_has_moved_enough_to_be_seen(
    kitchen: WorldState, reach: RuledReach, height: float
) -> None:
    made = press(box(kitchen), np.array([-0.026, 0.0, height]), FRONT, reach.limits)
    assert made.push.stroke >= PRESS
    # Turned about the far edge, 52 mm from the near one; equality where the tilt needs more.
    assert made.push.stroke / height * 0.052 >= RAISED - 1e-12


def test_it_is_none_of_the_experiments_that_find_parameters(
    kitchen: WorldState, reach: RuledReach
) -> None:
    assert "press" not in {e.kind for e in experiments(box(kitchen), reach.limits)}


def test_an_off_centre_slide_is_low_at_one_end_and_high_at_the_other(
    kitchen: WorldState, reach: RuledReach
) -> None:
    seen = box(kitchen)
    slides = [e for e in experiments(seen, reach.limits) if e.kind == "off-centre slide"]
    for low, high in zip(slides[::2], slides[1::2], strict=True):
        assert low.lateral == -high.lateral > 0.0
        assert low.push.p_BC[2] == pytest.approx(reach.limits.lowest_height)
        assert low.push.p_BC[2] < high.push.p_BC[2] <= 0.13
        inward = seen.pose.R_WB.T @ np.array(high.push.direction_W)
        assert seen.model.likelihood([high.push.p_BC], [inward], exact=False).slide[0] > 0.98


def test_it_stays_low_where_nothing_surely_slides(reach: RuledReach) -> None:
    state = world(cereal_box=PlanarPose(0.6, 0.0))
    sticky = box(state).model.model_copy(update={"friction": 1.5})
    seen = dataclasses.replace(box(state), model=sticky)
    slides = [e for e in experiments(seen, reach.limits) if e.kind == "off-centre slide"]
    low = reach.limits.lowest_height
    # It tilts from 26 mm / 1.5 on.
    assert [e.push.p_BC[2] for e in slides if e.push.face == "front"] == pytest.approx([low, low])

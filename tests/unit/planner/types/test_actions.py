"""Actions in words, and how far a fall is followed."""

from __future__ import annotations

import math

import pytest

from planner.types.actions import Grasp
from planner.types.world_state import PlanarPose
from tests.unit.planner.conftest import RuledReach, planned, world


@pytest.mark.parametrize(
    ("down", "words"),
    [
        (0.0, "from its side"),
        (2.0, "from its side"),
        (4.0, "askew from above"),
        (70.0, "askew from above"),
        (74.0, "from above"),
        (90.0, "from above"),
    ],
)
def test_a_hand_comes_from_the_side_or_from_above(down: float, words: str) -> None:
    pitch = math.radians(down)
    grasp = Grasp(
        p_BG=(0.0, 0.0, 0.1), closing_W=(0.0, 1.0, 0.0), width=0.06,
        approach_W=(math.cos(pitch), 0.0, -math.sin(pitch)),
        squeeze=5.0, needed=3.0, strongest=20.0,
    )  # fmt: skip
    assert grasp.approach_text == words


def test_a_push_follows_an_object_11_degrees_past_the_angle_from_which_it_falls() -> None:
    state = world(ice_tea_box=PlanarPose(0.5, 0.0))
    push = planned("topple the ice tea box away", state, RuledReach()).push
    model, doubt = state.objects["ice tea box"].model, push.margins.sigmas
    # The centre of mass is as low and as far back as it may be; so it falls latest.
    back = 0.5 * model.extents[0] - model.com[0] + doubt * model.com_sd[0]
    falls = math.atan2(back, model.com[2] - doubt * model.com_sd[2])
    # A stroke has 30 mm for what the model does not know.
    followed, _ = model.stroke_tilt((1.0, 0.0, 0.0), push.p_BC[2], push.stroke - 0.03)
    assert math.degrees(followed - falls) == pytest.approx(11.0, abs=1e-6)

"""Corrections end where the camera tells no more of them."""

from __future__ import annotations

import math

import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.corrections import LEFT_SO, Corrections
from planner.types.actions import Aim
from planner.types.defaults import DEFAULTS
from planner.types.world_state import PlanarPose
from sim.robots.cell_description import Vision
from sim.truth.scene_file import Scene, parse_scene
from tests.unit.planner.conftest import planned, world

SHARP, BIASED = Vision(), Vision(position_bias_m=0.008, angle_bias_deg=3.0)
SCENE = """
version: 1
name: biased
vision: {position_noise_m: 0.004, angle_noise_deg: 2.0, position_bias_m: 0.008, angle_bias_deg: 3.0}
objects:
  - name: coffee box
    model: coffee box
    pose: {x_m: 0.55, y_m: -0.05, yaw_deg: -20.0}
    truth:
      size_m: [0.062, 0.093, 0.18]
      mass_kg: 0.5
      friction_table: 0.3
      friction_finger: 0.8
      centre_of_mass_m: [0, 0, 0.088]
"""


def are_worth(vision: Vision, *offs: float, way: float = 0.1, turned: float = 0.0) -> bool:
    """Whether a push of a box that is off by the last of some distances is made [m]."""
    start = PlanarPose(0.45, 0.0)
    made = planned("push the coffee box away", world(coffee_box=start))
    aim = Aim(x=start.x + way, y=0.0, yaw=0.0)
    corrections = Corrections(vision, DEFAULTS)
    corrections.begin_at(start)
    found = True
    for off in offs:
        state = world(coffee_box=PlanarPose(aim.x - off, 0.0, math.radians(turned)))
        found = corrections.are_worth(made.model_copy(update={"aim": aim}), state)
    return found


@pytest.mark.parametrize(
    ("vision", "off", "way", "turned", "worth"),
    [
        (SHARP, 0.004, 0.1, 0.0, True),  # what a sharp camera sees is corrected
        (BIASED, 0.004, 0.1, 0.0, False),  # half the tolerance is 5 mm
        (BIASED, 0.007, 0.1, 0.0, True),
        (BIASED, 0.004, 0.012, 0.0, True),  # of a small amount a third is allowed
        (BIASED, 0.002, 0.1, 2.0, True),  # half of 3° is allowed
        (BIASED, 0.002, 0.1, 1.2, False),
    ],
)
def test_what_is_corrected(
    vision: Vision, off: float, way: float, turned: float, worth: bool
) -> None:
    assert are_worth(vision, off, way=way, turned=turned) == worth


def test_what_comes_no_nearer_is_left() -> None:
    assert are_worth(SHARP, 0.009, 0.008)
    assert not are_worth(SHARP, 0.007, 0.008)
    assert are_worth(SHARP, 0.02, 0.03)  # out of what is asked it must still come nearer


@pytest.mark.slow
def test_a_biased_camera_takes_few_pushes() -> None:
    """It took three, eight and five of them."""
    scene: Scene = parse_scene(SCENE)
    pushes = []
    for seed in (1, 2, 3):
        controller = Controller(scene, seed=seed)
        result = Conversation(controller).say("push the coffee box exactly 25 mm away")
        assert result.status == "done"
        pushes.append(len(result.steps[0].plans))
        assert LEFT_SO in result.notes
    assert max(pushes) <= 3

"""Flat things drawn along from above by the simulated robot."""

import numpy as np
import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from sim.truth.scene_file import parse_scene

pytestmark = pytest.mark.slow

SCENE = """
version: 1
name: flat
objects:
  - name: book
    model: book
    pose: {x_m: 0.45, y_m: -0.10, yaw_deg: 10}
    truth: {size_m: [0.15, 0.22, 0.03], mass_kg: 0.7, friction_table: 0.33, friction_finger: %s}
"""


def test_a_book_is_drawn_to_the_left() -> None:
    result = Conversation(Controller(parse_scene(SCENE % 0.62), seed=3)).say(
        "push the book 10 cm to the left"
    )
    assert result.status == "done", result.error
    (plan,) = result.steps[0].plans
    assert plan.push.press > 10.0
    trace = result.trace
    assert trace is not None
    # The camera is off by 2 mm, and the finger keeps its line to a few.
    np.testing.assert_allclose(trace.displacement("book")[:2], (0.0, 0.1), atol=0.005)
    pushing = trace.phase == "push"
    down = -np.sum([felt[pushing, 2] for felt in trace.felt.values()], axis=0)
    # Once it is there, the force is kept within a tenth.
    drawing = np.abs(down[len(down) // 2 : -200] / plan.push.press - 1.0)
    assert np.median(drawing) < 0.1


def test_a_fingertip_that_slips_over_it_is_felt() -> None:
    result = Conversation(Controller(parse_scene(SCENE % 0.3), seed=3)).say(
        "push the book 10 cm to the left"
    )
    assert result.status == "failed"
    trace = result.trace
    assert trace is not None
    assert trace.end == "slipped"
    assert np.hypot(*trace.displacement("book")[:2]) < 0.005

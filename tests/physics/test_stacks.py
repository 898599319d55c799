"""One thing put on another by the simulated robot."""

import numpy as np
import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from sim.truth.scene_file import parse_scene

pytestmark = pytest.mark.slow

SCENE = """
version: 1
name: stack
objects:
  - {name: mug, model: mug, pose: {x_m: 0.30, y_m: -0.25}}
  - {name: book, model: book, pose: {x_m: 0.45, y_m: 0.10, yaw_deg: 10}}
"""


def test_a_mug_is_put_on_a_book_and_stands_there() -> None:
    talk = Conversation(Controller(parse_scene(SCENE), seed=1))
    put = talk.say("put the mug on the book")
    assert put.status == "done", put.error
    assert put.trace is not None
    poses = put.trace.poses
    off = poses["mug"][-1, 4:] - poses["book"][-1, 4:]
    # The book is 30 mm high; slabs stand a tenth of a millimetre apart.
    np.testing.assert_allclose(off[2], 0.03, atol=3e-4)
    # The camera's noise, and what the arm gives way.
    assert np.hypot(off[0], off[1]) < 0.03
    assert np.linalg.norm(put.trace.displacement("book")) < 1e-3
    assert put.trace.tilt("mug")[-1] < np.radians(0.5)
    assert talk.say("push the book to the left", plan_only=True).status == "refused"
    down = talk.say("take the mug off the book and put it on the table", plan_only=True)
    assert down.status == "planned", down.error

"""One sentence after another while the hand holds something."""

import numpy as np
import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from sim import load_scene
from tests.lone_objects import with_only

pytestmark = pytest.mark.slow


def test_what_is_picked_up_is_put_down_before_anything_is_pushed() -> None:
    scene = with_only(load_scene("kitchen"), "mug", "ice tea box")
    controller = Controller(scene, seed=0)
    talk = Conversation(controller)
    lifted = talk.say("pick up the mug")
    assert lifted.status == "done", lifted.error
    assert controller.held is not None
    refused = talk.say("push the ice tea box away")
    assert refused.status == "refused"
    assert refused.error is not None
    assert "the hand holds the mug" in refused.error.message
    down = talk.say("put it down")
    assert down.status == "done", down.error
    assert controller.held is None
    assert down.trace is not None
    assert lifted.trace is not None
    moved = down.trace.poses["mug"][-1, 4:] - lifted.trace.poses["mug"][0, 4:]
    np.testing.assert_allclose(moved, 0.0, atol=0.004)  # the camera, and what the fingers push

"""Something put into an open box by the simulated robot."""

import numpy as np
import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from objectmodels import Registry
from sim.truth.scene_file import parse_scene

pytestmark = pytest.mark.slow

SCENE = """
version: 1
name: box
objects:
  - {name: storage bin, model: storage bin, pose: {x_m: 0.50, y_m: -0.05}}
  - {name: soup can, model: soup can, pose: {x_m: 0.65, y_m: 0.25}}
"""


def test_a_can_is_put_into_a_bin_and_stands_on_its_floor() -> None:
    inside = Registry.built_in().get("storage bin").inside
    assert inside is not None
    talk = Conversation(Controller(parse_scene(SCENE), seed=1))
    put = talk.say("put the soup can into the storage bin")
    assert put.status == "done", put.error
    assert put.trace is not None
    off = put.trace.poses["soup can"][-1, 4:] - put.trace.poses["storage bin"][-1, 4:]
    # Solids sink into one another by some hundredths of a millimetre.
    assert off[2] == pytest.approx(inside.floor, abs=3e-4)
    radius = 0.033
    assert (np.abs(off[:2]) + radius < 0.5 * np.array(inside.size)).all()
    assert np.linalg.norm(put.trace.displacement("storage bin")) < 1e-3
    # What is loaded is not pushed, as its load is not known to stand still.
    assert talk.say("push the storage bin away", plan_only=True).status == "refused"
    out = talk.say("take the soup can out of the storage bin", plan_only=True)
    assert out.status == "planned", out.error

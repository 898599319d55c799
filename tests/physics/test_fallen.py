"""What lies in the simulated world is pushed as it lies, and stood up."""

from __future__ import annotations

import numpy as np
import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from objectmodels import Registry
from objectmodels.geometry.rotations import from_quaternion
from sim.robots.cell_description import Vision
from sim.truth.object_truth import truth_as_believed
from sim.truth.scene_file import Pose, Scene, SceneObject

pytestmark = pytest.mark.slow

SUGAR = "sugar box"


@pytest.mark.parametrize(
    ("said", "upwards"),
    [
        (f"push the {SUGAR} 8 cm away", 0.0),  # its own axis stays level
        (f"stand the {SUGAR} up", 1.0),
    ],
)
def test_what_lies_is_moved_as_foreseen(said: str, upwards: float) -> None:
    model = Registry.built_in().get(SUGAR)
    lying = Pose(x_m=0.5, y_m=0.05, yaw_deg=30.0, roll_deg=90.0)
    truth = truth_as_believed(model)
    box = SceneObject(name=SUGAR, model=SUGAR, pose=lying, truth=truth)
    scene = Scene(version=1, name="fallen", vision=Vision(), objects=(box,))
    result = Conversation(Controller(scene, seed=3)).say(said)
    assert result.status == "done", result.error
    assert result.trace is not None
    end = result.trace.poses[SUGAR][-1]
    # A degree for what the camera and the table leave open.
    assert from_quaternion(end[None, :4])[0, 2, 2] == pytest.approx(upwards, abs=0.018)
    if not upwards:
        moved = result.trace.displacement(SUGAR)
        np.testing.assert_allclose(moved, [0.08, 0.0, 0.0], atol=0.010)  # as asked, ± 10 mm

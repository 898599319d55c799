"""Lids that come off, by what is said: a jar's lid and back on, the cap of a bottle in a holder."""

import numpy as np
import pytest

from nlcontrol.results.result import Result
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from sim import load_scene
from tests.lone_objects import with_only

pytestmark = pytest.mark.slow


def _alone(name: str) -> Conversation:
    """One thing of the pantry, where it stands there."""
    return Conversation(Controller(with_only(load_scene("pantry"), name), seed=1))


def _off(result: Result, name: str) -> np.ndarray:
    """Where the lid is at the end, from its object [m]."""
    assert result.trace is not None
    trace = result.trace
    return np.asarray(trace.lid_poses[name][-1, 4:] - trace.poses[name][-1, 4:])


def test_the_lid_of_a_jar_comes_off_and_goes_back_on() -> None:
    talk = _alone("jar")
    opened = talk.say("take the lid off the jar")
    assert opened.status == "done", opened.error
    x, y, z = _off(opened, "jar")
    assert np.hypot(x, y) > 0.084  # beside the jar: both are 42 mm in radius
    assert z == pytest.approx(0.0, abs=1e-3)
    closed = talk.say("put the lid back on")
    assert closed.status == "done", closed.error
    # It is on its rim again, and the jar is where it was.
    assert _off(closed, "jar") == pytest.approx((0.0, 0.0, 0.11), abs=1e-3)
    assert closed.trace is not None
    assert np.linalg.norm(closed.trace.displacement("jar")) < 0.003


def test_a_cap_is_turned_off_where_a_holder_keeps_the_bottle() -> None:
    # A quarter of a turn takes two strokes: the fingers give way by some degrees in each.
    scene = load_scene("pantry")
    item = scene.object("fixed bottle")
    lid = item.truth.lid
    assert lid is not None
    quarter = {"lid": lid.model_copy(update={"turns": 0.25})}
    item = item.model_copy(update={"truth": item.truth.model_copy(update=quarter)})
    controller = Controller(scene.model_copy(update={"objects": (item,)}), seed=1)
    believed = controller.models["fixed bottle"]
    assert believed.lid is not None
    quarter = {"lid": believed.lid.model_copy(update={"turns": 0.25})}
    controller.models["fixed bottle"] = believed.model_copy(update=quarter)
    opened = Conversation(controller).say("open the bottle")
    assert opened.status == "done", opened.error
    assert opened.trace is not None
    assert opened.trace.lids["fixed bottle"][-1] == pytest.approx(0.5 * np.pi, abs=0.05)
    x, y, z = _off(opened, "fixed bottle")
    assert np.hypot(x, y) > 0.05
    assert z == pytest.approx(0.0, abs=1e-3)


def test_a_lid_that_takes_a_quarter_more_than_believed_opens_at_the_first_try() -> None:
    """Its catch takes 0.84 N; open, the cup tips at 0.44 N, where the lid takes less."""
    scene = load_scene("pantry")
    item = scene.object("ice tea cup")
    lid = item.truth.lid
    assert lid is not None
    stiff = {name: 1.25 * getattr(lid, name) for name in ("friction_torque", "snap_torque")}
    truth = item.truth.model_copy(update={"lid": lid.model_copy(update=stiff)})
    item = item.model_copy(update={"truth": truth})
    controller = Controller(scene.model_copy(update={"objects": (item,)}), seed=1)
    opened = Conversation(controller).say("open the ice tea cup")
    assert opened.status == "done", opened.error
    assert len(opened.steps[0].plans) == 1

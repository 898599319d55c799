"""The picture of a plan: everything drawn stands where plan and belief say."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from numpy.typing import NDArray

from nlcontrol.cli import run
from nlcontrol.reports.plan_drawing import plan_figure
from nlcontrol.results.result import Result
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from planner.problem.footprints import footprint
from planner.types.world_state import WorldState


def planned(sentence: str, scene: str = "kitchen") -> tuple[Result, WorldState]:
    controller = Controller(scene, seed=0)
    result = Conversation(controller).say(sentence, plan_only=True)
    assert controller.last_look.state is not None
    return result, controller.last_look.state


def points(axes: Axes, label: str) -> list[NDArray[np.float64]]:
    """Points (x, y) in W of every line of that label that was drawn, shape (k, 2) [m]."""
    lines = [line for line in axes.get_lines() if line.get_label() == label]
    found = [np.array([line.get_ydata(), line.get_xdata()], dtype=float).T for line in lines]
    return [each for each in found if len(each)]


def test_contacts_end_and_distances_stand_where_the_plan_says() -> None:
    result, state = planned("push the ice tea box away")
    plan, target = result.plan, state.objects["ice tea box"]
    assert plan is not None
    assert plan.aim is not None
    above, face = plan_figure(result, state).axes
    (tips,) = points(above, "contact")
    middle = target.pose.p_WB + target.pose.R_WB @ np.array(plan.push.p_BC)
    # The picture's numbers are rounded to 0.01 mm.
    np.testing.assert_allclose(tips.mean(axis=0), middle[:2], atol=2e-5)
    assert np.linalg.norm(tips[0] - tips[1]) == pytest.approx(plan.push.spread, abs=2e-5)
    (end,) = points(above, "predicted end")
    np.testing.assert_allclose(
        (end.min(axis=0) + end.max(axis=0)) / 2, (plan.aim.x, plan.aim.y), atol=2e-5
    )
    kept = points(above, "distance kept")
    assert len(kept) == len(state.objects) - 1
    mug = footprint(state.objects["mug"])
    (around,) = [each for each in kept if abs(each.mean(axis=0) - mug.mean(axis=0)).max() < 0.01]
    assert np.ptp(around, axis=0) - np.ptp(mug, axis=0) == pytest.approx(0.02, abs=1e-4)
    levels = [line for line in face.get_lines() if line.get_linestyle() in ("--", ":")]
    heights = {float(np.array(line.get_ydata(), dtype=float)[0]) for line in levels}
    prediction = plan.push.prediction
    assert {prediction.critical_height, prediction.critical_height_worst} <= heights


def test_what_is_fragile_is_kept_clear_of_farther() -> None:
    result, state = planned("push the coffee box 3 cm away", "breakfast")
    above = plan_figure(result, state).axes[0]
    fragile = [seen for seen in state.objects.values() if seen.fragile]
    assert fragile
    for seen in fragile:
        sizes = [np.ptp(each, axis=0) for each in points(above, "distance kept")]
        wanted = np.ptp(footprint(seen), axis=0) + 2 * 0.03
        assert min(np.abs(size - wanted).max() for size in sizes) < 1e-4


@pytest.mark.parametrize(
    "sentence", ["pour the contents of the ice tea into the mug", "topple the ice tea box"]
)
def test_plans_of_other_kinds_are_drawn(sentence: str, tmp_path: Path) -> None:
    picture = tmp_path / "plan.svg"
    assert run(["plan", "-q", sentence, "--picture", str(picture)]) == 0
    assert "predicted end" in picture.read_text("utf-8")

"""Calibration: who is calibrated passes, who is too sure, too unsure or off does not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from objectmodels import BoxModel, ModelError, ObjectModel, Registry
from objectmodels.models.predictor import (
    LEAST_PUSHES,
    PREDICTIONS,
    SeenPushes,
    calibration_of,
    own_predictions,
    require_calibration,
)

BOX = BoxModel(
    name="crate", size=(0.1, 0.1, 0.2), mass=1.0, mass_sd=0.08, friction=0.4, friction_sd=0.04,
    friction_radius_sd=0.0,
)  # fmt: skip


def seen(count: int, seed: int, *, factor: float = 1.0) -> SeenPushes:
    """Pushes of boxes drawn from the belief, straight at the middle of a side, low and high."""
    rng = np.random.default_rng(seed)
    p = np.column_stack((np.full(count, -0.05), np.zeros(count), rng.uniform(0.02, 0.19, count)))
    u = np.array([[1.0, 0.0, 0.0]])
    forces, slid = np.empty((count, 3)), np.empty(count, dtype=bool)
    for k in range(count):
        mass, friction = rng.normal([1.0, 0.4], [0.08, 0.04])
        drawn = BOX.model_copy(update={"mass": mass, "friction": friction})
        t = drawn.thresholds(p[k : k + 1], u)
        forces[k], slid[k] = factor * t.onset[0] * u[0], t.slide[0] < t.topple[0]
    return SeenPushes(p, forces, slid)


def test_who_is_calibrated_passes() -> None:
    good = [calibration_of(BOX, seen(40, seed)).is_good for seed in range(10)]
    # Each fails in two cases of a hundred: two of ten in one case of sixty.
    assert sum(good) >= 9


@pytest.mark.parametrize(
    ("changes", "factor"),
    [
        ({"mass_sd": 0.02, "friction_sd": 0.01}, 1.0),
        ({"mass_sd": 0.25, "friction_sd": 0.12}, 1.0),
        ({}, 1.12),
    ],
    ids=["too sure", "too unsure", "off"],
)
def test_who_is_not_fails(changes: dict[str, float], factor: float) -> None:
    found = calibration_of(BOX.model_copy(update=changes), seen(100, 1, factor=factor))
    assert found.of_forces < 1e-3


def test_outcomes_that_are_told_too_surely_fail() -> None:
    pushes = seen(60, 2)
    sure = BOX.model_copy(update={"friction_sd": 0.001, "friction": 0.5})
    assert calibration_of(sure, pushes).of_outcomes < 1e-3
    assert calibration_of(BOX, pushes).of_outcomes > 0.01


def test_few_pushes_judge_nothing() -> None:
    require_calibration(BOX, seen(LEAST_PUSHES, 3), "crate")
    for pushes in (None, seen(LEAST_PUSHES - 1, 3)):
        with pytest.raises(ModelError) as raised:
            require_calibration(BOX, pushes, "crate")
        assert raised.value.code == "not_calibrated"


class Corrected(BoxModel):
    """A box that slides at a share of the force."""

    def thresholds(self, points: Any, directions: Any, **options: Any) -> Any:
        return super().thresholds(points, directions, **options)


def test_no_registry_takes_predictions_that_are_not_calibrated() -> None:
    registry = Registry()
    with pytest.raises(ModelError) as raised:
        registry.add(Corrected(name="corrected", size=(0.1, 0.1, 0.2), mass=1.0, friction=0.4))
    assert raised.value.code == "not_calibrated"
    assert len(registry) == 0
    registry.add(BOX)


def test_what_a_kind_answers_by_itself_is_known() -> None:
    assert own_predictions(Corrected, ObjectModel) == ("thresholds",)
    assert own_predictions(BoxModel, ObjectModel) == ()
    assert 6 <= len(PREDICTIONS) <= 10

"""What touches should show: the models' own thresholds, balance at a tilt, derivatives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from objectmodels import BoxModel, CylinderModel, ModelError, ObjectModel
from objectmodels.geometry.base_shapes import Array
from objectmodels.identification import Trial
from objectmodels.identification.least_squares import damped_step
from objectmodels.identification.measurement_model import (
    LOGARITHMIC,
    MASS,
    Balance,
    Linear,
    coordinates_of,
    values_at,
)
from tests.unit.objectmodels.identification.touching import slide, slip, tilt

BOX = BoxModel(
    name="b", size=(0.09, 0.12, 0.2), mass=0.8, friction=0.3, com=(0.006, -0.004, 0.09),
    support="corners", friction_radius=0.05,
)  # fmt: skip
CAN = CylinderModel(
    name="c", radius=0.05, height=0.2, mass=0.8, friction=0.3, com=(0.006, -0.004, 0.09)
)
MODELS = pytest.mark.parametrize("model", [BOX, CAN], ids=["box", "can"])


def pushes(model: ObjectModel, moved: str) -> list[Trial]:
    """Oblique pushes on the front, low for slides and high for tilts."""
    height, trial = (0.02, slide()) if moved == "slide" else (0.19, tilt())
    trials = []
    for off, up in ((-0.03, 0.1), (0.0, 0.0), (0.02, -0.1), (0.03, 0.05)):
        u = np.array([1.0, 0.15, up])
        x, y, z = (u / np.linalg.norm(u)).tolist()
        trials.append(replace(trial, point=(-0.045, off, height), force=(x, y, z)))
    return trials


@MODELS
@pytest.mark.parametrize("exact", [False, True])
def test_slides_are_the_models_thresholds_and_twists(model: ObjectModel, exact: bool) -> None:
    balance = Balance(model, pushes(model, "slide"), exact=exact)
    t = model.thresholds(balance.touches.p, balance.touches.u, exact=exact)
    shown = balance.linear_predictions(model.means).predicted
    np.testing.assert_allclose(shown[:4], t.slide, rtol=1e-9)  # one formula, written twice
    np.testing.assert_allclose(shown[4:], t.twist[:, 2], rtol=1e-6)  # limits precise to 1e-10


@MODELS
def test_tilts_begin_at_the_topple_threshold(model: ObjectModel) -> None:
    balance = Balance(model, pushes(model, "topple"))
    t = model.thresholds(balance.touches.p, balance.touches.u)
    np.testing.assert_allclose(balance.predict(model.means), t.topple, rtol=1e-9)


@pytest.mark.parametrize("angle", [0.05, 0.2, 0.35])
def test_a_tilted_box_is_in_balance(angle: float) -> None:
    """Moments about the edge of the box turned as a whole, by its rotation matrix."""
    trial = replace(tilt(angle=angle), point=(-0.045, 0.0, 0.19), force=(0.9, 0.0, 0.3))
    balance = Balance(BOX, [trial])
    force = balance.predict(BOX.means).item() * balance.touches.u[0]
    cos, sin = np.cos(angle), np.sin(angle)
    turn = np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])
    edge = np.array([0.045, 0.0, 0.0])
    contact, com = turn @ (np.array(trial.point) - edge), turn @ (np.array(BOX.com) - edge)
    weight = np.array([0.0, 0.0, -BOX.weight])
    about_edge = (np.cross(contact, force) + np.cross(com, weight))[1]
    assert about_edge == pytest.approx(0.0, abs=1e-12)  # of moments of 0.3 N·m


def test_a_slip_shows_the_ratio_of_forces() -> None:
    trial = replace(slip(), force=(4.0, 1.2, 1.6))
    balance = Balance(BOX, [trial])
    assert balance.observed == pytest.approx([0.5])  # 2 N across, 4 N pressing
    assert balance.predict(BOX.means) == pytest.approx([BOX.finger_friction])


@MODELS
@pytest.mark.parametrize("exact", [False, True])
def test_derivatives_are_those_of_differences(model: ObjectModel, exact: bool) -> None:
    trials = [*pushes(model, "slide"), tilt(angle=0.1), tilt("left"), slip()]
    balance = Balance(model, trials, exact=exact)
    x, steps = coordinates_of(model.means), 1e-4 * np.where(LOGARITHMIC, 1.0, 0.06)
    found = balance.linear_predictions(model.means).jacobian

    def near(k: int, sign: float) -> Array:
        return balance.linear_predictions(
            values_at(x + sign * steps * (np.arange(7) == k))
        ).predicted

    expected = np.stack([(near(k, 1.0) - near(k, -1.0)) / (2.0 * steps[k]) for k in range(7)], 1)
    scale = np.abs(expected).max(axis=0) + 1e-12
    np.testing.assert_allclose(found / scale, expected / scale, atol=1e-5)  # steps of 1e-4


def test_an_error_of_the_tilt_counts_by_the_force_it_makes() -> None:
    trial = replace(tilt(angle=0.1), tilt_sd=0.01)
    sd = Balance(BOX, [trial]).linear_predictions(BOX.means).sd.item()
    held = [Balance(BOX, [replace(trial, tilt=a)]).predict(BOX.means).item() for a in (0.09, 0.11)]
    slope = abs(held[1] - held[0]) / 0.02
    assert sd == pytest.approx(np.hypot(trial.force_sd, 0.01 * slope), rel=1e-3)  # curvature


@pytest.mark.parametrize(
    "trial",
    [
        replace(tilt(), force=(0.0, 0.0, 0.0)),
        replace(tilt(), force=(float("nan"), 0.0, 0.0)),
        replace(tilt(), force_sd=0.0),
        replace(slip(), normal=None),
        replace(slip(), force=(-1.0, 0.0, 0.5)),
        replace(slide(), force=(0.0, 0.0, 1.0)),
    ],
)
def test_trials_that_make_no_sense_are_refused(trial: Trial) -> None:
    with pytest.raises(ModelError, match=trial.source) as caught:
        Balance(BOX, [trial])
    assert caught.value.code == "bad_trial"


def test_no_trials_are_refused() -> None:
    with pytest.raises(ModelError) as caught:
        Balance(BOX, [])
    assert caught.value.code == "no_trials"


def test_a_step_is_no_longer_than_a_factor_of_two() -> None:
    balance = Balance(BOX, pushes(BOX, "slide"))
    at, step = balance.linear_predictions(BOX.means), np.zeros(7)
    step[MASS] = 2.0
    after = damped_step(balance, at, step, balance.linear_predictions)
    assert after.values[MASS] == pytest.approx(BOX.mass * np.exp(0.7))
    step[MASS] = 0.6
    after = damped_step(balance, at, step, balance.linear_predictions)
    assert after.values[MASS] == pytest.approx(BOX.mass * np.exp(0.6))


@pytest.mark.parametrize(("refusals", "possible"), [(11, True), (12, False)])
def test_a_step_is_halved_eleven_times(refusals: int, possible: bool) -> None:
    balance = Balance(BOX, pushes(BOX, "slide"))
    at, step = balance.linear_predictions(BOX.means), np.zeros(7)
    step[MASS] = 0.5
    tried: list[float] = []

    def never_at_first(values: Array) -> Linear:
        tried.append(float(np.log(values[MASS] / BOX.mass)))
        if len(tried) <= refusals:
            raise ModelError("not_possible", "not so far", suggestions=("less",))
        return balance.linear_predictions(values)

    if possible:
        damped_step(balance, at, step, never_at_first)
    else:
        with pytest.raises(ModelError) as raised:
            damped_step(balance, at, step, never_at_first)
        assert raised.value.code == "no_fit"
    np.testing.assert_allclose(tried, 0.5 ** np.arange(1, len(tried) + 1), rtol=1e-9)

"""Points that carry, found from motions under known pushes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from objectmodels import BoxModel, ModelError
from objectmodels.geometry.base_shapes import Array, Support
from objectmodels.geometry.rotations import vector_tuple
from objectmodels.identification import Trial, fit
from objectmodels.identification.joint_fit import LEAST_TRIALS, pressure_points

FEET: Support = ((-0.04, -0.045), (0.04, -0.03), (0.005, 0.05))
TRUTH = BoxModel(
    name="b", size=(0.09, 0.11, 0.1), mass=1.0, mass_sd=0.01, friction=0.4, finger_friction=0.6,
    com=(0.002, -0.008, 0.05), support=FEET,
)  # fmt: skip
BELIEF = TRUTH.model_copy(
    update={"support": "uniform", "friction": 0.3, "friction_sd": 0.1, "friction_radius": 0.04}
)
ASKED = ("friction", "friction_radius")


def slides(count: int, *, seed: int, noise: float = 0.0, truth: BoxModel = TRUTH) -> list[Trial]:
    """Low pushes all around, with the forces and motions of the truth."""
    rng = np.random.default_rng(seed)
    side = rng.integers(0, 4, count) * np.pi / 2.0
    out, along = np.array([np.cos(side), np.sin(side)]), rng.uniform(-0.04, 0.04, count)
    half = np.where(np.abs(out[0]) > 0.5, 0.045, 0.055)
    p = np.column_stack(
        (*(half * out + along * np.array([-out[1], out[0]])), np.full(count, 0.005))
    )
    heading = side + np.pi + rng.uniform(-0.4, 0.4, count)
    u = np.column_stack((np.cos(heading), np.sin(heading), np.zeros(count)))
    t = truth.thresholds(p, u, exact=True)
    turn, v = t.twist[:, 2], t.twist[:, 3:5]
    contact = v + turn[:, None] * np.column_stack((-p[:, 1], p[:, 0]))
    advance = (contact * u[:, :2]).sum(axis=1)
    aside = u[:, 0] * contact[:, 1] - u[:, 1] * contact[:, 0]
    force = t.slide * (1.0 + noise * rng.standard_normal(count))
    turned = turn / advance + 30.0 * noise * rng.standard_normal(count)
    drift = aside / advance + noise * rng.standard_normal(count)
    return [
        Trial(
            "slide", tuple(p[k].tolist()), tuple((force[k] * u[k]).tolist()), 0.02 * force[k],
            turn_rate=float(turned[k]), turn_rate_sd=0.5, drift=float(drift[k]), source=f"row {k}",
        )
        for k in range(count)
    ]  # fmt: skip


def miss(found: Support, truth: Support) -> float:
    """Largest distance of a true foot from the next point that was found [m]."""
    assert not isinstance(found, str)
    assert not isinstance(truth, str)
    a, b = (np.array([point[:2] for point in points]) for points in (found, truth))
    apart: Array = np.linalg.norm(a[:, None] - b, axis=2)
    return float(apart.min(axis=0).max())


def test_three_feet_are_found_from_motions_alone() -> None:
    found = pressure_points(BELIEF, slides(30, seed=1))
    assert found is not None
    assert len(found) == 3
    # Places that are tried are 11 mm apart, and a foot between them is met by their middle.
    assert miss(found, FEET) < 0.006
    loads = np.array(found)[:, 2]
    assert loads.sum() == pytest.approx(1.0)
    # The true loads are those that balance the weight about three feet.
    true = np.linalg.solve(np.vstack((np.array(FEET).T, np.ones(3))), [*TRUTH.com[:2], 1.0])
    np.testing.assert_allclose(np.sort(loads), np.sort(true), atol=0.05)


def test_fewer_slides_or_none_with_a_motion_tell_no_points() -> None:
    trials = slides(30, seed=1)
    assert pressure_points(BELIEF, trials[: LEAST_TRIALS - 1]) is None
    assert pressure_points(BELIEF, [replace(trial, drift=None) for trial in trials]) is None


def test_the_fit_takes_them_where_they_predict_better() -> None:
    found = fit(BELIEF, slides(30, seed=2, noise=0.01), parameters=ASKED)
    assert miss(found.model.support, FEET) < 0.012
    assert found.model.friction == pytest.approx(0.4, rel=0.03)
    assert any(note.startswith("the support of") for note in found.notes)
    even = TRUTH.model_copy(update={"support": "uniform", "friction_radius": 0.038})
    again = fit(BELIEF, slides(30, seed=2, noise=0.03, truth=even), parameters=ASKED)
    assert again.model.support == "uniform"


def test_feet_that_are_found_predict_other_motions() -> None:
    """The turn of thirty other pushes, beside that by the support that was believed."""
    trials, others = slides(30, seed=3, noise=0.03), slides(30, seed=4)
    fitted = fit(BELIEF, trials, parameters=ASKED).model
    guessed = fit(BELIEF, trials, parameters=ASKED, supports=["uniform"]).model
    p = np.array([t.point for t in others])
    force = np.array([t.force for t in others])
    u = force / np.linalg.norm(force, axis=1)[:, None]
    true = TRUTH.thresholds(p, u, exact=True).twist[:, 2]
    off = [
        np.abs(m.thresholds(p, u, exact=True).twist[:, 2] - true).mean() for m in (fitted, guessed)
    ]
    assert off[0] < 0.6 * off[1]


def test_slides_alone_are_fitted_where_the_mass_is_known() -> None:
    trials = slides(20, seed=5, noise=0.02)
    found = fit(BELIEF, trials)
    assert "friction" in found.found
    assert "mass" not in found.found
    # One slide is off by 2 %, twenty of them and a mass known to 1 % by a third of this.
    assert found.model.friction == pytest.approx(0.4, rel=0.04)
    unknown = BELIEF.model_copy(update={"mass_sd": 0.3})
    with pytest.raises(ModelError, match="a slide gives only friction times mass"):
        fit(unknown, trials)


def test_trials_that_contradict_each_other_are_named() -> None:
    trials = slides(20, seed=6, noise=0.02)
    trials[3] = replace(trials[3], force=vector_tuple(3.0 * np.array(trials[3].force)))
    assert list(fit(BELIEF, trials, parameters=ASKED).dropped) == ["row 3"]

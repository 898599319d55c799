"""Probabilities by the exact tier: the critical friction, and what is averaged over."""

from __future__ import annotations

import numpy as np
import pytest

from objectmodels import BoxModel, ModelError, ObjectModel, Registry
from objectmodels.exact.exact_probability import least_probability
from objectmodels.exact.exact_thresholds import (
    exact_codes,
    springs_of,
    thresholds_of_sample,
)
from objectmodels.exact.slide_search import SlideSearch, Standing
from objectmodels.mechanics.friction_cone import contact_forces
from objectmodels.mechanics.outcome_probability import draw_parameters, sample_parameters
from objectmodels.mechanics.push_thresholds import ratio_at, topple_threshold

CRATE = BoxModel(
    name="crate", size=(0.1, 0.1, 0.2), mass=1.0, mass_sd=0.05, friction=0.4, friction_sd=0.06,
    support="corners", com_sd=(0.004, 0.004, 0.010),
)  # fmt: skip
SLIDES, TOPPLES = 1, 2


def pushes(model: ObjectModel, n: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    p = np.array(model.extents) * rng.uniform([-0.5, -0.5, 0.4], [0.5, 0.5, 1.0], (n, 3))
    u = rng.normal(size=(n, 3)) * [1.0, 1.0, 0.3]
    return p, u / np.linalg.norm(u, axis=1, keepdims=True)


@pytest.mark.parametrize("support", ["corners", "uniform", "feet"])
def test_the_class_turns_at_the_critical_friction(support: str) -> None:
    feet = ((0.03, 0.02), (-0.03, 0.03), (-0.04, -0.02), (0.02, -0.03), (0.0, 0.03))
    stands = {"support": feet if support == "feet" else support, "com": (0.003, 0.002, 0.09)}
    box = {"name": "b", "size": (0.1, 0.08, 0.2), "mass": 1.0, "friction": 0.4}
    model = BoxModel.model_validate(box | stands)
    p, u = pushes(model, 24, 5)
    springs, com = springs_of(model), np.array(model.com)
    tips = ratio_at(topple_threshold(model.base, p, u, com, 1.0), u[:, 2], 1.0)
    scale = np.array([model.friction_radius / springs.radius])
    body = Standing(model.base, springs, scale, np.array([np.inf]), com[None, :2])
    critical = SlideSearch(body, p, u, tips).critical_friction()
    (found,) = np.nonzero((critical > 0.01) & (critical < 5.0))  # what a model may have
    assert len(found) > 12
    for i in found.tolist():
        # Friction limits are found to 1e-10.
        below, above = (
            exact_codes(model.model_copy(update={"friction": by * critical[i]}), p[[i]], u[[i]])
            for by in (1.0 - 1e-8, 1.0 + 1e-8)
        )
        assert (below.item(), above.item()) == (SLIDES, TOPPLES)


def test_the_probability_is_how_often_drawn_objects_topple() -> None:
    p, u = pushes(CRATE, 6, 2)
    told = CRATE.likelihood(p, u, exact=True)
    assert (told.samples, told.method) == (64, "exact tier")
    np.testing.assert_allclose(told.none + told.slide + told.topple, 1.0, atol=1e-12)
    rng, toppled, n = np.random.default_rng(0), np.zeros(6), 300
    draws = draw_parameters(CRATE, rng.standard_normal((n, 4)))
    for com, radius, mean in zip(draws.com, draws.friction_radius, draws.friction, strict=True):
        mu = mean + draws.friction_sd * rng.standard_normal()
        drawn = {"com": tuple(com.tolist()), "friction_radius": float(radius), "friction": mu}
        toppled += exact_codes(CRATE.model_copy(update=drawn), p, u) == TOPPLES
    # Three standard deviations of a share of 300; the closed form is off by half.
    np.testing.assert_allclose(told.topple, toppled / n, atol=3.0 * 0.5 / np.sqrt(n))
    assert np.abs(CRATE.likelihood(p, u, exact=False).topple - toppled / n).max() > 0.4


def test_a_batch_is_answered_as_its_pushes_one_by_one() -> None:
    model = Registry.built_in().get("ice tea box")
    p, u = pushes(model, 3, 1)
    singly = [model.likelihood(p[[i]], u[[i]], exact=True).topple.item() for i in range(3)]
    np.testing.assert_allclose(model.likelihood(p, u, exact=True).topple, singly, atol=1e-9)


@pytest.mark.parametrize("correlations", [(), (("mass", "friction", -0.7),)])
def test_what_a_force_does_is_what_it_does_to_drawn_bodies(
    correlations: tuple[tuple[str, str, float], ...],
) -> None:
    model = BoxModel(**(CRATE.model_dump() | {"correlations": correlations}))
    p, u = pushes(model, 4, 8)
    n = 2000
    sample = sample_parameters(model, n, 1)
    for i, force in enumerate([1.5, 2.5, 3.0, 3.5]):
        told = model.likelihood(p[[i]], u[[i]], force=force, exact=True)
        slide, topple = thresholds_of_sample(
            model, sample, np.tile(p[i], (n, 1)), np.tile(u[i], (n, 1))
        )
        moves = np.minimum(slide, topple) <= force
        shares = [~moves, moves & (slide < topple), moves & (slide >= topple)]
        # 64 points of five numbers, and three standard deviations of a share of 2000.
        got = np.ravel([told.none, told.slide, told.topple])
        np.testing.assert_allclose(got, np.mean(shares, axis=1), atol=0.03 + 0.034)


def test_a_force_of_nothing_moves_nothing_and_must_be_a_number() -> None:
    p, u = pushes(CRATE, 2, 0)
    still = CRATE.likelihood(p, u, force=0.0, exact=True)
    np.testing.assert_allclose(still.none, 1.0, atol=1e-6)  # of the normal's far end
    with pytest.raises(ModelError) as caught:
        CRATE.likelihood(p, u, force=float("nan"), exact=True)
    assert caught.value.code == "bad_value"


def test_the_least_probable_force_of_a_cone_is_no_more_probable_than_those_in_it() -> None:
    p, normal = np.array([-0.05, 0.02, 0.12]), np.array([-1.0, 0.0, 0.0])
    grip = CRATE.model_copy(update={"finger_friction": 0.4, "finger_friction_sd": 0.0})
    turns = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
    u = contact_forces(normal, 0.4 * np.column_stack((np.cos(turns), np.sin(turns))))
    around = grip.likelihood(np.tile(p, (8, 1)), u, exact=True)
    for outcome in ("slide", "topple"):
        least = least_probability(grip, p, normal, outcome)
        # The nominal body's worst direction stands for that of all; the ring encloses the cone.
        assert least <= getattr(around, outcome).min() + 0.02
    upright = least_probability(grip, p, normal, "topple", aside=False)
    assert upright >= least_probability(grip, p, normal, "topple")
    early = least_probability(grip, p, normal, "topple", topples_at=0.8)
    assert early >= least_probability(grip, p, normal, "topple")


def test_the_friction_that_is_used_is_found_where_limits_are_coarse() -> None:
    """Near tipping a rim bears on few points; there the search went on without end."""
    bottle = Registry.built_in().get("water bottle")
    p, u = pushes(bottle, 60, 0)
    likely = bottle.likelihood(p, u, exact=True)
    np.testing.assert_allclose(likely.none + likely.slide + likely.topple, 1.0, atol=1e-12)

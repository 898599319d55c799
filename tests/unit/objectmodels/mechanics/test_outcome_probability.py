"""Probabilities of the classes, against sampling."""

from __future__ import annotations

from math import erf, sqrt

import numpy as np
import pytest

from objectmodels import BoxModel, ModelError, Registry
from objectmodels.mechanics.outcome_probability import draw_parameters, normal_cdf

BOX = BoxModel(
    name="b",
    size=(0.09, 0.09, 0.23),
    mass=1.0,
    friction=0.378,
    friction_sd=0.05,
    finger_friction=1e-6,
    friction_radius_sd=0.0,
)


def test_normal_cdf_is_that_of_the_error_function() -> None:
    x = np.array([-np.inf, -40.0, -3.0, -1.0, -1e-9, 0.0, 0.5, 2.0, 6.0, np.inf])
    expected = [0.5 * (1 + erf(v / sqrt(2))) for v in x]
    np.testing.assert_allclose(normal_cdf(x), expected, atol=1.5e-7)  # the formula's stated error


def test_frictionless_finger_leaves_the_friction_alone() -> None:
    """A centred horizontal push slides first iff μ < b/h."""
    heights = np.linspace(0.08, 0.16, 9)
    points = np.column_stack((np.full(9, -0.045), np.zeros(9), heights))
    c = BOX.cone_thresholds(points, np.tile([-1.0, 0.0, 0.0], (9, 1)))
    expected = [0.5 * (1 + erf((0.045 / h - 0.378) / 0.05 / sqrt(2))) for h in heights]
    # The finger's friction of 1e-6 and the approximation of Φ.
    np.testing.assert_allclose(c.probability_slide, expected, atol=1e-4)
    np.testing.assert_allclose(c.probability_topple, 1 - np.array(expected), atol=1e-4)


def test_uncertain_centre_of_mass_adds_to_the_friction_s_uncertainty() -> None:
    """Slides first iff μ < (b − c_x)/h: variances add."""
    box = BOX.model_copy(update={"com_sd": (0.006, 0.0, 0.0)})
    heights = np.linspace(0.09, 0.15, 7)
    points = np.column_stack((np.full(7, -0.045), np.zeros(7), heights))
    c = box.cone_thresholds(points, np.tile([-1.0, 0.0, 0.0], (7, 1)))
    spread = np.hypot(0.05, 0.006 / heights)
    expected = [
        0.5 * (1 + erf((0.045 / h - 0.378) / s / sqrt(2)))
        for h, s in zip(heights, spread, strict=True)
    ]
    np.testing.assert_allclose(c.probability_slide, expected, atol=0.01)  # 128 points
    without = BOX.cone_thresholds(points, np.tile([-1.0, 0.0, 0.0], (7, 1)))
    assert np.abs(without.probability_slide - expected).max() > 0.04


def test_certain_parameters_give_certain_classes() -> None:
    box = BOX.model_copy(update={"friction_sd": 0.0})
    c = box.cone_thresholds([[-0.045, 0, 0.1], [-0.045, 0, 0.14]], [[-1.0, 0, 0]] * 2)
    assert c.probability_slide.tolist() == [1.0, 0.0]
    assert c.probability_topple.tolist() == [0.0, 1.0]


def test_a_push_that_never_topples_has_no_probability_of_it() -> None:
    low = BOX.model_copy(update={"finger_friction": 0.7})
    c = low.cone_thresholds([[-0.045, 0, 0.03]], [[-1.0, 0, 0]])
    assert c.probability_topple.tolist() == [0.0]


def test_a_jam_is_no_toppling() -> None:
    """Every force tips this box but those straight down its face, which jam it."""
    box = BoxModel(name="b", size=(0.09, 0.09, 0.3), mass=1.0, friction=0.6, finger_friction=3.0)
    u = np.array([[1.0, 0.0, -3.0]]) / np.sqrt(10.0)
    assert box.thresholds([[-0.045, 0.0, 0.25]], u).outcome.tolist() == ["none"]
    c = box.cone_thresholds([[-0.045, 0.0, 0.25]], [[-1.0, 0.0, 0.0]], yaw=False)
    assert c.probability_topple.tolist() == [0.0]
    assert c.topple_margin.tolist() == [-np.inf]


@pytest.mark.parametrize("name", ["ice tea box", "cereal box", "coffee box"])
def test_probabilities_of_the_built_in_models_match_sampling(name: str) -> None:
    """Oracle: classes of sampled boxes for many directions, the worst direction counting."""
    box = Registry.default().get(name)
    rng = np.random.default_rng(3)
    face = box.faces()[2]
    lateral = np.repeat([0.0, 0.15], 5) * face.width
    points = np.array(face.centre) + lateral[:, None] * np.array(face.tangent)
    points[:, 2] = np.tile(np.linspace(0.15, 0.95, 5), 2) * face.height
    normals = np.tile(face.normal, (len(points), 1))
    c = box.cone_thresholds(points, normals)
    slide, topple = np.ones(len(points)), np.ones(len(points))
    k = 400
    d = draw_parameters(box, rng.standard_normal((k, 4)))
    mu = np.maximum(box.friction + box.friction_sd * rng.standard_normal(k), 1e-6)
    boxes = [
        box.model_copy(
            update={
                "com": tuple(d.com[i]),
                "friction": mu[i],
                "friction_radius": d.friction_radius[i],
            }
        )
        for i in range(k)
    ]
    phi = np.linspace(0.0, 2 * np.pi, 12, endpoint=False)
    share = np.vstack((np.column_stack((np.cos(phi), np.sin(phi))), [[0.0, 0.0]]))
    tangent = np.array(face.tangent)
    hits_slide, hits_topple = (
        np.zeros((len(points), len(share))),
        np.zeros((len(points), len(share))),
    )
    for i, drawn in enumerate(boxes):
        reach = d.finger_friction[i]
        f = -np.array(face.normal) + reach * (share[:, :1] * tangent + share[:, 1:] * [[0, 0, 1.0]])
        u = f / np.linalg.norm(f, axis=1, keepdims=True)
        p = np.repeat(points, len(share), axis=0)
        outcome = drawn.thresholds(p, np.tile(u, (len(points), 1))).outcome
        hits_slide += (outcome == "slide").reshape(hits_slide.shape)
        hits_topple += (outcome == "topple").reshape(hits_slide.shape)
    slide, topple = hits_slide.min(axis=1) / k, hits_topple.min(axis=1) / k
    # 400 samples scatter by up to 0.025, the sequence errs by up to 0.04.
    np.testing.assert_allclose(c.probability_slide, slide, atol=0.09)
    np.testing.assert_allclose(c.probability_topple, topple, atol=0.09)
    assert slide.max() > 0.9  # the grid spans sure and unsure contacts
    assert slide.min() < 0.3


def test_drawn_parameters_stay_sensible() -> None:
    box = Registry.default().get("ice tea box").model_copy(update={"com_sd": (0.1, 0.1, 0.0)})
    d = draw_parameters(box, np.array([[9.0, -9.0, -9.0, -99.0], [0.0] * 4]))
    assert (np.abs(d.com[:, :2]) < 0.045).all()
    assert (d.friction_radius > 0).all()
    assert (d.finger_friction >= 0).all()
    assert tuple(d.com[1]) == box.com


def spread(**changes: object) -> BoxModel:
    """The ice tea box with beliefs that are spread and correlated."""
    tea = Registry.built_in().get("ice tea box")
    return BoxModel(**(tea.model_dump() | {"com": (0.004, -0.003, 0.1)} | changes))


PUSHES = np.array(
    [[-0.045, 0.0, 0.09], [-0.045, 0.02, 0.13], [-0.045, -0.03, 0.2], [-0.045, 0.0, 0.12]]
)
WAYS = np.array([[1, 0, 0], [1, 0, 0.3], [0.9, 0.1, -0.2], [1, -0.3, 0]], dtype=float)
WAYS /= np.linalg.norm(WAYS, axis=1, keepdims=True)


@pytest.mark.parametrize(
    "correlations",
    [
        (),
        (("mass", "friction", -0.7),),
        (("friction", "com_x", 0.8), ("friction_radius", "friction", -0.4)),
        (("friction", "com_x", 1.0),),
    ],
)
def test_closed_form_and_sampling_agree_at_the_onset(
    correlations: tuple[tuple[str, str, float], ...],
) -> None:
    box = spread(correlations=correlations)
    fixed = box.likelihood(PUSHES, WAYS, exact=False)
    drawn = box.likelihood(PUSHES, WAYS, force=1e4, exact=False)  # far beyond every onset
    assert (fixed.method, drawn.method) == ("closed form", "sampled")
    assert (fixed.seed, drawn.seed) == (None, 0)
    # 128 points in four dimensions, and four standard errors of 4000 samples.
    np.testing.assert_allclose(fixed.slide, drawn.slide, atol=0.03 + 0.03)
    np.testing.assert_allclose(fixed.topple, drawn.topple, atol=0.03 + 0.03)
    for each in (fixed, drawn):
        np.testing.assert_allclose(each.none + each.slide + each.topple, 1.0, atol=1e-9)


def test_correlation_changes_the_odds() -> None:
    """Rough boxes whose weight lies ahead slide late and topple early: both at once is likelier."""
    apart = spread(com_sd=(0.006, 0.0, 0.0)).likelihood(PUSHES[:1], WAYS[:1], exact=False)
    along, against = (
        spread(com_sd=(0.006, 0.0, 0.0), correlations=[("friction", "com_x", r)]).likelihood(
            PUSHES[:1], WAYS[:1], exact=False
        )
        for r in (0.9, -0.9)
    )
    assert against.topple.item() < apart.topple.item() < along.topple.item()


def test_a_given_force_moves_it_with_the_probability_that_the_onset_is_smaller() -> None:
    box = BOX.model_copy(update={"mass_sd": 0.1})
    p, u = [[-0.045, 0.0, 0.02]], [[1.0, 0.0, 0.0]]
    force = box.thresholds(p, u).slide.item()
    likely = box.likelihood(p, u, force=force, exact=False)
    # μ m g against its own nominal value, nearly symmetric; four standard errors.
    assert likely.none.item() == pytest.approx(0.5, abs=0.04)
    assert box.likelihood(p, u, force=0.0, exact=False).none.item() == 1.0
    again = box.likelihood(p, u, force=force, exact=False)
    assert again.none.item() == likely.none.item()  # seeded


def test_a_round_object_keeps_drawn_centres_over_its_base() -> None:
    mug = Registry.built_in().get("mug").model_copy(update={"com_sd": (0.2, 0.2, 0.0)})
    drawn = draw_parameters(mug, np.random.default_rng(0).normal(size=(500, 4)))
    assert np.hypot(*drawn.com[:, :2].T).max() <= 0.95 * 0.03 + 1e-12


@pytest.mark.parametrize(
    "correlations",
    [
        [("mass", "weight", 0.5)],
        [("mass", "mass", 0.5)],
        [("mass", "friction", 1.5)],
        [("mass", "friction", 0.5), ("friction", "mass", 0.5)],
        [("mass", "friction", 0.9), ("friction", "com_x", 0.9), ("mass", "com_x", -0.9)],
    ],
)
def test_impossible_correlations_are_refused(correlations: object) -> None:
    with pytest.raises(ValueError, match=r"correlation|less than"):
        spread(correlations=correlations)


@pytest.mark.parametrize("exact", [True, False])
@pytest.mark.parametrize("force", [-1.0, float("nan"), float("inf"), np.array([1.0, 2.0])])
def test_forces_must_be_numbers(force: float, exact: bool) -> None:
    with pytest.raises(ModelError) as raised:
        BOX.likelihood(PUSHES, WAYS, force=force, exact=exact)
    assert raised.value.code == "bad_value"


def test_what_is_told_if_nothing_is_said_is_calibrated() -> None:
    """Pushes off the middle and askew, under which the box turns as it slides."""
    rng, n = np.random.default_rng(3), 60
    box = BoxModel(
        name="box", size=(0.09, 0.11, 0.2), mass=0.8, mass_sd=0.05, friction=0.42,
        friction_sd=0.06, com_sd=(0.004, 0.004, 0.01), support="corners",
    )  # fmt: skip
    low, high = (-0.0495, 0.06), (0.0495, 0.19)
    points = np.column_stack([np.full(n, -0.045), rng.uniform(low, high, (n, 2))])
    ways = np.column_stack([np.ones(n), rng.uniform(-0.4, 0.4, n), rng.uniform(-0.3, 0.3, n)])
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    drawn = rng.multivariate_normal(box.means, box.covariance, size=n)
    toppled = np.zeros(n)
    for i, (mass, friction, _, radius, *com) in enumerate(drawn.tolist()):
        true = {"mass": mass, "friction": friction, "friction_radius": radius, "com": tuple(com)}
        push = points[i : i + 1], ways[i : i + 1]
        outcome = box.model_copy(update=true).thresholds(*push, exact=True).outcome
        toppled[i] = outcome.item() == "topple"
    told = box.likelihood(points, ways).topple
    # The mean of n draws of half a chance each strays by 0.065; the closed form is 0.2 too high.
    assert abs(told.mean() - toppled.mean()) < 0.13
    assert np.mean((told - toppled) ** 2) < 0.7 * toppled.var()

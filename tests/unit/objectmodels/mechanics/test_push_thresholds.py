"""Closed-form thresholds: golden heights, limits, jams, twists and predictions."""

from __future__ import annotations

import numpy as np
import pytest

from objectmodels import BoxModel, Registry
from objectmodels.geometry.base_shapes import Array
from objectmodels.mechanics.push_thresholds import (
    centre_of_pressure,
    critical_friction,
    slide_threshold,
    topple_threshold,
    yaw_arm,
)

ICE_TEA = BoxModel(name="ice tea box", size=(0.09, 0.09, 0.23), mass=0.9952, friction=0.378)
LATER_FIT = BoxModel(name="later fit", size=(0.09, 0.09, 0.23), mass=0.4190, friction=0.2978)
CEREAL = Registry.default().get("cereal box")
COFFEE = Registry.default().get("coffee box")


def outcomes_around(box: BoxModel, axis: int, height: float, up: float = 0.0) -> list[str]:
    """Classes 0.5 mm below and above a height, pushed in the middle of a rear face."""
    points = np.zeros((2, 3))
    points[:, axis] = -box.size[axis] / 2
    points[:, 2] = height - 5e-4, height + 5e-4
    u = np.zeros(3)
    u[axis], u[2] = 1.0, up
    outcome: list[str] = box.thresholds(
        points, np.tile(u / np.hypot(1.0, up), (2, 1))
    ).outcome.tolist()
    return outcome


@pytest.mark.parametrize(
    ("box", "axis", "height"),
    [
        (ICE_TEA, 0, 0.045 / 0.378),
        (LATER_FIT, 0, 0.045 / 0.2978),
        (CEREAL, 0, 0.026 / 0.3428),
        (COFFEE, 0, 0.031 / 0.3133),
        (COFFEE, 1, 0.0465 / 0.3133),
    ],
)
def test_golden_heights(box: BoxModel, axis: int, height: float) -> None:
    golden = {ICE_TEA: (119,), LATER_FIT: (151,), CEREAL: (76,), COFFEE: (99, 148)}[box]
    assert round(1e3 * height) in golden
    assert outcomes_around(box, axis, height) == ["slide", "topple"]


def test_the_cereal_box_never_topples_along_its_wide_side() -> None:
    n = 50
    points = np.column_stack((np.zeros(n), np.full(n, -0.096), np.linspace(0.0, 0.26, n)))
    assert set(CEREAL.thresholds(points, np.tile([0.0, 1.0, 0.0], (n, 1))).outcome) == {"slide"}


@pytest.mark.parametrize(("up", "height"), [(-0.45, 0.1393), (0.69, 0.0880)])
def test_golden_heights_of_oblique_forces(up: float, height: float) -> None:
    """With f_z = up · f_x the height is h* = b/μ − up · b."""
    assert height == pytest.approx(0.045 / 0.378 - up * 0.045, abs=5e-5)  # rounding
    assert outcomes_around(ICE_TEA, 0, height, up) == ["slide", "topple"]


def test_equal_thresholds_are_undecided() -> None:
    box = BoxModel(name="b", size=(0.1, 0.1, 0.2), mass=1.0, friction=0.5)
    t = box.thresholds([[-0.05, 0.0, 0.05 / 0.5]], [[1.0, 0.0, 0.0]])
    assert t.outcome.tolist() == ["slide+topple"]
    assert np.isnan(t.twist).all()


def test_pressing_down_jams_and_nothing_moves() -> None:
    u = np.array([[0.15, 0.0, -1.0]]) / np.hypot(0.15, 1.0)  # inside the table's friction cone
    t = ICE_TEA.thresholds([[0.0, 0.0, 0.23]], u)
    # The force meets the table 35 mm from the middle, inside the base, so nothing tips either.
    assert t.outcome.tolist() == ["none"]
    assert np.isinf(t.onset).all()
    assert t.edge.tolist() == [-1]


def test_lifting_in_the_middle_tips_no_edge_before_the_box_hangs() -> None:
    t = ICE_TEA.thresholds([[0.0, 0.0, 0.23]], [[0.0, 0.0, 1.0]])
    assert t.topple[0] == pytest.approx(ICE_TEA.weight, rel=1e-12)
    assert np.isinf(t.slide[0])


def residual(r: float, h: float, w: float, a: float, mu: float) -> float:
    return r * r * (h * h + ((1 + r * w) * a) ** 2) - mu * mu


def test_slide_threshold_is_the_first_root_of_the_quartic() -> None:
    """Oracle: a dense scan of the quartic for its first change of sign."""
    rng = np.random.default_rng(0)
    jams = bends = 0
    for _ in range(600):
        w = rng.uniform(-1.0, 0.5)
        h = np.sqrt(1 - w * w)
        arm, mu = rng.uniform(0.0, 6.0) * rng.integers(2), rng.uniform(0.1, 0.8)
        if w < 0 and arm * arm > 8 * h * h and rng.random() < 0.5:
            # Just below the peak, where the later roots are near.
            peak = (np.sqrt(1 - 8 * (h / arm) ** 2) - 3) / (4 * w)
            mu = np.sqrt(residual(peak, h, w, arm, 0.0)) * (1 - 0.03 * rng.random())
        end = 50.0 if w >= 0 else -1.0 / w
        r = np.linspace(0.0, end, 20001)
        with np.errstate(over="ignore"):
            positive = np.nonzero(r * r * (h * h + ((1 + r * w) * arm) ** 2) > mu * mu)[0]
        s = slide_threshold(np.array([h, 0.0, w]), np.array(arm), mu, 1.0, 1.0).item()
        if not positive.size:
            assert np.isinf(s)
            jams += 1
            continue
        found = s / (1.0 - s * w)
        # Rounding of terms of the order of one or μ².
        assert abs(residual(found, h, w, arm, mu)) < 1e-12 * max(1.0, mu * mu)
        # The scan brackets the first root between two of its points.
        assert r[positive[0] - 1] - 1e-12 <= found <= r[positive[0]] + 1e-12
        bends += w < 0 and arm * arm > 8 * h * h
    assert jams > 10  # both special cases were met
    assert bends > 10


def test_slide_threshold_without_yaw_is_the_no_yaw_formula() -> None:
    rng = np.random.default_rng(1)
    u = rng.normal(size=(200, 3))
    h, w = np.hypot(u[:, 0], u[:, 1]), u[:, 2]
    s = slide_threshold(u, np.zeros(200), 0.4, 0.05, 3.0)
    free = h + 0.4 * w > 0
    np.testing.assert_allclose(s[free], 0.4 * 3.0 / (h + 0.4 * w)[free], rtol=1e-13)
    assert np.isinf(s[~free]).all()
    assert (~free).any()


def test_horizontal_slide_threshold_with_yaw_is_the_ellipse() -> None:
    arm = np.linspace(-0.1, 0.1, 21)
    s = slide_threshold(np.tile([0.6, 0.8, 0.0], (21, 1)), arm, 0.4, 0.05, 3.0)
    np.testing.assert_allclose(s, 0.4 * 3.0 / np.sqrt(1 + (arm / 0.05) ** 2), rtol=1e-13)


def random_pushes(n: int, seed: int) -> tuple[BoxModel, Array, Array]:
    rng = np.random.default_rng(seed)
    box = BoxModel(name="b", size=(0.1, 0.16, 0.24), mass=0.8, friction=0.4, com=(0.01, -0.02, 0.1))
    p = rng.uniform([-0.05, -0.08, 0.0], [0.05, 0.08, 0.24], (n, 3))
    u = rng.normal(size=(n, 3))
    return box, p, u / np.linalg.norm(u, axis=1, keepdims=True)


@pytest.mark.parametrize("radius", [0.05, 0.005])
def test_critical_friction_separates_the_classes(radius: float) -> None:
    """A box a little smoother than μ* slides first, a little rougher one topples first.

    With the small friction radius many a push turns the box where a harder one would not.
    """
    box, p, u = random_pushes(2000, 2)
    c = np.array(box.com)
    topple = topple_threshold(box.base, p, u, c, box.weight)
    arm = yaw_arm(p, u, c)
    limit = critical_friction(u, arm, topple, radius, box.weight)
    tips = np.isfinite(topple) & np.isfinite(limit)
    assert tips.sum() > 1000
    for factor, slides in ((1 - 1e-6, True), (1 + 1e-6, False)):
        s = slide_threshold(u, arm, factor * limit, radius, box.weight)
        assert ((s < topple) == slides)[tips].all()


def test_twist_is_allowed_by_the_contact_and_scaled() -> None:
    box, p, u = random_pushes(2000, 3)
    t = box.thresholds(p, u)
    moving = np.isin(t.outcome, ["slide", "topple"])
    p, u, v = p[moving], u[moving], t.twist[moving]
    velocity = v[:, 3:] + np.cross(v[:, :3], p)
    np.testing.assert_allclose(np.sum(velocity * u, axis=1), 1.0, atol=1e-9)  # of order one
    slides = t.outcome[moving] == "slide"
    np.testing.assert_array_equal(v[slides][:, [0, 1, 5]], 0.0)  # planar
    # A toppling box leaves no base corner below the table, and its pivot edge at rest.
    corners = np.array([[x, y, 0.0] for x in (-0.05, 0.05) for y in (-0.08, 0.08)])
    rates = v[~slides][:, None, :]
    lifts = (rates[..., 3:] + np.cross(rates[..., :3], corners))[..., 2]
    scale = np.abs(lifts).max(axis=1, keepdims=True)
    assert (lifts >= -1e-12 * scale).all()
    assert (np.sum(np.abs(lifts) < 1e-12 * scale, axis=1) == 2).all()


def test_sliding_twist_opposes_the_friction_of_the_limit_surface() -> None:
    """Power against friction equals the push's power: s · 1 = f·v + m ω on the surface."""
    box, p, u = random_pushes(1000, 4)
    t = box.thresholds(p, u)
    i = t.outcome == "slide"
    p, u, s, v = p[i], u[i], t.slide[i], t.twist[i]
    load = box.weight - s * u[:, 2]
    q = centre_of_pressure(p, s[:, None] * u, np.array(box.com), box.weight)
    at_q = v[:, 3:5] + v[:, 2:3] * np.column_stack((-q[:, 1], q[:, 0]))
    rate = np.sqrt(np.sum(at_q**2, axis=1) + (box.friction_radius * v[:, 2]) ** 2)
    # Dissipation of an ellipsoid: μ N sqrt(v² + c̄² ω²).
    np.testing.assert_allclose(box.friction * load * rate, s, rtol=1e-9)


def test_predictions_know_their_margins() -> None:
    t = ICE_TEA.thresholds([[-0.045, 0.0, 0.15]], [[1.0, 0.0, 0.0]])
    slide, topple = t.slide.item(), t.topple.item()
    forces = np.array([0.0, topple - 0.1, topple + 0.05, topple + 10.0])
    o = ICE_TEA.predict(np.tile([-0.045, 0.0, 0.15], (4, 1)), forces[:, None] * [[1.0, 0.0, 0.0]])
    assert o.outcome.tolist() == ["none", "none", "topple", "topple"]
    # Differences of forces of some newtons.
    np.testing.assert_allclose(o.margin[1:], [0.1, 0.05, slide - topple], atol=1e-12)
    assert o.margin[0] == np.inf  # no force has no direction, and never moves anything

"""Extremes over the finger's cone and the parameters, against random directions and parameters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from objectmodels import BoxModel, ConeThresholds, ObjectModel, Registry
from objectmodels.geometry.base_shapes import Array
from objectmodels.mechanics.friction_cone import contact_forces
from objectmodels.mechanics.push_thresholds import (
    slide_threshold,
    topple_threshold,
    yaw_arm,
)

ICE_TEA = BoxModel(
    name="b", size=(0.09, 0.09, 0.23), mass=0.9952, friction=0.378, finger_friction=0.45
)
# Contact in the middle of the rear face, and its outward normal.
REAR = [-0.045, 0.0], [-1.0, 0.0, 0.0]


def at_heights(box: ObjectModel, heights: Array, sigmas: float = 0.0) -> ConeThresholds:
    """The middle of the rear face, at several heights."""
    xy, normal = REAR
    points = np.column_stack((np.tile(xy, (len(heights), 1)), heights))
    return box.cone_thresholds(points, np.tile(normal, (len(heights), 1)), sigmas=sigmas)


def test_forces_are_made_of_the_inward_normal_and_friction() -> None:
    normals = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    f = contact_forces(normals, np.array([[0.2, 0.3], [0.2, 0.3]]))
    np.testing.assert_array_equal(f, [[-1.0, 0.2, 0.3], [0.2, 1.0, 0.3]])


def test_nominal_height_is_that_of_a_horizontal_push() -> None:
    c = at_heights(ICE_TEA, np.array([0.1]))
    assert c.critical_height[0] == pytest.approx(0.045 / 0.378, rel=1e-12)


@pytest.mark.parametrize(("share", "height"), [(0.69, 0.0880), (0.45, 0.0988)])
def test_upward_share_sets_the_height_below(share: float, height: float) -> None:
    """All slide first below b/μ − μ_f b, where the finger pulls up as hard as its friction allows.

    No yaw at the worst direction, so sliding knows nothing of the friction radius there.
    """
    box = ICE_TEA.model_copy(update={"finger_friction": share})
    c = at_heights(box, np.array([0.1]))
    assert height == pytest.approx(0.045 / 0.378 - share * 0.045, abs=5e-5)  # rounding
    # Directions lie on a polygon around the cone, cos(π/128) short of touching its corners.
    assert c.height_below[0] == pytest.approx(height, abs=1.5e-4)


def test_height_above_where_nothing_yaws() -> None:
    """With a huge friction radius all topple first above b sqrt((1 + μ_f²)(1 + μ²)) / μ.

    It is the largest b (sqrt(1 + η²)/μ + κ) on η² + κ² = μ_f²; straight down (η = 0) 139 mm.
    """
    c = at_heights(ICE_TEA.model_copy(update={"friction_radius": 1e3}), np.array([0.1]))
    expected = 0.045 * np.sqrt((1 + 0.45**2) * (1 + 0.378**2)) / 0.378
    assert expected > 0.045 / 0.378 + 0.45 * 0.045
    assert c.height_above[0] == pytest.approx(expected, abs=1.5e-4)


def test_two_fingers_that_keep_it_straight_are_as_good_as_a_huge_friction_radius() -> None:
    box = Registry.default().get("ice tea box")
    stiff = box.model_copy(update={"friction_radius": 1e6, "friction_radius_sd": 0.0})
    points = np.column_stack((np.full(20, -0.045), np.full(20, 0.01), np.linspace(0.02, 0.22, 20)))
    normals = np.tile([-1.0, 0.0, 0.0], (20, 1))
    straight = box.cone_thresholds(points, normals, sigmas=1.0, yaw=False)
    expected = stiff.cone_thresholds(points, normals, sigmas=1.0)
    one = box.cone_thresholds(points, normals, sigmas=1.0)
    for name in ("slide_margin", "topple_margin", "slide_max", "height_below", "height_above"):
        # An arm of centimetres over 1e6 m shortens the ellipse by less than 1e-12.
        np.testing.assert_allclose(getattr(straight, name), getattr(expected, name), rtol=1e-9)
    np.testing.assert_allclose(straight.probability_topple, expected.probability_topple, atol=1e-9)
    assert (straight.topple_margin >= one.topple_margin).all()
    assert (straight.topple_margin > one.topple_margin + 0.5).any()  # newtons
    assert straight.probability_topple[-1] > 0.9 > one.probability_topple[-1]


def test_parameters_at_their_worst_set_the_height_below() -> None:
    """h = b/μ − κ (2b₀ − b), b the lever to the pivot: finger and centre of mass 2b₀ − b apart."""
    sd = {"friction_sd": 0.03, "finger_friction_sd": 0.05, "com_sd": (0.003, 0.0, 0.0)}
    c = at_heights(ICE_TEA.model_copy(update=sd), np.array([0.05]), sigmas=2.0)
    b, mu, reach = 0.045 - 0.006, 0.378 + 0.06, 0.45 + 0.1
    assert c.height_below[0] == pytest.approx(b / mu - reach * (0.09 - b), abs=2e-4)


def test_heights_agree_with_the_classes() -> None:
    for box in (*Registry.default(), ICE_TEA.model_copy(update={"friction_radius": 1e3})):
        for face in box.faces():
            heights = np.linspace(0.005, box.extents[2], 80)
            points = np.tile(face.centre, (80, 1)) + 0.1 * face.width * np.array(face.tangent)
            points[:, 2] = heights
            c = box.cone_thresholds(points, np.tile(face.normal, (80, 1)), sigmas=1.0)
            # The two are found on different sets of directions: 0.5 mm covers the finer polygon.
            assert (c.slides | (heights > c.height_below - 5e-4)).all()
            assert (~c.slides | (heights < c.height_below + 5e-4)).all()
            assert (c.topples | (heights < c.height_above + 5e-4)).all()
            assert (~c.topples | (heights > c.height_above - 5e-4)).all()


def test_heights_off_the_box_are_infinite() -> None:
    cereal = Registry.default().get("cereal box")
    c = cereal.cone_thresholds([[0.0, -0.096, 0.1]], [[0.0, -1.0, 0.0]])
    assert np.isinf(c.critical_height[0])
    assert np.isinf(c.height_above[0])


def test_a_jamming_contact_promises_nothing() -> None:
    """Rough finger, smooth table: pressing down at the top stops the box."""
    rough = ICE_TEA.model_copy(update={"finger_friction": 3.0})
    c = at_heights(rough, np.array([0.05]))
    assert c.slide_max[0] == np.inf
    assert c.slide_margin[0] == -np.inf
    assert c.height_below[0] == 0.0
    assert not c.slides[0]


def test_jams_count_even_where_nothing_topples() -> None:
    """The centre of mass far behind the pivot keeps the box from tipping, not from jamming."""
    rough = ICE_TEA.model_copy(update={"finger_friction": 3.0, "com": (-0.035, 0.0, 0.1)})
    c = at_heights(rough, np.array([0.01]))
    assert c.height_below[0] == 0.0
    assert not c.slides[0]


@dataclass(frozen=True)
class Sampled:
    """Thresholds of contacts under random directions in the cone and random parameters."""

    slide: Array
    topple: Array

    def later(self, first: Array, other: Array) -> Array:
        with np.errstate(invalid="ignore"):
            least: Array = np.where(np.isinf(first), -np.inf, other - first).min(axis=1)
        return least


def random_box(rng: np.random.Generator) -> ObjectModel:
    size = rng.uniform([0.04, 0.04, 0.06], [0.2, 0.2, 0.3])
    com = size * rng.uniform([-0.2, -0.2, 0.3], [0.2, 0.2, 0.6])
    box = BoxModel(
        name="b",
        size=tuple(size.tolist()),
        mass=rng.uniform(0.1, 2.0),
        friction=rng.uniform(0.15, 0.8),
        finger_friction=rng.uniform(0.2, 1.0),
        com=tuple(com.tolist()),
        friction_sd=rng.uniform(0.0, 0.07),
        finger_friction_sd=rng.uniform(0.0, 0.1),
        com_sd=tuple((size * rng.uniform(0.0, 0.08, 3)).tolist()),
        support="corners" if rng.random() < 0.5 else "uniform",
    )
    # A small friction radius makes the slide threshold peak sharply where nothing yaws.
    share = rng.choice([1.0, 1.0, 0.1])
    return box.model_copy(update={"friction_radius": share * box.friction_radius})


def random_contacts(box: ObjectModel, rng: np.random.Generator, n: int) -> tuple[Array, Array]:
    points, normals = np.zeros((n, 3)), np.zeros((n, 3))
    for i in range(n):
        face = box.faces()[rng.integers(4)]
        lateral = rng.uniform(-0.5, 0.5) * rng.choice([0.0, 0.3, 1.0]) * face.width
        points[i] = np.array(face.centre) + lateral * np.array(face.tangent)
        points[i, 2] = rng.uniform(0.02, 1.0) * face.height
        normals[i] = face.normal
    return points, normals


def sample(
    box: ObjectModel, p: Array, normals: Array, sigmas: float, k: int, rng: np.random.Generator
) -> Sampled:
    """Thresholds from the box's own closed forms, shape (n, k); half of the draws at corners."""
    e = sigmas * rng.uniform(-1.0, 1.0, (k, 5))
    e[: k // 2] = sigmas * np.sign(e[: k // 2])
    com = np.array(box.com) + np.column_stack((e[:, :2] * np.array(box.com_sd[:2]), np.zeros(k)))
    reach = box.finger_friction + e[:, 4] * box.finger_friction_sd
    phi, out = rng.uniform(0.0, 2 * np.pi, k), np.sqrt(rng.random(k))
    out[rng.random(k) < 0.7] = 1.0  # mostly on the cone's boundary
    side, up = reach * out * np.cos(phi), reach * out * np.sin(phi)
    tangents = np.cross([0.0, 0.0, 1.0], normals)
    f = -normals[:, None] + side[:, None] * tangents[:, None] + up[:, None] * [0.0, 0.0, 1.0]
    q = p[:, None, :]
    radius = np.maximum(box.friction_radius + e[:, 3] * box.friction_radius_sd, 1e-4)
    mu = box.friction + e[:, 2] * box.friction_sd
    return Sampled(
        slide=slide_threshold(f, yaw_arm(q, f, com), np.maximum(mu, 0.0), radius, box.weight),
        topple=topple_threshold(box.base, q, f, com, box.weight),
    )


@pytest.mark.parametrize("sigmas", [0.0, 1.0, 2.0])
def test_no_random_direction_or_parameter_is_worse(sigmas: float) -> None:
    rng = np.random.default_rng(int(sigmas))
    certain = {"slide": 0, "topple": 0}
    for _ in range(25):
        box = random_box(rng)
        p, normals = random_contacts(box, rng, 40)
        c = box.cone_thresholds(p, normals, sigmas=sigmas)
        s = sample(box, p, normals, sigmas, 500, rng)
        slide_margin, topple_margin = s.later(s.slide, s.topple), s.later(s.topple, s.slide)
        # Certainty claimed: refined margins, which no sample undercuts by 0.1 % of the weight.
        fine, g = 1e-3 * box.weight, box.weight
        assert (c.slide_margin <= slide_margin + fine)[c.slides].all()
        assert (c.topple_margin <= topple_margin + fine)[c.topples].all()
        assert (slide_margin[c.slides] > -fine).all()
        assert (topple_margin[c.topples] > -fine).all()
        # Not claimed: coarse where the thresholds are of the order of the weight.
        near = (c.slide_margin > -0.3 * g) & ~c.slides
        assert (c.slide_margin <= slide_margin + 0.05 * g)[near].all()
        near = (c.topple_margin > -0.3 * g) & ~c.topples
        assert (c.topple_margin <= topple_margin + 0.05 * g)[near].all()
        # Forces: directions 3° apart miss a peak of the slide threshold by less than 0.5 %.
        usual = c.slide_max < 5 * g
        assert (s.slide.max(axis=1) <= 1.005 * c.slide_max)[usual].all()
        usual = c.topple_max < 5 * g
        assert (s.topple.max(axis=1) <= 1.02 * c.topple_max)[usual].all()
        certain["slide"] += int(c.slides.sum())
        certain["topple"] += int(c.topples.sum())
    assert certain["slide"] > 200
    if sigmas < 2.0:  # at 2 σ of an unfitted friction radius hardly anything is sure to topple
        assert certain["topple"] > 10


def test_extremes_are_nearly_met() -> None:
    """The worst case is no mere bound: without uncertainty some direction comes that close."""
    rng = np.random.default_rng(5)
    short: list[Array] = []
    for _ in range(10):
        box = random_box(rng)
        p, normals = random_contacts(box, rng, 40)
        c = box.cone_thresholds(p, normals)
        s = sample(box, p, normals, 0.0, 2000, rng)
        slide_margin, topple_margin = s.later(s.slide, s.topple), s.later(s.topple, s.slide)
        short.append((slide_margin[c.slides] - c.slide_margin[c.slides]) / box.weight)
        short.append((topple_margin[c.topples] - c.topple_margin[c.topples]) / box.weight)
    # The enclosing polygon exaggerates the cone by 0.5 %, forces are of the weight's order, and
    # two thousand random directions miss the worst one by a little.
    assert np.concatenate(short).max() < 0.03
    assert np.median(np.concatenate(short)) < 0.005


def test_more_uncertainty_is_never_safer() -> None:
    box = Registry.default().get("coffee box")
    heights = np.linspace(0.02, 0.18, 30)
    points = np.column_stack((np.full(30, -0.031), np.full(30, 0.01), heights))
    normals = np.tile([-1.0, 0.0, 0.0], (30, 1))
    sure, usual, bad = (box.cone_thresholds(points, normals, sigmas=s) for s in (0, 1, 2))
    for a, b in ((sure, usual), (usual, bad)):
        assert (a.slide_margin >= b.slide_margin).all()
        assert (a.topple_margin >= b.topple_margin).all()
        assert (a.height_below >= b.height_below).all()
        assert (a.slide_max <= b.slide_max).all()


def test_mass_scales_the_forces_only() -> None:
    box = Registry.default().get("ice tea box")
    heavy = box.model_copy(update={"mass": 3 * box.mass})
    heights = np.linspace(0.02, 0.22, 20)
    a, b = at_heights(box, heights, 1.0), at_heights(heavy, heights, 1.0)
    np.testing.assert_array_equal(a.slides, b.slides)
    np.testing.assert_allclose(3 * a.slide_margin, b.slide_margin, rtol=1e-9)
    np.testing.assert_allclose(a.height_below, b.height_below, rtol=1e-12)
    np.testing.assert_allclose(a.probability_slide, b.probability_slide, atol=1e-12)

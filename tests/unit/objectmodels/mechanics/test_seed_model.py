"""The seed's model: torque ranges, axes, and agreement with the closed forms."""

from __future__ import annotations

from itertools import pairwise
from math import pi

import numpy as np
import pytest

from objectmodels import BoxModel, ModelError, PrismModel
from objectmodels.geometry.base_shapes import without_collinear
from objectmodels.mechanics.push_thresholds import centre_of_pressure
from tests.unit.objectmodels.mechanics.seed_model import SeedModel, TorqueRange, torque_range

BOX = BoxModel(name="b", size=(0.1, 0.2, 0.2), mass=1.0, friction=0.4)
BAND = 1e-9
"""Relative distance from a threshold within which rounding may decide."""


def test_a_square_corner_balances_a_quarter_turn() -> None:
    square = np.array([(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)])
    r = torque_range(square, 0)
    assert r.width == pytest.approx(pi / 2, rel=1e-12)
    # Weight at (−x, 0) from the vertex turns about −y: (r × −ẑ) = (−r_y, r_x).
    assert r.distance(np.array([0.0, -1.0, 0.0])) == 0.0
    assert r.distance(np.array([0.0, 1.0, 0.0])) == pytest.approx(pi / 2, rel=1e-12)


def test_distance_wraps_around() -> None:
    r = TorqueRange(start=3.0, width=0.5)  # passes ±π
    assert r.distance(np.array([np.cos(-3.0), np.sin(-3.0)])) == 0.0
    assert r.distance(np.array([np.cos(2.9), np.sin(2.9)])) == pytest.approx(0.1, rel=1e-9)


def test_collinear_vertices_are_dropped() -> None:
    base = np.array([(0, 0), (1, 0), (2, 0), (2, 2), (0, 2), (0, 1)], dtype=float)
    np.testing.assert_array_equal(without_collinear(base), [(0, 0), (2, 0), (2, 2), (0, 2)])
    plain = SeedModel(without_collinear(base), (1, 1, 1), 9.81, 0.4)
    assert SeedModel(base, (1, 1, 1), 9.81, 0.4).ranges == plain.ranges


def test_the_weight_alone_is_balanced() -> None:
    rng = np.random.default_rng(0)
    for _ in range(200):
        angles = np.sort(rng.uniform(0, 2 * pi, rng.integers(3, 8)))
        if max(b - a for a, b in pairwise([*angles, angles[0] + 2 * pi])) > pi - 0.1:
            continue  # the polygon would not hold the origin
        base = np.column_stack((np.cos(angles), np.sin(angles)))
        model = SeedModel(base, (0.0, 0.0, rng.uniform(0.1, 2)), 9.81, 0.4)
        assert model.rotation((0, 0, 0), (0, 0, 0)) is None


@pytest.mark.parametrize(("force", "edge"), [((9.0, 0, 0), 0), ((-9.0, 0, 0), 2), ((0, 9.0, 0), 1)])
def test_axis_is_the_edge_that_is_crossed(force: tuple[float, float, float], edge: int) -> None:
    axis = SeedModel.of(BOX).rotation((0.0, 0.0, 0.18), force)
    assert axis is not None
    assert len(axis.vertices) == 2
    n, d = BOX.footprint.normals[edge], BOX.footprint.offsets[edge]
    assert n @ axis.point == pytest.approx(d, rel=1e-12)
    assert n @ axis.direction == pytest.approx(0.0, abs=1e-12)  # of a unit vector


def test_a_tie_turns_about_a_corner() -> None:
    """Pushed diagonally, a square box tips about one corner, square to the push."""
    square = BoxModel(name="s", size=(0.1, 0.1, 0.2), mass=1.0, friction=0.4)
    axis = SeedModel.of(square).rotation((0.0, 0.0, 0.2), (6.0, 6.0, 0.0))
    assert axis is not None
    assert axis.vertices == (1,)
    np.testing.assert_allclose(axis.point, [0.05, 0.05], rtol=1e-12)
    assert axis.direction @ [1.0, 1.0] == pytest.approx(0.0, abs=1e-12)  # of a unit vector


def test_lifting_is_refused() -> None:
    with pytest.raises(ModelError, match="lifts"):
        SeedModel.of(BOX).rotation((0, 0, 0.2), (0, 0, 10.0))


@pytest.mark.parametrize(
    ("height", "force", "outcome"),
    [(0.05, 3.0, "none"), (0.05, 5.0, "slide"), (0.19, 3.5, "topple"), (0.19, 5.0, "slide+topple")],
)
def test_the_paper_s_four_outcomes(height: float, force: float, outcome: str) -> None:
    assert SeedModel.of(BOX).outcome((-0.05, 0.0, height), (force, 0.0, 0.0)) == outcome


@pytest.mark.slow
def test_ten_thousand_random_pushes_agree_with_the_closed_form() -> None:
    """Tipping is the centre of pressure leaving the base; sliding is the no-yaw formula."""
    rng = np.random.default_rng(11)
    seen = {"none": 0, "slide": 0, "topple": 0, "slide+topple": 0}
    checked = 0
    for _ in range(100):
        size = rng.uniform([0.03, 0.03, 0.05], [0.25, 0.25, 0.35])
        com = size * rng.uniform([-0.3, -0.3, 0.2], [0.3, 0.3, 0.8])
        box = BoxModel(
            name="b",
            size=tuple(size.tolist()),
            com=tuple(com.tolist()),
            mass=rng.uniform(0.05, 3.0),
            friction=rng.uniform(0.1, 0.9),
        )
        seed, g, d = SeedModel.of(box), box.weight, box.footprint.offsets
        p = rng.uniform([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0], (100, 3)) * size
        u = rng.normal(size=(100, 3))
        u /= np.linalg.norm(u, axis=1, keepdims=True)
        f = u * (g * rng.uniform(0.0, 0.95, 100) ** 2 / np.maximum(u[:, 2], 0.95))[:, None]
        q = centre_of_pressure(p, f, com, g)
        beyond = (q @ box.footprint.normals.T - d).max(axis=1)
        pull = np.hypot(f[:, 0], f[:, 1]) - box.friction * (g - f[:, 2])
        topples = box.thresholds(p, u).topple < np.linalg.norm(f, axis=1)
        for i in np.nonzero((np.abs(beyond) > BAND * d.min()) & (np.abs(pull) > BAND * g))[0]:
            assert (seed.rotation(p[i], f[i]) is not None) == (beyond[i] > 0) == topples[i]
            assert seed.slides(f[i]) == (pull[i] > 0)
            seen[seed.outcome(p[i], f[i])] += 1
            checked += 1
    assert checked > 9_990  # nearly none lies in the band
    assert min(seen.values()) > 300


@pytest.mark.parametrize("corners", [3, 5, 6, 8])
def test_the_seed_tips_where_the_closed_form_does_on_any_polygon(corners: int) -> None:
    rng = np.random.default_rng(corners)
    turns = 2 * pi * (np.arange(corners) + rng.uniform(-0.2, 0.2, corners)) / corners
    outline = 0.06 * np.column_stack((np.cos(turns), np.sin(turns)))
    prism = PrismModel(
        name="p", corners=tuple(map(tuple, outline.tolist())), height=0.2, mass=0.7, friction=0.4
    )
    seed, checked = SeedModel.of(prism), 0
    p = rng.uniform([-0.06, -0.06, 0.0], [0.06, 0.06, 0.2], (300, 3))
    u = rng.normal(size=(300, 3)) * [1.0, 1.0, 0.4]
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    t = prism.thresholds(p, u)
    for i in np.nonzero(t.topple < 3.0 * prism.weight)[0]:
        for share, tips in ((1.0 - BAND, False), (1.0 + BAND, True)):
            force = share * t.topple[i] * u[i]
            if force[2] < 0.99 * prism.weight:
                assert (seed.rotation(p[i], force) is not None) is tips
                checked += 1
    assert checked > 300


def test_axis_just_past_the_threshold_is_the_first_edge_crossed() -> None:
    rng = np.random.default_rng(12)
    seed, d = SeedModel.of(BOX), BOX.footprint.offsets
    p = rng.uniform([-0.05, -0.1, 0.0], [0.05, 0.1, 0.2], (300, 3))
    u = rng.normal(size=(300, 3))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    t = BOX.thresholds(p, u)
    checked = 0
    for i in np.nonzero(np.isfinite(t.topple))[0]:
        f = (1 + 1e-6) * t.topple[i] * u[i]
        if f[2] >= 0.99 * BOX.weight:
            continue
        axis, n = seed.rotation(p[i], f), BOX.footprint.normals[t.edge[i]]
        assert axis is not None
        assert n @ axis.point == pytest.approx(d[t.edge[i]], abs=1e-12)
        assert n @ axis.direction == pytest.approx(0.0, abs=1e-12)
        checked += 1
    assert checked > 150


def test_a_common_scale_of_all_forces_changes_no_class() -> None:
    """The paper's remark: forces sensed wrong by a factor give such a mass, and equal classes."""
    rng = np.random.default_rng(13)
    p = rng.uniform([-0.05, -0.1, 0.0], [0.05, 0.1, 0.2], (400, 3))
    f = rng.normal(size=(400, 3)) * 3.0
    expected = BOX.predict(p, f).outcome
    assert set(expected) == {"none", "slide", "topple"}
    for factor in (0.5, 0.9, 1.37, 3.0):
        scaled = BOX.model_copy(update={"mass": factor * BOX.mass})
        np.testing.assert_array_equal(scaled.predict(p, factor * f).outcome, expected)
        seed, off = SeedModel.of(BOX), SeedModel.of(scaled)
        held = [i for i in range(100) if f[i, 2] < 0.99 * BOX.weight]
        assert [seed.outcome(p[i], f[i]) for i in held] == [
            off.outcome(p[i], factor * f[i]) for i in held
        ]

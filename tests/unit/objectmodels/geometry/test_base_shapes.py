"""Bases: polygons and discs, where they end, and how they are cut up."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import dblquad

from objectmodels import Disc, ModelError, Polygon
from objectmodels.geometry.base_shapes import (
    Array,
    Base,
    carrying_base,
    friction_radius,
    support_points,
)
from objectmodels.geometry.rotations import unique_rows

HEXAGON = Polygon.convex(
    [
        [0.045, 0],
        [0.0225, 0.039],
        [-0.0225, 0.039],
        [-0.045, 0],
        [-0.0225, -0.039],
        [0.0225, -0.039],
    ]
)
LOPSIDED = Polygon.convex([[0.05, 0.0], [0.02, 0.06], [-0.05, 0.03], [-0.04, -0.05]])
BASES: dict[str, Base] = {
    "rectangle": Polygon.rectangle(0.09, 0.12),
    "hexagon": HEXAGON,
    "lopsided": LOPSIDED,
    "disc": Disc(0.04),
}


def inside(base: Base, q: Array) -> bool:
    """Whether a point lies in a base, straight from its definition."""
    if isinstance(base, Disc):
        return bool(np.hypot(*q) <= base.radius)
    assert isinstance(base, Polygon)
    ahead = np.roll(base.vertices, -1, axis=0) - base.vertices
    to = q - base.vertices
    return bool((ahead[:, 0] * to[:, 1] - ahead[:, 1] * to[:, 0] >= 0.0).all())


@pytest.mark.parametrize("name", BASES)
@given(seed=st.integers(0, 2**32 - 1))
def test_the_centre_of_pressure_leaves_the_base_at_the_force_given(name: str, seed: int) -> None:
    base, rng = BASES[name], np.random.default_rng(seed)
    weight, w = 9.81, rng.uniform(-0.9, 0.9)
    m, e = weight * rng.uniform(-0.015, 0.015, 2), rng.uniform(-0.2, 0.2, 2)
    s = float(base.topple_force(m, e, np.array(w), weight))
    assert s >= 0.0
    last = min(s, 1e3)  # a push of a hundred weights is as good as endless
    for share in (0.1, 0.5, 0.999):
        load = weight - share * last * w
        if load > 1e-9:
            assert inside(base, (m + share * last * e) / load)
    if np.isfinite(s) and weight - 1.001 * s * w > 0.0:
        assert not inside(base, (m + 1.001 * s * e) / (weight - 1.001 * s * w))


@pytest.mark.parametrize("name", BASES)
@given(seed=st.integers(0, 2**32 - 1))
def test_the_topple_height_is_where_the_same_force_topples(name: str, seed: int) -> None:
    base, rng = BASES[name], np.random.default_rng(seed)
    weight = 9.81
    m = weight * rng.uniform(-0.015, 0.015, 2)
    force = rng.uniform(-3.0, 3.0, 3)
    e = -force[2] * rng.uniform(-0.03, 0.03, 2)
    load = weight - force[2]
    height = float(base.topple_height(m, e, force[:2], np.array(load)))
    for factor, stays in ((0.999, True), (1.001, False)):
        if 1e-3 < height < 1e3:  # metres: far above or below nothing is left to test
            q = (m + e + factor * height * force[:2]) / load
            assert inside(base, q) is stays


@pytest.mark.parametrize("name", BASES)
def test_uniform_radius_is_the_mean_distance(name: str) -> None:
    base = BASES[name]
    centre = base.centroid if isinstance(base, Polygon) else np.zeros(2)
    rng = np.random.default_rng(0)
    q = rng.uniform(-base.size, base.size, (400_000, 2))
    q = q[[inside(base, x) for x in q[:40_000]] + [False] * 360_000]
    distance = np.hypot(*(q - centre).T)
    # Four standard errors of the mean.
    assert base.uniform_radius == pytest.approx(
        distance.mean(), abs=4 * distance.std() / np.sqrt(len(q))
    )


def test_uniform_radius_of_a_hexagon_by_quadrature() -> None:
    a = 1.0
    hexagon = Polygon.convex([[np.cos(t), np.sin(t)] for t in np.pi / 3 * np.arange(6)])
    height = a * np.sqrt(3) / 2
    total, _ = dblquad(
        np.hypot, 0.0, height, lambda y: 0.0, lambda y: a - y / np.sqrt(3), epsrel=1e-9
    )
    # A quarter of the area; dblquad's tolerance with a margin for the kink at the centre.
    assert hexagon.uniform_radius == pytest.approx(4 * total / hexagon.area, rel=1e-7)


@pytest.mark.parametrize("name", BASES)
def test_nodes_stand_for_uniform_pressure(name: str) -> None:
    base = BASES[name]
    points, weights = base.quadrature_nodes()
    centre = base.centroid if isinstance(base, Polygon) else np.zeros(2)
    assert weights.sum() == pytest.approx(1.0, rel=1e-12)  # rounding
    np.testing.assert_allclose(weights @ points, centre, atol=1e-12)
    assert base.contains(points, 1e-12)
    # Cells are a sixteenth of the base: 3 % of the mean distance at most.
    mean = weights @ np.hypot(*(points - centre).T)
    assert mean == pytest.approx(base.uniform_radius, rel=0.03)


def test_corners_in_either_order_and_on_a_line_make_the_same_polygon() -> None:
    forward = Polygon.convex([[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    backward = Polygon.convex([[0, 1], [1, 1], [1, 0], [0, 0]])
    assert forward.area == backward.area == 1.0
    assert len(forward.vertices) == 4


@pytest.mark.parametrize(
    "corners",
    [
        [[0, 0], [1, 0]],
        [[0, 0], [1, 0], [2, 0]],
        [[0, 0], [1, 0], [0.1, 0.1], [0, 1]],  # a dent
        [[0, 0], [1, 1], [1, 0], [0, 1]],  # crosses itself
        [[np.cos(t), np.sin(t)] for t in 4 * np.pi / 5 * np.arange(5)],  # a star, twice around
        [[0, 0], [1, 0], [float("nan"), 1]],
        [0, 1, 2],
    ],
)
def test_what_is_no_convex_polygon_is_refused(corners: list[object]) -> None:
    with pytest.raises(ModelError) as error:
        Polygon.convex(corners)  # type: ignore[arg-type]
    assert error.value.code == "bad_value"


def test_radius_of_rim_points_and_feet() -> None:
    assert friction_radius("corners", Disc(0.04)) == pytest.approx(0.04, rel=1e-12)  # rounding
    assert friction_radius("uniform", Disc(0.03)) == pytest.approx(0.02, rel=1e-12)
    # Two light feet and a heavy one: the middle lies at x = 0.01.
    feet = ((0.03, 0.0, 1.0), (0.0, 0.04, 1.0), (0.0, -0.04, 1.0))
    expected = (0.02 + 2 * np.hypot(0.01, 0.04)) / 3
    assert friction_radius(feet, Polygon.rectangle(0.1, 0.1)) == pytest.approx(expected, rel=1e-12)


def test_an_object_on_feet_topples_over_their_hull() -> None:
    feet = ((0.03, 0.0), (-0.03, 0.03), (-0.03, -0.03), (0.0, 0.0))
    base = carrying_base(feet, Polygon.rectangle(0.1, 0.1))
    assert isinstance(base, Polygon)
    assert len(base.vertices) == 3
    points, weights = support_points(feet, Polygon.rectangle(0.1, 0.1))
    assert len(points) == 4
    np.testing.assert_allclose(weights, 0.25)


@pytest.mark.parametrize(
    "feet", [((0.0, 0.0), (0.01, 0.0), (0.02, 0.0)), ((0.06, 0.0), (0.0, 0.01), (-0.01, -0.01))]
)
def test_feet_on_a_line_or_beyond_the_base_are_refused(
    feet: tuple[tuple[float, float], ...],
) -> None:
    with pytest.raises(ModelError, match=r"line|outside"):
        carrying_base(feet, Polygon.rectangle(0.1, 0.1))


@pytest.mark.parametrize("rows", [[], [[1.0, 2.0]], [[2.0, 1.0], [1.0, 2.0], [2.0, 1.0]]])
def test_unique_rows_are_those_of_numpy(rows: list[list[float]]) -> None:
    values = np.array(rows).reshape(-1, 2)
    _, expected_first, expected_which = np.unique(
        values, axis=0, return_index=True, return_inverse=True
    )
    first, which = unique_rows(values)
    assert first.tolist() == expected_first.tolist()
    assert which.tolist() == expected_which.ravel().tolist()

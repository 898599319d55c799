"""Thresholds against an independent oracle: contact forces at the corners that hold the box.

A linear programme finds the largest push for which forces at the four base corners, each pressing
and inside its friction cone, balance push and weight. Its friction cones are pyramids with an edge
against the push, so they lose nothing where friction points straight back (no yaw). With forces
along the table left free it finds the tipping threshold of any push.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from scipy.integrate import dblquad
from scipy.optimize import linprog

from objectmodels import BoxModel
from objectmodels.geometry.base_shapes import Polygon, Support, friction_radius

if TYPE_CHECKING:
    from objectmodels.geometry.base_shapes import Array

SIDES = 8


def radius(support: Support, sides: tuple[float, float]) -> float:
    return friction_radius(support, Polygon.rectangle(*sides))


def largest_push(box: BoxModel, p: Array, u: Array, friction: float | None) -> float:
    """Largest s for which corner forces balance s·u at p and the weight, inf if unbounded.

    Without a friction coefficient the corners hold any force along the table.
    """
    x, y = box.size[0] / 2, box.size[1] / 2
    angles = np.arctan2(-u[1], -u[0]) + np.arange(SIDES) * 2 * np.pi / SIDES
    along = np.column_stack((np.cos(angles), np.sin(angles), np.zeros(SIDES)))
    up = np.array([0.0, 0.0, 1.0])
    edges = np.vstack((along, up)) if friction is None else friction * along + up
    columns = []
    for corner in ((x, y, 0.0), (-x, y, 0.0), (-x, -y, 0.0), (x, -y, 0.0)):
        columns += [np.concatenate((f, np.cross(corner, f))) for f in edges]
    columns.append(np.concatenate((u, np.cross(p, u))))
    weight = np.array([0.0, 0.0, -box.weight])
    load = np.concatenate((weight, np.cross(box.com, weight)))
    cost = np.zeros(len(columns))
    cost[-1] = -1.0
    # Scaled by the weight, so that the solver's tolerances are relative ones.
    found = linprog(cost, A_eq=np.column_stack(columns), b_eq=-load / box.weight, method="highs")
    if found.status == 3:  # unbounded
        return float("inf")
    assert found.status == 0
    assert found.x is not None
    return float(found.x[-1] * box.weight)


def random_box(rng: np.random.Generator, offset: float) -> BoxModel:
    size = rng.uniform([0.04, 0.04, 0.06], [0.2, 0.2, 0.3])
    com = size * rng.uniform([-offset, -offset, 0.2], [offset, offset, 0.7])
    return BoxModel(
        name="b",
        size=tuple(size.tolist()),
        com=tuple(com.tolist()),
        mass=rng.uniform(0.1, 2.0),
        friction=rng.uniform(0.15, 0.8),
    )


def test_topple_threshold_is_the_largest_push_that_holding_corners_bear() -> None:
    rng = np.random.default_rng(0)
    finite = 0
    for _ in range(150):
        box = random_box(rng, 0.3)
        p = np.array(box.size) * rng.uniform([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0])
        u = rng.normal(size=3)
        u /= np.linalg.norm(u)
        expected = largest_push(box, p, u, None)
        topple = box.thresholds(p[None], u[None]).topple.item()
        # HiGHS balances to 1e-7 of the weight, and a lever of millimetres magnifies it.
        assert topple == pytest.approx(expected, rel=1e-5)
        finite += np.isfinite(topple)
    assert finite > 100


def test_onset_of_centred_pushes_is_the_largest_push_that_the_corners_hold() -> None:
    """Centre of mass, contact and force in one vertical plane of symmetry: no yaw."""
    rng = np.random.default_rng(1)
    classes = {"slide": 0, "topple": 0, "none": 0}
    for _ in range(200):
        box = random_box(rng, 0.0)
        axis = rng.integers(2)
        p, u = np.zeros(3), np.zeros(3)
        p[axis], p[2] = -box.size[axis] / 2, rng.uniform(0.0, box.size[2])
        u[axis], u[2] = 1.0, rng.uniform(-4.0, 2.0) * rng.integers(2)
        u /= np.linalg.norm(u)
        t = box.thresholds(p[None], u[None])
        assert t.onset.item() == pytest.approx(largest_push(box, p, u, box.friction), rel=1e-6)
        classes[t.outcome.item()] += 1
    assert min(classes["slide"], classes["topple"]) > 40
    assert classes["none"] > 0


@pytest.mark.parametrize(("a", "b"), [(0.09, 0.09), (0.052, 0.192), (1.0, 1.0), (0.01, 2.0)])
def test_friction_radius_of_uniform_pressure_is_the_mean_distance(a: float, b: float) -> None:
    total, _ = dblquad(np.hypot, 0.0, a / 2, 0.0, b / 2, epsrel=1e-9)
    # dblquad's own tolerance, with a margin for the kink at the centre.
    assert radius("uniform", (a, b)) == pytest.approx(4 * total / (a * b), rel=1e-7)


def test_friction_radius_of_the_unit_square_and_of_corners() -> None:
    assert radius("uniform", (1.0, 1.0)) == pytest.approx(0.3826, abs=5e-5)  # rounding
    assert radius("corners", (0.03, 0.04)) == pytest.approx(0.025, rel=1e-12)
    # Four corners hold 1.85 times the moment of uniform pressure on a square (two digits).
    ratio = radius("corners", (1.0, 1.0)) / friction_radius("uniform", Polygon.rectangle(1.0, 1.0))
    assert ratio == pytest.approx(1.85, abs=0.005)

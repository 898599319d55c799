"""Margins and probabilities of stacks, by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from objectmodels.geometry.base_shapes import Polygon
from objectmodels.mechanics.standing_balance import (
    StackedBody,
    stack_margins,
    standing_probability,
)

LENGTHS = 1e-12  # sums of a few lengths [m]


def body(x: float, width: float, *, mass: float = 1.0, below: int | None = None) -> StackedBody:
    """A square prism about x, its centre of mass in its middle."""
    face = Polygon(np.array([x, 0.0]) + Polygon.rectangle(width, width).vertices)
    return StackedBody(mass, 0.0, np.array([x, 0.0]), np.zeros((2, 2)), face, face, below)


def test_a_tower_leans_as_far_as_the_harmonic_series_allows() -> None:
    """Of equal blocks the top one may overhang by a half, the next by a quarter, then a sixth."""
    at, bodies = 0.0, [body(0.0, 2.0)]
    for k, shift in enumerate((1 / 4, 1 / 3, 1 / 2, 1.0)):
        at += shift
        bodies.append(body(at, 2.0, below=k))
    assert stack_margins(bodies)[1:] == pytest.approx(0.0, abs=LENGTHS)


def test_what_stands_apart_counts_where_it_stands_alone() -> None:
    low = body(0.0, 0.2, mass=1.0)
    left, right = body(-0.08, 0.02, mass=2.0, below=0), body(0.08, 0.02, mass=2.0, below=0)
    assert stack_margins([low, left, right]) == pytest.approx([0.1, 0.01, 0.01], abs=LENGTHS)
    # Without the one the other moves the common centre of mass.
    assert stack_margins([low, right])[0] == pytest.approx(0.1 - 0.16 / 3.0, abs=LENGTHS)


def test_a_small_top_carries_less_than_the_base_on_it() -> None:
    post, plate = body(0.0, 0.04), body(0.015, 0.2, below=0)
    assert stack_margins([post, plate])[1] == pytest.approx(0.005, abs=LENGTHS)
    assert stack_margins([post, body(0.03, 0.2, below=0)])[1] == pytest.approx(-0.01, abs=LENGTHS)


def test_the_probability_is_that_of_many_draws_where_one_edge_decides() -> None:
    rng = np.random.default_rng(0)
    low = replace(body(0.0, 0.1, mass=0.5), mass_sd=0.1)
    up = body(0.04, 0.05, mass=0.4, below=0)
    up = replace(up, com_covariance=np.diag([0.004**2, 0.0]), mass_sd=0.05)
    told = standing_probability([low, up])
    n = 200_000
    m_low, m_up = rng.normal(0.5, 0.1, n), rng.normal(0.4, 0.05, n)
    x = rng.normal(0.04, 0.004, n)
    stands = (x < 0.05) & (m_up * x / (m_low + m_up) < 0.05)
    # Of so many draws a standard deviation is 0.0003; masses are taken to first order.
    assert told == pytest.approx(float(stands.mean()), abs=0.002)
    assert 0.9 < told < 0.999

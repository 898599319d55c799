"""What something in the hand weighs."""

import numpy as np
import pytest

from sim.control.held_object_sensing import LEVER_ERROR, estimate_weight


def test_a_weight_is_the_mean_of_what_is_felt() -> None:
    felt = estimate_weight(np.array([2.9, 3.1, 3.0, 3.0]), 100)
    assert felt.mean == pytest.approx(3.0)
    assert felt.samples == 4


def test_noise_of_the_zero_counts_like_that_of_the_weight() -> None:
    rng = np.random.default_rng(0)
    vertical = 3.0 + 0.1 * rng.standard_normal(400)
    many, few = estimate_weight(vertical, 10**6), estimate_weight(vertical, 100)
    assert many.sd == pytest.approx(np.hypot(0.1 / 20.0, LEVER_ERROR * 3.0), rel=0.05)
    assert few.sd == pytest.approx(np.sqrt(0.005**2 + 0.01**2 + (LEVER_ERROR * 3.0) ** 2), rel=0.05)


def test_one_sample_tells_nothing() -> None:
    assert estimate_weight(np.array([3.0]), 10).sd == np.inf

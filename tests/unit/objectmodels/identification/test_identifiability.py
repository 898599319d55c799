"""Limits of what counts as identified: how open, and how much a value may hang on beliefs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from objectmodels import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.pushed_body import UNCERTAIN
from objectmodels.identification.experiment_design import identifiable_parameters
from objectmodels.identification.measurement_model import Balance
from tests.unit.objectmodels.identification.touching import TRUTH, slide, touched


def found(
    noise: float,
    friction_sd: float,
    parameters: tuple[str, ...] | None = None,
    *,
    mass_sd: float = 0.2,
) -> tuple[str, ...]:
    """Names that one slide identifies, of a relative noise, with a belief about the friction."""
    (trial,) = touched(TRUTH, [slide(turn=False)])
    size = float(np.linalg.norm(trial.force))
    balance = Balance(TRUTH, [replace(trial, force_sd=noise * size)])
    belief: Array = 1e-12 * np.eye(7)
    belief[0, 0], belief[1, 1] = mass_sd**2, friction_sd**2
    at = balance.linear_predictions(TRUTH.means)
    free, _ = identifiable_parameters(balance, at, belief, parameters)
    return tuple(name for name, sought in zip(UNCERTAIN, free, strict=True) if sought)


def test_a_logarithm_known_to_a_half_is_found() -> None:
    assert found(0.45, 0.0, ("mass",)) == ("mass",)
    with pytest.raises(ModelError, match="not identifiable: mass"):
        found(0.6, 0.0, ("mass",))


def test_a_value_that_was_asked_for_hangs_on_beliefs_by_a_tenth_at_most() -> None:
    # Force and mass times friction are one: an error of the friction is one of the mass.
    assert found(0.02, 0.09, ("mass",)) == ("mass",)
    with pytest.raises(ModelError, match="not identifiable: mass"):
        found(0.02, 0.11, ("mass",))


def test_a_value_that_was_not_asked_for_hangs_on_beliefs_by_a_twentieth_at_most() -> None:
    assert found(0.02, 0.045) == ("mass",)
    with pytest.raises(ModelError, match="not identifiable"):
        found(0.02, 0.055)


def test_slides_alone_tell_the_friction_of_a_known_mass() -> None:
    assert found(0.02, 0.2, mass_sd=0.045) == ("friction",)
    assert found(0.02, 0.04, mass_sd=0.045) == ("mass",)  # the better known one is kept
    with pytest.raises(ModelError, match="not identifiable"):
        found(0.02, 0.2, mass_sd=0.055)

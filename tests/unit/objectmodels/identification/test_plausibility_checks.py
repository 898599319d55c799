"""Limits of plausibility: forces that are off by their unit, pulls, contacts at the origin."""

from __future__ import annotations

import numpy as np
import pytest

from objectmodels import BoxModel
from objectmodels.identification import Trial
from objectmodels.identification.trial import contact_objection, force_objection

BOX = BoxModel(
    name="b", size=(0.1, 0.1, 0.2), mass=1.0, friction=0.3, finger_friction=0.6, support="corners"
)
SLIDE = 0.3 * 9.81  # force that slides it by a push through its middle [N]


def quantity(force: tuple[float, float, float]) -> str | None:
    """The quantity that a slide by a push at the front is refused for."""
    objection = force_objection(BOX, Trial("slide", (-0.05, 0.0, 0.02), force, 1e-3, source="t"))
    return None if objection is None else objection.quantity


@pytest.mark.parametrize(("factor", "found"), [(40.0, None), (60.0, "force")])
def test_a_force_may_be_off_by_a_factor_of_fifty(factor: float, found: str | None) -> None:
    assert quantity((SLIDE * factor, 0.0, 0.0)) == found
    assert quantity((SLIDE / factor, 0.0, 0.0)) == found


@pytest.mark.parametrize(("outwards", "found"), [(0.04, None), (0.06, "force")])
def test_a_force_may_pull_by_a_twentieth(outwards: float, found: str | None) -> None:
    across = float(np.sqrt(1.0 - outwards**2))
    assert quantity((-2.0 * outwards, 2.0 * across, 0.0)) == found


@pytest.mark.parametrize(("height", "found"), [(0.0015, "x"), (0.0025, None)])
def test_a_contact_at_the_origin_is_none(height: float, found: str | None) -> None:
    objection = contact_objection(BOX, (0.0, 0.0, height))
    assert (None if objection is None else objection.quantity) == found

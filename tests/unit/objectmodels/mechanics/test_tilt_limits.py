"""Whether what is tilted comes back."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from objectmodels import BoxModel, Registry
from objectmodels.mechanics.push_thresholds import largest_return, return_probability

AWAY = (1.0, 0.0, 0.0)
ICE_TEA = Registry.default().get("ice tea box")


def test_the_share_of_drawn_centres_of_mass_that_come_back() -> None:
    rng, angle = np.random.default_rng(0), np.radians(17.0)
    com = rng.normal(ICE_TEA.com, ICE_TEA.com_sd, (20_000, 3))
    comes_back = com[:, 2] * np.tan(angle) < 0.045 - com[:, 0]
    # Four standard deviations of a share of 20 000.
    assert return_probability(ICE_TEA, AWAY, angle) == pytest.approx(comes_back.mean(), abs=0.012)


def test_what_is_known_falls_at_its_angle_of_no_return() -> None:
    box = BoxModel(name="box", size=(0.1, 0.1, 0.2), mass=1.0, friction=0.5)
    no_return = box.angle_of_no_return(AWAY)
    assert return_probability(box, AWAY, no_return - 1e-6) == 1.0
    assert return_probability(box, AWAY, no_return + 1e-6) == 0.0
    assert largest_return(box, AWAY, 0.95) == pytest.approx(no_return)


@given(
    com_sd=st.tuples(st.floats(1e-5, 0.02), st.floats(1e-5, 0.02), st.floats(1e-5, 0.1)),
    probability=st.floats(0.6, 0.999),
    heading=st.floats(-np.pi, np.pi),
)
def test_the_largest_angle_has_its_probability(
    com_sd: tuple[float, float, float], probability: float, heading: float
) -> None:
    box = ICE_TEA.model_copy(update={"com_sd": com_sd})
    direction = np.array([np.cos(heading), np.sin(heading)])
    angle = largest_return(box, direction, probability)
    if angle > 0.0:
        # Rounding in the closed form, where deviations of 10 µm make the probability steep.
        assert return_probability(box, direction, angle) == pytest.approx(probability, abs=1e-6)
    else:
        assert return_probability(box, direction, 0.0) <= probability + 1e-9

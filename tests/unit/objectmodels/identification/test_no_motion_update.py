"""What a push that moved nothing tells: that the object takes more."""

from __future__ import annotations

from math import erfc, exp, pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from objectmodels import BoxModel, ObjectModel
from objectmodels.geometry.pushed_body import UNCERTAIN
from objectmodels.identification import Trial
from objectmodels.identification.belief_update import (
    SURPRISING,
    _shift_while_standing,
    belief_of,
    normal_hazard,
    update_without_motion,
    widen_belief,
)

BELIEF = BoxModel(
    name="b", size=(0.09, 0.09, 0.23), mass=1.0, mass_sd=0.04, friction=0.35, friction_sd=0.06,
    finger_friction=0.6, finger_friction_sd=0.1, friction_radius=0.05, friction_radius_sd=0.02,
    com=(0.0, 0.0, 0.1), com_sd=(0.003, 0.003, 0.02),
)  # fmt: skip
LOW, HIGH = 0.03, 0.21


def onset(model: ObjectModel, height: float = LOW, lateral: float = 0.0) -> float:
    """Force at which the model moves, pushed at the front [N]."""
    return float(model.thresholds([(-0.045, lateral, height)], [(1.0, 0.0, 0.0)]).onset[0])


def bound(force: float, height: float = LOW, lateral: float = 0.0) -> Trial:
    """A push at the front that moved nothing."""
    return Trial("none", (-0.045, lateral, height), (force, 0.0, 0.0), 0.03 * force)


beliefs = st.builds(
    lambda mass, friction, sds, com_z: BELIEF.model_copy(
        update={
            "mass": mass,
            "friction": friction,
            "mass_sd": sds[0] * mass,
            "friction_sd": sds[1] * friction,
            "com": (0.0, 0.0, com_z),
            "com_sd": (0.003, 0.003, 0.1 * com_z),
        }
    ),
    st.floats(0.1, 3.0),
    st.floats(0.1, 0.8),
    st.tuples(st.floats(0.01, 0.3), st.floats(0.01, 0.4)),
    st.floats(0.03, 0.2),
)
heights, shares = st.floats(0.02, 0.22), st.floats(0.05, 4.0)


@settings(max_examples=150, deadline=None)
@given(belief=beliefs, height=heights, lateral=st.floats(-0.035, 0.035), share=shares)
def test_the_onset_that_is_believed_never_falls(
    belief: BoxModel, height: float, lateral: float, share: float
) -> None:
    before = onset(belief, height, lateral)
    taught = update_without_motion(belief, bound(share * before, height, lateral))
    # The means are those to first order in the parameters; a hair is what that may cost.
    assert onset(taught.model, height, lateral) >= (1.0 - 1e-3) * before
    assert taught.surprise >= 0.0
    assert (taught.surprise > 0.0) == (share > 1.0)
    assert np.isfinite(taught.model.covariance).all()
    assert np.linalg.eigvalsh(belief_of(taught.model)).min() > -1e-9


@settings(max_examples=60, deadline=None)
@given(belief=beliefs, height=heights)
def test_a_force_far_below_the_believed_one_tells_next_to_nothing(
    belief: BoxModel, height: float
) -> None:
    taught = update_without_motion(belief, bound(0.05 * onset(belief, height), height))
    assert taught.surprise == 0.0
    # log 20 is six deviations or more of what is believed here: λ < 1e-8. Of ten deviations of 0.5.
    change = (taught.model.means - belief.means) / belief.deviations
    assert np.nan_to_num(change) == pytest.approx(0.0, abs=1e-4)
    assert taught.model.deviations == pytest.approx(belief.deviations, rel=1e-3)


def test_a_bound_at_the_believed_force_is_half_a_normal_distribution() -> None:
    """Oracle: samples of the belief, those left out that would have moved."""
    force = onset(BELIEF)
    taught = update_without_motion(BELIEF, bound(force)).model
    rng = np.random.default_rng(0)
    # Logarithms of mass and friction; the low push slides, whatever the rest is.
    x = rng.normal([0.0, np.log(0.35)], [0.04, 0.06 / 0.35], (400_000, 2))
    felt = np.log(force) + 0.03 * rng.standard_normal(len(x))
    left = x[x.sum(axis=1) + np.log(9.81) > felt]
    # The topple's part of the update is none: it is six deviations away.
    assert np.log(taught.mass) == pytest.approx(left[:, 0].mean(), abs=5e-4)  # sampling
    assert np.log(taught.friction) == pytest.approx(left[:, 1].mean(), abs=5e-4)
    assert taught.mass_sd / taught.mass == pytest.approx(left[:, 0].std(), rel=0.01)
    assert taught.friction_sd / taught.friction == pytest.approx(left[:, 1].std(), rel=0.01)


def test_what_could_be_makes_surer_what_could_not_be_makes_less_sure() -> None:
    mass, friction = UNCERTAIN.index("mass"), UNCERTAIN.index("friction")
    expected = update_without_motion(BELIEF, bound(onset(BELIEF)))
    assert expected.surprise == pytest.approx(0.0, abs=1e-9)
    assert not expected.is_contradiction
    assert expected.model.deviations[friction] < BELIEF.deviations[friction]
    shocking = update_without_motion(BELIEF, bound(3.0 * onset(BELIEF)))
    # log 3 over what is believed of mass and friction, and of the force.
    sd = np.sqrt(0.04**2 + (0.06 / 0.35) ** 2 + 0.03**2)
    assert shocking.surprise == pytest.approx(np.log(3.0) / sd, rel=1e-6)
    assert shocking.is_contradiction
    assert shocking.model.deviations[friction] > BELIEF.deviations[friction]
    # The mass has little part in it, known to 4 % beside 17 % of friction: it stays as it was.
    share = shocking.model.deviations[mass] / shocking.model.means[mass]
    assert share == pytest.approx(0.04, rel=0.2)


def test_what_was_stated_without_doubt_is_doubted_and_learned() -> None:
    """Four times too light, and stated exactly: three bounds of 1.7 times get there."""
    model: ObjectModel = BELIEF.model_copy(
        update={"mass_sd": 0.0, "friction_sd": 0.0, "finger_friction_sd": 0.0, "com_sd": (0.0,) * 3}
    )
    true = 4.0 * onset(model)
    for _ in range(3):
        model = update_without_motion(model, bound(1.7 * onset(model))).model
    assert true < 1.7 * onset(model) < 6.0 * true
    # What has no part in it is neither doubted nor learned.
    assert model.friction_radius_sd == pytest.approx(BELIEF.friction_radius_sd)


def test_a_bound_far_beyond_leaves_an_object_that_stands() -> None:
    """Its centre of mass would have to lie outside of its base for that lever."""
    light = BELIEF.model_copy(update={"friction": 0.5, "mass_sd": 0.03, "com_sd": (0.01,) * 3})
    taught = update_without_motion(light, bound(4.0 * onset(light, 0.125), 0.125)).model
    assert abs(taught.com[0]) < 0.045
    assert onset(taught, 0.125) > 1.5 * onset(light, 0.125)


def test_a_high_bound_tells_of_the_weight_not_of_the_friction() -> None:
    slippery = BELIEF.model_copy(update={"friction": 0.6})
    taught = update_without_motion(slippery, bound(1.2 * onset(slippery, HIGH), HIGH)).model
    assert taught.mass > slippery.mass
    assert taught.friction / slippery.friction == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("surprise", [0.0, 1.0, SURPRISING])
def test_what_does_not_surprise_widens_nothing(surprise: float) -> None:
    assert widen_belief(BELIEF, surprise) is BELIEF


def test_widened_by_as_much_as_it_takes() -> None:
    wide = widen_belief(BELIEF, 4.0 * SURPRISING)
    assert wide.deviations == pytest.approx(4.0 * BELIEF.deviations)
    assert wide.means == pytest.approx(BELIEF.means)
    assert wide.correlation == pytest.approx(BELIEF.correlation)


@settings(max_examples=60, deadline=None)
@given(belief=beliefs, height=heights)
def test_a_belief_three_times_too_low_gets_there_soon(belief: ObjectModel, height: float) -> None:
    """With force limits of 1.5 times what is believed, as long as they move nothing."""
    model: ObjectModel = belief
    true = 3.0 * onset(model, height)
    bounds = 0
    while (limit := 1.5 * onset(model, height)) < true:
        model = update_without_motion(model, bound(limit, height)).model
        bounds += 1
        assert bounds <= 4
    assert limit < 6.0 * true  # and does not run away


@pytest.mark.parametrize("z", [-3.0, 0.0, 5.5, 29.9, 30.1, 36.0])
def test_the_hazard_is_that_of_the_normal_distribution(z: float) -> None:
    beyond = 0.5 * erfc(z / sqrt(2.0))
    hazard = exp(-0.5 * z * z) / sqrt(2.0 * pi) / beyond
    # The next term of the series is 10 / z⁵.
    assert normal_hazard(z) == pytest.approx(hazard, rel=2e-8)


@pytest.mark.parametrize("z", [-3.0, 0.0, 5.0, 6.0, 29.9, 30.1, 60.0, 1000.0])
def test_what_is_cut_off_leaves_some_variance(z: float) -> None:
    hazard = normal_hazard(z)
    assert 0.0 < hazard * (hazard - z) < 1.0


@pytest.mark.parametrize(("halvings", "shifted"), [(5, True), (6, False)])
def test_a_step_off_the_base_is_halved_five_times(halvings: int, shifted: bool) -> None:
    """As far as 0.7 of the way from the middle to the edge with so many halvings, or not at all."""
    step = np.zeros(7)
    step[UNCERTAIN.index("com_x")] = 0.7 * 0.045 * 2.0**halvings
    step[UNCERTAIN.index("mass")] = 0.1
    moved = _shift_while_standing(BELIEF, step)
    assert moved.com[0] == pytest.approx(0.7 * 0.045 if shifted else 0.0)
    assert moved.mass == pytest.approx(BELIEF.mass * exp(0.1))

"""Whether a grasp holds a load of any direction."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from objectmodels.errors import ModelError
from objectmodels.mechanics.grasp_stability import (
    Contacts,
    Lifted,
    critical_friction,
    normal_loads,
    slip_multiplier,
    squeeze_needed,
)
from objectmodels.models.upright_solids import BoxModel

HALF = 0.027
CONTACTS = Contacts.from_arrays(
    [[0.0, 0.0], [0.0, HALF], [0.0, 0.0], [0.0, -HALF]], [1.0, 1 / 3, 1 / 3, 1 / 3]
)
WEIGHT = 3.0
DOWN, MIDDLE = np.array([[0.0, -WEIGHT, 0.0]]), np.zeros((1, 3))


def test_a_weight_in_the_middle_is_borne_by_both_sides() -> None:
    needed = squeeze_needed(CONTACTS, 0.6, DOWN, MIDDLE)
    np.testing.assert_allclose(needed, WEIGHT / (2.0 * 0.6), rtol=1e-6)


def test_a_weight_beside_the_contacts_turns_about_one_of_them() -> None:
    # Thumb and middle finger carry the centre of rotation; the outer two resist with their levers.
    off = 0.04
    place = np.array([[0.0, 0.0, off]])
    mu, squeeze = 0.6, 5.0
    needed = critical_friction(CONTACTS, squeeze, DOWN, place)[0]
    # Between turning about the middle, which is one way to slip, and the moment alone.
    about_middle = WEIGHT * off / (2.0 * squeeze / 3.0 * HALF)
    assert needed > about_middle - 1e-9
    assert slip_multiplier(CONTACTS, squeeze, mu, DOWN, place)[0] == pytest.approx(mu / needed)


def test_what_presses_balances_the_load_across() -> None:
    force, place = np.array([[2.0, -1.0, 0.0]]), np.array([[0.0, 0.03, 0.0]])
    loads = normal_loads(CONTACTS, 8.0, force, place)[:, 0]
    on_it = np.array([-1.0, 1.0, 1.0, 1.0]) * loads
    assert on_it.sum() + force[0, 0] == pytest.approx(0.0, abs=1e-9)
    y = CONTACTS.places[:, 1]
    moment = (-y * on_it).sum() - place[0, 1] * force[0, 0]
    assert moment == pytest.approx(0.0, abs=1e-9)


def test_a_contact_that_would_open_holds_nothing() -> None:
    force, place = np.array([[3.0, -0.1, 0.0]]), np.array([[0.0, 0.08, 0.0]])
    assert np.isinf(critical_friction(CONTACTS, 1.0, force, place))[0]
    assert np.isfinite(squeeze_needed(CONTACTS, 0.6, force, place))[0]


def test_a_weight_straight_onto_the_thumb_cannot_slip() -> None:
    force = np.array([[WEIGHT, 0.0, 0.0]])
    assert critical_friction(CONTACTS, 8.0, force, MIDDLE)[0] == 0.0
    assert np.isinf(slip_multiplier(CONTACTS, 8.0, 0.5, force, MIDDLE))[0]


@settings(max_examples=30)
@given(
    st.floats(0.2, 1.0),
    st.floats(-np.pi, np.pi),
    st.floats(-0.02, 0.02),
    st.floats(-0.02, 0.02),
    st.floats(1.05, 3.0),
)
@pytest.mark.slow
def test_more_squeeze_never_holds_less(
    mu: float, tilt: float, y: float, z: float, more: float
) -> None:
    force = WEIGHT * np.array([[np.sin(tilt), -np.cos(tilt), 0.0]])
    place = np.array([[0.0, y, z]])
    needed = squeeze_needed(CONTACTS, mu, force, place)
    if np.isfinite(needed[0]) and needed[0] > 0.01:
        assert slip_multiplier(CONTACTS, more * needed, mu, force, place)[0] >= 1.0
        assert slip_multiplier(CONTACTS, needed / more, mu, force, place)[0] <= 1.0 + 1e-6


def test_contacts_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ModelError) as error:
        Contacts.from_arrays([[0.0, 0.0]], [1.0, 1.0])
    assert error.value.code == "bad_array"


def _lifted(tilts: np.ndarray) -> Lifted:
    model = BoxModel(
        name="carton",
        size=(0.06, 0.08, 0.16),
        mass=0.34,
        mass_sd=0.034,
        friction=0.35,
        finger_friction=0.6,
        finger_friction_sd=0.06,
        com=(0.0, 0.0, 0.08),
        com_sd=(0.002, 0.002, 0.005),
    )
    R_BG = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    down = np.column_stack([np.sin(tilts), np.zeros_like(tilts), -np.cos(tilts)])
    return Lifted(model, CONTACTS, np.array([0.0, 0.0, 0.08]), R_BG, down)


def test_the_worst_case_needs_more_and_holds_surely() -> None:
    hold = _lifted(np.zeros(1)).hold_by(8.0)
    assert hold.needed == pytest.approx(0.34 * 9.81 / 1.2, rel=1e-6)
    assert hold.worst > hold.needed
    assert hold.probability > 0.999
    assert (
        _lifted(np.zeros(1)).hold_probability(hold.worst) > 0.95
    )  # two standard deviations of each


def test_what_just_holds_is_a_toss_up() -> None:
    lifted = _lifted(np.zeros(1))
    # Off the middle it only holds less, so that a little less than a half is left.
    assert 0.3 < lifted.hold_probability(lifted.hold_by(8.0).needed) < 0.52


def test_a_motion_needs_what_its_worst_pose_needs() -> None:
    tilts = np.linspace(0.0, 2.0, 9)
    whole = _lifted(tilts).hold_by(8.0)
    each = [_lifted(np.array([tilt])).hold_by(8.0) for tilt in tilts]
    assert whole.needed == pytest.approx(max(one.needed for one in each), rel=1e-6)
    assert whole.probability <= min(one.probability for one in each) + 1e-9

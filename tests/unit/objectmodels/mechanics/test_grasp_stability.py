"""Whether a grasp holds a load of any direction."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from objectmodels.errors import ModelError
from objectmodels.geometry.side_faces import Face, SidePress
from objectmodels.mechanics.grasp_stability import (
    Contacts,
    GraspLoads,
    Lifted,
    least_squeezes,
)
from objectmodels.models.kinds import BoxModel

HALF = 0.027
CONTACTS = Contacts.from_arrays(
    [[0.0, 0.0], [0.0, HALF], [0.0, 0.0], [0.0, -HALF]], [1.0, 1 / 3, 1 / 3, 1 / 3]
)
WEIGHT = 3.0
DOWN, MIDDLE = np.array([[0.0, -WEIGHT, 0.0]]), np.zeros((1, 3))


def _loads(force: np.ndarray, place: np.ndarray) -> GraspLoads:
    return GraspLoads.on_contacts(CONTACTS, force, place)


def test_a_weight_in_the_middle_is_borne_by_both_sides() -> None:
    needed = _loads(DOWN, MIDDLE).squeeze_needed(0.6)
    np.testing.assert_allclose(needed, WEIGHT / (2.0 * 0.6), rtol=1e-6)


def test_a_weight_beside_the_contacts_turns_about_one_of_them() -> None:
    # Thumb and middle finger carry the centre of rotation; the outer two resist with their levers.
    off = 0.04
    place = np.array([[0.0, 0.0, off]])
    mu, squeeze = 0.6, 5.0
    needed = _loads(DOWN, place).critical_friction(squeeze)[0]
    # Between turning about the middle, which is one way to slip, and the moment alone.
    about_middle = WEIGHT * off / (2.0 * squeeze / 3.0 * HALF)
    assert needed > about_middle - 1e-9
    assert _loads(DOWN, place).slip_multiplier(squeeze, mu)[0] == pytest.approx(mu / needed)


def test_what_presses_balances_the_load_across() -> None:
    force, place = np.array([[2.0, -1.0, 0.0]]), np.array([[0.0, 0.03, 0.0]])
    loads = _loads(force, place).normal_loads(8.0)[:, 0]
    on_it = np.array([-1.0, 1.0, 1.0, 1.0]) * loads
    assert on_it.sum() + force[0, 0] == pytest.approx(0.0, abs=1e-9)
    y = CONTACTS.places[:, 1]
    moment = (-y * on_it).sum() - place[0, 1] * force[0, 0]
    assert moment == pytest.approx(0.0, abs=1e-9)


def test_a_contact_that_would_open_holds_nothing() -> None:
    force, place = np.array([[3.0, -0.1, 0.0]]), np.array([[0.0, 0.08, 0.0]])
    assert np.isinf(_loads(force, place).critical_friction(1.0))[0]
    assert np.isfinite(_loads(force, place).squeeze_needed(0.6))[0]


def test_a_weight_straight_onto_the_thumb_cannot_slip() -> None:
    force = np.array([[WEIGHT, 0.0, 0.0]])
    assert _loads(force, MIDDLE).critical_friction(8.0)[0] == 0.0
    assert np.isinf(_loads(force, MIDDLE).slip_multiplier(8.0, 0.5))[0]


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
    needed = _loads(force, place).squeeze_needed(mu)
    if np.isfinite(needed[0]) and needed[0] > 0.01:
        assert _loads(force, place).slip_multiplier(more * needed, mu)[0] >= 1.0
        assert _loads(force, place).slip_multiplier(needed / more, mu)[0] <= 1.0 + 1e-6


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
    lifted = _lifted(np.zeros(1))
    (needed,), (worst,) = least_squeezes((lifted,))
    assert needed == pytest.approx(0.34 * 9.81 / 1.2, rel=1e-6)
    assert worst > needed
    assert lifted.hold_probability(8.0) > 0.999
    assert lifted.hold_probability(worst) > 0.95  # two standard deviations of each


def test_what_just_holds_is_a_toss_up() -> None:
    lifted = _lifted(np.zeros(1))
    # Off the middle it only holds less, so that a little less than a half is left.
    assert 0.3 < lifted.hold_probability(least_squeezes((lifted,))[0][0]) < 0.52


def test_a_motion_needs_what_its_worst_pose_needs() -> None:
    tilts = np.linspace(0.0, 2.0, 9)
    whole, each = _lifted(tilts), [_lifted(np.array([tilt])) for tilt in tilts]
    (needed,), _ = least_squeezes((whole,))
    assert needed == pytest.approx(max(least_squeezes(tuple(each))[0]), rel=1e-6)
    assert whole.hold_probability(8.0) <= min(one.hold_probability(8.0) for one in each) + 1e-9


def test_grasps_searched_together_are_those_searched_alone() -> None:
    two = Contacts.from_arrays([[0.0, 0.0], [0.0, HALF], [0.0, -HALF]], [1.0, 0.5, 0.5])
    grasps = [_lifted(np.linspace(0.0, tilt, 4)) for tilt in (0.1, 0.7, 1.5)]
    grasps.insert(1, replace(grasps[0], contacts=two))  # with one contact less than the others
    alone = [least_squeezes((grasp,)) for grasp in grasps]
    for together, each in zip(least_squeezes(tuple(grasps)), zip(*alone, strict=True), strict=True):
        np.testing.assert_array_equal(together, np.concatenate(each))


def test_a_side_that_turns_away_takes_friction_for_itself() -> None:
    face = Face.upright((0.0, 1.0), (0.0, 0.0), 0.06, 0.1, 1.0 / 0.04)
    closing, pitch, squeeze = np.array([0.0, -1.0, 0.0]), np.radians(45.0), 5.0
    approach = np.array([np.cos(pitch), 0.0, -np.sin(pitch)])
    press = SidePress.on_face(face, closing, approach, CONTACTS.places, 0.01)
    flat = _loads(DOWN, MIDDLE).critical_friction(squeeze)[0]
    loads = GraspLoads.on_contacts(replace(CONTACTS, press=press), DOWN, MIDDLE)
    # Each outer fingertip: the closing direction, inward, and what a flat side bears of the weight.
    aside = np.cross(approach, closing)
    needed = []
    for side in (1.0, -1.0):
        lateral = side * HALF * float(aside @ face.tangent)
        turned = np.arcsin(lateral / 0.05)
        normal = -(np.cos(turned) * np.array(face.normal) + np.sin(turned) * np.array(face.tangent))
        force = closing - side * press.inward * aside + flat * np.array([0.0, 0.0, 1.0])
        along = float(force @ normal)
        needed.append(np.linalg.norm(force - along * normal) / along)
    assert loads.critical_friction(squeeze)[0] == pytest.approx(max(needed))
    # Without any weight it takes less friction than pressing straight ahead would.
    straight = np.tan(np.arcsin(HALF * np.sin(pitch) / 0.05))
    assert np.hypot(press.around, press.axial) / press.normal < 0.7 * straight

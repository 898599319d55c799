"""Estimates in closed form, and the table over repetitions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from objectmodels import CylinderModel, ModelError, PrismModel
from objectmodels.geometry.pushed_body import UNCERTAIN
from objectmodels.identification import (
    Estimates,
    Trial,
    estimates_by_repetition,
    estimates_from_trials,
    repetition_table,
)
from tests.unit.objectmodels.identification.touching import (
    BELIEF,
    TRUTH,
    everything,
    slide,
    slip,
    tilt,
    touched,
)


def test_noise_free_trials_give_back_the_truth() -> None:
    found = estimates_from_trials(BELIEF, touched(TRUTH, everything()))
    assert [getattr(found, name) for name in UNCERTAIN] == pytest.approx(TRUTH.means.tolist())
    assert found.notes == ()


def test_the_force_ratio_gives_the_radius_without_turn_rates() -> None:
    plan = [*(tilt(side) for side in ("front", "back")), slide(turn=False), slide(0.03, turn=False)]
    truth = TRUTH.model_copy(update={"com": (0.003, 0.0, 0.08)})  # as believed along y
    found = estimates_from_trials(BELIEF, touched(truth, plan))
    assert found.friction_radius == pytest.approx(TRUTH.friction_radius)
    assert found.friction == pytest.approx(TRUTH.friction)


def test_one_side_gives_mass_times_distance_and_says_so() -> None:
    found = estimates_from_trials(BELIEF, touched(TRUTH, [tilt()]))
    assert found.mass == pytest.approx(TRUTH.mass * (0.045 - TRUTH.com[0]) / 0.045)
    assert (found.com_x, found.com_z, found.friction) == (None, None, None)
    assert any("one side" in note for note in found.notes)


def test_two_angles_give_the_height() -> None:
    at_places = BELIEF.model_copy(update={"com": (0.003, -0.002, 0.115)})
    found = estimates_from_trials(at_places, touched(TRUTH, [tilt(), tilt(angle=0.15)]))
    assert found.com_z == pytest.approx(TRUTH.com[2])
    assert found.mass == pytest.approx(TRUTH.mass)


def test_one_angle_takes_the_believed_height_and_says_so() -> None:
    at_height = BELIEF.model_copy(update={"com": (0.0, 0.0, 0.08)})
    plan = [tilt(side, 0.1) for side in ("front", "back")]
    found = estimates_from_trials(at_height, touched(TRUTH, plan))
    assert (found.mass, found.com_x) == pytest.approx((TRUTH.mass, TRUTH.com[0]))
    assert found.com_z is None
    assert any("height" in note for note in found.notes)


def test_slides_alone_give_the_friction_of_the_believed_mass() -> None:
    plan = [slide()]
    truth = TRUTH.model_copy(update={"com": (0.0, 0.0, 0.08)})
    found = estimates_from_trials(BELIEF, touched(truth, plan))
    assert found.friction == pytest.approx(TRUTH.friction * TRUTH.mass / BELIEF.mass)
    assert found.mass is None
    assert any("believed mass" in note for note in found.notes)


def test_a_straight_slide_counts_by_how_it_turned() -> None:
    """Where the centre of mass lies across the push nobody has found; the turn shows it."""
    truth = TRUTH.model_copy(update={"com": (0.0, 0.03, 0.08)})
    believed = BELIEF.model_copy(update={"friction_radius": TRUTH.friction_radius})
    plan = [*(tilt(side) for side in ("front", "back")), slide()]
    found = estimates_from_trials(believed, touched(truth, plan))
    assert found.friction == pytest.approx(TRUTH.friction)


def test_a_push_aslant_counts_by_the_load_it_leaves() -> None:
    """The paper's friction: F_xy / (G − F_z)."""
    trial = replace(slide(turn=False), force=(3.0, 0.0, -1.0))
    middle = BELIEF.model_copy(update={"com": (0.0, 0.0, 0.115)})
    found = estimates_from_trials(middle, [trial])
    assert found.friction == pytest.approx(3.0 / (middle.weight + 1.0))


def test_round_bases_are_estimated_too() -> None:
    can = CylinderModel(name="c", radius=0.045, height=0.23, mass=0.7, friction=0.3)
    found = estimates_from_trials(can.model_copy(update={"mass": 1.0}), touched(can, everything(1)))
    assert (found.mass, found.friction) == pytest.approx((0.7, 0.3))


def test_tilts_one_way_do_not_tell_the_place_across() -> None:
    """On a rim the ways of opposite tilts are not quite opposite, which tells noise only."""
    can = CylinderModel(name="c", radius=0.045, height=0.23, mass=0.7, friction=0.3)
    ways = [
        ("front", 1.0, 0.02),
        ("front", 1.0, -0.01),
        ("back", -1.0, 0.03),
        ("back", -1.0, -0.02),
    ]
    aslant = [replace(tilt(side), force=(x, y, 0.0)) for side, x, y in ways]
    found = estimates_from_trials(can, touched(can, aslant))
    assert found.com_x == pytest.approx(0.0, abs=1e-9)
    assert found.com_y is None


def test_a_negative_weight_is_refused() -> None:
    beyond = replace(tilt(), tilt=1.0)  # where it would fall, yet it had to be pushed
    with pytest.raises(ModelError) as caught:
        estimates_from_trials(BELIEF, [beyond])
    assert caught.value.code == "not_possible"


def test_a_pull_that_would_lift_is_refused_by_name() -> None:
    with pytest.raises(ModelError, match="row 9") as caught:
        estimates_from_trials(BELIEF, [replace(slide(), force=(1.0, 0.0, 100.0), source="row 9")])
    assert caught.value.code == "not_possible"


def test_the_table_counts_repetitions() -> None:
    trials = [
        replace(trial, repetition=number)
        for number in range(10)
        for trial in touched(TRUTH, everything(1), seed=number)
    ]
    lines = repetition_table(estimates_by_repetition(BELIEF, trials))
    assert set(lines) == set(UNCERTAIN)
    mass = lines["mass"]
    assert mass.n == 10
    assert mass.least < mass.mean < mass.most
    assert mass.sd is not None
    # Eight tilts of 1 % each, a third of it from the tilts' angles.
    assert mass.percent is not None
    assert mass.percent == pytest.approx(100.0 * mass.sd / mass.mean)
    assert mass.percent < 1.5
    assert mass.mean == pytest.approx(TRUTH.mass, rel=0.01)


def test_the_table_leaves_out_what_was_not_found() -> None:
    lines = repetition_table([Estimates(mass=1.0), Estimates(mass=3.0, friction=0.3)])
    assert set(lines) == {"mass", "friction"}
    mass, friction = lines["mass"], lines["friction"]
    assert (mass.mean, mass.least, mass.most, mass.n) == (2.0, 1.0, 3.0, 2)
    assert mass.sd == pytest.approx(np.sqrt(2.0))
    assert (friction.sd, friction.percent, friction.n) == (None, None, 1)


def test_slips_give_the_fingers_friction() -> None:
    assert estimates_from_trials(BELIEF, touched(TRUTH, [slip()])).finger_friction == pytest.approx(
        0.7
    )


def level_slide(arm: float, height: float = 0.02, turn: bool = True) -> Trial:
    """A slide whose arm about the centre of mass is a share of the friction radius."""
    off = arm * TRUTH.friction_radius + TRUTH.com[1]
    return replace(slide(off, turn), point=(-0.045, off, height))


@pytest.mark.parametrize(("arm", "found"), [(0.15, False), (0.25, True)])
def test_a_turn_shows_the_radius_from_an_arm_of_a_fifth_on(arm: float, found: bool) -> None:
    (trial,) = touched(TRUTH, [level_slide(arm)])
    radius = estimates_from_trials(TRUTH, [trial]).friction_radius
    assert radius == (pytest.approx(TRUTH.friction_radius, rel=1e-6) if found else None)


@pytest.mark.parametrize(("arm", "found"), [(0.08, True), (0.12, False)])
def test_a_slide_is_straight_up_to_an_arm_of_a_tenth(arm: float, found: bool) -> None:
    # Without turns a straight and an off-centre slide give the radius together.
    trials = touched(TRUTH, [level_slide(arm, turn=False), level_slide(0.6, turn=False)])
    assert (estimates_from_trials(TRUTH, trials).friction_radius is not None) == found


@pytest.mark.parametrize(("height", "found"), [(0.030, True), (0.040, False)])
def test_slides_count_up_to_half_as_much_again_as_the_lowest(height: float, found: bool) -> None:
    trials = touched(TRUTH, [level_slide(0.0, turn=False), level_slide(0.5, height)])
    assert (estimates_from_trials(TRUTH, trials).friction_radius is not None) == found


@pytest.mark.parametrize(("apart", "found"), [(0.0055, False), (0.0085, True)])
def test_two_tilts_tell_the_height_once_their_angles_differ(apart: float, found: bool) -> None:
    plan = [tilt(side, angle) for side in ("front", "back") for angle in (0.12, 0.12 + apart)]
    estimates = estimates_from_trials(TRUTH, touched(TRUTH, plan))
    assert (estimates.com_z is not None) == found


def test_tilts_nearly_along_y_tell_the_place_along_y() -> None:
    corners = np.array([[0.04, 0.04], [-0.04, 0.04], [-0.04, -0.04], [0.04, -0.04]])
    c, s = np.cos(np.radians(10.0)), np.sin(np.radians(10.0))
    turned = corners @ np.array([[c, s], [-s, c]])
    block = PrismModel(
        name="b", corners=tuple(map(tuple, turned.tolist())), height=0.2, mass=1.0, friction=0.4
    )
    ways = [(-s, c), (s, -c)]
    plan = [
        Trial("topple", (-0.04 * x, -0.04 * y, 0.19), (x, y, 0.0), 0.02, source="tilt")
        for x, y in ways
    ]
    estimates = estimates_from_trials(block, touched(block, plan))
    assert estimates.com_y is not None
    assert estimates.com_x is None

"""The onset of motion in made-up recordings: what moved when, and at which force."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from objectmodels import BoxModel, ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.identification import Trial, detect_onset
from objectmodels.identification.onset_detection import (
    Recording,
    tilted_trial,
    trial_from_series,
)
from tests.unit.objectmodels.identification.recordings import made_up

BOX = BoxModel(name="b", size=(0.09, 0.09, 0.2), mass=1.0, friction=0.3)


@given(
    onset=st.floats(0.3, 20.0),
    seconds=st.floats(0.5, 3.0),
    seed=st.integers(0, 100),
    fall=st.sampled_from([0.0, 0.3]),
)
def test_the_force_at_the_onset(onset: float, seconds: float, seed: int, fall: float) -> None:
    noise = 0.05 * onset
    found = detect_onset(*made_up(onset, seconds, noise, fall, seed=seed))
    assert found.moved
    assert found.time == pytest.approx(seconds, abs=0.08)  # eight samples, a kink's blur by noise
    # Some 200 samples of 5 % noise, and a slope read off them: 1 %, four of these.
    assert found.force == pytest.approx(onset, rel=0.04)


def test_the_stated_deviation_is_that_of_many_recordings() -> None:
    found = [detect_onset(*made_up(3.0, 1.0, 0.1, 0.2, seed=k)) for k in range(200)]
    spread = np.std([f.force for f in found])
    # The place of the kink scatters too, which the line through the forces does not know.
    assert np.mean([f.force_sd for f in found]) == pytest.approx(spread, rel=0.5)


def test_static_friction_above_the_kinetic_one_is_read_before_the_drop() -> None:
    found = detect_onset(*made_up(3.0, 1.0, 0.02, 0.0, sticks=1.15))
    assert found.force == pytest.approx(3.45, rel=0.02)


def test_what_does_not_move_has_no_onset() -> None:
    time = np.arange(0.0, 2.0, 0.01)
    found = detect_onset(time, 4.0 * time, 1e-5 * time)
    assert not found.moved
    assert found.force == pytest.approx(8.0, rel=0.02)  # the largest, averaged over a few samples


@pytest.mark.parametrize(
    ("time", "force", "travel"),
    [
        (np.arange(5.0), np.ones(5), np.ones(5)),
        (np.arange(50.0), np.ones(49), np.ones(50)),
        (np.zeros(50), np.ones(50), np.ones(50)),
        (np.arange(50.0), np.full(50, np.nan), np.ones(50)),
    ],
    ids=["too few", "lengths", "times", "nan"],
)
def test_broken_recordings_are_refused(
    time: np.ndarray, force: np.ndarray, travel: np.ndarray
) -> None:
    with pytest.raises(ModelError) as raised:
        detect_onset(time, force, travel)
    assert raised.value.code == "bad_array"


def bent(before: float, after: float) -> tuple[Array, Array, Array]:
    """A touch without noise whose finger travels at two speeds [m/s], a second and then three."""
    time = np.arange(0.0, 4.0, 0.01)
    later = np.maximum(time - 1.0, 0.0)
    return time, 3.0 * np.minimum(time, 1.0), before * np.minimum(time, 1.0) + after * later


@pytest.mark.parametrize(("way", "moved"), [(0.0008, False), (0.0013, True)])
def test_a_millimetre_shows_that_it_moved(way: float, moved: bool) -> None:
    assert detect_onset(*bent(0.0, way / 3.0)).moved == moved


@pytest.mark.parametrize(("faster", "moved"), [(2.0, False), (4.5, True)])
def test_what_moves_goes_three_times_as_fast_as_before(faster: float, moved: bool) -> None:
    time, force, travel = bent(0.002, 0.002 * faster)
    assert detect_onset(time, force + np.maximum(time - 1.0, 0.0), travel).moved == moved


@pytest.mark.parametrize("rise", [0.03, 0.2, 1.0])
def test_the_onset_of_a_stiff_finger_is_where_the_force_stops_rising(rise: float) -> None:
    """It travels evenly all the time, 16 mm at 2.5 mm/s, and touches after 2 s."""
    rng = np.random.default_rng(2)
    time = np.arange(0.0, 6.5, 0.01)
    force = 4.4 * np.clip((time - 2.0) / rise, 0.0, 1.0) + 0.05 * rng.standard_normal(len(time))
    onset = detect_onset(time, force, 0.0025 * time)
    assert onset.moved
    # Samples are 10 ms apart; the scatter of 1 % of the force shifts the end of a slow rise.
    assert onset.time == pytest.approx(2.0 + rise, abs=0.02 + 0.05 * rise)
    assert onset.force == pytest.approx(4.4, abs=0.03)


def test_a_stiff_finger_that_stops_before_the_force_stays_moved_nothing() -> None:
    time = np.arange(0.0, 6.5, 0.01)
    way = 0.0025 * np.minimum(time, 4.0)
    assert not detect_onset(time, 4.4 * np.clip((time - 2.0) / 2.0, 0.0, 1.0), way).moved


def test_poses_before_and_after_tell_the_motion() -> None:
    """A quarter turn about the corner (−45, 30) mm, pushed along x at (−45, −20) mm."""
    made = stiff_recording()
    corner, turn = np.array([-0.045, 0.03]), np.radians(20.0)
    R = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    x, y = corner - R @ corner
    trial = trial_of(replace(made, end=(float(x), float(y), float(turn))))
    # The contact went along a chord of an arc of 50 mm, square to its arm half-way: with the force.
    chord = 2.0 * 0.05 * np.sin(turn / 2.0)
    assert trial.turn_rate == pytest.approx(turn / chord, rel=1e-3)
    # The onset is found to a sample, 0.1 mm of the finger's way along an arm of 50 mm.
    assert trial.drift == pytest.approx(0.0, abs=3e-3)
    # In the axes of B the force stays as it was, though in those of the start it turns with B.
    np.testing.assert_allclose(trial.force, (3.0, 0.0, 0.0), atol=0.02)


def stiff_recording() -> Recording:
    """A finger at 10 mm/s that loads the object in half a second, and turns with it by 20°."""
    time = np.arange(0.0, 3.0, 0.01)
    way = 0.01 * time
    turn = np.radians(20.0) * np.clip((way - 0.005) / (way[-1] - 0.005), 0.0, 1.0)
    size = 3.0 * np.minimum(time / 0.5, 1.0)
    force = np.column_stack((size * np.cos(turn), size * np.sin(turn), 0.0 * time))
    tip = np.column_stack((way - 0.05, 0.0 * time - 0.02, 0.0 * time + 0.04))
    return Recording(time=time, force=force, tip=tip, moved="slide")


def recording(**changes: Any) -> Recording:
    """A slide without noise: 1 s of rise to 3 N, then 30 mm at 10 mm/s."""
    time = np.arange(0.0, 4.0, 0.01)
    after = np.maximum(time - 1.0, 0.0)
    x, zero = 0.01 * after, np.zeros_like(time)
    force = np.column_stack((3.0 * np.minimum(time, 1.0), zero, zero))
    tip = np.column_stack((x - 0.045, zero, zero + 0.04))
    return Recording(**({"time": time, "force": force, "tip": tip} | changes))


def trial_of(made: Recording) -> Trial:
    trial, _ = trial_from_series(made)
    assert trial is not None
    return trial


def test_no_force_is_surer_than_one_in_a_hundred() -> None:
    trial = trial_of(recording())
    assert trial.force_sd == pytest.approx(0.01 * 3.0, rel=0.02)


@pytest.mark.parametrize(("degrees", "moved"), [(1.7, "slide"), (2.3, "topple")])
def test_a_tilt_of_two_degrees_is_a_topple(degrees: float, moved: str) -> None:
    made = recording()
    tilt = np.radians(degrees) * made.time / made.time[-1]
    assert trial_of(replace(made, tilt=tilt)).moved == moved


def test_the_turn_is_that_of_the_first_centimetre() -> None:
    """The slope of x² over a way W is W; a small share of the angle's error is its deviation."""
    made = recording()
    travel = made.tip[:, 0] - made.tip[0, 0]
    trial = trial_of(replace(made, yaw=10.0 * travel**2))
    assert trial.turn_rate == pytest.approx(10.0 * 0.010, rel=0.03)
    assert trial.turn_rate_sd == pytest.approx(0.2 * np.radians(0.5) / 0.010, rel=0.1)


def test_the_force_is_read_off_the_first_centimetre_of_travel() -> None:
    """The line that fits x² over a way W best is −W²/6 where it begins."""
    made = recording()
    travel = made.tip[:, 0] - made.tip[0, 0]
    force = made.force[:, 0] + 6e3 * travel**2
    found = detect_onset(made.time, force, travel)
    assert found.force == pytest.approx(3.0 - 6e3 * 0.010**2 / 6.0, abs=0.02)


def test_sticking_is_read_off_the_last_two_fifths_of_the_rise() -> None:
    """The line that fits t² over a time w best is w²/6 below it where it ends."""
    made = recording()
    travel = made.tip[:, 0] - made.tip[0, 0]
    force = np.where(made.time < 1.02, 3.0 * made.time**2, 2.0)
    found = detect_onset(made.time, force, travel)
    touched = np.sqrt(0.05)  # [s]: it touches from a twentieth of the largest force on
    fitted = 0.4 * (found.time - touched)
    assert found.force == pytest.approx(3.0 * (found.time**2 - fitted**2 / 6.0), abs=0.012)


@pytest.mark.parametrize(("drop", "force"), [(0.02, 3.0), (0.045, 3.0 * 1.045)])
def test_a_drop_of_three_in_a_hundred_is_static_friction(drop: float, force: float) -> None:
    time = np.arange(0.0, 5.0, 0.01)
    held = 3.0 * (1.0 + drop) * np.minimum(time, 1.0)
    travel = 0.01 * np.maximum(time - 2.0, 0.0)
    found = detect_onset(time, np.where(time < 2.0, held, 3.0), travel)
    assert found.force == pytest.approx(force, rel=2e-3)


def test_a_held_tilt_is_the_mean_of_the_last_tenth() -> None:
    made = recording(moved="topple")
    tilt = 0.2 * made.time / made.time[-1]
    held = tilted_trial(replace(made, tilt=tilt), trial_of(made), BOX)
    assert held is not None
    assert held.tilt == pytest.approx(0.2 * 0.95, abs=1e-3)
    assert held.tilt_sd == pytest.approx(np.radians(0.5))

"""The onset of motion in made-up recordings: what moved when, and at which force."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from objectmodels import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.identification import detect_onset
from tests.unit.objectmodels.identification.recordings import made_up


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
    assert detect_onset(*bent(0.002, 0.002 * faster)).moved == moved

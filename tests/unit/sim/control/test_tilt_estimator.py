"""The tilt as fingertip and camera tell it together."""

from __future__ import annotations

import numpy as np
import pytest

from sim.control.object_estimate import TiltEstimator

NOISE = np.radians(1.0)
PERIOD, FRAME, DELAY = 0.01, 1.0 / 30.0, 0.05


def _watched(rate: float, offset: float, *, seconds: float, seed: int = 0) -> TiltEstimator:
    """A tilt that grows at a rate, while the fingertip tells it with an offset [rad]."""
    rng, view, taken = np.random.default_rng(seed), TiltEstimator(NOISE), 0
    for time in np.arange(0.0, seconds, PERIOD):
        view.update_from_tip(time, rate * time + offset)
        if taken * FRAME + DELAY <= time:
            seen = rate * taken * FRAME + rng.normal(0.0, NOISE)
            view.update_from_camera(taken * FRAME, seen)
            taken += 1
    return view


def test_late_frames_do_not_make_it_lag() -> None:
    rate = np.radians(6.0)
    errors = [
        _watched(rate, 0.0, seconds=2.0, seed=seed).tilt - rate * (2.0 - PERIOD)
        for seed in range(200)
    ]
    # A lag of the camera's 50 ms would be 0.3°; a mean over 200 has a deviation of 0.02°.
    assert np.degrees(np.mean(errors)) == pytest.approx(0.0, abs=0.06)


@pytest.mark.parametrize("offset", [-3.0, 2.0])
def test_the_camera_takes_out_what_the_fingertip_does_not_know(offset: float) -> None:
    views = [_watched(0.05, np.radians(offset), seconds=3.0, seed=seed) for seed in range(200)]
    errors = [view.tilt - 0.05 * (3.0 - PERIOD) for view in views]
    # Of the offset at the start less than a hundredth is left after 85 frames.
    assert np.degrees(np.mean(errors)) == pytest.approx(0.0, abs=0.08)
    assert np.std(errors) == pytest.approx(views[0].unsure, rel=0.25)


def test_without_frames_the_fingertip_is_believed() -> None:
    view = TiltEstimator(NOISE)
    view.update_from_tip(0.0, 0.01)
    assert view.tilt == pytest.approx(0.01)
    # The frames that it is trusted like: a single one moves it by a fifth at most.
    view.update_from_camera(0.0, 0.02)
    assert view.tilt == pytest.approx(0.012)


def test_a_base_that_slides_late_is_noticed_within_a_third_of_a_second() -> None:
    view = TiltEstimator(NOISE)
    slid = np.radians(2.0)
    for frame in range(110):
        view.update_from_tip(frame * FRAME, 0.1)
        view.update_from_camera(frame * FRAME, 0.1 - (slid if frame >= 100 else 0.0))
    # Two thirds of it after ten frames: sooner would be noise, later too late.
    assert -view.correction / slid == pytest.approx(0.65, abs=0.1)


def test_frames_may_be_late() -> None:
    view, rate, late = TiltEstimator(NOISE), 0.05, 80
    for step in range(300):
        view.update_from_tip(step * PERIOD, rate * step * PERIOD)
        if step >= late and step % 3 == 0:
            then = (step - late) * PERIOD
            view.update_from_camera(then, rate * then)
    assert view.correction == pytest.approx(0.0, abs=1e-12)

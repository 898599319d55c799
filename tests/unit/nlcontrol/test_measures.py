"""Quantities measured on traces whose truth is known in closed form."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from nlcontrol import measures
from sim.trace import Trace

TraceMaker = Callable[..., Trace]


def test_windowed_mean_keeps_lines_and_flattens_noise() -> None:
    time = np.linspace(0.0, 2.0, 201)
    line = 3.0 + 2.0 * time
    inner = (time > 0.1) & (time < 1.9)
    # A symmetric window leaves a line as it is; the trapezoidal rule is exact on it.
    np.testing.assert_allclose(
        measures.windowed_mean(time, line, 0.2)[inner], line[inner], atol=1e-12
    )
    noise = np.random.default_rng(0).standard_normal(time.size)
    # 21 samples in the window, so the deviation falls by about their root, 4.6.
    assert measures.windowed_mean(time, noise, 0.2)[inner].std() < 0.35


def test_windowed_mean_takes_uneven_samples() -> None:
    time = np.cumsum(np.random.default_rng(1).uniform(0.001, 0.02, 300))
    mean = measures.windowed_mean(time, np.full(300, 7.0), 0.1)
    np.testing.assert_allclose(mean, 7.0, atol=1e-9)  # rounding of a running sum of 300 terms


def test_speed_and_force_of_the_push(make_trace: TraceMaker) -> None:
    trace = make_trace(speed=0.03, force=4.0)
    # The trace samples its 100 ms of speed at 10 ms; the tip's first step is up to 1 % off.
    assert measures.largest_push_speed(trace) == pytest.approx(0.03, rel=0.02)
    assert measures.largest_push_force(trace) == pytest.approx(4.0, rel=1e-9)


def test_the_fastest_moment_counts(make_trace: TraceMaker) -> None:
    trace = make_trace(speed=0.02)
    pushing = np.flatnonzero(trace.phase == "push")
    for tip in trace.tips.values():
        tip[pushing[:100], 0] += np.linspace(0.0, 0.05, 100)  # 50 mm/s more during one second
        tip[pushing[100:], 0] += 0.05
    # 99 steps of 10 ms carry the added 50 mm.
    assert measures.largest_push_speed(trace) == pytest.approx(0.02 + 0.05 / 0.99, rel=0.02)


def test_forces_outside_of_contact_do_not_count(make_trace: TraceMaker) -> None:
    trace = make_trace(force=4.0)
    away = (trace.phase == "look") | (trace.phase == "settle")
    for force in trace.felt.values():
        force[away] = 50.0
    assert measures.largest_push_force(trace) == pytest.approx(4.0, rel=1e-9)


def test_nothing_pushed_measures_zero(make_trace: TraceMaker) -> None:
    trace = make_trace()
    trace.phase[:] = "look"
    assert measures.largest_push_force(trace) == 0.0
    assert measures.largest_push_speed(trace) == 0.0
    assert measures.first_contact(trace, "ice tea box") is None


def test_first_contact_is_seen_from_the_object(make_trace: TraceMaker) -> None:
    contact = measures.first_contact(make_trace(height=0.04), "ice tea box")
    assert contact is not None
    # Half the box and the fingertip's radius, in front of it.
    np.testing.assert_allclose(contact[0], [-0.055, 0.0, 0.04], atol=1e-12)
    np.testing.assert_allclose(contact[1], np.eye(3), atol=1e-12)


def test_first_contact_of_a_turned_object(make_trace: TraceMaker) -> None:
    trace = make_trace()
    trace.poses["ice tea box"][:, :4] = [math.cos(math.pi / 4), 0, 0, math.sin(math.pi / 4)]
    contact = measures.first_contact(trace, "ice tea box")
    assert contact is not None
    # Turned a quarter to the left, it is touched on the face that B's +y points at.
    np.testing.assert_allclose(contact[0], [0.0, 0.055, 0.03], atol=1e-12)


@pytest.mark.parametrize("heading", [0.0, 1.0, math.pi / 2, -2.0, math.pi])
def test_heading_of_a_fall(make_trace: TraceMaker, heading: float) -> None:
    trace = make_trace(tilt=math.radians(88), tilt_heading=heading, turned=0.3)
    fell = measures.fall_heading(trace, "ice tea box")
    assert math.cos(fell - heading) == pytest.approx(1.0, abs=1e-12)


def test_rotation_of_a_quarter_turn() -> None:
    pose = np.array([math.cos(math.pi / 4), 0, 0, math.sin(math.pi / 4), 0, 0, 0])
    np.testing.assert_allclose(
        measures.rotation(pose), [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15
    )

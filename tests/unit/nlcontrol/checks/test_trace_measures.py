"""Quantities measured on traces whose truth is known in closed form."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from nlcontrol.checks import trace_measures as measures
from objectmodels import BoxModel
from sim.traces.trace import Trace, join_traces
from tests.unit.nlcontrol.pushes import seen

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


def test_nothing_pushed_measures_nothing(make_trace: TraceMaker) -> None:
    trace = make_trace()
    trace.phase[:] = "look"
    assert measures.largest_push_force(trace) is None
    assert measures.largest_push_speed(trace) is None
    assert measures.contacts(trace, "ice tea box") == []
    assert measures.push_duration(trace) is None
    assert measures.largest_force_limit(trace) is None


@pytest.mark.parametrize("names", [("thumb", "fore"), ("right", "left")])
def test_a_squeeze_is_felt_by_fingers_of_any_name(
    make_trace: TraceMaker, names: tuple[str, ...]
) -> None:
    trace = make_trace()
    trace.phase[:] = "lift"
    force = np.tile([12.0, 0.0, 0.0], (len(trace.time), 1))
    assert measures.largest_squeeze(
        replace(trace, felt=dict.fromkeys(names, force))
    ) == pytest.approx(12.0)
    assert measures.largest_squeeze(replace(trace, felt={})) is None


def test_first_contact_is_seen_from_the_object(make_trace: TraceMaker) -> None:
    (contact,) = measures.contacts(make_trace(height=0.04), "ice tea box")
    # Half the box and the fingertip's radius, in front of it.
    np.testing.assert_allclose(contact[0], [-0.055, 0.0, 0.04], atol=1e-12)
    np.testing.assert_allclose(contact[1], np.eye(3), atol=1e-12)


def test_first_contact_of_a_turned_object(make_trace: TraceMaker) -> None:
    trace = make_trace()
    trace.poses["ice tea box"][:, :4] = [math.cos(math.pi / 4), 0, 0, math.sin(math.pi / 4)]
    (contact,) = measures.contacts(trace, "ice tea box")
    # Turned a quarter to the left, it is touched on the face that B's +y points at.
    np.testing.assert_allclose(contact[0], [0.0, 0.055, 0.03], atol=1e-12)


def test_each_push_is_measured_by_itself(make_trace: TraceMaker) -> None:
    """Between two pushes on two sides the hand is somewhere else; that is no speed of a push."""
    first = seen(make_trace(travel=(0.1, 0.0), speed=0.02, force=3.0))
    second = seen(make_trace(travel=(0.0, -0.1), side=(0.0, 1.0), speed=0.03, force=4.0))
    both = join_traces([first, replace(second, time=second.time + first.time[-1] + 0.01)])
    assert len(measures.contacts(both, "ice tea box")) == 2
    # Windows at the ends of a push are shorter, so that a sample more or less counts for 2 %.
    assert measures.largest_push_speed(both) == pytest.approx(0.03, rel=0.02)
    assert measures.largest_push_force(both) == pytest.approx(4.0, rel=1e-9)
    stronger = seen(make_trace(travel=(0.1, 0.0), force=5.0))
    both = join_traces([stronger, replace(second, time=second.time + stronger.time[-1] + 0.01)])
    # The trace's direction is that of its last push; the first one went another way.
    assert measures.largest_push_force(both) == pytest.approx(5.0, rel=1e-9)


def test_duration_and_readiness_of_a_push(make_trace: TraceMaker) -> None:
    trace = make_trace(travel=(0.1, 0.0), speed=0.05)
    # 200 samples at 100 Hz.
    assert measures.push_duration(trace) == pytest.approx(1.99)
    assert measures.largest_force_limit(trace) == 6.0


def test_a_turn_counts_on_beyond_half_a_turn(make_trace: TraceMaker) -> None:
    turned = measures.turn(make_trace(turned=math.radians(-330)), "ice tea box")
    assert math.degrees(turned[-1]) == pytest.approx(-330)


@pytest.mark.parametrize("heading", [0.3, 1.0, 2.5])
def test_what_falls_over_does_not_turn(make_trace: TraceMaker, heading: float) -> None:
    fallen = make_trace(tilt=math.radians(90), tilt_heading=heading)
    assert np.abs(measures.turn(fallen, "ice tea box")).max() == pytest.approx(0.0, abs=1e-9)
    # The heading of B_x, which a fall to the side takes along, is another matter.
    assert abs(fallen.yaw("ice tea box")[-1]) > 0.1


def test_slip_and_rise_of_a_box_that_tips_over_its_edge(
    make_trace: TraceMaker, box: BoxModel
) -> None:
    trace = make_trace(travel=(0.0, 0.0))
    poses = trace.poses["ice tea box"]
    tilt = np.linspace(0.0, math.pi / 2, len(poses))
    # Over its front edge, 45 mm from the middle, which stays where it is.
    poses[:, 0], poses[:, 2] = np.cos(tilt / 2), np.sin(tilt / 2)
    poses[:, 4] = 0.5 + 0.045 * (1.0 - np.cos(tilt))
    poses[:, 6] = 0.045 * np.sin(tilt)
    corners = box.footprint.corners
    # While the other edge is less than 1 mm up it counts as well; then it has moved by micrometres.
    assert measures.slip(trace, "ice tea box", corners) == pytest.approx(0.0, abs=1e-5)
    assert measures.rise(trace, "ice tea box", corners) == pytest.approx(0.0, abs=1e-9)
    poses[:, 4] += np.linspace(0.0, 0.02, len(poses))
    assert measures.slip(trace, "ice tea box", corners) == pytest.approx(0.02, abs=1e-5)
    poses[:, 6] += np.linspace(0.0, 0.03, len(poses))
    assert measures.rise(trace, "ice tea box", corners) == pytest.approx(0.03)


def test_a_turn_on_the_spot_is_no_slip(make_trace: TraceMaker, box: BoxModel) -> None:
    trace = make_trace(travel=(0.0, 0.0), turned=1.0)
    slip = measures.slip(trace, "ice tea box", box.footprint.corners)
    assert slip == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("heading", [0.0, 1.0, math.pi / 2, -2.0, math.pi])
def test_heading_of_a_fall(make_trace: TraceMaker, heading: float) -> None:
    trace = make_trace(tilt=math.radians(88), tilt_heading=heading, turned=0.3)
    fell = measures.tilt_heading(trace, "ice tea box")
    assert math.cos(fell - heading) == pytest.approx(1.0, abs=1e-12)


def test_rotation_of_a_quarter_turn() -> None:
    pose = np.array([math.cos(math.pi / 4), 0, 0, math.sin(math.pi / 4), 0, 0, 0])
    np.testing.assert_allclose(
        measures.rotation(pose), [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15
    )


def test_a_peak_of_force_counts_over_150_ms(make_trace: TraceMaker) -> None:
    trace = make_trace(force=4.0)
    peak = np.flatnonzero(trace.phase == "push")[100:105]
    for force in trace.felt.values():
        force[peak, 0] += 3.0 / len(trace.felt)
    # Shorter averages let the noise of the sensors through as peaks.
    assert measures.largest_push_force(trace) == pytest.approx(4.0 + 3.0 * 0.05 / 0.15, abs=0.05)


def test_a_jump_counts_as_speed_over_100_ms(make_trace: TraceMaker) -> None:
    trace = make_trace(speed=0.02)
    later = np.flatnonzero(trace.phase == "push")[100:]
    for tip in trace.tips.values():
        tip[later, 0] += 0.005
    assert measures.largest_push_speed(trace) == pytest.approx(0.02 + 0.005 / 0.1, rel=0.03)


@pytest.mark.parametrize(("millimetres", "force"), [(3.0, 0.0), (8.0, 4.0)])
def test_a_push_over_less_than_5_mm_has_the_direction_of_its_plan(
    make_trace: TraceMaker, millimetres: float, force: float
) -> None:
    trace = make_trace(travel=(1e-3 * millimetres, 0.0), force=4.0)
    planned = replace(trace, direction=np.array([0.0, 1.0, 0.0]))
    assert measures.largest_push_force(planned) == pytest.approx(force, abs=1e-9)


@pytest.mark.parametrize(("millimetres", "slips"), [(0.7, 0.0), (1.4, 0.009)])
def test_an_edge_less_than_a_millimetre_up_stands(
    make_trace: TraceMaker, box: BoxModel, millimetres: float, slips: float
) -> None:
    """On its whole base a box turns on the spot; on an edge, 45 mm aside, the edge moves."""
    trace = make_trace(travel=(0.0, 0.0), tilt=1e-3 * millimetres / 0.09, turned=0.2)
    slip = measures.slip(trace, "ice tea box", box.footprint.corners)
    assert slip == pytest.approx(slips, abs=3e-4)


@pytest.mark.parametrize(("before", "counts"), [(0.15, True), (0.30, False)])
def test_what_rests_at_the_end_rested_for_a_fifth_of_a_second(
    make_trace: TraceMaker, before: float, counts: bool
) -> None:
    trace, angle = make_trace(), math.radians(5.0)
    sample = np.searchsorted(trace.time, trace.time[-1] - before)
    trace.poses["ice tea box"][sample, :4] = [math.cos(angle / 2), 0.0, math.sin(angle / 2), 0.0]
    largest = measures.tilt_at_end(trace, "ice tea box")[1]
    assert largest == pytest.approx(angle if counts else 0.0, abs=1e-9)

"""Streams against textbook weirs and free fall; pours against what the brim leaves."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from objectmodels import Disc, Polygon
from objectmodels.containers.pour_dynamics import (
    Catch,
    Pour,
    UncertainPour,
    angle_for,
    caught_volume,
    landing_distance,
    outflow_rate,
    pour,
    simulate_pour,
    tilt_for,
)
from objectmodels.mechanics.push_thresholds import GRAVITY
from objectmodels.models.object_parts import Opening, Vessel

CARTON = Vessel(
    Polygon.rectangle(0.056, 0.076), 0.002, 0.16, Opening(centre=(0.0, 0.02), radius=0.014)
)
MUG = Vessel(Disc(0.037), 0.003, 0.082, Opening(radius=0.037))
FULL = 0.3e-3
SHARP_EDGE = 0.6  # share of the ideal flow over a weir or through a hole with a sharp edge
FORWARDS = np.pi / 2.0  # to the side on which the carton has its opening
OVER = {"heading": FORWARDS, "angle": np.radians(115.0), "rate": np.radians(20.0), "wait": 2.0}


@pytest.mark.parametrize("head", [0.002, 0.01, 0.027])
def test_an_upright_opening_is_the_circular_weir(head: float) -> None:
    """Q = c ∫ width(y) √(2g (h − y)) dy over what is wet of a hole in an upright wall."""
    r = 0.014

    def layer(y: float) -> float:
        return 2.0 * math.sqrt(y * (2.0 * r - y)) * math.sqrt(2.0 * GRAVITY * (head - y))

    flow, _ = quad(layer, 0.0, min(head, 2.0 * r))
    # Twelve nodes for an arc that ends as a root.
    assert outflow_rate(head, np.pi / 2.0, r) == pytest.approx(SHARP_EDGE * flow, rel=2e-3)


def test_a_level_opening_overflows_all_round() -> None:
    weir = 2.0 / 3.0 * SHARP_EDGE * np.sqrt(2.0 * GRAVITY) * 2.0 * np.pi * 0.03 * 0.004**1.5
    assert outflow_rate(0.004, 0.0, 0.03) == pytest.approx(weir, rel=1e-9)


def test_no_more_than_the_whole_hole_lets_through() -> None:
    hole = SHARP_EDGE * np.pi * 0.01**2 * np.sqrt(2.0 * GRAVITY * 0.1)
    assert outflow_rate(0.1, np.pi, 0.01) == pytest.approx(hole)
    assert outflow_rate(-0.01, 1.0, 0.01) == 0.0


def test_the_stream_falls_freely() -> None:
    level = landing_distance(0.006, np.radians(80.0), 0.05)
    assert level == pytest.approx(np.sqrt(4.0 * GRAVITY / 6.0 * 0.006) * np.sqrt(0.1 / GRAVITY))
    steep = landing_distance(0.006, np.radians(150.0), 0.05)
    speed, t = np.sqrt(2.0 / 3.0 * GRAVITY * 0.006), steep / (0.5 * 0.19809)
    # By the slope of the wall: cos 60° of the speed ahead, sin 60° down.
    assert speed == pytest.approx(0.19809, abs=1e-5)
    assert speed * np.sin(np.pi / 3.0) * t + 0.5 * GRAVITY * t * t == pytest.approx(0.05, rel=1e-3)
    assert landing_distance(0.006, 1.0, -0.01) == 0.0


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 1.0])
def test_the_tilt_for_a_volume_lets_it_out(share: float) -> None:
    tilt = tilt_for(CARTON, FULL, share * FULL, FORWARDS)
    out = FULL - CARTON.brim(tilt, FORWARDS)
    # A tenth of a microlitre stays in strips that lie along the surface.
    assert out == pytest.approx(share * FULL, abs=1e-9)


def test_a_pour_ends_where_the_brim_says() -> None:
    angles = np.radians([60.0, 75.0, 85.0, 115.0])
    running = pour(CARTON, FULL, heading=FORWARDS, angle=angles, rate=0.3, wait=300.0)
    held = np.maximum(FULL - CARTON.brim(angles, FORWARDS), 0.0)
    # The last of it drips through the narrow opening for minutes.
    assert running.total_volume == pytest.approx(held, abs=0.01 * FULL)
    assert running.total_volume[0] == 0.0
    assert (np.diff(running.poured) >= 0.0).all()
    assert running.volume_steps.sum(axis=-1) == pytest.approx(running.total_volume)


@pytest.mark.slow
def test_a_pour_takes_the_time_that_fine_steps_take() -> None:
    coarse = pour(CARTON, FULL, **OVER)
    time = np.linspace(0.0, float(coarse.time[-1]), 4000)
    tilt = np.interp(time, coarse.time, coarse.tilt)
    fine = simulate_pour(CARTON, FULL, FORWARDS, time, tilt)
    assert coarse.total_volume == pytest.approx(fine.total_volume, abs=0.003 * FULL)
    # Two steps of the coarse one.
    assert coarse.start_time == pytest.approx(fine.start_time, abs=0.1)
    assert coarse.end_time == pytest.approx(fine.end_time, abs=0.1)
    assert coarse.landing(0.05)[0] == pytest.approx(fine.landing(0.05)[0], abs=5e-4)


@pytest.mark.parametrize("share", [0.2, 0.6])
def test_the_angle_for_a_volume_lets_it_out_in_time(share: float) -> None:
    motion = {"heading": FORWARDS, "rate": 0.35, "wait": 2.0}
    angle = angle_for(CARTON, FULL, share * FULL, **motion)
    running = pour(CARTON, FULL, angle=angle, **motion)
    # Interpolated over 2° or so.
    assert running.total_volume == pytest.approx(share * FULL, abs=0.01 * FULL)


def test_what_is_aimed_well_is_caught() -> None:
    running = pour(CARTON, FULL, **OVER)
    ahead, spread = running.landing(0.04)
    catch = Catch(float(ahead), 0.0, 0.04, radius=0.036, free=0.4e-3)
    assert spread < 0.012
    result = caught_volume(running, FULL, catch)
    assert result.received[0] == pytest.approx(running.total_volume)
    assert (result.left + result.poured)[0] == pytest.approx(FULL)
    beside = caught_volume(
        running, FULL, Catch(float(ahead), 0.05, 0.04, radius=0.036, free=0.4e-3)
    )
    assert beside.spilled[0] == pytest.approx(running.total_volume)
    below = caught_volume(running, FULL, Catch(float(ahead), 0.0, -0.01, radius=0.036, free=0.4e-3))
    assert below.received[0] == pytest.approx(0.0)


def test_what_does_not_fit_is_spilled() -> None:
    running = pour(CARTON, FULL, **OVER)
    ahead, _ = running.landing(0.04)
    result = caught_volume(running, FULL, Catch(float(ahead), 0.0, 0.04, radius=0.036, free=0.1e-3))
    assert result.received[0] == pytest.approx(0.1e-3)
    assert result.spilled[0] == pytest.approx(running.total_volume - 0.1e-3)


def test_chances_are_those_of_drawn_aims() -> None:
    """A thread that is thrown a fixed way and missed by a normal error."""
    rng = np.random.default_rng(0)
    running = pour(CARTON, FULL, **OVER)
    ahead, _ = running.landing(0.0)  # at the lip it lands on one point
    catch = Catch(float(ahead), 0.0, 1e-9, radius=0.02, free=1.0, sd=0.02)
    inside = np.hypot(*rng.normal(0.0, 0.02, (2, 100_000))) < 0.02
    likely = caught_volume(running, FULL, catch).probability(received=0.9 * FULL)
    # 225 nodes: a ring of them more or less.
    assert likely == pytest.approx(inside.mean(), abs=0.05)


def test_unknown_contents_make_unknown_volumes() -> None:
    catch = Catch(0.03, 0.0, 0.04, radius=0.036, free=1.0)
    angles = np.radians([70.0, 80.0])
    running = UncertainPour.from_belief(
        CARTON, FULL, 0.03e-3, heading=FORWARDS, angle=angles, rate=0.3, wait=3.0
    )
    alone = pour(CARTON, FULL, heading=FORWARDS, angle=angles, rate=0.3, wait=3.0)
    # Levels are found to 1e-10 m, over some 5 cm² of surface.
    assert running.nominal_pour.poured == pytest.approx(alone.poured, abs=1e-12)
    result = running.caught_by(catch)
    means = result.mean_volumes()
    assert means["poured"].shape == (2,)
    assert means["poured"] + means["left"] == pytest.approx(FULL, rel=1e-6)
    # At 70° it begins to run for half of what may be in it.
    assert 0.2 < result.probability(received=1e-7)[0] < 0.8
    assert result.probability(received=1e-7)[1] == 1.0


def test_a_mug_can_be_poured_from_any_side() -> None:
    running = pour(MUG, 0.2e-3, heading=[0.0, 1.0, 2.0], angle=1.9, rate=0.5, wait=1.0)
    # It is round: all of it, and alike.
    assert running.total_volume == pytest.approx(0.2e-3, rel=0.01)
    assert np.ptp(running.end_time) < 1e-6


def test_the_end_is_when_all_but_a_hundredth_has_run_out() -> None:
    time = np.linspace(0.0, 1.0, 1001)
    even = Pour(time, np.zeros(1001), 1e-4 * time, np.zeros(1001))
    assert even.end_time == pytest.approx(0.99, abs=2e-3)
    assert even.start_time == pytest.approx(0.0, abs=2e-3)


def test_a_pour_leans_to_130_degrees_at_most() -> None:
    hasty = {"heading": FORWARDS, "rate": np.radians(2000.0), "wait": 0.0}
    assert np.degrees(angle_for(CARTON, FULL, 0.5 * FULL, **hasty)) == pytest.approx(130.0)

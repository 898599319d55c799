"""Speeds that strokes come to, beside the law integrated in small steps."""

from __future__ import annotations

import pytest

from planner.types.plan import USUAL, SpeedProfile, reached_speed, speed_profile


def integrated(profile: SpeedProfile, stroke: float) -> float:
    """Largest speed by steps of time [m/s]."""
    period, speed, way, largest = 1e-4, 0.0, 0.0, 0.0
    while way < stroke - 1e-4:
        speed = min(speed + profile.acceleration * period, profile.braking * (stroke - way))
        way, largest = way + speed * period, max(largest, speed)
    return largest


@pytest.mark.parametrize("stroke", [0.02, 0.058, 0.15])
@pytest.mark.parametrize("profile", [USUAL, SpeedProfile(0.2, 3.0)])
def test_largest_speed_is_that_of_the_law(profile: SpeedProfile, stroke: float) -> None:
    # A step of time changes the speed by 0.02 mm/s at most.
    assert profile.largest_speed(stroke) == pytest.approx(integrated(profile, stroke), abs=1e-4)


def test_what_is_slow_or_has_room_is_pushed_as_usual() -> None:
    assert speed_profile(0.05, 0.01) == USUAL
    assert speed_profile(0.12, 0.20) == USUAL


@pytest.mark.parametrize("stroke", [0.08, 0.10, 0.14])
def test_a_fast_push_speeds_up_no_more_than_it_takes(stroke: float) -> None:
    made = speed_profile(0.12, stroke)
    assert reached_speed(0.12, stroke) == pytest.approx(0.12)
    assert USUAL.acceleration <= made.acceleration <= 0.2
    gentler = SpeedProfile(0.9 * made.acceleration, made.braking)
    assert made.acceleration == USUAL.acceleration or gentler.largest_speed(stroke) < 0.12


def test_a_short_stroke_stays_below_the_speed() -> None:
    assert reached_speed(0.12, 0.05) < 0.10

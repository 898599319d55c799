"""Defaults as people set them: names with units, ranges, and what is suggested instead."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.types.defaults import DEFAULTS, Defaults, DefaultsError, settings, with_settings


def test_what_is_listed_can_be_set_again() -> None:
    there = with_settings(DEFAULTS, {s.name: s.value for s in settings()})
    for name, value in vars(DEFAULTS).items():
        # Ten digits are listed.
        assert getattr(there, name) == pytest.approx(value, rel=1e-9)


def test_units_of_people_become_si() -> None:
    found = with_settings(
        DEFAULTS, {"turn_deg": 45, "distance_m": 0.2, "force_hard_n": 9, "sigmas": 3}
    )
    assert (found.turn, found.distance) == (math.radians(45), 0.2)
    assert (found.force_hard, found.sigmas) == (9, 3)
    assert found == replace(DEFAULTS, turn=math.radians(45), distance=0.2, force_hard=9, sigmas=3)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("distance_m", 0.0, "distance_m must be more than 0 and at most 10, found 0"),
        ("distance_m", -1.0, "found -1"),
        ("distance_m", math.nan, "found nan"),
        ("distance_m", math.inf, "found inf"),
        ("place_gap_m", -0.01, "place_gap_m must be at least 0"),
        ("turn_deg", 361, "at most 360, found 361"),
        ("probability", 1.0, "at most 0.9999"),
        ("no_topple_share", 1.5, "at most 1"),
        ("distance_m", True, "must be a number"),
        ("distance_m", "far", "must be a number"),
        ("most_pushes", 2.5, "must be a whole number, found 2.5"),
        ("distance_m", 10**400, "at most 10"),
    ],
)
def test_values_out_of_range(name: str, value: float, message: str) -> None:
    with pytest.raises(DefaultsError, match=message):
        with_settings(DEFAULTS, {name: value})


def test_a_gap_may_be_nothing() -> None:
    assert with_settings(DEFAULTS, {"place_gap_m": 0}).place_gap == 0


@pytest.mark.parametrize(
    ("said", "meant"),
    [
        ("turn", "turn_deg"),  # the field, without the unit in which people set it
        ("speed", "speed_m_s"),
        ("distnce_m", "distance_m"),
        ("xyz", "nlcontrol defaults lists all with their units"),
    ],
)
def test_a_name_that_is_none_gets_a_suggestion(said: str, meant: str) -> None:
    with pytest.raises(DefaultsError) as raised:
        with_settings(DEFAULTS, {said: 1.0})
    assert meant in raised.value.suggestions[0]


def test_fields_are_kept_in_their_ranges_too() -> None:
    with pytest.raises(DefaultsError, match="turn_deg must be"):
        Defaults(turn=-1.0)
    with pytest.raises(DefaultsError, match="probability"):
        replace(DEFAULTS, probability=math.nan)


@given(st.dictionaries(st.text(max_size=12), st.floats(), max_size=3))
def test_whatever_is_set_is_taken_or_refused_with_a_reason(values: dict[str, float]) -> None:
    try:
        found = with_settings(DEFAULTS, values)
    except DefaultsError as raised:
        assert str(raised)  # noqa: PT017
    else:
        assert all(math.isfinite(value) for value in vars(found).values())

"""The observer: what moved first, from poses alone."""

from __future__ import annotations

import numpy as np
import pytest

from sim import load_scene
from sim.truth.observer import BOUND, first_motion

BOX = load_scene("kitchen").object("ice tea box").truth  # 0.09 m deep and wide


def poses(
    *, ahead: float = 0.0, tilt: float = 0.0, turn: float = 0.0, sinks: float = 0.0
) -> np.ndarray:
    """Ten poses from rest to an end: moved along x, tilted over its front edge, turned about z."""
    share = np.linspace(0.0, 1.0, 10)
    made = np.zeros((10, 7))
    made[:, 0] = np.cos(share * (tilt + turn) / 2.0)
    made[:, 2], made[:, 3] = np.sin(share * tilt / 2.0), np.sin(share * turn / 2.0)
    # The edge ahead stays where it is: B's origin swings about it.
    made[:, 4] = share * ahead + 0.045 * (1.0 - np.cos(share * tilt))
    made[:, 6] = 0.045 * np.sin(share * tilt) - share * sinks
    return made


@pytest.mark.parametrize(
    ("motion", "outcome"),
    [
        ({}, "none"),
        ({"ahead": 0.9 * BOUND}, "none"),
        ({"ahead": -1.1 * BOUND}, "slide"),
        # The rear edge rises by the base's length times the tilt.
        ({"tilt": 0.9 * BOUND / 0.09}, "none"),
        ({"tilt": 1.1 * BOUND / 0.09}, "topple"),
        ({"tilt": 0.5}, "topple"),
        # A corner is 64 mm from the middle.
        ({"turn": 0.9 * BOUND / 0.0636}, "none"),
        ({"turn": 1.1 * BOUND / 0.0636}, "slide"),
        ({"sinks": 5.0 * BOUND}, "none"),
        ({"tilt": 0.05, "ahead": 0.001}, "topple"),
        ({"tilt": 0.05, "ahead": 0.02}, "slide"),
    ],
)
def test_what_moved_first(motion: dict[str, float], outcome: str) -> None:
    verdict = first_motion(BOX, poses(**motion))
    assert verdict.outcome == outcome
    moved = max(verdict.slip[verdict.sample], verdict.lift[verdict.sample])
    assert (moved > BOUND) == (outcome != "none")


def test_motion_is_measured_from_the_first_sample() -> None:
    elsewhere = poses()
    elsewhere[:, 4:] += [0.3, -0.2, 0.1]
    assert first_motion(BOX, elsewhere).outcome == "none"


def test_the_bound_is_the_callers() -> None:
    little = poses(ahead=0.2e-3)
    assert first_motion(BOX, little).outcome == "none"
    assert first_motion(BOX, little, bound=1e-4).outcome == "slide"

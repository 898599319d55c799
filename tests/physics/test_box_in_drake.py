"""Thresholds against Drake: a free box on its four corners, pushed by a slowly growing force.

Measured with this set-up: the motion starts within 0.2 % of the closed forms' onset where nothing
turns about the vertical.
"""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.worlds.drake import DrakeWorld
from benchmarks.worlds.pushes import Array, Push, Seen, roll_out
from objectmodels import BoxModel

BOX = BoxModel(
    name="b",
    size=(0.09, 0.11, 0.23),
    mass=0.9952,
    friction=0.378,
    com=(0.004, -0.006, 0.10),
    support="corners",
)


def seen_in_drake(p: Array, u: Array, expected: float) -> Seen:
    """What the box does under a force that grows through the expected onset."""
    push = Push(0, BOX, p, u, outcome="unknown", onset=expected, apart=np.inf)
    return roll_out(DrakeWorld(BOX), push)


@pytest.mark.parametrize(
    ("point", "direction", "outcome"),
    [
        ((-0.045, -0.006, 0.05), (1.0, 0.0, 0.0), "slide"),
        ((-0.045, -0.006, 0.17), (1.0, 0.0, 0.0), "topple"),
        ((-0.045, -0.006, 0.12), (1.0, 0.0, -0.45), "slide"),
        ((-0.045, -0.006, 0.12), (1.0, 0.0, 0.45), "topple"),
        ((0.0, 0.055, 0.20), (0.2, -1.0, 0.1), "topple"),
    ],
)
def test_onset_is_met_within_one_percent(
    point: tuple[float, ...], direction: tuple[float, ...], outcome: str
) -> None:
    p, u = np.array(point), np.array(direction) / np.linalg.norm(direction)
    t = BOX.thresholds(p[None], u[None])
    assert t.outcome.item() == outcome
    seen = seen_in_drake(p, u, t.onset.item())
    assert seen.outcome == outcome
    assert seen.onset == pytest.approx(t.onset.item(), rel=0.01)


def test_off_centre_push_turns_as_the_exact_tier_says() -> None:
    """The ellipsoid stands in for four corners, 11 % too strong here; the exact tier does not."""
    p, u = np.array([-0.045, 0.03, 0.04]), np.array([1.0, 0.0, 0.0])
    t, ellipsoid = BOX.thresholds(p[None], u[None], exact=True), BOX.thresholds(p[None], u[None])
    assert 1.05 < ellipsoid.onset.item() / t.onset.item() < 1.15
    seen = seen_in_drake(p, u, t.onset.item())
    assert seen.outcome == "slide"
    assert seen.onset == pytest.approx(t.onset.item(), rel=0.01)

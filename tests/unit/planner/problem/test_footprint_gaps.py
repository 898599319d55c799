"""Distances between footprints."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from objectmodels.geometry.base_shapes import Array
from planner.problem.footprints import gap, overlaps

SQUARE = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])


def _turned(angle: float, shift: tuple[float, float]) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(SQUARE @ np.array([[c, s], [-s, c]]) + shift)


@pytest.mark.parametrize(
    ("other", "expected"),
    [
        (_turned(0.0, (5.0, 0.5)), 3.0),  # edge to edge
        (_turned(0.0, (5.0, 6.0)), 5.0),  # corner to corner: 3 aside, 4 ahead
        (_turned(np.pi / 4.0, (4.0, 0.0)), 3.0 - np.sqrt(2.0)),  # corner to edge
        (_turned(0.0, (1.5, 0.0)), -0.5),  # overlapping by 0.5
    ],
)
def test_gap(other: Array, expected: float) -> None:
    assert gap(SQUARE, other) == pytest.approx(expected)
    assert gap(other, SQUARE) == pytest.approx(expected)


@given(st.floats(0.0, 6.3), st.floats(-5.0, 5.0), st.floats(-5.0, 5.0))
def test_what_is_closer_than_a_clearance_has_a_smaller_gap(
    angle: float, x: float, y: float
) -> None:
    other = _turned(angle, (x, y))
    # `overlaps` measures along the edges' normals, which between two corners is less.
    if not overlaps(SQUARE, other, 0.7):
        assert gap(SQUARE, other) >= 0.7 - 1e-9
    assert overlaps(SQUARE, other, 0.0) == (gap(SQUARE, other) < 0.0)

"""Free motion of a point keeps its bounds."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sim.motion.held_object_path import attractor_points

PERIOD = 0.01
numbers = st.floats(-2.0, 2.0)


@given(
    start=st.lists(numbers, min_size=3, max_size=3),
    target=st.lists(numbers, min_size=3, max_size=3),
    speed=st.floats(0.05, 2.0),
    acceleration=st.floats(0.2, 5.0),
)
def test_attractor_keeps_its_bounds_and_arrives(
    start: list[float], target: list[float], speed: float, acceleration: float
) -> None:
    a, b = np.array(start), np.array(target)
    points = np.array(
        [a, *attractor_points(a, b, speed=speed, acceleration=acceleration, period=PERIOD)]
    )
    np.testing.assert_array_equal(points[-1], b if len(points) > 1 else points[-1])
    assert np.linalg.norm(points[-1] - b) < 1e-6
    velocity = np.diff(points, axis=0) / PERIOD
    assert (np.linalg.norm(velocity, axis=1) <= speed * (1 + 1e-9)).all()
    # The last step snaps to the target, which is less than one period of braking off.
    change = np.linalg.norm(np.diff(velocity, axis=0), axis=1)
    assert (change <= acceleration * PERIOD * 2.5).all()
    # On the straight line: what was checked for collisions.
    line = (b - a) / max(float(np.linalg.norm(b - a)), 1e-12)
    off = points - a - ((points - a) @ line)[:, None] * line
    assert np.abs(off).max() < 1e-9

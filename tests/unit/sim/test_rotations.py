"""Rotations as quaternions."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from objectmodels.geometry.rotations import axis_rotation, quaternion

ANGLES = st.floats(-np.pi, np.pi)


@given(st.tuples(*3 * (st.floats(-1.0, 1.0),)).filter(lambda v: np.linalg.norm(v) > 0.1), ANGLES)
def test_a_quaternion_is_axis_and_half_the_angle(axis: tuple[float, ...], angle: float) -> None:
    unit = np.array(axis) / np.linalg.norm(axis)
    q = quaternion(axis_rotation(unit, angle))
    expected = np.array([np.cos(angle / 2.0), *(np.sin(angle / 2.0) * unit)])
    # The same rotation has two; a few roundings of numbers of one.
    np.testing.assert_allclose(q * np.sign(q @ expected), expected, atol=1e-14)


def test_whole_arrays_of_quaternions() -> None:
    angles = np.linspace(-3.0, 3.0, 6).reshape(2, 3)
    q = quaternion(axis_rotation(np.array([0.0, 1.0, 0.0]), angles))
    np.testing.assert_allclose(q[..., 2] / q[..., 0], np.tan(angles / 2.0), rtol=1e-12)

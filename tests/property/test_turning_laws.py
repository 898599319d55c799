"""Laws of pushes that turn an object, whatever the object and the push."""

from __future__ import annotations

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st

from objectmodels import BoxModel
from objectmodels.geometry.base_shapes import Array
from objectmodels.mechanics.push_motion import Turning, turning_motion

ANGLES = st.floats(0.01, 3.0)
SLANTS = st.floats(-1.2, 1.2)
LATERALS = st.floats(-0.9, 0.9)


def box(scale: float = 1.0) -> BoxModel:
    return BoxModel(
        name="b",
        size=(0.06 * scale, 0.10 * scale, 0.2),
        mass=0.5,
        friction=0.3,
        finger_friction=0.7,
        finger_friction_sd=0.1,
    )


def pushed(slant: float, lateral: float, angle: float, scale: float = 1.0) -> Turning:
    point = [[-0.03 * scale, 0.05 * scale * lateral, 0.05]]
    return turning_motion(box(scale), point, [[-1.0, 0.0, 0.0]], slant, angle, sigmas=1.0)


def after(first: Array, second: Array) -> Array:
    """One pose after another, the second in the frame that the first leads to."""
    c, s = np.cos(first[2]), np.sin(first[2])
    x, y = np.array([[c, -s], [s, c]]) @ second[:2]
    return np.array([first[0] + x, first[1] + y, first[2] + second[2]])


@given(SLANTS, LATERALS, ANGLES, ANGLES)
def test_two_turns_make_one(slant: float, lateral: float, one: float, two: float) -> None:
    parts = [pushed(slant, lateral, -a) for a in (one, two)]
    assume(parts[0].turns.all())
    whole = pushed(slant, lateral, -one - two)
    together = after(parts[0].pose[0], parts[1].pose[0])
    # Rounding, relative to pivots that may lie far away.
    size = 1e-11 * (1.0 + np.linalg.norm(whole.pivot))
    np.testing.assert_allclose(whole.pose[0], together, atol=float(size))
    np.testing.assert_allclose(whole.travel, parts[0].travel + parts[1].travel, rtol=1e-12)


@given(SLANTS, LATERALS, ANGLES)
def test_a_mirror_turns_it_the_other_way(slant: float, lateral: float, angle: float) -> None:
    this, other = pushed(slant, lateral, angle), pushed(-slant, -lateral, -angle)
    assert this.is_successful.tolist() == other.is_successful.tolist()
    np.testing.assert_allclose(this.pose * [1.0, -1.0, -1.0], other.pose, atol=1e-12)
    np.testing.assert_allclose(this.travel, other.travel, rtol=1e-12)


@given(SLANTS, LATERALS, ANGLES, st.floats(0.2, 5.0))
def test_a_larger_box_moves_farther_by_as_much(
    slant: float, lateral: float, angle: float, scale: float
) -> None:
    small, large = pushed(slant, lateral, angle), pushed(slant, lateral, angle, scale)
    assume(small.turns.tolist() == large.turns.tolist())  # a rate of zero has no sense
    np.testing.assert_allclose(large.travel, scale * small.travel, rtol=1e-9)
    np.testing.assert_allclose(large.pose[:, :2], scale * small.pose[:, :2], rtol=1e-9, atol=1e-9)


@given(SLANTS, LATERALS)
def test_it_turns_in_exactly_one_sense(slant: float, lateral: float) -> None:
    nominal = [
        turning_motion(box(), [[-0.03, 0.05 * lateral, 0.05]], [[-1.0, 0.0, 0.0]], slant, angle)
        for angle in (-0.3, 0.3)
    ]
    turns = [bool(each.turns[0]) for each in nominal]
    assert sum(turns) == 1 or _aims_at_the_middle(nominal[0].slant[0], lateral)


def _aims_at_the_middle(slant: float, lateral: float) -> bool:
    """Whether the force goes through the centre of mass."""
    return bool(abs(-0.03 * np.sin(slant) - 0.05 * lateral * np.cos(slant)) < 1e-6)

"""Suddenly applied forces: the formula for a centred push, and Newton's laws for every class."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from objectmodels import BoxModel

G = 9.81
BOX = BoxModel(name="b", size=(0.09, 0.09, 0.23), mass=0.9952, friction=0.378)


def expected(s: float, h: float) -> str:
    """The class of a horizontal push in the middle of a face, from the closed formula."""
    m, mu, b, c_z = BOX.mass, BOX.friction, 0.045, 0.115
    weight = m * G
    inertia = m * (0.09**2 + 0.23**2) / 12 + m * (b * b + c_z * c_z)
    alpha = (s * h - weight * b) / inertia
    if s <= mu * weight and s * h <= weight * b:
        return "none"
    if alpha > 0 and abs(s - m * alpha * c_z) <= mu * (weight + m * alpha * b):
        return "topple"
    ahead = s * (h - c_z) > weight * (b - mu * c_z)
    back = s * (c_z - h) > weight * (b + mu * c_z)
    return "slide+topple" if ahead or back else "slide"


def test_centred_pushes_follow_the_closed_formula() -> None:
    s, h = (a.ravel() for a in np.meshgrid(np.linspace(0.3, 60, 80), np.linspace(0.002, 0.229, 60)))
    p = np.column_stack((np.full(s.size, -0.045), np.zeros(s.size), h))
    found = BOX.sudden(p, np.column_stack((s, 0 * s, 0 * s))).outcome
    wanted = [expected(a, b) for a, b in zip(s, h, strict=True)]
    assert set(wanted) == {"none", "slide", "topple", "slide+topple"}
    np.testing.assert_array_equal(found, wanted)


@given(st.floats(0.1, 40.0), st.floats(0.0, 0.23), st.floats(-0.5, 0.5), st.floats(0.0, 2 * np.pi))
def test_below_the_onset_nothing_moves_and_above_it_something_does(
    force: float, height: float, slope: float, turn: float
) -> None:
    u = np.array([np.cos(turn), np.sin(turn), slope]) / np.hypot(1.0, slope)
    # Through the centre of mass sideways, so that nothing turns.
    p = np.array([-0.02 * np.cos(turn), -0.02 * np.sin(turn), height])
    onset = BOX.thresholds([p], [u]).onset.item()
    outcome = BOX.sudden([p], [force * u]).outcome.item()
    if force < onset * (1 - 1e-9):  # rounding
        assert outcome == "none"
    elif force > onset * (1 + 1e-9):
        assert outcome != "none"


@pytest.mark.parametrize(
    ("p", "force", "outcome"),
    [
        ((-0.045, 0.0, 0.05), (5.0, 0.0, 0.0), "slide"),
        ((-0.045, 0.0, 0.22), (4.0, 0.0, 0.0), "topple"),
        ((-0.045, 0.0, 0.01), (60.0, 0.0, 0.0), "slide+topple"),  # its foot is pulled away
        ((0.0, 0.0, 0.115), (0.0, 0.0, 12.0), "lift"),
    ],
)
def test_examples(p: tuple[float, ...], force: tuple[float, ...], outcome: str) -> None:
    assert BOX.sudden([p], [force]).outcome.item() == outcome


def test_sliding_accelerates_by_what_friction_leaves() -> None:
    push = BOX.sudden([[-0.045, 0.0, 0.1]], [[6.0, 0.0, -1.0]])
    load = BOX.weight + 1.0
    assert push.outcome.item() == "slide"
    assert push.acceleration.item() == pytest.approx((6.0 - 0.378 * load) / BOX.mass, rel=1e-12)
    assert push.angular.item() == 0.0


def test_backwards_is_the_mirror_image_of_forwards() -> None:
    rng = np.random.default_rng(0)
    box = BoxModel(name="b", size=(0.09, 0.07, 0.2), mass=1.0, friction=0.4, com=(0.01, 0.0, 0.08))
    image = box.model_copy(update={"com": (-0.01, 0.0, 0.08)})
    p = rng.uniform([-0.045, 0.0, 0.0], [0.045, 0.0, 0.2], (300, 3))
    f = rng.uniform([-40.0, 0.0, -4.0], [40.0, 0.0, 4.0], (300, 3))
    mirror = np.array([-1.0, 1.0, 1.0])
    a, b = box.sudden(p, f), image.sudden(p * mirror, f * mirror)
    np.testing.assert_array_equal(a.outcome, b.outcome)
    np.testing.assert_allclose(a.acceleration, b.acceleration, rtol=1e-9)  # rounding


def test_accelerations_obey_newton_and_euler() -> None:
    """What the floor must do for them: press, and rub as Coulomb's law has it where it slips."""
    rng = np.random.default_rng(1)
    s, h = rng.uniform(1.0, 60.0, 400), rng.uniform(0.002, 0.229, 400)
    p = np.column_stack((np.full(400, -0.045), 0 * h, h))
    found = BOX.sudden(p, np.column_stack((s, 0 * s, 0 * s)))
    m, b, c_z = BOX.mass, 0.045, 0.115
    inertia = m * (0.09**2 + 0.23**2) / 12
    alpha, a = found.angular, found.acceleration
    normal = BOX.weight + m * np.abs(alpha) * b  # about either edge the centre of mass rises
    rubs = m * a - s
    edge = np.sign(alpha) * b
    tilting = alpha != 0.0
    moment = s * (h - c_z) - c_z * rubs - edge * normal
    # Rounding of moments of a newton metre.
    np.testing.assert_allclose(inertia * alpha[tilting], moment[tilting], atol=1e-9)
    slips = np.isin(found.outcome, ["slide", "slide+topple"])
    np.testing.assert_allclose(np.abs(rubs[slips]), 0.378 * normal[slips], rtol=1e-9)
    sticks = found.outcome == "topple"
    assert (np.abs(rubs[sticks]) <= 0.378 * normal[sticks] * (1 + 1e-9)).all()
    np.testing.assert_allclose(a[sticks], alpha[sticks] * c_z, rtol=1e-9)
    assert min(slips.sum(), sticks.sum(), (found.outcome == "slide+topple").sum()) > 20

"""Strokes: straight ones, slipping ones, two fingers, and an integrator of another make."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from objectmodels import BoxModel, CylinderModel, ModelError

BOX = BoxModel(
    name="b", size=(0.09, 0.11, 0.2), mass=1.0, friction=0.4, finger_friction=0.6,
    com=(0.008, -0.005, 0.1),
)  # fmt: skip
REAR = np.array([-1.0, 0.0, 0.0])


def direction(angle: float) -> list[float]:
    return [np.cos(angle), np.sin(angle), 0.0]


def test_through_the_centre_it_goes_straight() -> None:
    s = BOX.stroke([[-0.045, -0.005, 0.05]], [REAR], [1, 0, 0], 0.1)
    np.testing.assert_allclose(s.pose[0], (0.1, 0.0, 0.0), atol=1e-12)
    assert s.mode.item() == "stick"
    assert s.stable.item()


@settings(max_examples=60, deadline=None)
@given(st.floats(-0.05, 0.05), st.floats(-0.45, 0.45))
@pytest.mark.slow
def test_the_sense_of_turning_is_that_of_masons_vote(lateral: float, angle: float) -> None:
    """Both edges of the friction cone and the push vote by the side on which the centre lies."""
    p = np.array([-0.045, lateral])
    to_centre = np.array(BOX.com[:2]) - p
    rays = [direction(angle)[:2], [1.0, 0.6], [1.0, -0.6]]
    votes = [np.sign(ray[0] * to_centre[1] - ray[1] * to_centre[0]) for ray in rays]
    away = min(abs(ray[0] * to_centre[1] - ray[1] * to_centre[0]) for ray in rays)
    if away < 1e-4:  # the vote may be a tie
        return
    s = BOX.stroke([[*p, 0.05]], [REAR], direction(angle), 0.002)
    # Forces that leave the centre to their left turn the object left.
    assert np.sign(s.pose[0, 2]) == np.sign(sum(votes))


def limit_surface_rhs(lateral: float, angle: float, mu: float):  # type: ignore[no-untyped-def]
    """An independent right-hand side: force by bisection over its direction, not by formula."""
    c, radius = np.array(BOX.com[:2]), BOX.friction_radius

    def rates(_: float, state: np.ndarray) -> np.ndarray:
        theta, along = state[2:]
        R = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
        d = R.T @ direction(angle)[:2]
        p = np.array([-0.045, lateral + along]) - c

        def twist(phi: np.ndarray | float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            f = np.array([np.cos(phi), np.sin(phi)])
            w = (p[0] * f[1] - p[1] * f[0]) / radius**2
            return f, w, f + np.multiply.outer([-p[1], p[0]], w)

        def off(phi: np.ndarray | float) -> np.ndarray:
            v = twist(phi)[2]
            return np.asarray(v[0] * d[1] - v[1] * d[0])

        phi = np.linspace(-1.5, 1.5, 4001)
        values = off(phi)
        k = int(np.flatnonzero(np.diff(np.sign(values)))[0])
        lo, hi = phi[k], phi[k + 1]
        for _i in range(50):
            mid = 0.5 * (lo + hi)
            lo, hi = (mid, hi) if np.sign(off(mid)) == np.sign(off(lo)) else (lo, mid)
        stick = abs(np.tan(lo)) <= mu
        f, w, v = twist(lo if stick else np.sign(lo) * np.arctan(mu))
        scale = d[0] / v[0]
        slip = 0.0 if stick else float(d[1] - scale * v[1])
        velocity = scale * (f - w * np.array([-c[1], c[0]]))
        return np.array([*(R @ velocity), scale * w, slip])

    return rates


@pytest.mark.parametrize(
    ("lateral", "angle"), [(0.01, 0.0), (-0.03, 0.1), (0.045, 0.0), (0.0, 0.5), (0.02, -0.55)]
)
def test_pose_after_a_stroke_is_that_of_another_integrator(lateral: float, angle: float) -> None:
    travel = 0.03
    found = solve_ivp(
        limit_surface_rhs(lateral, angle, BOX.finger_friction), (0.0, travel), np.zeros(4),
        rtol=1e-7, atol=1e-9, max_step=travel / 40,
    )  # fmt: skip
    s = BOX.stroke([[-0.045, lateral, 0.05]], [REAR], direction(angle), travel)
    # Half a step of 0.15 mm is lost where sticking turns to slipping.
    np.testing.assert_allclose(s.pose[0], found.y[:3, -1], atol=2e-5)
    # Slip counts along ẑ × normal, which is −y on this face.
    np.testing.assert_allclose(-s.slipped[0], found.y[3, -1], atol=2e-5)


def test_two_fingers_keep_it_straight_within_their_cone() -> None:
    fingers = [[-0.045, -0.025, 0.05], [-0.045, 0.015, 0.05]]
    for angle in (0.0, 0.15, -0.15):
        s = BOX.stroke([fingers], [REAR], direction(angle), 0.1)
        np.testing.assert_allclose(
            s.pose[0], (*(0.1 * np.array(direction(angle))[:2]), 0.0), atol=1e-12
        )
        assert s.stable.item()


def test_two_fingers_that_push_past_the_centre_lose_it() -> None:
    fingers = [[-0.045, 0.01, 0.05], [-0.045, 0.05, 0.05]]
    s = BOX.stroke([fingers], [REAR], [1, 0, 0], 0.05)
    assert not s.stable.item()
    assert s.mode.item() == "turn"
    assert s.pose[0, 2] < -0.1  # pushed left of the centre it turns right


def test_two_smooth_fingers_slip_along_without_turning_it() -> None:
    smooth = BOX.model_copy(update={"finger_friction": 0.1})
    fingers = [[-0.045, -0.045, 0.05], [-0.045, 0.035, 0.05]]
    s = smooth.stroke([fingers], [REAR], direction(0.4), 0.05)
    assert s.mode.item() == "slip left"
    assert s.pose[0, 2] == pytest.approx(0.0, abs=1e-12)
    assert s.pose[0, 1] == pytest.approx(0.1 * s.pose[0, 0], rel=1e-9)  # along the cone's edge


def test_a_finger_that_leaves_the_face_is_lost() -> None:
    s = BOX.stroke([[-0.045, 0.05, 0.05]], [REAR], direction(1.2), 0.08)
    assert s.mode.item() == "lost"
    assert s.path.shape == (201, 1, 3)
    np.testing.assert_array_equal(s.path[-1, 0], s.path[-2, 0])


def test_a_finger_runs_around_a_can() -> None:
    """Pushed off its axis a smooth can rolls off the finger; the contact moves around it."""
    can = CylinderModel(
        name="can", radius=0.033, height=0.1, mass=0.3, friction=0.3, finger_friction=0.1
    )
    n = np.array([np.cos(np.pi - 0.3), np.sin(np.pi - 0.3), 0.0])
    s = can.stroke([0.033 * n + [0, 0, 0.05]], [n], [1, 0, 0], 0.04)
    assert s.mode.item() == "slip left"
    assert abs(s.slipped.item()) > 0.005
    x, y, _ = s.pose[0]
    finger = 0.033 * n[:2] + [0.04, 0.0]
    # The finger is still on the circle around the can's axis.
    assert np.hypot(finger[0] - x, finger[1] - y) == pytest.approx(0.033, rel=2e-3)


def test_a_contact_beside_the_face_is_refused() -> None:
    with pytest.raises(ModelError) as raised:
        BOX.stroke([[-0.045, 0.070, 0.05]], [REAR], [1, 0, 0], 0.05)
    assert raised.value.code == "off_object"


@pytest.mark.parametrize(
    ("points", "normals", "way", "travel"),
    [
        ([[-0.045, 0, 0.05]], [[1, 0, 0]], [1, 0, 0], 0.1),
        ([[-0.045, 0, 0.05]], [[-1, 0, 0]], [1, 0, 0.5], 0.1),
        ([[-0.045, 0, 0.05]], [[-1, 0, 0]], [1, 0, 0], -0.1),
        ([[-0.045, 0, 0.05]], [[-1, 0, 0]] * 2, [1, 0, 0], 0.1),
        ([[-0.045, 0, float("nan")]], [[-1, 0, 0]], [1, 0, 0], 0.1),
        ([[-0.045, 0, 0.05]], [[-np.sqrt(0.5), np.sqrt(0.5), 0]], [1, 0, 0], 0.1),
    ],
)
def test_strokes_that_make_no_sense_are_refused(
    points: object, normals: object, way: object, travel: float
) -> None:
    with pytest.raises(ModelError):
        BOX.stroke(points, normals, way, travel)  # type: ignore[arg-type]

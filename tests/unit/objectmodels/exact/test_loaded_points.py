"""Strokes on loaded points, and the limit surface, beside thresholds of the exact tier."""

from __future__ import annotations

from itertools import groupby

import numpy as np
import pytest

from objectmodels import BoxModel, CylinderModel, ModelError
from objectmodels.exact.planar_wrench import twist_of_wrench, wrench_of_twist
from objectmodels.exact.stroke_draws import DRAWS, stroke_draws
from objectmodels.exact.top_drag import LoadedPoints
from objectmodels.geometry.base_shapes import Array, Support, friction_radius

FEET: Support = ((-0.03, -0.04), (0.035, -0.03), (0.01, 0.045))
REAR = np.array([-1.0, 0.0, 0.0])


BOX = BoxModel(
    name="b", size=(0.09, 0.11, 0.2), mass=1.0, friction=0.4, finger_friction=0.6,
    com=(0.008, -0.005, 0.05), support=FEET,
)  # fmt: skip


def box(support: Support = FEET, **changes: object) -> BoxModel:
    """The box on other points, with their own friction radius if that is not among the changes."""
    radius = friction_radius(support, BOX.footprint)
    return BOX.model_copy(update={"support": support, "friction_radius": radius} | changes)


def unit(angle: Array) -> Array:
    return np.column_stack((np.cos(angle), np.sin(angle), 0.0 * angle))


def parallel(a: Array, b: Array) -> Array:
    """Sine of the angle between planar twists, turning rates by 5 cm, shape (n,)."""
    a, b = (v * [1.0, 1.0, 0.05] for v in (a, b))
    size = np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1)
    return np.asarray(np.linalg.norm(np.cross(a, b), axis=1) / size)


@pytest.mark.parametrize("support", [FEET, "corners", "uniform"])
def test_a_led_contact_moves_as_under_the_force_that_the_threshold_needs(support: Support) -> None:
    """Forwards the exact tier seeks the motion of a force, backwards the law the force of one."""
    rng = np.random.default_rng(5)
    n, model = 12, box(support, friction_radius=0.04)
    p = np.column_stack((np.full(n, -0.045), rng.uniform(-0.05, 0.05, n), rng.uniform(0, 0.02, n)))
    d = unit(rng.uniform(-0.6, 0.6, n))
    law = LoadedPoints.of_model(model, p[:, 2])
    r, force = p[:, :2] - law.com, np.zeros((n, 2))
    for _ in range(12):  # the push shifts the load, which shifts the push
        slide = law.law_under(force).slide_with(r, d[:, :2])
        force = slide.force
    u = np.column_stack((force / np.hypot(*force.T)[:, None], np.zeros(n)))
    t = model.thresholds(p, u, exact=True)
    twist = t.twist[:, [3, 4, 2]]
    origin = slide.v - slide.turn[:, None] * np.column_stack((-law.com[:, 1], law.com[:, 0]))
    # Friction of points slower than 1e-7 of the finger is left out; limits are found to 1e-10.
    assert parallel(np.column_stack((origin, slide.turn)), twist).max() < 1e-5
    weight = model.friction * model.weight
    np.testing.assert_allclose(weight * np.hypot(*force.T), t.slide, rtol=1e-6)


def test_a_point_that_holds_is_turned_about() -> None:
    """A heavy foot straight beside the finger's path keeps its place, and the finger turns it."""
    heavy: Support = ((0.0, 0.0, 50.0), (0.03, 0.04), (0.03, -0.04), (-0.03, 0.0))
    model = box(heavy, com=(0.0, 0.0, 0.05))
    law = LoadedPoints.of_model(model, np.zeros(1))
    slide = law.slide_with(np.array([[-0.0, 0.05]]), np.array([[1.0, 0.0]]))
    np.testing.assert_allclose(slide.v, [[0.0, 0.0]], atol=1e-6)
    assert slide.turn.item() == pytest.approx(-20.0, rel=1e-6)


def test_strokes_begin_as_the_law_says_and_slip_at_the_edge_of_the_cone() -> None:
    model = box(finger_friction=0.1)
    p, d, mu = np.array([[-0.045, -0.03, 0.01]]), unit(np.array([0.5])), 0.1
    s = model.stroke(p, [REAR], d, 1e-5, exact=True)
    edge = np.array([[1.0, mu, 0.0]]) / np.hypot(1.0, mu)
    twist = model.thresholds(p, edge, exact=True).twist[:, [3, 4, 2]]
    assert s.mode.item() == "slip left"
    # Over a travel of 10 µm the push turns by 1e-4.
    assert parallel(s.pose, twist).max() < 1e-3


def test_the_mode_is_told_over_time() -> None:
    """Beside the centre it slips outwards at first, sticks as it turns, and leaves the far end."""
    model = box(finger_friction=0.25)
    s = model.stroke([[-0.045, -0.04, 0.01]], [REAR], [1, 0, 0], 0.2, exact=True)
    told = [mode for mode, _ in groupby(s.modes[:, 0].tolist())]
    assert told == ["slip left", "stick", "slip right", "lost"]
    assert not s.stable.item()


@pytest.mark.parametrize("exact", [False, True])
def test_each_stroke_has_its_travel(exact: bool) -> None:
    model = box()
    p = np.array([[-0.045, 0.02, 0.01], [-0.045, -0.03, 0.01]])
    both = model.stroke(p, [REAR, REAR], [1, 0, 0], [0.02, 0.05], exact=exact)
    for k, travel in enumerate((0.02, 0.05)):
        one = model.stroke(p[k : k + 1], [REAR], [1, 0, 0], travel, exact=exact)
        np.testing.assert_allclose(both.pose[k], one.pose[0], atol=1e-12)


@pytest.mark.parametrize("exact", [False, True])
def test_a_round_tip_stays_on_its_face(exact: bool) -> None:
    """The tip's centre keeps its radius from the face, at the place that is told."""
    tip, lateral, travel = 0.008, 0.03, 0.06
    s = box().stroke(
        [[-0.045, lateral, 0.01]], [REAR], [1, 0, 0], travel, exact=exact, tip_radius=tip
    )
    x, y, theta = s.pose[0]
    off = np.array([-0.045 - tip + travel - x, lateral - y])
    R = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
    # The face is at −45 mm; where the contact has come along ẑ × normal, which is −y. The midpoint
    # rule is off by 1 µm, by half a step of 0.3 mm where sticking turns to slipping.
    np.testing.assert_allclose(R.T @ off, [-0.045 - tip, lateral - s.slipped.item()], atol=3e-5)
    point = box().stroke([[-0.045, lateral, 0.01]], [REAR], [1, 0, 0], travel, exact=exact)
    assert abs(point.pose[0, 2] - theta) > 0.004


def test_a_round_tip_stays_on_a_can() -> None:
    can = CylinderModel(
        name="can", radius=0.033, height=0.1, mass=0.3, friction=0.3, finger_friction=0.1
    )
    n = np.array([np.cos(np.pi - 0.3), np.sin(np.pi - 0.3), 0.0])
    s = can.stroke([0.033 * n + [0, 0, 0.01]], [n], [1, 0, 0], 0.04, tip_radius=0.01)
    finger = 0.043 * n[:2] + [0.04, 0.0] - s.pose[0, :2]
    # As without a radius, the midpoint rule keeps the distance to some thousandths.
    assert np.hypot(*finger) == pytest.approx(0.043, rel=2e-3)


def test_two_fingers_push_as_one_body_or_turn_it_by_the_loaded_points() -> None:
    model = box()
    straight = model.stroke(
        [[[-0.045, -0.03, 0.01], [-0.045, 0.02, 0.01]]], [REAR], [1, 0, 0], 0.05, exact=True
    )
    np.testing.assert_allclose(straight.pose[0], (0.05, 0.0, 0.0), atol=1e-12)
    fingers = [[[-0.045, 0.01, 0.01], [-0.045, 0.05, 0.01]]]
    past = model.stroke(fingers, [REAR], [1, 0, 0], 0.02, exact=True)
    alone = model.stroke([[-0.045, 0.01, 0.01]], [REAR], [1, 0, 0], 0.02, exact=True)
    assert past.mode.item() == "turn"
    np.testing.assert_allclose(past.pose, alone.pose, atol=1e-12)


@pytest.mark.parametrize("support", [FEET, "uniform"])
def test_the_wrench_of_a_twist_has_that_twist(support: Support) -> None:
    rng = np.random.default_rng(3)
    model = box(support)
    twist = rng.normal(size=(40, 3)) * [1.0, 1.0, 25.0]
    wrench = wrench_of_twist(model, twist)
    # As of 40 random twists none turns about a foot, the wrench tells the twist.
    assert parallel(twist_of_wrench(model, wrench), twist).max() < 1e-5
    power = (wrench * twist).sum(axis=1)
    others = wrench_of_twist(model, rng.normal(size=(40, 3)) * [1.0, 1.0, 25.0])
    assert (power >= (others * twist).sum(axis=1)).all()  # most dissipation of all wrenches


def test_a_moment_alone_turns_it() -> None:
    (twist,) = twist_of_wrench(box("corners", com=(0.0, 0.0, 0.05)), [[0.0, 0.0, 0.1]])
    # The force that stands for the moment is a million sizes of the base away.
    np.testing.assert_allclose(twist[:2], 0.0, atol=1e-5)
    assert twist[2] > 0.0


@pytest.mark.parametrize("rows", [[[0.0, 0.0, 0.0]], [0.0, 1.0, 0.0], [[np.nan, 1.0, 0.0]]])
def test_rows_that_make_no_sense_are_refused(rows: object) -> None:
    for function in (wrench_of_twist, twist_of_wrench):
        with pytest.raises(ModelError, match=r"expected|finite"):
            function(box(), rows)  # type: ignore[arg-type]


def test_draws_of_a_sure_object_end_alike_and_those_of_an_unsure_one_apart() -> None:
    sure = box(com_sd=(0.0, 0.0, 0.0), friction_radius_sd=0.0, finger_friction_sd=0.0)
    p, way = np.array([[-0.045, 0.02, 0.01], [-0.045, -0.01, 0.01]]), [0.03, 0.05]
    told = stroke_draws(sure, p, [REAR, REAR], [1, 0, 0], way)
    end = sure.stroke(p, [REAR, REAR], [1, 0, 0], way, exact=True).pose
    assert told.pose.shape == (DRAWS, 2, 3)
    np.testing.assert_allclose(told.mean, end, atol=1e-12)
    assert told.covariance.max() < 1e-20
    unsure = sure.model_copy(update={"com_sd": (0.0, 0.004, 0.0)})
    spread = stroke_draws(unsure, p, [REAR, REAR], [1, 0, 0], way)
    shifted = [
        sure.model_copy(update={"com": (0.008, -0.005 + dy, 0.05)})
        .stroke(p, [REAR, REAR], [1, 0, 0], way, exact=True)
        .pose
        for dy in (-0.004, 0.004)
    ]
    # To first order the turn's deviation is half of what ± one deviation of the centre does.
    first_order = np.abs(shifted[1] - shifted[0])[:, 2] / 2.0
    np.testing.assert_allclose(np.sqrt(spread.covariance[:, 2, 2]), first_order, rtol=0.15)
    assert (spread.lost == 0.0).all()

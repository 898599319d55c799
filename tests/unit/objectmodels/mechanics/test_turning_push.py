"""Pushes that turn an object: exact poses, the pivot at rest, what a round side allows."""

from __future__ import annotations

import numpy as np
import pytest

from objectmodels import BoxModel, CylinderModel, ModelError, ObjectModel, Registry
from objectmodels.geometry.base_shapes import Array
from objectmodels.mechanics.push_motion import (
    STROKE_SLACK,
    best_turn,
    learned_radius,
    turning_motion,
)

BOX = BoxModel(
    name="b",
    size=(0.08, 0.12, 0.2),
    com=(0.004, -0.006, 0.09),
    mass=1.0,
    friction=0.3,
    finger_friction=0.6,
    support="corners",
)
CAN = CylinderModel(name="c", radius=0.035, height=0.1, mass=0.4, friction=0.3, finger_friction=0.6)


def rotated(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def stepwise(
    model: ObjectModel, point: Array, normal: Array, slant: float, angle: float, steps: int
) -> tuple[Array, float]:
    """The same push by many short strokes of `ObjectModel.stroke`, each along the finger's way."""
    x, heading, travelled = np.zeros(2), 0.0, 0.0
    inward = np.arctan2(-normal[1], -normal[0])
    direction = np.array([np.cos(inward + slant), np.sin(inward + slant), 0.0])
    (rate,) = model.stroke([point], [normal], direction, 1e-6).pose[:, 2] / 1e-6
    h = angle / rate / steps
    for _ in range(steps):
        # A straight stroke whose direction is that of the arc half way leads along its chord.
        half = 0.5 * rate * h
        d = np.append(rotated(half) @ direction[:2], 0.0)
        dx, dy, turned = model.stroke([point], [normal], d, h).pose[0]
        x = x + rotated(heading) @ np.array([dx, dy])
        heading += turned
        travelled += h
    return np.array([*x, heading]), travelled


@pytest.mark.parametrize(
    ("model", "point", "normal", "slant", "angle"),
    [
        pytest.param(BOX, (-0.04, 0.04, 0.05), (-1.0, 0.0, 0.0), 0.5, -0.6, marks=pytest.mark.slow),
        (BOX, (-0.04, -0.04, 0.05), (-1.0, 0.0, 0.0), -0.3, 0.9),
        pytest.param(BOX, (0.02, 0.06, 0.05), (0.0, 1.0, 0.0), 0.2, -0.4, marks=pytest.mark.slow),
        (CAN, (-0.035, 0.0, 0.05), (-1.0, 0.0, 0.0), -0.6, 0.5),
    ],
)
def test_it_is_what_many_short_strokes_add_up_to(
    model: ObjectModel,
    point: tuple[float, float, float],
    normal: tuple[float, float, float],
    slant: float,
    angle: float,
) -> None:
    found = turning_motion(model, [point], [normal], slant, angle)
    assert found.is_successful.all()
    p, n = np.array(point), np.array(normal)
    pose, travel = stepwise(model, p, n, slant, angle, 40)
    # Each short stroke lets the direction swing in B by a fortieth of the turn: second order.
    np.testing.assert_allclose(found.pose[0], pose, atol=6e-5)
    assert found.travel[0] == pytest.approx(travel, rel=2e-4)


def test_the_pivot_stays_where_it_is() -> None:
    found = turning_motion(BOX, [[-0.04, 0.04, 0.05]], [[-1.0, 0.0, 0.0]], 0.4, [-0.7])
    x, y, angle = found.pose[0]
    pivot = found.pivot[0]
    np.testing.assert_allclose(np.array([x, y]) + rotated(angle) @ pivot, pivot, atol=1e-12)
    # c̄² is the product of the distances of pivot and line of force from the centre of mass.
    c = np.array(BOX.com[:2])
    force = np.array([np.cos(found.slant[0]), np.sin(found.slant[0])])
    r = np.array([-0.04, 0.04]) - c
    lever = abs(r[0] * force[1] - r[1] * force[0])
    product = float(np.linalg.norm(pivot - c)) * lever
    assert product == pytest.approx(BOX.friction_radius**2, rel=1e-9)


def test_a_round_side_is_turned_by_friction_alone() -> None:
    slants = np.radians([-30.0, 0.0, 30.0, 75.0])
    p, n = np.tile([-0.035, 0.0, 0.05], (4, 1)), np.tile([-1.0, 0.0, 0.0], (4, 1))
    found = turning_motion(CAN, p, n, slants, 0.5)
    assert found.turns.tolist() == [True, False, False, False]
    assert found.sticks.tolist() == [True, True, True, False]
    assert np.isnan(found.pose[~found.turns]).all()
    assert np.isinf(found.travel[~found.turns]).all()
    assert turning_motion(CAN, p, n, slants, -0.5).is_successful.tolist() == [
        False,
        False,
        True,
        False,
    ]
    lever = 0.035 * abs(np.sin(found.slant[0]))
    distance = np.linalg.norm(found.pivot[0])
    assert distance == pytest.approx(CAN.friction_radius**2 / lever, rel=1e-9)


def test_doubt_may_take_the_finger_off_its_friction_cone() -> None:
    unsure = BOX.model_copy(update={"finger_friction_sd": 0.2})
    contact = ([[-0.04, 0.04, 0.05]], [[-1.0, 0.0, 0.0]], 0.6, -0.5)
    assert turning_motion(unsure, *contact).is_successful.all()
    assert not turning_motion(unsure, *contact, sigmas=1.0).sticks.any()


@pytest.mark.parametrize("sense", [-1.0, 1.0])
def test_the_best_push_turns_with_least_translation(sense: float) -> None:
    face = BOX.faces()[2]
    best = best_turn(BOX, face, 0.4 * sense, 0.05)
    assert best is not None
    farthest = BOX.size[1] / 2.0 - 0.010
    assert abs(best.point[1]) == pytest.approx(farthest)
    assert best.stroke > best.travel + 0.99 * STROKE_SLACK
    moved = np.hypot(*best.pose[:2])
    # Nothing that surely sticks on a grid of contacts and directions does better.
    y, slant = (
        a.ravel()
        for a in np.meshgrid(
            np.linspace(-farthest, farthest, 41), np.radians(np.linspace(-80.0, 80.0, 321))
        )
    )
    p = np.column_stack((np.full(len(y), -0.04), y, np.full(len(y), 0.05)))
    others = turning_motion(
        BOX, p, np.tile(face.normal, (len(y), 1)), slant, 0.4 * sense, sigmas=1.0
    )
    sure = others.is_successful & (np.abs(np.tan(others.slant)) <= 0.9 * BOX.finger_friction)
    assert np.hypot(*others.pose[sure, :2].T).min() > 0.99 * moved


def test_a_chosen_push_still_sticks_to_a_finger_that_is_smoother_by_a_deviation() -> None:
    unsure = BOX.model_copy(update={"finger_friction_sd": 0.1})
    for angle in (-0.4, 0.4):
        best = best_turn(unsure, unsure.faces()[2], angle, 0.05)
        assert best is not None
        (n_x, n_y, _), (d_x, d_y, _) = best.normal, best.direction
        slant = np.arctan2(n_y * d_x - n_x * d_y, -n_x * d_x - n_y * d_y)
        shown = turning_motion(BOX, [best.point], [best.normal], slant, angle)
        # The force takes nine tenths of the friction that is left one deviation below belief.
        left = BOX.finger_friction - 0.1
        assert abs(np.tan(shown.slant[0])) == pytest.approx(0.9 * left, rel=1e-6)


def test_a_narrow_face_and_a_slippery_can_are_not_turned() -> None:
    slippery = CAN.model_copy(update={"finger_friction": 0.1, "finger_friction_sd": 0.1})
    assert best_turn(slippery, slippery.faces()[0], 0.3, 0.05) is None
    assert best_turn(CAN, CAN.faces()[0], 0.3, 0.05) is not None


@pytest.mark.parametrize("model", list(Registry.built_in()), ids=lambda m: m.name)
def test_everything_built_in_can_be_turned_both_ways(model: ObjectModel) -> None:
    for face in model.faces():
        for angle in (-0.3, 0.3):
            best = best_turn(model, face, angle, 0.03)
            assert best is not None
            assert best.pose[2] == angle
            assert np.dot(best.direction, best.normal) < 0.0


def test_what_makes_no_sense_is_refused() -> None:
    contact = ([[-0.04, 0.04, 0.05]], [[-1.0, 0.0, 0.0]])
    for slant, angle, sigmas in ((0.1, 0.0, 0.0), (np.nan, 0.1, 0.0), (0.1, 0.1, -1.0)):
        with pytest.raises(ModelError, match=r"must be|from 0 on"):
            turning_motion(BOX, *contact, slant, angle, sigmas=sigmas)
    with pytest.raises(ModelError, match="side faces"):
        turning_motion(BOX, [[0.0, 0.0, 0.2]], [[0.0, 0.0, 1.0]], 0.1, 0.1)


@pytest.mark.parametrize("true_radius", [0.03, 0.05, 0.07])
@pytest.mark.parametrize("angle", [-0.3, 0.6])
def test_a_turn_shows_the_friction_radius(true_radius: float, angle: float) -> None:
    believed = BOX.model_copy(update={"friction_radius": 0.04})
    true = BOX.model_copy(update={"friction_radius": true_radius})
    best = best_turn(believed, BOX.faces()[2], angle, 0.05)
    assert best is not None
    n, d = np.array(best.normal), np.array(best.direction)
    slant = np.arctan2(-n[0] * d[1] + n[1] * d[0], -n @ d)
    shown = turning_motion(true, [best.point], [n], slant, angle).pose[0]
    assert learned_radius(believed, best.point, d, shown) == pytest.approx(true_radius, rel=1e-9)
    # Never more than an object on its corners has, nor nothing.
    assert learned_radius(believed, best.point, d, [10.0, 10.0, angle]) <= np.hypot(0.04, 0.06)
    assert learned_radius(believed, best.point, d, [0.0, 0.0, angle]) > 0.01
    with pytest.raises(ModelError, match="did not turn"):
        learned_radius(believed, best.point, d, [0.01, 0.0, 0.0])


def test_a_stroke_allows_for_two_deviations_of_the_friction_radius() -> None:
    unsure = BOX.model_copy(update={"friction_radius": 0.03, "friction_radius_sd": 0.005})
    wide = BOX.model_copy(update={"friction_radius": 0.04, "friction_radius_sd": 0.0})
    best = best_turn(unsure, unsure.faces()[2], 0.4, 0.05)
    assert best is not None
    x, y, _ = best.direction
    n = best.normal
    slant = np.arctan2(-n[0] * y + n[1] * x, -n[0] * x - n[1] * y)
    longest = turning_motion(wide, [best.point], [n], slant, 0.4).travel.item()
    assert best.stroke == pytest.approx(longest + 0.005, rel=1e-6)

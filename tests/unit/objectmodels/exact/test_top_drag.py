"""Drags from above beside closed forms, the push of a heavier object, and sampled objects."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from objectmodels import BoxModel, ModelError
from objectmodels.exact.top_drag import (
    drag_probability,
    press_range,
    top_drag,
)

FEET = ((-0.07, -0.1), (0.07, -0.1), (0.07, 0.1), (-0.07, 0.1))


def book(**changes: Any) -> BoxModel:
    fields: dict[str, Any] = {
        "name": "book", "size": (0.15, 0.22, 0.03), "mass": 0.65, "friction": 0.3,
        "finger_friction": 0.6, "support": FEET,
    }  # fmt: skip
    return BoxModel(**fields | changes)


MIDDLE, LEFT = np.array([[0.0, 0.0, 0.03]]), np.array([[0.0, 1.0, 0.0]])


def test_over_the_centre_of_mass_the_least_force_is_that_of_the_closed_form() -> None:
    model = book()
    needed = model.friction * model.weight / (model.finger_friction - model.friction)
    found = press_range(model, MIDDLE[0], LEFT[0], 30.0)
    # The search halves its bracket of 2.4 N 14 times.
    assert found is not None
    np.testing.assert_allclose(np.array(found), np.array([needed, 30.0]), atol=2e-4)
    forces = np.array([0.99, 1.01]) * needed
    drag = top_drag(model, np.tile(MIDDLE, (2, 1)), np.tile(LEFT, (2, 1)), forces)
    assert drag.outcome.tolist() == ["slips", "drags"]
    np.testing.assert_allclose(
        np.hypot(*drag.force.T), model.friction * (model.weight + forces), rtol=1e-9
    )
    # Nothing turns: rates of more than a microradian per metre would be no rounding.
    np.testing.assert_allclose(drag.turn, 0.0, atol=1e-6)


def test_a_finger_that_is_smoother_than_the_table_never_drags() -> None:
    assert press_range(book(finger_friction=0.29), MIDDLE[0], LEFT[0], 100.0) is None


def test_the_force_is_that_of_a_push_on_a_heavier_object() -> None:
    """The exact tier finds the slide of an object of the weight G + N under the force it took."""
    model, press = book(com=(0.01, -0.02, 0.015)), 12.0
    points = np.array([[0.05, 0.03, 0.03], [-0.04, 0.08, 0.03], [0.02, -0.06, 0.03]])
    ways = np.array([[0.6, 0.8, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    drag = top_drag(model, points, ways, press)
    for point, force in zip(points, drag.force, strict=True):
        weight = model.weight + press
        com = (model.weight * np.array(model.com[:2]) + press * point[:2]) / weight
        heavy = book(mass=model.mass * weight / model.weight, com=(*com.tolist(), 0.015))
        size = float(np.hypot(*force))
        u = np.append(force / size, 0.0)
        slide = heavy.thresholds(point[None], u[None], exact=True).slide
        # What points at rest resist is left out below 1e-7 of the finger's speed.
        assert slide[0] == pytest.approx(size, rel=1e-5)


def test_a_drawn_edge_tips_where_the_pressure_leaves_the_base() -> None:
    """q = c' + h F / W, and the object drags with F = μ W: it tips from h μ beyond c' on."""
    # At the end of the base, drawn outwards: c' = N p / W is h μ short of the edge or nearer.
    model, press, edge = book(size=(0.15, 0.22, 0.08)), 40.0, 0.1
    weight = model.weight + press
    p = (edge - 0.08 * model.friction) * weight / press
    points = np.array([[0.0, p - 0.002, 0.08], [0.0, p + 0.002, 0.08]])
    drag = top_drag(model, points, np.tile(LEFT, (2, 1)), press)
    assert drag.outcome.tolist() == ["drags", "tips"]
    # Beyond its feet it tips by the pressing alone.
    beyond = np.array([[0.0, 0.13, 0.08]])
    assert top_drag(model, beyond, -LEFT, press).tip_ratio == 0.0


def test_drawn_from_ahead_it_turns_towards_the_way() -> None:
    """A contact to the right of the centre, led ahead, turns the object counter-clockwise."""
    drag = top_drag(book(), np.array([[0.06, 0.0, 0.03]]), LEFT, 10.0)
    assert drag.turn[0] > 1.0


def test_it_drags_below_the_critical_friction() -> None:
    model, points = book(), np.array([[0.05, 0.03, 0.03], [0.0, 0.095, 0.03]])
    ways = np.array([[0.6, 0.8, 0.0], [0.0, 1.0, 0.0]])
    critical = top_drag(model, points, ways, 12.0).critical_friction
    for point, way, limit in zip(points, ways, critical, strict=True):
        outcomes = [
            top_drag(book(friction=share * limit), point[None], way[None], 12.0).outcome[0]
            for share in (0.999, 1.001)
        ]
        assert outcomes[0] == "drags"
        assert outcomes[1] != "drags"


def test_the_probability_is_that_of_sampled_objects() -> None:
    sds: dict[str, Any] = {
        "mass_sd": 0.1, "friction_sd": 0.05, "finger_friction_sd": 0.08, "friction_radius_sd": 0.0
    }  # fmt: skip
    probability = drag_probability(book(**sds), MIDDLE, LEFT, 9.0)[0]
    z = np.random.default_rng(3).standard_normal((200_000, 3))
    mass, mu, finger = (np.array([0.65, 0.3, 0.6]) + z * [0.1, 0.05, 0.08]).T
    drags = mu * (mass * 9.80665 + 9.0) < finger * 9.0
    # A fixed sequence of 64 points is as good as some thousand random ones.
    assert probability == pytest.approx(drags.mean(), abs=0.02)
    assert 0.6 < probability < 0.95
    found = press_range(book(**sds), MIDDLE[0], LEFT[0], 30.0, 0.9)
    assert found is not None
    assert found[0] > 9.0
    at_it = drag_probability(book(**sds), MIDDLE, LEFT, found[0])[0]
    assert at_it == pytest.approx(0.9, abs=1e-4)  # where the halving ends


@pytest.mark.parametrize(
    ("direction", "press"), [([[0.0, 0.6, 0.8]], 5.0), ([[0.0, 1.0, 0.0]], -1.0),
                             ([[0.0, 1.0, 0.0]], [1.0, 2.0]), ([[0.0, 2.0, 0.0]], 5.0)],
)  # fmt: skip
def test_what_is_no_drag_is_refused(direction: Any, press: Any) -> None:
    with pytest.raises(ModelError) as error:
        top_drag(book(), MIDDLE, direction, press)
    assert error.value.code == "bad_array"

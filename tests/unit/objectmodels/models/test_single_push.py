"""A push by itself is predicted as it is among many, and refused as it is among many."""

from __future__ import annotations

from unittest.mock import Mock

import numpy as np
import pytest

from objectmodels import ModelError, ObjectModel, Registry
from objectmodels.geometry.base_shapes import Array
from objectmodels.mechanics import push_thresholds
from objectmodels.mechanics.push_thresholds import BLOCK, slide_threshold

MODELS = "ice tea box", "sugar box", "mug"


def pushes_of_all_kinds(model: ObjectModel, n: int) -> tuple[Array, Array]:
    """Contacts and unit directions, some of them straight up, down, or through the middle."""
    rng = np.random.default_rng(3)
    p = rng.uniform([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0], (n, 3)) * model.extents
    u = rng.normal(size=(n, 3)) * [1.0, 1.0, 0.7]
    u[:4] = [0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.3, 0.0, -1.0]
    p[2, 1] = model.com[1]
    return p, u / np.linalg.norm(u, axis=1, keepdims=True)


@pytest.mark.parametrize("name", MODELS)
def test_one_push_is_predicted_as_among_many(name: str) -> None:
    model = Registry.built_in().get(name)
    p, u = pushes_of_all_kinds(model, 150)
    f = u * np.linspace(0.0, model.weight, len(u))[:, None]
    t, told = model.thresholds(p, u), model.predict(p, f)
    for i in range(len(p)):
        one, other = model.thresholds(p[i : i + 1], u[i : i + 1]), model.predict(p[[i]], f[[i]])
        # The same operations in the same order, but for those that look closer.
        np.testing.assert_allclose(one.slide, t.slide[[i]], rtol=1e-12)
        np.testing.assert_allclose(one.topple, t.topple[[i]], rtol=1e-12)
        np.testing.assert_allclose(other.margin, told.margin[[i]], rtol=1e-9)  # a difference
        assert one.outcome[0] == t.outcome[i]
        assert other.outcome[0] == told.outcome[i]
        np.testing.assert_allclose(one.twist, t.twist[[i]], rtol=1e-9, atol=1e-12)


def test_one_push_takes_no_arrays_but_seldom(monkeypatch: pytest.MonkeyPatch) -> None:
    model = Registry.built_in().get("ice tea box")
    p, u = pushes_of_all_kinds(model, 400)
    looks = Mock(side_effect=slide_threshold)
    monkeypatch.setattr(push_thresholds, "slide_threshold", looks)
    for i in range(len(p)):
        model.thresholds(p[[i]], u[[i]])
    assert looks.call_count <= 8  # pushes with two roots, and such as go straight up or down


def test_one_push_is_refused_as_among_many() -> None:
    model = Registry.built_in().get("ice tea box")
    p, u = np.array([[0.0, -0.03, 0.1]]), np.array([[0.0, 1.0, 0.0]])
    for point, direction, code in (
        (p + 1.0, u, "off_object"),
        (p, 1.01 * u, "bad_array"),
        (p * np.nan, u, "bad_array"),
        (p, np.full((1, 3), np.inf), "bad_array"),
        (p[0], u[0], "bad_array"),
    ):
        with pytest.raises(ModelError) as caught:
            model.thresholds(point, direction)
        assert caught.value.code == code
    with pytest.raises(ModelError):
        model.predict(p, np.array([[0.0, np.nan, 0.0]]))
    with pytest.raises(ModelError):
        model.thresholds(p, u, friction="kinetic")


def test_many_pushes_are_predicted_as_few() -> None:
    model = Registry.built_in().get("mug")
    p, u = pushes_of_all_kinds(model, BLOCK + 7)
    many, last = model.thresholds(p, u), model.thresholds(p[BLOCK:], u[BLOCK:])
    np.testing.assert_allclose(many.slide[BLOCK:], last.slide, rtol=1e-12)
    np.testing.assert_allclose(many.topple[BLOCK:], last.topple, rtol=1e-12)


def test_what_has_no_friction_slides_at_once() -> None:
    box = Registry.built_in().get("ice tea box").model_copy(update={"friction": 0.0})
    p, u = np.array([[0.0, -0.03, 0.1]] * 2), np.array([[0.0, 1.0, 0.0], [0.6, 0.0, -0.8]])
    assert box.thresholds(p, u).slide.tolist() == [0.0, 0.0]
    assert box.thresholds(p[:1], u[:1]).slide.item() == 0.0

"""Slides found at once for a set of loaded points are those found in brackets."""

from __future__ import annotations

import numpy as np
import pytest

from objectmodels import BoxModel
from objectmodels.exact import slide_search
from objectmodels.exact.slide_search import Stretch, slides_on


@pytest.mark.parametrize("radius", [1.0, 0.7, 1.3])
def test_slides_are_those_of_the_brackets(radius: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Feet that lift and land, as they come, and with a fitted friction radius."""
    for number in range(8):
        rng = np.random.default_rng((31, number))
        feet = rng.uniform(-0.06, 0.06, (int(rng.integers(3, 9)), 2))
        com = (*(rng.dirichlet(np.ones(len(feet))) @ feet), 0.1)
        stated = {"friction": rng.uniform(0.1, 1.2), "com": com, "support": feet}
        box = BoxModel.model_validate(
            {"name": "b", "size": (0.12, 0.12, 0.2), "mass": 1.0, **stated}
        )
        box = box.model_copy(update={"friction_radius": radius * box.friction_radius})
        p = np.array(box.size) * rng.uniform([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0], (60, 3))
        u = rng.normal(size=(60, 3)) * [1.0, 1.0, rng.choice([0.3, 1.0])]
        u /= np.linalg.norm(u, axis=1, keepdims=True)
        found = box.thresholds(p, u, exact=True)
        with monkeypatch.context() as patched:
            patched.setattr(slide_search, "_STRETCHES", 0)
            sought = box.thresholds(p, u, exact=True)
        np.testing.assert_array_equal(found.code, sought.code)
        np.testing.assert_allclose(found.slide, sought.slide, rtol=1e-9)  # ten times the limit's
        slides = found.code == 1
        np.testing.assert_allclose(found.twist[slides], sought.twist[slides], rtol=1e-5, atol=1e-5)


def test_what_surely_holds_needs_no_look(monkeypatch: pytest.MonkeyPatch) -> None:
    """One of these pushes slides before the ratio at which it would slide or topple again."""
    earlier = 0
    for number in range(33, 37):
        rng = np.random.default_rng((32, number))
        feet = rng.uniform(-0.06, 0.06, (8, 2))
        com = (*(rng.dirichlet(np.full(8, 0.2)) @ feet), 0.1)
        stated = {"size": (0.12, 0.12, 0.2), "friction": 0.5, "com": com, "support": feet}
        box = BoxModel.model_validate({"name": "b", "mass": 1.0, **stated})
        p = np.array(box.size) * rng.uniform([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0], (50, 3))
        u = rng.normal(size=(50, 3)) * [1.0, 1.0, 3.0]
        u /= np.linalg.norm(u, axis=1, keepdims=True)
        slide = [box.thresholds(p, u, exact=True).slide]
        for answer in (np.zeros, np.ones):
            with monkeypatch.context() as patched:
                patched.setattr(
                    slide_search.SlideSearch, "_surely_hold",
                    lambda self, r, held, i, answer=answer: answer(i.size, dtype=bool),
                )  # fmt: skip
                slide.append(box.thresholds(p, u, exact=True).slide)
        np.testing.assert_array_equal(slide[0], slide[1])
        earlier += (slide[0] != slide[2]).sum()
    assert earlier > 0


def test_a_heavily_loaded_point_is_turned_about() -> None:
    """The push grows until the friction of the three others gives way, in a lever's ratio."""
    along, left = np.array([[0.0, 1.0, 0.0, 1.0]]).T, np.array([[1.0, 1.0, 2.0, 2.0]]).T
    loads, still = np.array([[0.97, 0.01, 0.01, 0.01]]).T, np.zeros((4, 1))
    one, zero = np.ones(1), np.zeros(1)
    place = np.hstack((along, left))
    distances = np.hypot(*np.moveaxis(place[:, None] - place, 2, 0))
    stretch = Stretch(0.5 * one, loads, still, along, left, zero, demand=one, last=2.0 * one)
    ratio, limit = slides_on(stretch, distances, patient=False)
    assert ratio.item() == pytest.approx(0.01 * (2.0 + np.sqrt(2.0)), rel=1e-12)
    assert limit.residual.item() == 0.0
    slip = limit.slip_velocities(along, left)
    np.testing.assert_allclose(np.hypot(*slip)[0], 0.0, atol=1e-15)


def test_a_push_that_holds_has_the_last_ratio() -> None:
    """Straight through the middle of four equal loads all friction resists: r |u_xy| / μ = 1."""
    along, left = np.array([[1.0, 1.0, -1.0, -1.0]]).T, np.array([[1.0, -1.0, 1.0, -1.0]]).T
    place = np.hstack((along, left))
    distances = np.hypot(*np.moveaxis(place[:, None] - place, 2, 0))
    for last in (0.9, 1.1):
        one, loads = np.ones(1), np.full((4, 1), 0.25)
        stretch = Stretch(0.5 * one, loads, 0.0 * loads, along, left, 0.0 * one, one, last * one)
        ratio, limit = slides_on(stretch, distances, patient=False)
        assert ratio.item() == pytest.approx(min(last, 1.0), rel=1e-12)
        assert limit.ratio.item() == pytest.approx(1.0, rel=1e-12)

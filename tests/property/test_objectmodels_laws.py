"""Laws that the thresholds obey, whatever the object and the push."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from objectmodels import BoxModel, CylinderModel, ObjectModel, PrismModel, Thresholds
from objectmodels.geometry.base_shapes import Array
from objectmodels.mechanics.push_thresholds import (
    centre_of_pressure,
    critical_friction,
    topple_threshold,
    yaw_arm,
)
from tests.sizes import examples

PUSHES = 20

Model = TypeVar("Model", bound=ObjectModel)


@st.composite
def boxes(draw: st.DrawFn) -> BoxModel:
    length = st.floats(0.02, 0.3)
    share = st.floats(-0.4, 0.4)
    size = (draw(length), draw(length), draw(length))
    com = (draw(share) * size[0], draw(share) * size[1], draw(st.floats(0.1, 0.9)) * size[2])
    return BoxModel(
        name="b",
        size=size,
        com=com,
        mass=draw(st.floats(0.02, 5.0)),
        friction=draw(st.floats(0.05, 1.2)),
        support=draw(st.sampled_from(["corners", "uniform"])),
    )


@st.composite
def prisms(draw: st.DrawFn) -> PrismModel:
    """Prisms whose corners lie on a circle around the origin, at random angles."""
    k, seed = draw(st.integers(3, 8)), draw(st.integers(0, 2**32 - 1))
    rng = np.random.default_rng(seed)
    # One corner in each of k sectors, which keeps the origin inside.
    turns = 2 * np.pi * (np.arange(k) + rng.uniform(0.35, 0.65, k)) / k
    radius, height = draw(st.floats(0.02, 0.15)), draw(st.floats(0.03, 0.3))
    corners = radius * np.column_stack((np.cos(turns), np.sin(turns)))
    share = rng.dirichlet(np.full(k, 3.0)) @ corners
    x, y = (0.4 * share).tolist()
    return PrismModel(
        name="p",
        corners=tuple((a, b) for a, b in corners.tolist()),
        height=height,
        com=(x, y, draw(st.floats(0.1, 0.9)) * height),
        mass=draw(st.floats(0.02, 5.0)),
        friction=draw(st.floats(0.05, 1.2)),
        support=draw(st.sampled_from(["corners", "uniform"])),
    )


@st.composite
def cylinders(draw: st.DrawFn) -> CylinderModel:
    radius, height = draw(st.floats(0.02, 0.15)), draw(st.floats(0.03, 0.3))
    share = st.floats(-0.5, 0.5)
    com = (draw(share) * radius, draw(share) * radius, draw(st.floats(0.1, 0.9)) * height)
    return CylinderModel(
        name="c",
        radius=radius,
        height=height,
        com=com,
        mass=draw(st.floats(0.02, 5.0)),
        friction=draw(st.floats(0.05, 1.2)),
        support=draw(st.sampled_from(["corners", "uniform"])),
    )


models = st.one_of(boxes(), prisms(), cylinders())


def pushes(box: ObjectModel, seed: int) -> tuple[Array, Array]:
    """Random contacts on and in the box, random directions, a third of them horizontal."""
    rng = np.random.default_rng(seed)
    p = np.array(box.extents) * rng.uniform([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0], (PUSHES, 3))
    u = rng.normal(size=(PUSHES, 3))
    u[::3, 2] = 0.0
    return p, u / np.linalg.norm(u, axis=1, keepdims=True)


seeds = st.integers(0, 2**32 - 1)


def changed(box: Model, **values: object) -> Model:
    return type(box)(**(box.model_dump(exclude={"friction_radius", "friction_radius_sd"}) | values))


def same(a: Thresholds, b: Thresholds, scale: float = 1.0, rtol: float = 1e-9) -> None:
    # Forces of some newtons; roots are found to a few units in the last place.
    np.testing.assert_allclose(scale * a.slide, b.slide, rtol=rtol)
    np.testing.assert_allclose(scale * a.topple, b.topple, rtol=rtol)
    with np.errstate(invalid="ignore"):  # neither ever happens
        decided = ~(np.abs(a.slide - a.topple) <= 1e-6 * a.onset)  # rounding may cross the border
    np.testing.assert_array_equal(a.outcome[decided], b.outcome[decided])


@given(models, seeds, st.floats(0.1, 10.0))
def test_mass_scales_forces_and_no_class(box: ObjectModel, seed: int, factor: float) -> None:
    p, u = pushes(box, seed)
    heavier = changed(box, mass=factor * box.mass)
    same(box.thresholds(p, u), heavier.thresholds(p, u), factor)


@given(boxes(), seeds, st.floats(0.2, 5.0))
def test_size_scales_no_force(box: BoxModel, seed: int, factor: float) -> None:
    p, u = pushes(box, seed)
    size, com = (tuple(factor * x for x in v) for v in (box.size, box.com))
    same(box.thresholds(p, u), changed(box, size=size, com=com).thresholds(factor * p, u))


@given(boxes(), seeds)
def test_mirror_image_behaves_alike(box: BoxModel, seed: int) -> None:
    p, u = pushes(box, seed)
    mirror = np.array([1.0, -1.0, 1.0])
    image = changed(box, com=(box.com[0], -box.com[1], box.com[2]))
    t, m = box.thresholds(p, u), image.thresholds(p * mirror, u * mirror)
    same(t, m)
    decided = ~np.isnan(t.twist[:, 0]) & ~np.isnan(m.twist[:, 0])
    # Angular velocities are axial vectors: a mirror turns the other components about.
    reflected = m.twist * [-1.0, 1.0, -1.0, 1.0, -1.0, 1.0]
    np.testing.assert_allclose(t.twist[decided], reflected[decided], rtol=1e-6, atol=1e-9)


@given(boxes(), seeds)
def test_a_quarter_turn_of_the_frame_changes_nothing(box: BoxModel, seed: int) -> None:
    p, u = pushes(box, seed)
    turn = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    (x, y, z), (a, b, c) = box.size, box.com
    turned = changed(box, size=(y, x, z), com=(b, -a, c))
    same(box.thresholds(p, u), turned.thresholds(p @ turn.T, u @ turn.T))


@given(models, seeds, st.floats(1.0, 3.0))
def test_more_friction_holds_longer_and_tips_no_later(
    box: ObjectModel, seed: int, factor: float
) -> None:
    p, u = pushes(box, seed)
    smooth, rough = box.thresholds(p, u), changed(box, friction=factor * box.friction)
    t = rough.thresholds(p, u)
    assert (t.slide >= smooth.slide * (1 - 1e-12)).all()  # rounding of the root
    np.testing.assert_array_equal(t.topple, smooth.topple)
    assert not ((smooth.outcome == "topple") & (t.outcome == "slide")).any()


@given(models, seeds)
def test_yaw_never_makes_sliding_harder(box: ObjectModel, seed: int) -> None:
    p, u = pushes(box, seed)
    straight = box.model_copy(update={"friction_radius": 1e9})
    assert (
        box.thresholds(p, u).slide <= straight.thresholds(p, u).slide * (1 + 1e-9)
    ).all()  # arms of 0.1 m over 1e9 m still leave a share of 1e-20


@given(models, seeds)
def test_a_single_push_tips_before_it_lifts(box: ObjectModel, seed: int) -> None:
    p, u = pushes(box, seed)
    t = box.thresholds(p, u)
    pulls = u[:, 2] > 0
    assert (t.onset[pulls] * u[pulls, 2] <= box.weight * (1 + 1e-12)).all()


@settings(
    max_examples=examples(40), deadline=None
)  # the exact tier on even pressure takes its time
@given(prisms(), seeds, st.floats(-np.pi, np.pi))
def test_any_turn_of_the_frame_changes_nothing(prism: PrismModel, seed: int, angle: float) -> None:
    p, u = pushes(prism, seed)
    c, s = np.cos(angle), np.sin(angle)
    R = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    corners = (np.array(prism.corners) @ R[:2, :2].T).tolist()
    turned = changed(prism, corners=corners, com=(R @ np.array(prism.com)).tolist())
    same(prism.thresholds(p, u), turned.thresholds(p @ R.T, u @ R.T))
    few = slice(0, 3)
    exact = prism.thresholds(p[few], u[few], exact=True)
    # Limits are found to 1e-10, the onsets of far pushes to less.
    same(exact, turned.thresholds(p[few] @ R.T, u[few] @ R.T, exact=True), rtol=1e-7)


@given(cylinders(), seeds, st.floats(-np.pi, np.pi))
def test_a_round_object_may_be_turned(can: CylinderModel, seed: int, angle: float) -> None:
    p, u = pushes(can, seed)
    c, s = np.cos(angle), np.sin(angle)
    R = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    turned = changed(can, com=(R @ np.array(can.com)).tolist())
    same(can.thresholds(p, u), turned.thresholds(p @ R.T, u @ R.T))


@settings(max_examples=examples(40), deadline=None)
@given(st.one_of(boxes(), prisms()), seeds, st.floats(1.1, 3.0))
def test_the_exact_tier_obeys_the_same_laws(box: ObjectModel, seed: int, factor: float) -> None:
    assume(box.support == "corners")
    p, u = pushes(box, seed)
    t = box.thresholds(p, u, exact=True)
    heavy = changed(box, mass=factor * box.mass).thresholds(p, u, exact=True)
    same(t, heavy, factor, rtol=1e-7)
    rough = changed(box, friction=factor * box.friction).thresholds(p, u, exact=True)
    assert (rough.onset >= t.onset * (1 - 1e-8)).all()
    assert not ((t.outcome == "topple") & (rough.outcome == "slide")).any()


@given(boxes(), seeds)
def test_the_centre_of_pressure_is_on_the_edge_when_it_tips(box: BoxModel, seed: int) -> None:
    p, u = pushes(box, seed)
    t = box.thresholds(p, u)
    loaded = np.isfinite(t.topple)
    loaded[loaded] &= box.weight - t.topple[loaded] * u[loaded, 2] > 1e-3 * box.weight
    # Very far thresholds lose digits: a push of a thousand weights is no push.
    loaded &= t.topple < 1e3 * box.weight
    assume(loaded.any())
    p, s, edge = p[loaded], t.topple[loaded], t.edge[loaded]
    q = centre_of_pressure(p, s[:, None] * u[loaded], np.array(box.com), box.weight)
    x, y = box.size[0] / 2, box.size[1] / 2
    beyond = np.column_stack((q[:, 0] - x, q[:, 1] - y, -q[:, 0] - x, -q[:, 1] - y))
    # Of a base of centimetres; loads of a thousandth of the weight lose three digits.
    np.testing.assert_allclose(beyond[np.arange(len(edge)), edge], 0.0, atol=1e-9)
    assert (beyond < 1e-9).all()


@given(models, seeds)
def test_critical_friction_decides_the_class(box: ObjectModel, seed: int) -> None:
    p, u = pushes(box, seed)
    t = box.thresholds(p, u)
    c = np.array(box.com)
    topple = topple_threshold(box.base, p, u, c, box.weight)
    limit = critical_friction(u, yaw_arm(p, u, c), topple, box.friction_radius, box.weight)
    clear = np.abs(limit / box.friction - 1) > 1e-6  # either side of the border
    slides = (t.outcome == "slide")[clear]
    np.testing.assert_array_equal(slides, (box.friction < limit)[clear])


@settings(max_examples=examples(30))
@given(boxes(), seeds, st.floats(0.1, 1.0))
def test_cone_extremes_hold_for_any_direction_in_the_cone(
    box: BoxModel, seed: int, finger: float
) -> None:
    rng = np.random.default_rng(seed)
    box = box.model_copy(update={"finger_friction": finger})
    face = box.faces()[seed % 4]
    p = np.array(face.centre) * [1.0, 1.0, 0.0] + rng.uniform(-0.4, 0.4) * face.width * np.array(
        face.tangent
    )
    p[2] = rng.uniform(0.05, 1.0) * face.height
    c = box.cone_thresholds(p[None], np.array(face.normal)[None])
    phi, share = rng.uniform(0, 2 * np.pi, 200), finger * np.sqrt(rng.random(200))
    f = -np.array(face.normal) + share[:, None] * (
        np.cos(phi)[:, None] * np.array(face.tangent) + np.sin(phi)[:, None] * [0.0, 0.0, 1.0]
    )
    length = np.linalg.norm(f, axis=1)
    t = box.thresholds(np.tile(p, (200, 1)), f / length[:, None])
    later = (t.topple - t.slide) / length if c.slides or c.topples else np.zeros(200)
    if c.slides.item():
        # Refined margins: 0.1 % of the weight covers the search's last step.
        assert later.min() >= c.slide_margin.item() - 1e-3 * box.weight
    if c.topples.item():
        assert (-later).min() >= c.topple_margin.item() - 1e-3 * box.weight


def test_an_example_for_each_class() -> None:
    """The random pushes above meet every class, so that none of the laws is empty."""
    box = BoxModel(name="b", size=(0.1, 0.1, 0.2), mass=1.0, friction=0.5)
    outcomes = np.concatenate([box.thresholds(*pushes(box, seed)).outcome for seed in range(20)])
    assert set(outcomes) == {"none", "slide", "topple"}


@pytest.mark.parametrize("seed", range(3))
def test_equal_questions_get_equal_answers(seed: int) -> None:
    box = BoxModel(name="b", size=(0.1, 0.1, 0.2), mass=1.0, friction=0.5)
    p, u = pushes(box, seed)
    a, b = box.thresholds(p, u), box.thresholds(p[::-1], u[::-1])
    np.testing.assert_array_equal(a.slide, b.slide[::-1])
    np.testing.assert_array_equal(a.outcome, b.outcome[::-1])

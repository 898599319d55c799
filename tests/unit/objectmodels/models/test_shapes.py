"""Kinds of models: shapes that are the same behave the same, and every face is where it looks."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from objectmodels import (
    BoxModel,
    CylinderModel,
    HullModel,
    ModelError,
    ObjectModel,
    PrismModel,
    Registry,
    Thresholds,
)
from objectmodels.geometry.base_shapes import Array, Polygon

COMMON: dict[str, Any] = {
    "name": "x", "mass": 0.8, "friction": 0.35, "com": (0.006, -0.004, 0.07),
}  # fmt: skip
BOX = BoxModel(size=(0.08, 0.06, 0.15), **COMMON)
PRISM = PrismModel(
    corners=((0.04, -0.03), (0.04, 0.03), (-0.04, 0.03), (-0.04, -0.03)), height=0.15, **COMMON
)
HULL = HullModel(
    vertices=tuple((x, y, z) for x in (-0.04, 0.04) for y in (-0.03, 0.03) for z in (0.0, 0.15)),
    **COMMON,
)
CAN = CylinderModel(name="can", radius=0.033, height=0.115, mass=0.35, friction=0.3)


def pushes(model: ObjectModel, n: int = 200, seed: int = 0) -> tuple[Array, Array]:
    rng = np.random.default_rng(seed)
    p = np.array(model.extents) * rng.uniform([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0], (n, 3))
    u = rng.normal(size=(n, 3))
    return p, u / np.linalg.norm(u, axis=1, keepdims=True)


def same(a: Thresholds, b: Thresholds, rel: float = 1e-9) -> None:
    np.testing.assert_allclose(a.slide, b.slide, rtol=rel)
    np.testing.assert_allclose(a.topple, b.topple, rtol=rel)
    np.testing.assert_array_equal(a.outcome, b.outcome)


@pytest.mark.parametrize("other", [PRISM, HULL])
@pytest.mark.parametrize("support", ["corners", "uniform"])
def test_a_box_is_a_prism_is_a_hull(other: ObjectModel, support: str) -> None:
    box = BoxModel(**(BOX.model_dump(include={*COMMON, "size"}) | {"support": support}))
    names = {*COMMON, "corners", "height", "vertices"}
    twin = type(other)(**(other.model_dump(include=names) | {"support": support}))
    p, u = pushes(box)
    same(box.thresholds(p, u), twin.thresholds(p, u))  # rounding
    exact = box.thresholds(p[:40], u[:40], exact=True)
    # Corners come in another order; limits are found to 1e-10.
    same(exact, twin.thresholds(p[:40], u[:40], exact=True), rel=1e-8)
    decided = ~np.isnan(exact.twist[:, 0])
    np.testing.assert_allclose(
        exact.twist[decided], twin.thresholds(p[:40], u[:40], exact=True).twist[decided], atol=1e-5
    )
    assert box.angle_of_no_return([1, 0, 0]) == pytest.approx(twin.angle_of_no_return([1, 0, 0]))


def test_a_round_base_is_the_limit_of_polygons() -> None:
    p, u = pushes(CAN)
    errors = []
    for k in (24, 96, 384):
        turns = 2 * np.pi * np.arange(k) / k
        corners = 0.033 * np.column_stack((np.cos(turns), np.sin(turns)))
        polygon = PrismModel(
            name="p", corners=corners.tolist(), height=0.115, mass=0.35, friction=0.3
        )
        t, r = CAN.thresholds(p, u), polygon.thresholds(p, u)
        both = np.isfinite(t.topple) & np.isfinite(r.topple) & (t.topple < 1e2)
        errors.append(np.abs(r.topple[both] / t.topple[both] - 1.0).max())
    # The polygon lies inside by a share that falls with the square of its sides.
    assert errors[0] > 5 * errors[1] > 25 * errors[2]
    assert errors[2] < 1e-3


def test_critical_height_of_a_can_is_radius_over_friction_all_around() -> None:
    for face in CAN.faces(np.linspace(-3.0, 3.0, 9)):
        p, n = face.points_at([0.0], [0.05])
        cone = CAN.cone_thresholds(p, n)
        assert cone.critical_height.item() == pytest.approx(0.033 / 0.3, rel=1e-9)  # b/μ
        np.testing.assert_allclose(np.hypot(*p[0, :2]), 0.033, rtol=1e-12)


@pytest.mark.parametrize("name", ["ice tea box", "mug", "soup can", "tea tin", "book"])
def test_faces_lie_on_the_outside(name: str) -> None:
    model = Registry.built_in().get(name)
    for face in model.faces():
        lateral, height = face.grid(0.007)
        p, n = face.points_at(lateral, height)
        assert face.contains(lateral, height).all()
        np.testing.assert_allclose(np.linalg.norm(n, axis=1), 1.0)
        beyond = (model.outline @ n[:, :2].T).max(axis=0) - np.sum(p[:, :2] * n[:, :2], axis=1)
        # A round outline is a polygon around the circle, up to 0.9 % larger.
        assert (beyond >= -1e-12).all()
        assert (beyond <= 0.01 * model.extents[0]).all()


def test_slanted_faces_of_a_hull() -> None:
    """A truncated pyramid: its sides lean inwards by atan(0.02 / 0.1)."""
    pot = HullModel(
        name="pot",
        mass=1.0,
        friction=0.4,
        vertices=tuple(
            (x * s, y * s, z)
            for x in (-1, 1)
            for y in (-1, 1)
            for s, z in ((0.06, 0.0), (0.04, 0.1))
        ),
    )
    faces = pot.faces()
    assert len(faces) == 4
    for face in faces:
        assert face.normal[2] == pytest.approx(np.sin(np.arctan(0.2)), rel=1e-9)
        p, n = face.points_at([0.0, 0.0], [0.0, 0.1])
        np.testing.assert_allclose(np.abs(p[:, :2]).max(axis=1), [0.06, 0.04], atol=1e-12)
        assert not face.contains(0.055, 0.09)
        assert face.contains(0.055, 0.005)
        cone = pot.cone_thresholds(p[1:], n[1:])
        assert np.isfinite(cone.slide_max).all()
    # The centre of a frustum's volume: h/4 (A + 2 sqrt(A B) + 3 B) / (A + sqrt(A B) + B).
    a, b = 0.12**2, 0.08**2
    m = np.sqrt(a * b)
    assert pot.centre[2] == pytest.approx(0.025 * (a + 2 * m + 3 * b) / (a + m + b), rel=1e-9)


def test_a_box_lies_on_any_face() -> None:
    tea = Registry.built_in().get("ice tea box")
    assert isinstance(tea, BoxModel)
    lying = tea.model_on_face("front")
    assert lying.extents == pytest.approx((0.23, 0.09, 0.09), rel=1e-12)
    np.testing.assert_allclose(lying.com, (0.0, 0.0, 0.045), atol=1e-12)
    assert lying.com_sd[0] == tea.com_sd[2]
    # Lying it cannot be tilted along either way (h* > 0.09 m at μ = 0.378).
    for face in lying.faces():
        p, n = face.points_at([0.0], [0.085])
        assert np.isinf(lying.cone_thresholds(p, n).critical_height).all()
    assert tea.model_on_face("bottom") is tea
    off = BoxModel(name="b", size=(0.1, 0.2, 0.3), mass=1.0, friction=0.4, com=(0.02, -0.03, 0.1))
    # On its left side what was up looks left… the centre of mass keeps its distance to each face.
    for side, height in (("front", 0.07), ("back", 0.03), ("left", 0.13), ("right", 0.07)):
        assert off.model_on_face(side).com[2] == pytest.approx(height, rel=1e-9)
    with pytest.raises(ModelError, match="cannot rest"):
        tea.model_on_face("lid")


def test_a_hull_lies_like_the_box_that_it_is() -> None:
    lying = {rest.face: rest.model for rest in HULL.rests if rest.face.startswith("face")}
    heights = sorted(round(model.top, 9) for model in lying.values())
    assert heights == [0.06, 0.06, 0.08, 0.08, 0.15]
    for model in lying.values():
        box = min(
            (rest.model for rest in BOX.rests),
            key=lambda b: abs(b.com[2] - model.com[2]) + abs(b.top - model.top),
        )
        assert model.com[2] == pytest.approx(box.com[2], abs=1e-9)
        for m in (model, box):
            assert m.friction_radius == pytest.approx(box.friction_radius, rel=1e-6)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]}, "plane"),
        ({"vertices": [[0, 0, 0], [1, 0, 1], [0, 1, 1], [-1, -1, 1]]}, "does not stand"),
        ({"vertices": [[1, 0, 0.1], [0, 1, 0.1], [-1, -1, 0.1], [0, 0, 1]]}, "lowest"),
        ({"vertices": [[1, 0, 0], [2, 1, 0], [2, -1, 0], [1.5, 0, 1]]}, "origin"),
    ],
)
def test_hulls_that_do_not_stand_are_refused(change: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        HullModel(**({"name": "h", "mass": 1.0, "friction": 0.4} | change))  # type: ignore[arg-type]


def test_a_fitted_friction_radius_moves_the_exact_tier_too() -> None:
    p, u = np.array([[-0.04, 0.02, 0.01]]), np.array([[1.0, 0.0, 0.0]])
    loose, tight = (
        BoxModel(**(BOX.model_dump(include={*COMMON, "size"}) | {"friction_radius": r}))
        for r in (0.015, 0.04)
    )
    for exact in (False, True):
        slides = [m.thresholds(p, u, exact=exact).slide.item() for m in (loose, tight)]
        assert slides[0] < 0.9 * slides[1]
    assert tight.thresholds(p, u, exact=True).residual.item() < 1e-8


def test_static_and_kinetic_friction_are_kept_apart() -> None:
    coffee = Registry.built_in().get("coffee box")
    p, u = [[-0.031, 0.0, 0.05]], [[1.0, 0.0, 0.0]]
    still, moving = coffee.thresholds(p, u), coffee.thresholds(p, u, friction="kinetic")
    assert (still.friction, moving.friction) == ("static", "kinetic")
    assert moving.slide.item() / still.slide.item() == pytest.approx(0.2403 / 0.3133, rel=1e-9)
    with pytest.raises(ModelError, match="kinetic friction"):
        BOX.thresholds(p, u, friction="kinetic")


def test_finger_slips_outside_its_cone() -> None:
    n = np.tile([-1.0, 0.0, 0.0], (4, 1))
    forces = [[1.0, 0.0, 0.5], [1.0, 0.5, 0.5], [1.0, 0.0, -0.7], [-1.0, 0.0, 0.0]]
    rough = BOX.model_copy(update={"finger_friction": 0.6, "finger_friction_kinetic": 0.4})
    assert rough.is_slipping(n, forces).tolist() == [False, True, True, True]
    assert rough.is_slipping(n, forces, friction="kinetic").tolist() == [True, True, True, True]


@pytest.mark.parametrize("model", [BOX, HULL, PRISM, Registry.built_in().get("tea tin")])
def test_the_pose_picks_the_base(model: ObjectModel) -> None:
    """Turned so that a face is below, it lies as that face's frame says."""
    assert len(model.rests) >= 6
    for number, rest in enumerate(model.rests):
        yaw = Rotation.from_euler("z", 0.7 * number).as_matrix()
        R_WB = yaw @ rest.R_BN.T
        found = model.resting_face(R_WB)
        assert found.face == rest.face
        np.testing.assert_allclose(R_WB @ found.R_BN, yaw, atol=1e-9)  # N is upright in W
        # The same centre of mass, once in each frame.
        com = found.p_BN + found.R_BN @ np.array(found.model.com)
        np.testing.assert_allclose(com, model.com, atol=1e-9)
        assert found.model.extents[2] == pytest.approx(found.model.top)
        # A pose of the face tells that of the body, and it stands as the model does.
        R_WN, p_WN = found.lying_pose(R_WB, np.array([0.3, 0.1, 0.2]))
        R_back, p_back = found.body_pose(R_WN, p_WN)
        np.testing.assert_allclose(R_back, R_WB, atol=1e-9)
        np.testing.assert_allclose(p_back, [0.3, 0.1, 0.2], atol=1e-9)
        np.testing.assert_allclose(R_WN @ found.foot, -R_WB[:, 2], atol=1e-9)
        assert found.standing is model
        leaning = Rotation.from_euler("x", np.radians(25.0)).as_matrix() @ R_WB
        with pytest.raises(ModelError, match="leans"):
            model.resting_face(leaning)


def test_a_can_lies_nowhere_else_than_on_its_base() -> None:
    assert [rest.face for rest in CAN.rests] == ["bottom"]
    with pytest.raises(ModelError, match="rests on: bottom"):
        CAN.resting_face(Rotation.from_euler("x", np.pi / 2).as_matrix())
    for wrong in (np.eye(2), 2 * np.eye(3), np.diag([1.0, 1.0, -1.0])):
        with pytest.raises(ModelError, match="rotation matrix"):
            CAN.resting_face(wrong)


@pytest.mark.parametrize("model", list(Registry.built_in()), ids=lambda model: model.name)
def test_bare_shape_is_the_models_without_its_figures(model: ObjectModel) -> None:
    bare = model.bare_shape()
    assert not isinstance(bare, ObjectModel)
    assert (bare.extents, bare.gyration, bare.top) == (model.extents, model.gyration, model.top)
    np.testing.assert_array_equal(bare.outline, model.outline)
    assert [face.centre for face in bare.faces()] == [face.centre for face in model.faces()]


@pytest.mark.parametrize("model", list(Registry.built_in()), ids=lambda model: model.name)
def test_points_and_columns_of_a_shape_keep_to_it(model: ObjectModel) -> None:
    outline, rounding = Polygon.convex(model.outline), 1e-12
    assert outline.contains(np.array(model.silhouette), rounding)
    assert outline.contains(np.array(model.crown), rounding)
    assert model.footprint.contains(np.array(model.feet), rounding)
    for column in model.columns:
        assert outline.contains(column.outline, rounding)
        assert column.height <= model.top
    assert max(column.height for column in model.columns) == model.top

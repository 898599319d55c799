"""Hulls that nearly are plain solids are found to be these, and no others."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from objectmodels import BoxModel, CylinderModel, HullModel, ObjectModel, PrismModel
from objectmodels.descriptions.mesh_import import import_mesh, plain_solid
from objectmodels.geometry.base_shapes import Array

LENGTHS = st.floats(0.02, 0.3)
YAWS = st.floats(-3.0, 3.0)


def upright(corners: Array, *heights: float) -> Array:
    return np.vstack([np.column_stack((corners, np.full(len(corners), z))) for z in heights])


def ring(radius: float, count: int) -> Array:
    phi = 2.0 * np.pi * np.arange(count) / count
    return radius * np.column_stack((np.cos(phi), np.sin(phi)))


def turned(vertices: Array, yaw: float) -> Array:
    return Rotation.from_euler("z", yaw).apply(vertices)


def revolved(profile: list[tuple[float, float]], sections: int = 64) -> trimesh.Trimesh:
    """A solid of revolution about z, over points (r, z) [m]."""
    return trimesh.creation.revolve(
        [(0.0, 0.0), *profile, (0.0, profile[-1][1])], sections=sections
    )


def imported(tmp_path: Path, mesh: trimesh.Trimesh) -> ObjectModel:
    mesh.export(tmp_path / "thing.ply")
    return import_mesh(tmp_path / "thing.ply", name="thing", mass=0.4)


@given(LENGTHS, LENGTHS, LENGTHS, YAWS)
def test_a_box_that_is_turned_is_a_box(x: float, y: float, z: float, yaw: float) -> None:
    corners = np.array([[-x, -y], [x, -y], [x, y], [-x, y]]) / 2.0 + 0.01
    found = plain_solid(turned(upright(corners, 0.0, z), yaw))
    assert found.kind is BoxModel
    # Sizes are kept to the micrometre; which side is x depends on the turn.
    assert sorted(found.shape["size"][:2]) == pytest.approx(sorted((x, y)), abs=2e-6)
    assert found.shape["size"][2] == pytest.approx(z, abs=2e-6)
    assert abs(found.yaw) <= np.pi / 4.0 + 1e-9
    middle = turned(np.array([0.01, 0.01, z / 2.0]), yaw)
    assert found.in_own_frame(middle) == pytest.approx([0.0, 0.0, z / 2.0], abs=1e-9)


@given(st.floats(0.02, 0.1), st.floats(0.05, 0.3), st.integers(36, 90), YAWS)
def test_a_round_solid_is_a_cylinder(r: float, h: float, count: int, yaw: float) -> None:
    found = plain_solid(turned(upright(ring(r, count) + 0.004, 0.0, h), yaw))
    assert found.kind is CylinderModel
    assert found.shape["radius"] == pytest.approx(r, abs=2e-6)
    assert "base_radius" not in found.shape


def test_a_narrower_foot_is_kept() -> None:
    vertices = np.vstack((upright(ring(0.03, 48), 0.0), upright(ring(0.04, 48), 0.006, 0.1)))
    found = plain_solid(vertices)
    assert found.kind is CylinderModel
    assert (found.shape["radius"], found.shape["base_radius"]) == pytest.approx((0.04, 0.03))
    # The foot may take 15 % of the height; a cone is no cylinder.
    assert plain_solid(vertices * [1.0, 1.0, 3.0]).kind is CylinderModel
    cone = np.vstack((upright(ring(0.03, 48), 0.0), upright(ring(0.04, 48), 0.05, 0.1)))
    assert plain_solid(cone).kind is HullModel


def test_a_hexagon_is_a_prism_and_a_pyramid_a_hull() -> None:
    found = plain_solid(upright(ring(0.04, 6) + 0.01, 0.0, 0.1))
    assert found.kind is PrismModel
    assert found.origin == pytest.approx([0.0, 0.0])  # it lies inside
    found = plain_solid(upright(ring(0.04, 6) + 0.05, 0.0, 0.1))
    assert found.origin == pytest.approx([0.05, 0.05])
    assert found.residual == pytest.approx(0.0, abs=1e-12)
    pyramid = np.vstack((upright(ring(0.04, 4), 0.0), [[0.0, 0.0, 0.1]]))
    assert plain_solid(pyramid).kind is HullModel


@pytest.mark.parametrize(("bevel", "kind"), [(0.001, BoxModel), (0.004, HullModel)])
def test_round_edges_are_forgiven_up_to_a_share_of_the_size(bevel: float, kind: type) -> None:
    """Of 80 mm 1.6 mm are; a bevel of b cuts a corner off by b times 2/√3."""
    a = 0.04
    corners = [
        [x * (a - bx), y * (a - by), z * (a - bz) + a]
        for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)
        for bx, by, bz in ((0, bevel, bevel), (bevel, 0, bevel), (bevel, bevel, 0))
    ]  # fmt: skip
    found = plain_solid(np.array(corners))
    assert found.kind is kind
    if kind is BoxModel:
        assert found.residual == pytest.approx(bevel * 2.0 / np.sqrt(3.0), rel=1e-6)


@pytest.mark.parametrize(
    "profile",
    [
        [(0.04, 0.0), (0.001, 0.1)],  # a cone
        [(0.02, 0.0), (0.04, 0.1)],  # a beaker
        [(0.036, 0.0), (0.036, 0.07), (0.02, 0.09), (0.02, 0.1)],  # a bottle with a shoulder
    ],
)
def test_what_is_no_upright_solid_stays_a_hull(
    tmp_path: Path, profile: list[tuple[float, float]]
) -> None:
    assert isinstance(imported(tmp_path, revolved(profile)), HullModel)


@pytest.mark.parametrize("sections", [24, 40, 48, 64])
def test_the_sides_of_a_round_hull_do_not_hang_on_the_fineness_of_its_mesh(
    tmp_path: Path, sections: int
) -> None:
    profile = [(0.036, 0.0), (0.036, 0.085), (0.028, 0.09), (0.028, 0.1)]
    model = imported(tmp_path, revolved(profile, sections))
    assert isinstance(model, HullModel)
    faces = model.faces()
    assert len(faces) == 4
    for face in faces:
        # 2 √(2 · 36 · 2.5) mm of a circle; corners of 24 sides stand 0.3 mm out, 15 mm apart.
        assert face.width == pytest.approx(0.0264, abs=0.002)

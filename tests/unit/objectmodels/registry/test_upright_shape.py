"""Meshes that are nearly a box, a cylinder or a prism become one, with the residual."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from objectmodels import BoxModel, CylinderModel, HullModel, PrismModel
from objectmodels.registry.mesh_import import import_mesh, read_mesh
from objectmodels.registry.upright_shape import TOLERANCE, upright_shape


def revolved(profile: list[tuple[float, float]], sections: int = 64) -> trimesh.Trimesh:
    """A solid of revolution about z, over points (r, z) [m]."""
    return trimesh.creation.revolve(
        [(0.0, 0.0), *profile, (0.0, profile[-1][1])], sections=sections
    )


def imported(tmp_path: Path, mesh: trimesh.Trimesh) -> object:
    mesh.export(tmp_path / "thing.ply")
    return import_mesh(tmp_path / "thing.ply", name="thing", mass=0.4)


def test_a_round_mesh_is_a_cylinder(tmp_path: Path) -> None:
    model = imported(tmp_path, revolved([(0.04, 0.0), (0.04, 0.15)]))
    assert isinstance(model, CylinderModel)
    # A mesh of 64 sides has its corners on the circle.
    assert (model.radius, model.height) == pytest.approx((0.04, 0.15), abs=1e-6)
    assert model.base_radius is None
    assert "within 0.0 mm" in model.provenance.method
    assert model.faces()


def test_a_foot_ring_is_the_base(tmp_path: Path) -> None:
    model = imported(tmp_path, revolved([(0.032, 0.0), (0.035, 0.003), (0.035, 0.12)]))
    assert isinstance(model, CylinderModel)
    assert (model.radius, model.base_radius) == pytest.approx((0.035, 0.032), abs=1e-6)


def test_boxes_and_prisms(tmp_path: Path) -> None:
    box = trimesh.creation.box(extents=(0.06, 0.08, 0.2))
    model = imported(tmp_path, box)
    assert isinstance(model, BoxModel)
    assert model.size == pytest.approx((0.06, 0.08, 0.2), abs=1e-6)
    turn = np.eye(4)
    turn[:2, :2] = [[np.cos(0.3), -np.sin(0.3)], [np.sin(0.3), np.cos(0.3)]]
    box.apply_transform(turn)
    turned = imported(tmp_path, box)
    assert isinstance(turned, PrismModel)
    assert sorted(turned.extents[:2]) != pytest.approx([0.06, 0.08], abs=1e-3)
    tin = imported(tmp_path, revolved([(0.05, 0.0), (0.05, 0.1)], sections=6))
    assert isinstance(tin, PrismModel)
    assert len(tin.corners) == 6


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


def test_the_residual_is_how_far_the_rim_stands_out(tmp_path: Path) -> None:
    """A chamfer of c × c leaves the rim c / √2 over its face."""
    c = 0.003
    mesh = revolved([(0.05, 0.0), (0.05, 0.12 - c), (0.05 - c, 0.12)], sections=128)
    mesh.export(tmp_path / "thing.ply")
    shape = upright_shape(read_mesh(tmp_path / "thing.ply").vertices)
    assert shape is not None
    assert shape.kind is CylinderModel
    # Between two of 128 corners the chamfer lies 15 µm inside of the circle.
    assert shape.residual == pytest.approx(c / np.sqrt(2.0), abs=2e-5)
    assert shape.residual <= TOLERANCE * 0.1


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

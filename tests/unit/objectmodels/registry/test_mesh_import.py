"""From meshes to models: the base, the volume and the centre of mass are found."""

from __future__ import annotations

import sys
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from objectmodels import HullModel, ModelError, PrismModel
from objectmodels.descriptions import mesh_import
from objectmodels.descriptions.mesh_import import import_mesh, read_mesh
from objectmodels.files.yaml_documents import LIMITS
from objectmodels.registry.model_registry import load_model, save_model

AXIS = np.array([1.0, 1.0, 0.0]) / np.sqrt(2.0)


def box_mesh(path: Path, size: tuple[float, float, float], shift: float = 0.0) -> Path:
    mesh = trimesh.creation.box(extents=size)
    mesh.apply_translation([shift, 2 * shift, 3 * shift])
    mesh.export(path)
    return path


def wedge(path: Path) -> Path:
    """A wedge, a right-angled triangle of 0.1 m × 0.2 m upright, 0.08 m wide, written by hand."""
    corners = [(x, y, z) for y in (0.0, 0.08) for x, z in ((0.0, 0.0), (0.1, 0.0), (0.0, 0.2))]
    faces = [(1, 2, 3), (4, 6, 5), (1, 4, 5), (1, 5, 2), (2, 5, 6), (2, 6, 3), (3, 6, 4), (3, 4, 1)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {a} {b} {c}" for a, b, c in faces]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "off"])
def test_a_box_is_found_standing_on_its_base(tmp_path: Path, suffix: str) -> None:
    path = box_mesh(tmp_path / f"box.{suffix}", (0.06, 0.08, 0.2), shift=0.3)
    solid = read_mesh(path)
    # STL keeps single precision: 1e-7 of the 0.9 m from the origin.
    np.testing.assert_allclose(np.ptp(solid.vertices, axis=0), (0.06, 0.08, 0.2), atol=1e-6)
    np.testing.assert_allclose(solid.com, (0.0, 0.0, 0.1), atol=1e-6)
    assert solid.volume == pytest.approx(0.06 * 0.08 * 0.2, rel=1e-5)
    assert solid.closed
    assert solid.vertices[:, 2].min() == 0.0


def test_a_wedge_has_its_centre_of_mass_over_a_third_of_its_base(tmp_path: Path) -> None:
    model = import_mesh(wedge(tmp_path / "wedge.obj"), name="wedge", density=500.0)
    assert model.mass == pytest.approx(500.0 * 0.5 * 0.1 * 0.2 * 0.08, rel=1e-6)
    x, y, z = model.com
    # A third of 0.1 m from the upright side; the base's middle is at a half.
    assert (x, y, z) == pytest.approx((0.1 / 3 - 0.05, 0.0, 0.2 / 3), abs=1e-6)
    assert "500 kg/m³" in model.provenance.method
    assert "friction estimated" in model.provenance.method


def test_the_centre_of_mass_is_turned_along(tmp_path: Path) -> None:
    """On its upright side, 0.08 m × 0.2 m, the wedge points up with its short edge."""
    solid = read_mesh(wedge(tmp_path / "wedge.obj"), up="+x")
    assert solid.vertices[:, 2].max() == pytest.approx(0.1, abs=1e-9)
    assert solid.com[2] == pytest.approx(0.1 / 3, abs=1e-9)
    # A third of 0.2 m from one end of that side, its middle at a half.
    assert np.abs(solid.com[:2]).max() == pytest.approx(0.1 - 0.2 / 3, abs=1e-9)


@pytest.mark.parametrize(("up", "height"), [("+z", 0.2), ("-z", 0.2), ("+x", 0.06), ("-y", 0.08)])
def test_upwards_is_as_stated(tmp_path: Path, up: str, height: float) -> None:
    path = box_mesh(tmp_path / "box.stl", (0.06, 0.08, 0.2))
    assert read_mesh(path, up=up).vertices[:, 2].max() == pytest.approx(height, abs=1e-6)


def test_a_tilted_mesh_is_stood_on_the_face_below_or_its_largest(tmp_path: Path) -> None:
    mesh = trimesh.creation.box(extents=(0.06, 0.08, 0.2))
    for angle, top, stood in ((4.0, 0.2, "below"), (30.0, 0.06, "largest")):
        turned = mesh.copy()
        leaning = np.eye(4)
        leaning[:3, :3] = Rotation.from_rotvec(np.radians(angle) * AXIS).as_matrix()
        turned.apply_transform(leaning)
        turned.export(tmp_path / "tilted.ply")
        solid = read_mesh(tmp_path / "tilted.ply")
        assert solid.vertices[:, 2].max() == pytest.approx(top, abs=1e-5)
        assert stood in solid.stood


def test_millimetres_are_told_and_a_mistaken_unit_is_noticed(tmp_path: Path) -> None:
    path = box_mesh(tmp_path / "box.stl", (60.0, 80.0, 200.0))
    assert read_mesh(path, unit="mm").vertices[:, 2].max() == pytest.approx(0.2, rel=1e-6)
    with pytest.raises(ModelError, match="--unit mm"):
        read_mesh(path)


def test_a_hollow_mug_keeps_its_own_centre_of_mass(tmp_path: Path) -> None:
    """Closed, but not convex: volume and centre are the mesh's, the shape is its hull's."""
    cup = trimesh.creation.revolve(
        [[0.0, 0.0], [0.04, 0.0], [0.04, 0.1], [0.036, 0.1], [0.036, 0.006], [0.0, 0.006]],
        sections=48,
    )
    cup.export(tmp_path / "cup.stl")
    solid = read_mesh(tmp_path / "cup.stl")
    wall, floor = np.pi * (0.04**2 - 0.036**2) * 0.1, np.pi * 0.036**2 * 0.006
    assert solid.closed
    # A ring of 48 sides has 0.3 % less area than a circle.
    assert solid.volume == pytest.approx(wall + floor, rel=0.005)
    assert solid.com[2] == pytest.approx((wall * 0.05 + floor * 0.003) / (wall + floor), rel=0.005)
    assert solid.vertices[:, 2].max() == pytest.approx(0.1, abs=1e-6)


def test_an_open_mesh_takes_its_hull(tmp_path: Path) -> None:
    mesh = trimesh.creation.box(extents=(0.06, 0.08, 0.2))
    open_ = trimesh.Trimesh(mesh.vertices, mesh.faces[2:])
    open_.export(tmp_path / "open.ply")
    model = import_mesh(tmp_path / "open.ply", name="o", mass=0.5)
    assert model.com == pytest.approx((0.0, 0.0, 0.1), abs=1e-6)
    assert "of the convex hull" in model.provenance.method


def test_a_fine_mesh_is_thinned_and_predicts_like_its_shape(tmp_path: Path) -> None:
    trimesh.creation.cylinder(radius=0.04, height=0.15, sections=600).export(tmp_path / "can.stl")
    solid = read_mesh(tmp_path / "can.stl")
    assert len(solid.vertices) <= 400
    model = HullModel(name="can", mass=0.4, friction=0.3, vertices=solid.vertices.tolist())
    turns = 2 * np.pi * np.arange(600) / 600
    prism = PrismModel(
        name="p", mass=0.4, friction=0.3, height=0.15,
        corners=(0.04 * np.column_stack((np.cos(turns), np.sin(turns)))).tolist(),
    )  # fmt: skip
    p, u = [[-0.04, 0.0, 0.12], [-0.02, 0.01, 0.14]], [[1.0, 0.0, 0.0], [0.6, 0.8, 0.0]]
    # A circle of 200 corners instead of 600.
    np.testing.assert_allclose(
        model.thresholds(p, u).topple, prism.thresholds(p, u).topple, rtol=1e-3
    )


def test_what_is_imported_is_written_and_read_again(tmp_path: Path) -> None:
    model = import_mesh(wedge(tmp_path / "w.obj"), name="wedge", mass=0.4, synonyms=("ramp",))
    save_model(model, tmp_path / "wedge.yaml")
    again = load_model(tmp_path / "wedge.yaml")
    assert isinstance(again, HullModel)
    assert again == model


@pytest.mark.parametrize(
    ("content", "name", "code"),
    [
        (b"", "empty.stl", "unreadable_file"),
        (b"not a mesh at all", "text.obj", "unreadable_file"),
        (b"solid x\nendsolid x\n", "nothing.stl", "unreadable_file"),
        (b"v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n", "flat.obj", "bad_mesh"),
        (b"\x00" * 300, "zeros.stl", "unreadable_file"),
        (b"hello", "model.xyz123", "unreadable_file"),
        (b"solid x", "model", "unreadable_file"),
        (b"v 0 0\n" + b"v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n", "level.obj", "bad_mesh"),
        (b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR\xff\xfe", "picture.stl", "unreadable_file"),
        (b"mtllib /dev/zero\nv 0 0 0\n", "other.obj", "bad_mesh"),
    ],
)
def test_files_that_hold_no_solid_are_refused(
    tmp_path: Path, content: bytes, name: str, code: str
) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(ModelError) as error:
        read_mesh(path)
    assert error.value.code in {code, "bad_mesh"}
    assert name in str(error.value)
    assert error.value.suggestions
    assert "charset" not in str(error.value)


def test_a_ball_stands_on_nothing(tmp_path: Path) -> None:
    with pytest.raises(ModelError) as error:
        read_mesh(tmp_path / "missing.stl")
    assert error.value.code == "unreadable_file"


@pytest.mark.parametrize(
    "figures", [{}, {"mass": 1.0, "density": 500.0}, {"mass": -1.0}, {"density": float("nan")}]
)
def test_mass_or_density_one_of_both(tmp_path: Path, figures: dict[str, float]) -> None:
    path = box_mesh(tmp_path / "box.stl", (0.06, 0.08, 0.2))
    with pytest.raises(ModelError, match="either the mass"):
        import_mesh(path, name="b", **figures)  # type: ignore[arg-type]


def test_without_the_extra_it_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(ModelError) as error:
        read_mesh(tmp_path / "x.stl")
    assert error.value.code == "missing_extra"
    # By the checkout: in the package index the name is another project's.
    assert error.value.suggestions == ("in nlcontrol's checkout: pip install '.[mesh]'",)


def test_a_cone_is_pushed_on_its_leaning_side(tmp_path: Path) -> None:
    trimesh.creation.cone(radius=0.05, height=0.12, sections=40).export(tmp_path / "cone.obj")
    model = import_mesh(tmp_path / "cone.obj", name="cone", density=300.0)
    faces = model.faces()
    assert len(faces) == 4
    for face in faces:
        assert face.normal[2] == pytest.approx(np.sin(np.arctan(0.05 / 0.12)), abs=0.01)
        p, n = face.points_at([0.0], [0.03])
        # The side at a quarter of the height; the plane stands off by the bulge at most.
        assert np.hypot(*p[0, :2]) == pytest.approx(0.05 * 0.75, abs=0.003)
        assert np.isfinite(model.cone_thresholds(p, n).slide_max).all()


def test_a_needle_has_no_side_for_a_finger(tmp_path: Path) -> None:
    box_mesh(tmp_path / "needle.stl", (0.006, 0.006, 0.3))
    model = import_mesh(tmp_path / "needle.stl", name="needle", mass=0.1)
    assert model.faces() == ()


@pytest.mark.parametrize(
    ("changes", "key"),
    [({"name": name}, "name") for name in ("", " ", "a ", "a" * 101, "\udcff", "\x1b[31m")]
    + [({"friction": mu}, "friction") for mu in (-1.0, 0.0, float("nan"), float("inf"))]
    + [({"mass": mass}, "mass") for mass in (1e-9, 1e300)]
    + [({"mass": None, "density": 1e-5}, "mass"), ({"synonyms": ("",)}, "synonyms")]
    + [({"unit": "ft"}, "unit"), ({"up": "z"}, "up")],
    ids=repr,
)
def test_arguments_out_of_range_are_named(tmp_path: Path, changes: Any, key: str) -> None:
    path = box_mesh(tmp_path / "box.stl", (0.06, 0.08, 0.2))
    with pytest.raises(ModelError) as raised:
        import_mesh(path, **({"name": "b", "mass": 1.0} | changes))
    assert raised.value.code == "bad_value"
    assert (raised.value.path or key).startswith(key)
    assert raised.value.suggestions


def test_a_mesh_of_very_many_points_is_read_by_its_outermost_ones(tmp_path: Path) -> None:
    can = trimesh.creation.cylinder(radius=0.04, height=0.15, sections=200)
    ball = trimesh.creation.icosphere(subdivisions=6, radius=0.03)
    ball.apply_translation([0.0, 0.0, 0.02])
    both: Any = trimesh.util.concatenate([can, ball])
    both.export(tmp_path / "can.ply")
    solid = read_mesh(tmp_path / "can.ply")
    # Directions are 7° apart: the sagitta of that on 0.04 m.
    np.testing.assert_allclose(np.ptp(solid.vertices, axis=0), (0.08, 0.08, 0.15), atol=3e-4)
    assert (solid.vertices[:, 2] == 0.0).sum() > 20


def test_too_many_triangles_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    few = LIMITS["mesh_triangles"]._replace(most=11)
    monkeypatch.setattr(mesh_import, "LIMITS", {**LIMITS, "mesh_triangles": few})
    with pytest.raises(ModelError, match="12 triangles") as raised:
        read_mesh(box_mesh(tmp_path / "box.stl", (0.06, 0.08, 0.2)))
    assert raised.value.code == "bad_mesh"


def test_what_would_unpack_to_very_much_is_refused(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "bomb.3mf", "w", zipfile.ZIP_DEFLATED) as parts:
        parts.writestr("3D/3dmodel.model", b" " * (int(LIMITS["mesh_file"].most) + 1))
    with pytest.raises(ModelError) as raised:
        read_mesh(tmp_path / "bomb.3mf")
    assert raised.value.code == "unreadable_file"

"""Files of other simulators become models: what was exported predicts the same when it is back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from objectmodels import (
    BoxModel,
    CylinderModel,
    HullModel,
    ModelError,
    ObjectModel,
    PrismModel,
    Registry,
)
from objectmodels.descriptions.description_import import import_description
from objectmodels.descriptions.description_reading import Format, write_description
from objectmodels.registry.model_checks import _level_pushes
from objectmodels.registry.model_registry import load_model, save_model

BASE = ((-0.05, -0.04, 0.0), (0.05, -0.04, 0.0), (0.05, 0.04, 0.0), (-0.05, 0.04, 0.0))
MODELS: tuple[ObjectModel, ...] = (
    BoxModel(name="tea box", size=(0.1, 0.06, 0.2), mass=0.5123456789, friction=0.3,
             com=(0.01, 0.002, 0.08), support="corners", finger_friction=0.71),
    BoxModel(name="crate", size=(0.1, 0.0667, 0.2), mass=1.0 / 3.0, friction=0.41),
    CylinderModel(name="can", radius=0.04, height=0.1, mass=0.3, friction=0.4,
                  com=(0.003, 0, 0.04)),
    CylinderModel(name="mug", radius=0.04, height=0.1, base_radius=0.03, mass=0.3, friction=0.4,
                  support="corners"),
    PrismModel(name="wedge", corners=((-0.04, -0.03), (0.05, -0.03), (0.0, 0.06)), height=0.1,
               mass=0.4, friction=0.35, support=((-0.03, -0.02), (0.03, -0.02, 2.0), (0.0, 0.04))),
    PrismModel(name="bar", corners=((0.05, 0.02), (-0.05, 0.03), (-0.04, -0.04), (0.06, -0.02)),
               height=0.05, mass=0.4, friction=0.35),
    HullModel(name="stone", mass=0.6, friction=0.5, vertices=(*BASE, (0.01, 0.0, 0.09))),
)  # fmt: skip


@pytest.mark.parametrize("form", ["mjcf", "sdf", "urdf"])
@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.name)
def test_what_was_exported_predicts_the_same(
    model: ObjectModel, form: Format, tmp_path: Path
) -> None:
    first, *_ = write_description(model, form, tmp_path)
    read = import_description(first)
    save_model(read, tmp_path / "read.yaml")
    for back in (read, load_model(tmp_path / "read.yaml")):
        assert (type(back), back.name) == (type(model), model.name)
        assert (back.mass, back.friction) == pytest.approx((model.mass, model.friction), rel=1e-12)
        assert back.finger_friction == pytest.approx(model.finger_friction, rel=1e-12)
        assert back.support == model.support or len(back.support) == len(model.support)
        p, u = _level_pushes(model)
        for exact in (False, True):
            told, found = (m.thresholds(p, u, exact=exact) for m in (model, back))
            # Fifteen digits are written.
            np.testing.assert_allclose(found.slide, told.slide, rtol=1e-9)
            np.testing.assert_allclose(found.topple, told.topple, rtol=1e-9)


@pytest.mark.parametrize("model", Registry.built_in(), ids=lambda model: model.name)
def test_the_models_that_are_built_in_come_back(model: ObjectModel, tmp_path: Path) -> None:
    first, *_ = write_description(model, "sdf", tmp_path)
    back = import_description(first)
    p, u = _level_pushes(model)
    # A friction radius that was fitted is not that of the feet, and has no place in these files.
    same = model.model_copy(update={"friction_radius": back.friction_radius})
    np.testing.assert_allclose(back.thresholds(p, u).onset, same.thresholds(p, u).onset, rtol=1e-9)


URDF = """\
<robot name="oat_crate">
  <link name="base">
    <inertial><origin xyz="0 0 0.01"/><mass value="0.8"/>
      <inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0 0 0" rpy="0 0 0.5"/><geometry>{shape}</geometry></collision>
  </link>
</robot>
"""


def described(tmp_path: Path, shape: str, text: str = URDF) -> Path:
    path = tmp_path / "thing.urdf"
    path.write_text(text.format(shape=shape), encoding="utf-8")
    return path


def test_a_box_that_is_turned_has_its_sides_along_b(tmp_path: Path) -> None:
    model = import_description(described(tmp_path, '<box size="0.1 0.06 0.2"/>'))
    assert isinstance(model, BoxModel)
    assert (model.name, model.size, model.mass) == ("oat crate", (0.1, 0.06, 0.2), 0.8)
    # Its middle is the origin of the file, so that the table is 0.1 m below.
    assert model.com == pytest.approx((0.0, 0.0, 0.11), abs=1e-12)
    assert (model.friction, model.finger_friction) == (0.35, 0.6)  # estimates
    told = import_description(
        described(tmp_path, '<box size="0.1 0.06 0.2"/>'), mass=0.5, friction=0.2, name="crate"
    )
    assert (told.mass, told.friction, told.name) == (0.5, 0.2, "crate")


def test_a_box_on_its_side_stands_on_it(tmp_path: Path) -> None:
    text = URDF.replace('rpy="0 0 0.5"', 'rpy="1.5707963267948966 0 0"')
    model = import_description(described(tmp_path, '<box size="0.1 0.06 0.2"/>', text))
    assert isinstance(model, BoxModel)
    assert sorted(model.size[:2]) == pytest.approx([0.1, 0.2])
    assert model.size[2] == pytest.approx(0.06)


def test_a_mesh_is_scaled_lowered_and_recognised(tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    mesh = trimesh.creation.cylinder(radius=40, height=90, sections=60)
    mesh.export(tmp_path / "meshes" / "jar.stl")
    name = '<mesh filename="package://jars/meshes/jar.stl" scale="0.001 0.001 0.001"/>'
    model = import_description(described(tmp_path, name))
    assert isinstance(model, CylinderModel)
    # STL has single precision.
    assert (model.radius, model.height) == pytest.approx((0.04, 0.09), rel=1e-6)
    assert model.com == pytest.approx((0.0, 0.0, 0.055), abs=1e-8)


def test_a_scan_that_leans_stands_on_its_face(tmp_path: Path) -> None:
    box = trimesh.creation.box(extents=(0.06, 0.08, 0.2))
    leaning = np.eye(4)
    leaning[:3, :3] = Rotation.from_rotvec([0.035, 0.035, 0.0]).as_matrix()
    box.apply_transform(leaning)
    box.apply_translation([0.5, 0.0, 0.0])
    box.export(tmp_path / "scan.obj")
    text = URDF.replace("0 0 0.01", "0.5 0 0.01").replace("0 0 0.5", "0 0 0")
    model = import_description(described(tmp_path, '<mesh filename="scan.obj"/>', text), mass=0.5)
    assert isinstance(model, BoxModel)
    assert sorted(model.size) == pytest.approx([0.06, 0.08, 0.2], abs=1e-6)


def test_several_shapes_are_one_hull(tmp_path: Path) -> None:
    two = URDF.replace(
        "</link>",
        '<collision><origin xyz="0 0 0.12"/><geometry><box size="0.02 0.02 0.04"/></geometry>'
        "</collision></link>",
    )
    model = import_description(described(tmp_path, '<box size="0.1 0.06 0.2"/>', two))
    assert isinstance(model, HullModel)
    assert model.top == pytest.approx(0.24)


MJCF = """\
<mujoco model="pot">
  <compiler angle="radian"/>
  <default><default class="body"><geom type="cylinder" friction="0.4 0 0"/></default></default>
  <worldbody>
    <body name="pot" pos="0.5 0 1" childclass="body">
      <joint type="free"/>
      <geom size="0.05 0.04" mass="0.3" euler="0 0 0.3"/>
      <geom type="box" size="1 1 1" contype="0" conaffinity="0" mass="0"/>
    </body>
  </worldbody>
</mujoco>
"""


def test_mjcf_has_classes_and_half_lengths(tmp_path: Path) -> None:
    path = tmp_path / "pot.xml"
    path.write_text(MJCF, encoding="utf-8")
    model = import_description(path)
    assert isinstance(model, CylinderModel)
    assert (model.radius, model.height, model.mass) == (0.05, 0.08, 0.3)
    assert (model.friction, model.com) == (0.4, (0.0, 0.0, 0.04))
    mujoco = pytest.importorskip("mujoco", reason="the extra dev has it")
    read = mujoco.MjModel.from_xml_path(str(path))
    assert read.body_mass[1] == pytest.approx(model.mass)
    assert read.geom_size[0, :2] == pytest.approx([model.radius, model.height / 2.0])


def test_turns_are_those_of_mujoco(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco", reason="the extra dev has it")
    text = MJCF.replace("0 0 0.3", "0.4 -0.7 0.3")
    path = tmp_path / "pot.xml"
    path.write_text(text, encoding="utf-8")
    quat = mujoco.MjModel.from_xml_path(str(path)).geom_quat[0]
    from objectmodels.descriptions.description_reading import read_link

    (shape,) = read_link(path).shapes
    expected = Rotation.from_quat(np.roll(quat, -1)).as_matrix()
    np.testing.assert_allclose(shape.R, expected, atol=1e-12)


SDF = """\
<sdf version="1.9"><model name="m"><link name="l"><pose>0 0 0.1 0 0 0</pose>{inertial}
<collision name="c"><geometry>{shape}</geometry></collision></link>{more}</model></sdf>
"""
BOX = "<box><size>0.1 0.1 0.1</size></box>"
HEAVY = "<inertial><mass>1</mass></inertial>"


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (SDF.format(shape=BOX, inertial="", more=""), "bad_description"),  # no mass
        (SDF.format(shape=BOX, inertial=HEAVY, more='<link name="o"/>'), "not_one_body"),
        (SDF.format(shape=BOX, inertial=HEAVY, more='<joint name="j"/>'), "not_one_body"),
        (SDF.format(shape="<plane/>", inertial=HEAVY, more=""), "unsupported_shape"),
        (SDF.format(shape="<sphere><radius>0.04</radius></sphere>", inertial=HEAVY, more=""),
         "unsupported_shape"),
        (SDF.format(shape="<box><size>1 2</size></box>", inertial=HEAVY, more=""),
         "bad_description"),
        (SDF.format(shape="<mesh><uri>no.obj</uri></mesh>", inertial=HEAVY, more=""),
         "bad_description"),
        (SDF.format(shape="<box><size>9 9 9</size></box>", inertial=HEAVY, more=""),
         "bad_description"),  # millimetres?
        (SDF.format(shape=BOX, inertial="<inertial><mass>-1</mass></inertial>", more=""),
         "bad_value"),
        ("<html/>", "bad_description"),
        ("<robot", "bad_description"),
        ('<robot name="r"><link name="l"/></robot>', "bad_description"),
        ('<!DOCTYPE a [<!ENTITY b "c">]><robot name="&b;"/>', "bad_description"),
        ("<mujoco><worldbody/></mujoco>", "not_one_body"),
        (MJCF.replace('type="free"', 'type="hinge"'), "not_one_body"),
        (MJCF.replace('"cylinder"', '"capsule"'), "unsupported_shape"),
        (MJCF.replace("euler", "axisangle"), "bad_description"),
        (MJCF.replace('euler="0 0 0.3"', 'quat="0 0 0 0"'), "bad_description"),
        (MJCF.replace('angle="radian"', 'eulerseq="xxy"'), "bad_description"),
        (MJCF.replace('friction="0.4 0 0"', 'friction=" "'), "bad_description"),
        (MJCF.replace('"cylinder"', '"sphere"').replace('size="0.05 0.04"', 'size=""'),
         "bad_description"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_told(text: str, code: str, tmp_path: Path) -> None:
    path = tmp_path / "thing.sdf"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ModelError) as raised:
        import_description(path)
    assert (raised.value.code, raised.value.path) == (code, str(path))
    assert raised.value.suggestions

"""Files for other simulators say what the model believes, as those simulators read them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from objectmodels import (
    BoxModel,
    CylinderModel,
    HullModel,
    ModelError,
    ObjectModel,
    PrismModel,
    Registry,
)
from objectmodels.descriptions.description_reading import (
    Format,
    description_texts,
    write_description,
)
from objectmodels.descriptions.description_writing import obj_text
from objectmodels.descriptions.rigid_body import FOOT, rigid_body
from objectmodels.geometry.solids import ConvexHull, volume_and_centre

BOX = BoxModel(
    name="tea box",
    size=(0.1, 0.06, 0.2),
    mass=0.5,
    friction=0.3,
    com=(0.01, 0, 0.08),
    support="corners",
)
CAN = CylinderModel(name="can", radius=0.04, height=0.1, base_radius=0.03, mass=0.3, friction=0.4)
PRISM = PrismModel(
    name="wedge",
    corners=((-0.04, -0.03), (0.05, -0.03), (0.0, 0.06)),
    height=0.1,
    mass=0.4,
    friction=0.35,
    support=((-0.03, -0.02), (0.03, -0.02, 2.0), (0.0, 0.04)),
)
BASE = [(-0.05, -0.04, 0), (0.05, -0.04, 0), (0.05, 0.04, 0), (-0.05, 0.04, 0)]
HULL = HullModel(name="stone", mass=0.6, friction=0.5, vertices=(*BASE, (0.0, 0.0, 0.09)))
BIN = Registry.built_in().get("storage bin")
MODELS = pytest.mark.parametrize(
    "model", [BOX, CAN, PRISM, HULL, BIN], ids=lambda model: model.name
)


@MODELS
@pytest.mark.parametrize("form", ["sdf", "urdf"])
def test_drake_reads_mass_inertia_feet_and_friction(
    model: ObjectModel, form: Format, tmp_path: Path
) -> None:
    from pydrake.geometry import Role
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
    from pydrake.systems.framework import DiagramBuilder

    first, *_ = write_description(model, form, tmp_path)
    plant, scene = AddMultibodyPlantSceneGraph(DiagramBuilder(), 0.001)
    (instance,) = Parser(plant).AddModels(str(first))
    plant.Finalize()
    (index,) = plant.GetBodyIndices(instance)
    body = plant.get_body(index)
    inertia = body.default_spatial_inertia()
    body_of_model = rigid_body(model)
    # Nine digits are written.
    assert inertia.get_mass() == pytest.approx(model.mass, rel=1e-8)
    assert inertia.get_com() == pytest.approx(model.com, abs=1e-9)
    about_com = inertia.Shift(inertia.get_com()).CalcRotationalInertia().get_moments()
    assert about_com == pytest.approx(body_of_model.inertia, rel=1e-7)

    inspector = scene.model_inspector()
    frame = plant.GetBodyFrameIdOrThrow(index)
    lows, shares, frictions = [], [], []
    for geometry in inspector.GetGeometries(frame, Role.kProximity):
        if inspector.GetShape(geometry).__class__.__name__ != "Sphere":
            continue
        properties = inspector.GetProximityProperties(geometry)
        lows.append(inspector.GetPoseInFrame(geometry).translation() - [0.0, 0.0, FOOT])
        shares.append(properties.GetProperty("material", "point_contact_stiffness"))
        frictions.append(properties.GetProperty("material", "coulomb_friction").static_friction())
    middle = np.array(shares) @ np.array(lows) / sum(shares)
    assert len(lows) == len(body_of_model.feet)
    assert frictions == pytest.approx([model.friction] * len(frictions))
    assert middle == pytest.approx(
        body_of_model.weights @ body_of_model.feet - [0.0, 0.0, FOOT], abs=1e-8
    )


@MODELS
def test_mujoco_reads_mass_inertia_and_feet(model: ObjectModel) -> None:
    mujoco = pytest.importorskip("mujoco", reason="the extra dev has it")
    (text,) = description_texts(model, "mjcf").values()
    read = mujoco.MjModel.from_xml_string(text)
    assert read.body_mass[1] == pytest.approx(model.mass, rel=1e-8)
    assert read.body_ipos[1] == pytest.approx(model.com, abs=1e-9)
    # Its axes of inertia may come in another order.
    assert sorted(read.body_inertia[1]) == pytest.approx(sorted(rigid_body(model).inertia))
    spheres = read.geom_type == mujoco.mjtGeom.mjGEOM_SPHERE
    assert read.geom_pos[spheres] == pytest.approx(rigid_body(model).feet, abs=1e-9)
    assert read.geom_friction[spheres, 0] == pytest.approx(model.friction)


@pytest.mark.parametrize("form", ["mjcf", "sdf"])
def test_pushes_end_there_as_the_exact_tier_says(form: Format) -> None:
    pytest.importorskip("mujoco", reason="the extra dev has it")
    from benchmarks.engines.single_pushes import described

    cases = [case for case in described(8, 3, "weighted") if case.group == form]
    assert {case.push.outcome for case in cases} == {"slide", "topple"}
    for case in cases:
        outcome = case.roll_out()
        assert outcome.seen == case.push.outcome
        # 95 % of 24 are within 0.7 %, of seed 0; soft feet turn the object a little.
        assert abs(outcome.errors["onset"]) < 0.03


def test_a_mesh_encloses_the_volume_of_the_hull() -> None:
    (solid,) = rigid_body(HULL).solids.values()
    assert isinstance(solid, ConvexHull)
    vertices = solid.vertices
    lines = [line.split() for line in obj_text(vertices).splitlines()]
    points = np.array([[float(x) for x in line[1:]] for line in lines if line[0] == "v"])
    faces = np.array([[int(k) - 1 for k in line[1:]] for line in lines if line[0] == "f"])
    signed = np.linalg.det(points[faces]).sum() / 6.0  # outwards, so that it is positive
    assert signed == pytest.approx(volume_and_centre(vertices)[0], rel=1e-6)


def test_an_open_box_is_hollow_where_a_ball_falls_into_it() -> None:
    mujoco = pytest.importorskip("mujoco", reason="the extra dev has it")
    assert BIN.inside is not None
    (text,) = description_texts(BIN, "mjcf").values()
    ball = (
        '<body pos="0 0 0.2"><freejoint/><geom type="sphere" size="0.02" density="100"/></body>'
        '<geom type="plane" size="1 1 1"/>'
    )
    world = mujoco.MjModel.from_xml_string(text.replace("</worldbody>", f"{ball}</worldbody>"))
    data = mujoco.MjData(world)
    mujoco.mj_step(world, data, nstep=1500)
    # It lies on the floor, into which its soft contact lets it sink by less than a millimetre.
    assert data.qpos[9] == pytest.approx(BIN.inside.floor + 0.02, abs=1e-3)


def test_files_are_named_for_the_object(tmp_path: Path) -> None:
    assert [path.name for path in write_description(BOX, "sdf", tmp_path)] == ["tea_box.sdf"]
    assert list(description_texts(HULL, "urdf")) == ["stone.urdf", "stone.obj"]
    strange = BOX.model_copy(update={"name": "Café № 1"})
    assert list(description_texts(strange, "mjcf")) == ["Café_1.xml"]


def test_a_folder_that_is_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "here").write_text("")
    with pytest.raises(ModelError) as raised:
        write_description(BOX, "sdf", tmp_path / "here")
    assert raised.value.code == "cannot_write"

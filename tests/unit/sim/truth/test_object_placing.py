"""Objects put on a table: as their models say, and where there is room."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import ArrayLike

from objectmodels import CylinderModel, Disc, Face, HullModel, ObjectModel, Polygon, Registry
from objectmodels.geometry.base_shapes import Array
from sim.errors import SceneError
from sim.truth.object_truth import Truth, truth_as_believed
from sim.truth.scene_file import Pose, Scene, free_place, load_scene, scene_with_object
from sim.worlds.drake.drake_world import DrakeWorld

FREE = Pose(x_m=0.45, y_m=0.18)


@pytest.fixture(scope="module")
def kitchen() -> Scene:
    return load_scene("kitchen")


def hull(height: float = 0.1) -> HullModel:
    """A jar of eight sides that narrows at the top."""
    turns = 2.0 * np.pi * np.arange(8) / 8
    rings = ((0.04, 0.0), (0.04, 0.8 * height), (0.03, height))
    corners = [(r * np.cos(t), r * np.sin(t), z) for r, z in rings for t in turns]
    return HullModel(name="honey jar", mass=0.4, friction=0.35, vertices=tuple(corners))


@pytest.mark.parametrize("model", [*Registry.built_in(), hull()], ids=lambda model: model.name)
def test_truth_is_as_believed(model: ObjectModel) -> None:
    truth = truth_as_believed(model)
    assert truth.shape.top == pytest.approx(model.top)
    assert (truth.mass_kg, truth.friction_table) == (model.mass, model.friction)
    assert truth.centre_of_mass == tuple(model.com)
    base = np.array(truth.shape.silhouette)
    radius = np.linalg.norm(base, axis=1).max()
    outline = np.linalg.norm(np.array(model.outline), axis=1).max()
    # The outline that a model has of a round side lies around it, by 1 / cos(π / 16).
    assert radius == pytest.approx(outline, rel=0.02 if isinstance(model, CylinderModel) else 1e-9)


def test_a_kind_of_a_plug_in_is_put_there(kitchen: Scene) -> None:
    class Bucket(ObjectModel):
        """A round base, and a wider square top."""

        @property
        def footprint(self) -> Disc:
            return Disc(0.03)

        @property
        def top(self) -> float:
            return 0.12

        @property
        def outline(self) -> Array:
            return Polygon.rectangle(0.1, 0.1).vertices

        def faces(self, headings: ArrayLike | None = None) -> tuple[Face, ...]:
            return ()

    scene = scene_with_object(kitchen, Bucket(name="bucket", mass=0.5, friction=0.3), FREE)
    truth = scene.objects[-1].truth
    assert truth.shape.top == 0.12
    assert np.ptp(truth.shape.silhouette, axis=0) == pytest.approx([0.1, 0.1])
    base = [(x, y) for x, y, z in truth.shape.hull_corners if z == 0.0]
    assert np.hypot(*np.array(base).T) == pytest.approx(0.03)


def test_what_is_put_there_stands_still(kitchen: Scene) -> None:
    scene = scene_with_object(kitchen, hull(), FREE)
    world = DrakeWorld(scene, seed=0)
    before = world.sample.poses["honey jar"]
    for _ in range(50):
        world.robot.step(*world.robot.commanded)
    # Half a second: it settles on its feet by less than a tenth of a millimetre.
    np.testing.assert_allclose(world.sample.poses["honey jar"], before, atol=1e-4)


@pytest.mark.parametrize(
    ("name", "pose"),
    [
        ("jar", Pose(x_m=1.5, y_m=0.0)),
        ("jar", Pose(x_m=0.46, y_m=0.02)),
        ("mug", FREE),
    ],
)
def test_where_there_is_no_room_is_told(kitchen: Scene, name: str, pose: Pose) -> None:
    with pytest.raises(SceneError) as raised:
        scene_with_object(kitchen, Registry.built_in().get(name), pose)
    assert raised.value.code == "bad_scene"
    assert raised.value.suggestions


def test_a_free_place_is_found_or_there_is_none(kitchen: Scene) -> None:
    jar = hull()
    place = free_place(kitchen, jar)
    assert place is not None
    assert scene_with_object(kitchen, jar, place).objects[-1].pose == place
    wide = CylinderModel(name="tray", radius=1.0, height=0.02, mass=1.0, friction=0.3)
    assert free_place(kitchen, wide) is None


def test_hulls_are_read_strictly() -> None:
    figures = {"mass_kg": 0.4, "friction_table": 0.35, "friction_finger": 0.6}
    vertices = hull().vertices
    assert Truth.model_validate({"vertices_m": vertices, **figures}).shape.top == 0.1
    raised = tuple((x, y, z + 0.01) for x, y, z in vertices)
    for wrong in ({"vertices_m": raised}, {"vertices_m": vertices, "height_m": 0.1}):
        with pytest.raises(ValueError, match=r"vertices_m|height_m"):
            Truth.model_validate(wrong | figures)

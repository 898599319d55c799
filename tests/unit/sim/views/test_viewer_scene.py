"""A scene as a viewer draws it: every body with its shapes, and what is there for the eye alone."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from nlcontrol.service.documents import SceneGeometry
from objectmodels import Registry
from objectmodels.geometry.rotations import from_quaternion
from sim import load_scene
from sim.truth.scene_file import Scene
from sim.views.trace_scene import TraceScene
from sim.views.viewer_recording import (
    SceneBodies,
    believed_scene,
    body_name,
    body_poses,
    drawn_bodies,
    viewer_scene,
)
from sim.worlds.ports import Sample

KINDS = {"box", "sphere", "capsule", "cylinder", "mesh", "lathe", "tube", "label", "grid"}
"""That `page/body_shapes.js` draws."""


def _stage(scene: Scene) -> TraceScene:
    return TraceScene(scene, lambda builder, model: None)


@pytest.fixture(scope="module", params=["kitchen", "pantry", "counter"])
def scene(request: pytest.FixtureRequest) -> Scene:
    return load_scene(request.param)


@pytest.fixture(scope="module")
def document(scene: Scene) -> dict[str, Any]:
    drawn = viewer_scene(scene, _stage(scene).model)
    return dict(json.loads(json.dumps(drawn)))


def _shapes(document: dict[str, Any], kind: str) -> dict[str, list[Any]]:
    """Shapes of the bodies of a kind, by their objects, or by their names if they have none."""
    return {
        body["object"] or body["name"]: body["shapes"]
        for body in document["bodies"]
        if body["kind"] == kind
    }


def test_every_object_and_lid_has_a_body_of_its_name(
    scene: Scene, document: dict[str, Any]
) -> None:
    assert set(_shapes(document, "object")) == set(scene.names)
    lids = {item.name for item in scene.objects if item.truth.lid is not None}
    assert set(_shapes(document, "lid")) == lids
    assert len(_shapes(document, "robot")) > 15
    names = [body["name"] for body in document["bodies"]]
    assert len(set(names)) == len(names)
    assert "lwr_arm/arm_link_1" in names


def test_every_shape_can_be_drawn(document: dict[str, Any]) -> None:
    for body in document["bodies"]:
        assert body["shapes"]
        for shape in body["shapes"]:
            assert shape["kind"] in KINDS
            assert np.linalg.norm(shape["pose"][:4]) == pytest.approx(1.0, abs=1e-4)
            assert len(shape["pose"]) == 7
            assert all(0.0 <= part <= 1.0 for part in shape["colour"])


def test_a_document_is_small(document: dict[str, Any]) -> None:
    assert len(json.dumps(document)) < 60_000


def test_a_mug_has_a_handle_that_reaches_out_of_it() -> None:
    scene = load_scene("kitchen")
    shapes = _shapes(viewer_scene(scene, _stage(scene).model), "object")["mug"]
    (handle,) = [shape for shape in shapes if shape["name"] == "handle"]
    points = np.array(handle["points"])
    out = np.hypot(*points[:, :2].T)
    radius = scene.object("mug").truth.shape.rim.size
    assert out.min() < radius < out.max() - 0.02
    assert points[:, 2].min() > 0.0
    assert points[:, 2].max() < scene.object("mug").truth.shape.top


def test_labels_lie_on_the_sides_of_their_box_and_read_upright() -> None:
    scene = load_scene("kitchen")
    shapes = _shapes(viewer_scene(scene, _stage(scene).model), "object")["coffee box"]
    size = scene.object("coffee box").truth.shape.extents
    labels = [shape for shape in shapes if shape["kind"] == "label"]
    assert len(labels) == 4
    for label in labels:
        R, p = from_quaternion(np.array(label["pose"][:4])), np.array(label["pose"][4:])
        outward = R[:, 2]
        assert R[2, 1] == pytest.approx(1.0, abs=1e-5)  # the text's up is up
        side = np.abs(outward[:2]) @ np.array(size[:2]) / 2.0
        assert 0.0 < p @ outward - side < 1e-3
        assert label["text"] == "coffee box"


def test_the_arm_hangs_from_a_stand_that_reaches_the_ground(document: dict[str, Any]) -> None:
    (world,) = _shapes(document, "world").values()
    named = {shape["name"]: shape for shape in world}
    column = named["column"]
    assert column["pose"][6] - column["size"][2] / 2 == pytest.approx(document["floor"])
    assert named["plate"]["pose"][6] - named["plate"]["size"][2] / 2 == pytest.approx(1.1)


def test_poses_stand_in_the_order_of_the_bodies(scene: Scene, document: dict[str, Any]) -> None:
    stage = _stage(scene)
    bodies = drawn_bodies(stage.model)
    poses = body_poses(stage.model, bodies, stage.plant_context)
    assert poses.shape == (len(document["bodies"]), 7)
    names = [body_name(body) for body in bodies]
    assert names == [body["name"] for body in document["bodies"]]
    for item in scene.objects:
        place = poses[names.index(f"{item.name}/{item.name}"), 4:]
        np.testing.assert_allclose(place, [item.pose.x_m, item.pose.y_m, 0.0], atol=1e-9)


def test_a_box_is_drawn_with_its_name_as_it_is_believed() -> None:
    model = Registry.default().find_one("ice tea box")
    (body,) = believed_scene("mine", {"crate": model})["bodies"]
    solid, *labels = body["shapes"]
    assert (body["object"], solid["size"]) == ("crate", model.extents)
    assert solid["pose"][6] == pytest.approx(model.top / 2)
    assert {label["text"] for label in labels} == {"crate"}


def test_every_model_is_drawn_as_large_as_it_is_believed() -> None:

    models = {model.name: model for model in Registry.default()}
    for body in believed_scene("all", models)["bodies"]:
        model, solid = models[body["name"]], body["shapes"][0]
        match solid["kind"]:
            case "box":
                # An open box is drawn as its floor and its walls.
                boxes = [each for each in body["shapes"] if each["kind"] == "box"]
                middles = np.array([each["pose"][4:] for each in boxes])
                halves = np.array([each["size"] for each in boxes]) / 2.0
                size = tuple((middles + halves).max(axis=0) - (middles - halves).min(axis=0))
            case "lathe":
                radius, height = np.max(solid["profile"], axis=0)
                size = (2 * radius, 2 * radius, height)
            case _:
                size = tuple(np.ptp(np.reshape(solid["corners"], (-1, 3)), axis=0))
        # Shapes are told to a hundredth of a millimetre.
        assert size == pytest.approx(model.extents, abs=2e-5), body["name"]


def test_poses_of_a_sample_are_told_by_the_names_of_the_document() -> None:
    scene = load_scene("kitchen")
    shown = SceneBodies(scene)
    rows = {item.name: np.array([1.0, 0, 0, 0, 0.1, 0.2, 0.3]) for item in scene.objects}
    sample = Sample(time=0.0, poses=rows, joints=np.array([0.5]), lids={"ice tea cup": 1.0})
    poses = shown.poses(sample, ["arm_joint_1"])
    geometry = SceneGeometry(source="observer", **shown.document())
    assert list(poses) == [body.name for body in geometry.bodies]
    assert poses["mug/mug"] == (1.0, 0.0, 0.0, 0.0, 0.1, 0.2, 0.3)
    assert poses["lwr_arm/arm_link_1"] != poses["lwr_arm/arm_base"]
    lid = from_quaternion(np.array(poses["ice tea cup lid/ice tea cup lid"][:4]))
    assert np.degrees(np.arccos(lid[2, 2])) == pytest.approx(np.degrees(1.0), abs=0.01)

"""A scene as a viewer draws it: its bodies with their shapes and colours, as plain data.

A body is named by its model and by its own name there, as `mug/mug` or `lwr_arm/arm_link_1`. The
table belongs to `WorldModelInstance/world`, which does not move. The shapes are those that the
plant has for pictures, and what `sim.views.visual_additions` adds.
A pose is a row of quaternion (w, x, y, z) and position [m]: of a shape in its body, of a body in W.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.rotations import Array
from sim.truth.scene_file import Scene
from sim.views.liquid_view import COLOUR, triangles
from sim.views.trace_scene import TraceScene
from sim.views.visual_additions import FLOOR, believed_shapes, furniture, object_shapes
from sim.worlds.drake.drake_plant import Plant

if TYPE_CHECKING:
    from pydrake.geometry import GeometryId, SceneGraphInspector, Shape
    from pydrake.math import RigidTransform
    from pydrake.multibody.tree import RigidBody
    from pydrake.systems.framework import Context

    from objectmodels import ObjectModel
    from sim.worlds.ports import Sample

FORMAT = "nlcontrol-viewer-scene/1"
"""Form of the document, and its version."""


def viewer_scene(scene: Scene, model: Plant) -> dict[str, Any]:
    """The bodies of a scene and of its plant, in the order of `body_poses`, as a JSON object."""
    bodies = [
        {
            "name": body_name(body),
            "kind": _kind(model, body),
            "object": _object(model, body),
            "shapes": shapes,
        }
        for body, shapes in _bodies_with_shapes(scene, model)
    ]
    return _document(scene.name, bodies)


def believed_scene(name: str, models: Mapping[str, ObjectModel]) -> dict[str, Any]:
    """Objects as they are believed to be, as `viewer_scene` has bodies.

    Args:
        name: of the scene.
        models: of the objects, by their names there.
    """
    bodies = [
        {"name": each, "kind": "object", "object": each, "shapes": believed_shapes(each, model)}
        for each, model in models.items()
    ]
    return _document(name, bodies)


def _document(name: str, bodies: list[dict[str, Any]]) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "name": name,
        "floor": FLOOR,
        "liquid": list(COLOUR),
        "bodies": bodies,
    }


class SceneBodies:
    """Robot, table and objects of a scene, apart from any world in which something happens.

    Args:
        scene: what is shown.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._stage = TraceScene(scene, lambda builder, model: None)
        self._bodies = drawn_bodies(self._stage.model)

    def document(self) -> dict[str, Any]:
        """All that is drawn; see `viewer_scene`."""
        return viewer_scene(self._scene, self._stage.model)

    def poses(self, sample: Sample, joint_names: Sequence[str]) -> dict[str, tuple[float, ...]]:
        """Poses of all bodies: quaternion (w, x, y, z) and position in W [m], by their names.

        Args:
            sample: of a world of this scene.
            joint_names: of the angles in it.
        """
        joints = dict(zip(joint_names, sample.joints.tolist(), strict=True))
        stage = self._stage
        stage.put(joints, sample.poses, sample.lids, sample.lid_poses)
        rows = body_poses(stage.model, self._bodies, stage.plant_context)
        return {
            body_name(body): tuple(rounded_values(row))
            for body, row in zip(self._bodies, rows, strict=True)
        }


def body_name(body: RigidBody) -> str:
    """Name of a body, which no other one of its plant has."""
    name: str = body.scoped_name().get_full()
    return name.replace("::", "/")


def drawn_bodies(model: Plant) -> list[RigidBody]:
    """The bodies of a plant that have something to be seen, in the order of the plant."""
    from pydrake.multibody.tree import BodyIndex

    plant = model.plant
    every = [plant.get_body(BodyIndex(i)) for i in range(plant.num_bodies())]
    return [body for body in every if _seen_geometries(model, body)]


def body_poses(model: Plant, bodies: list[RigidBody], context: Context) -> Array:
    """Poses of bodies in W, shape (n, 7), in a context of the plant."""
    return np.array([pose_row(model.plant.EvalBodyPoseInWorld(context, body)) for body in bodies])


def pose_row(X: RigidTransform) -> Array:
    """A pose as a row of a trace: quaternion (w, x, y, z) and position."""
    return np.append(X.rotation().ToQuaternion().wxyz(), X.translation())


def _kind(model: Plant, body: RigidBody) -> str:
    if body.index() == model.plant.world_body().index():
        return "world"
    if body.model_instance() in (model.arm, model.hand):
        return "robot"
    is_lid = any(lid.body.index() == body.index() for lid in model.lids.values())
    return "lid" if is_lid else "object"


def _object(model: Plant, body: RigidBody) -> str | None:
    """Name of the object that a body is, or whose lid it is; None for others."""
    lids = {lid.body.index(): name for name, lid in model.lids.items()}
    bodies = {each.index(): name for name, each in model.bodies.items()}
    return (lids | bodies).get(body.index())


def _bodies_with_shapes(scene: Scene, model: Plant) -> Iterator[tuple[RigidBody, list[Any]]]:
    inspector = model.scene_graph.model_inspector()
    for body in drawn_bodies(model):
        shapes = [_drawn(inspector, each) for each in _seen_geometries(model, body)]
        if _kind(model, body) == "object":
            shapes = object_shapes(scene.object(body.name()), shapes)
        elif _kind(model, body) == "world":
            shapes = furniture(scene, shapes)
        yield body, shapes


def _seen_geometries(model: Plant, body: RigidBody) -> list[GeometryId]:
    from pydrake.geometry import Role

    frame = model.plant.GetBodyFrameIdOrThrow(body.index())
    found: list[GeometryId] = model.scene_graph.model_inspector().GetGeometries(
        frame, Role.kIllustration
    )
    return found


def _drawn(inspector: SceneGraphInspector, geometry: GeometryId) -> dict[str, Any]:
    """A geometry as a shape with its place and colour."""
    from pydrake.geometry import Rgba

    properties = inspector.GetIllustrationProperties(geometry)
    colour = properties.GetPropertyOrDefault("phong", "diffuse", Rgba(0.8, 0.8, 0.8, 1.0))
    return {
        "name": inspector.GetName(geometry).rpartition("::")[2],
        "pose": rounded_values(pose_row(inspector.GetPoseInFrame(geometry))),
        "colour": rounded_values(np.array([colour.r(), colour.g(), colour.b(), colour.a()])),
        **_form(inspector.GetShape(geometry)),
    }


def _form(shape: Shape) -> dict[str, Any]:
    """The kind and the measures of a shape [m]."""
    from pydrake.geometry import Box, Capsule, Cylinder, Sphere

    match shape:
        case Box():
            return {"kind": "box", "size": rounded_values(shape.size())}
        case Sphere():
            return {"kind": "sphere", "radius": shape.radius()}
        case Cylinder() | Capsule():
            kind = "cylinder" if isinstance(shape, Cylinder) else "capsule"
            return {"kind": kind, "radius": shape.radius(), "length": shape.length()}
    hull = shape.GetConvexHull()
    corners = np.array([hull.vertex(i) for i in range(hull.num_vertices())])
    corners, faces = triangles([corners])
    return {
        "kind": "mesh",
        "corners": rounded_values(corners.ravel()),
        "faces": faces.ravel().tolist(),
    }


def rounded_values(values: Array) -> list[float]:
    """Numbers as a document has them, to the hundredth of a millimetre."""
    listed: list[float] = np.round(values, 5).tolist()
    return listed

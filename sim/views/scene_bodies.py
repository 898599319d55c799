"""Bodies of a scene for a viewer that draws them itself: shapes once, poses as they change.

A body is named by its model and by its own name there, as `mug/mug` or `lwr_arm/arm_link_1`. The
table belongs to `WorldModelInstance/world`, which does not move.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from sim.truth.scene_file import Scene
from sim.views.liquid_view import triangles
from sim.views.trace_scene import TraceScene
from sim.worlds.drake.drake_plant import Plant

if TYPE_CHECKING:
    from pydrake.geometry import Shape
    from pydrake.math import RigidTransform
    from pydrake.multibody.tree import RigidBody

    from sim.worlds.ports import Sample

ShapeKind = Literal["box", "cylinder", "capsule", "sphere", "mesh"]


@dataclass(frozen=True)
class BodyShape:
    """A shape of a body, as it is drawn.

    Attributes:
        body: name of the body.
        object: name of the scene's object that the body is, or whose lid it is; None for others.
        kind: of the shape; one with an axis stands along z.
        size: edges of a box; radius and length of a cylinder, of a capsule without its round ends;
            radius of a sphere [m].
        vertices, triangles: of a mesh, n places [m] and m times three of their numbers, either way
            round.
        pose: of the shape in the body: quaternion (w, x, y, z) and position [m].
        colour: red, green, blue and opacity, 0…1.
    """

    body: str
    object: str | None
    kind: ShapeKind
    size: tuple[float, ...]
    vertices: tuple[tuple[float, ...], ...]
    triangles: tuple[tuple[int, ...], ...]
    pose: tuple[float, ...]
    colour: tuple[float, ...]


class SceneBodies:
    """Robot, table and objects of a scene, apart from any world in which something happens.

    Args:
        scene: what is shown.
    """

    def __init__(self, scene: Scene) -> None:
        from pydrake.multibody.tree import BodyIndex

        self._models: list[Plant] = []
        self._stage = TraceScene(scene, lambda builder, model: self._models.append(model))
        plant = self._models[0].plant
        bodies = [plant.get_body(BodyIndex(i)) for i in range(plant.num_bodies())]
        self._bodies: Mapping[str, RigidBody] = {
            body.scoped_name().get_full().replace("::", "/"): body
            for body in bodies
            if plant.GetVisualGeometriesForBody(body)
        }

    def shapes(self) -> tuple[BodyShape, ...]:
        """All that is drawn."""
        (model,) = self._models
        objects = {body.index(): name for name, body in model.bodies.items()}
        objects |= {lid.body.index(): name for name, lid in model.lids.items()}
        inspector = model.scene_graph.model_inspector()
        found = []
        for name, body in self._bodies.items():
            for geometry in model.plant.GetVisualGeometriesForBody(body):
                shape = inspector.GetShape(geometry)
                kind, size = _form(shape)
                vertices, faces = _hull(shape) if kind == "mesh" else ((), ())
                pose = _row(inspector.GetPoseInFrame(geometry))
                drawn = inspector.GetIllustrationProperties(geometry)
                colour = drawn.GetProperty("phong", "diffuse")
                rgba = (colour.r(), colour.g(), colour.b(), colour.a())
                owner = objects.get(body.index())
                found.append(BodyShape(name, owner, kind, size, vertices, faces, pose, rgba))
        return tuple(found)

    def poses(self, sample: Sample, joint_names: Sequence[str]) -> dict[str, tuple[float, ...]]:
        """Poses of all bodies: quaternion (w, x, y, z) and position in W [m], by their names.

        Args:
            sample: of a world of this scene.
            joint_names: of the angles in it.
        """
        stage, plant = self._stage, self._models[0].plant
        joints = dict(zip(joint_names, sample.joints.tolist(), strict=True))
        stage.put(joints, sample.poses, sample.lids, sample.lid_poses)
        context = plant.GetMyContextFromRoot(stage.context)
        return {
            name: _row(plant.EvalBodyPoseInWorld(context, body))
            for name, body in self._bodies.items()
        }


def _row(X: RigidTransform) -> tuple[float, ...]:
    """A pose as seven numbers, to a hundredth of a millimetre."""
    row = np.concatenate([X.rotation().ToQuaternion().wxyz(), X.translation()])
    return tuple(np.round(row, 5).tolist())


def _form(shape: Shape) -> tuple[ShapeKind, tuple[float, ...]]:
    """Kind and size of a shape."""
    from pydrake.geometry import Box, Capsule, Cylinder, Sphere

    match shape:
        case Box():
            return "box", tuple(shape.size().tolist())
        case Cylinder():
            return "cylinder", (shape.radius(), shape.length())
        case Capsule():
            return "capsule", (shape.radius(), shape.length())
        case Sphere():
            return "sphere", (shape.radius(),)
    return "mesh", ()


def _hull(shape: Shape) -> tuple[tuple[tuple[float, ...], ...], tuple[tuple[int, ...], ...]]:
    """Corners of a prism [m], and triangles of its surface."""
    hull = shape.GetConvexHull()
    piece = np.array([hull.vertex(i) for i in range(hull.num_vertices())])
    corners, faces = triangles((piece,))
    return tuple(map(tuple, corners.tolist())), tuple(map(tuple, faces.tolist()))

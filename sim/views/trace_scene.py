"""A scene that is only looked at: robot and objects are put where a trace says they were."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from sim.rotations import Array
from sim.truth.scene_file import Scene
from sim.views.liquid_view import COLOUR, parts
from sim.worlds.drake.drake_plant import Plant, add_plant

if TYPE_CHECKING:
    from pydrake.geometry import GeometryId
    from pydrake.math import RigidTransform
    from pydrake.systems.framework import Context, Diagram, DiagramBuilder

    from sim.traces.trace import Trace

_BY_HAND = ("lift", "carry", "pour", "lid")
_NEARER = 0.7  # share of the distance from which the work of a hand is looked at


class TraceScene:
    """A diagram without motion of its own.

    Attributes:
        diagram: with what `furnish` added, which looks at it (a camera, a visualizer).
        context: of the diagram.
        model: the plant in it, and `plant_context` its part of the context.
    """

    def __init__(self, scene: Scene, furnish: Callable[[DiagramBuilder, Plant], None]) -> None:
        from pydrake.systems.framework import DiagramBuilder

        builder = DiagramBuilder()
        self._scene = scene
        self.model = add_plant(builder, scene)
        furnish(builder, self.model)
        self.diagram: Diagram = builder.Build()
        self.context: Context = self.diagram.CreateDefaultContext()
        self.plant_context = self.model.plant.GetMyMutableContextFromRoot(self.context)
        self._graph_context = self.model.scene_graph.GetMyMutableContextFromRoot(self.context)
        self._liquid: list[GeometryId] = []

    def show(self, trace: Trace, sample: int) -> None:
        """Puts everything where it was at a sample of a trace."""
        self.context.SetTime(float(trace.time[sample] - trace.time[0]))
        self.put(
            dict(zip(trace.joint_names, trace.joints[sample].tolist(), strict=True)),
            {name: rows[sample] for name, rows in trace.poses.items()},
            {name: float(rows[sample]) for name, rows in trace.lids.items()},
            {name: rows[sample] for name, rows in trace.lid_poses.items()},
        )

    def put(
        self,
        joints: Mapping[str, float],
        poses: Mapping[str, Array],
        lids: Mapping[str, float],
        lid_poses: Mapping[str, Array],
    ) -> None:
        """Puts everything somewhere.

        Args:
            joints: angles of the robot's joints by their names [rad].
            poses: of the objects; quaternion (w, x, y, z) and position in W [m], shape (7,) each.
            lids: how far they are open, by the names of their objects; see `Trace.lids`.
            lid_poses: of those that come off, as `poses`.
        """
        plant, context = self.model.plant, self.plant_context
        for name, angle in joints.items():
            plant.GetJointByName(name).set_angle(context, angle)
        for name, body in self.model.bodies.items():
            if body.is_floating_base_body():  # one in a holder stays where it is
                plant.SetFreeBodyPose(context, body, rigid_transform(poses[name]))
        for name, lid in self.model.lids.items():
            if name not in lids:
                continue  # nobody looked: it stays closed
            if lid.seat is None:
                lid.joint.set_angle(context, lids[name])
            else:
                plant.SetFreeBodyPose(context, lid.body, rigid_transform(lid_poses[name]))

    def fill(self, trace: Trace, sample: int) -> None:
        """Shows a camera the liquid as it was at a sample of a trace."""
        from pydrake.geometry import Convex, GeometryInstance, PerceptionProperties, Rgba
        from pydrake.math import RigidTransform

        plant, graph, context = self.model.plant, self.model.scene_graph, self._graph_context
        source = plant.get_source_id()
        for geometry in self._liquid:
            graph.RemoveGeometry(context, source, geometry)
        self._liquid.clear()
        properties = PerceptionProperties()
        properties.AddProperty("phong", "diffuse", Rgba(*COLOUR))
        for part in parts(trace, self._scene, sample):
            frame = graph.world_frame_id()
            if part.of == "level":
                frame = plant.GetBodyFrameIdOrThrow(self.model.bodies[part.name].index())
            for i, piece in enumerate(part.pieces):
                shape = Convex(piece.T, "liquid")
                drawn = GeometryInstance(RigidTransform(), shape, f"{part.name} {part.of} {i}")
                drawn.set_perception_properties(properties)
                self._liquid.append(graph.RegisterGeometry(context, source, frame, drawn))


def rigid_transform(row: Array) -> RigidTransform:
    """Pose of a row of a trace: quaternion (w, x, y, z) and position."""
    from pydrake.common.eigen_geometry import Quaternion
    from pydrake.math import RigidTransform, RotationMatrix

    wxyz = row[:4] / np.linalg.norm(row[:4])
    return RigidTransform(RotationMatrix(Quaternion(wxyz)), row[4:])


def samples(trace: Trace, rate: float) -> list[int]:
    """Samples of a trace nearest to a frame rate [1/s], the first and the last among them."""
    wanted = np.append(np.arange(trace.time[0], trace.time[-1], 1.0 / rate), trace.time[-1])
    return [int(i) for i in np.searchsorted(trace.time, wanted - 1e-9)]


def view(trace: Trace, at: Array, off: Array) -> tuple[Array, Array]:
    """Places of an eye and of what it looks at: nearer to what a whole hand does than to a push.

    Args:
        trace: what is looked at.
        at: what it looks at by default, in W, shape (3,) [m].
        off: the eye from there, shape (3,) [m].
    """
    if "push" in trace.phase or not np.isin(trace.phase, _BY_HAND).any():
        return at + off, at
    changed = [name for name, volume in trace.contents.items() if volume[0] != volume[-1]]
    places = np.array([trace.poses[n][[0, -1], 4:6] for n in {trace.pushed, *changed}])
    near = np.array([*places.mean(axis=(0, 1)), at[2]])
    return near + _NEARER * off, near

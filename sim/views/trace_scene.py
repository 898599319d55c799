"""A scene that is only looked at: robot and objects are put where a trace says they were.

The liquid's form, a mug's handle, labels and the stand of the arm are for the eye alone: nothing of
them exists for the physics, the planner or the camera.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from objectmodels.containers.pour_dynamics import exit_velocity, fall_time
from objectmodels.geometry.rotations import Array, from_quaternion, quaternion, rot_z
from objectmodels.geometry.solids import ConvexHull, Cuboid, UprightCylinder
from objectmodels.mechanics.push_thresholds import GRAVITY
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.object_parts import Vessel
from sim.truth.object_truth import Truth
from sim.truth.scene_file import Scene, SceneObject
from sim.worlds.drake.contents import lean_of
from sim.worlds.drake.drake_plant import Plant, add_plant

if TYPE_CHECKING:
    from pydrake.geometry import GeometryId
    from pydrake.math import RigidTransform
    from pydrake.systems.framework import Context, Diagram, DiagramBuilder

    from sim.traces.trace import Trace


COLOUR = (0.62, 0.33, 0.10, 1.0)
"""Of tea: red, green, blue and opacity."""

FLOOR = -0.74
"""Height of the ground below the table top [m]."""

Shape = dict[str, Any]
"""A shape as plain data, see `sim.views.viewer_recording`.

Kinds besides those of the plant are `lathe` (a profile of radius and height, turned about z),
`tube` (through points) and `label` (a sheet with a text, facing z)."""

_UPRIGHT = (1.0, 0.0, 0.0, 0.0)
_HERE = (*_UPRIGHT, 0.0, 0.0, 0.0)  # where its body is
_STEEL, _WHITE = (0.46, 0.48, 0.51, 1.0), (0.96, 0.95, 0.91, 1.0)
_WITH_HANDLE = frozenset({"mug"})  # models of the registry
_WIDE = 0.7  # share of the radius from which an opening shows what is inside
_SHELL = 0.42  # opacity of what it must be looked through
_LIFTED = 4e-4  # of a label above its side [m]


@dataclass(frozen=True)
class Part:
    """A body of liquid, drawn as convex pieces.

    What stands in a container is its cavity below the level; a stream is a chain of thin cylinders
    along its parabola, down to what catches it.

    Attributes:
        name: the container that it is in or comes from.
        of: `level` or `stream`.
        pieces: corners of convex pieces, shape (k, 3) each; a level's in B, a stream's in W [m].
    """

    name: str
    of: str
    pieces: tuple[Array, ...]


def parts(trace: Trace, scene: Scene, sample: int) -> Iterator[Part]:
    """All liquid at a sample of a trace."""
    for name, volumes in trace.contents.items():
        vessel = scene.object(name).truth.vessel
        assert vessel is not None
        R_WB, p_WB = _pose(trace, name, sample)
        if volumes[sample] > 1e-7:
            yield Part(name, "level", (_standing(vessel, volumes[sample], R_WB),))
        lost = volumes[max(sample - 1, 0)] - volumes[sample]
        if lost > 0.0:
            rate = lost / float(trace.time[sample] - trace.time[sample - 1])
            below = _landing_height(trace, scene, name, sample)
            pieces = _stream(vessel, volumes[sample], rate, (R_WB, p_WB), below)
            yield Part(name, "stream", pieces)


def triangles(pieces: Sequence[Array]) -> tuple[Array, Array]:
    """Corners (n, 3) of convex pieces, and of each triangle of their surfaces the three, (m, 3).

    Seen from outside a triangle's corners go counterclockwise: others are not drawn.
    """
    from scipy.spatial import ConvexHull

    faces, first = [], 0
    for piece in pieces:
        hull = ConvexHull(piece)
        a, b, c = np.asarray(piece)[hull.simplices].transpose(1, 0, 2)
        outwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) > 0.0
        ordered = np.where(outwards[:, None], hull.simplices, hull.simplices[:, ::-1])
        faces.append(ordered + first)
        first += len(piece)
    return np.concatenate(pieces), np.concatenate(faces)


def _pose(trace: Trace, name: str, sample: int) -> tuple[Array, Array]:
    pose = trace.poses[name][sample]
    return from_quaternion(pose[:4] / np.linalg.norm(pose[:4])), pose[4:]


def _standing(vessel: Vessel, volume: float, R_WB: Array) -> Array:
    """Corners of what of a cavity is below the level, in B."""
    ring = vessel.section.corners
    low, high = (np.column_stack([ring, np.full(len(ring), z)]) for z in (vessel.floor, vessel.top))
    level = float(vessel.surface_level(min(volume, vessel.capacity), *lean_of(R_WB[2])))
    starts = np.concatenate([low, high, low])
    ends = np.concatenate([np.roll(low, -1, axis=0), np.roll(high, -1, axis=0), high])
    a, b = starts @ R_WB[2] - level, ends @ R_WB[2] - level
    cut = a * b < 0.0
    crossing = starts[cut] + (a / np.where(cut, a - b, 1.0))[cut, None] * (ends - starts)[cut]
    corners = np.concatenate([low, high])
    return np.concatenate([corners[corners @ R_WB[2] <= level], crossing])


def _landing_height(trace: Trace, scene: Scene, source: str, sample: int) -> float:
    """Height at which a stream ends: the level of what it fills, or the table [m]."""
    for name, volumes in trace.contents.items():
        if name != source and volumes[sample] > volumes[sample - 1]:
            vessel = scene.object(name).truth.vessel
            assert vessel is not None
            R_WB, p_WB = _pose(trace, name, sample)
            return float(p_WB[2] + vessel.surface_level(volumes[sample], *lean_of(R_WB[2])))
    return 0.0


def _stream(
    vessel: Vessel, volume: float, rate: float, X_WB: tuple[Array, Array], below: float
) -> tuple[Array, ...]:
    """A stream from the lip down to a height."""
    R_WB, p_WB = X_WB
    tilt, heading = lean_of(R_WB[2])
    p_WL = p_WB + R_WB @ vessel.lip_point(heading)
    head = max(float(vessel.liquid_head(volume, tilt, heading)), 1e-4)
    ahead, down = (float(v) for v in exit_velocity(head, tilt))
    t = np.linspace(0.0, float(fall_time(down, p_WL[2] - below)), 9)
    out = R_WB[:2, 2] / max(float(np.hypot(*R_WB[:2, 2])), 1e-9)
    middles = p_WL + np.column_stack(
        [np.outer(ahead * t, out), -(down * t + 0.5 * GRAVITY * t * t)]
    )
    speeds = np.hypot(ahead, down + GRAVITY * t)
    radii = np.clip(np.sqrt(rate / (np.pi * speeds)), 0.0015, 0.006)  # [m]
    phi = 2.0 * np.pi * np.arange(8) / 8
    # Rings across the way: one side horizontal, the other square to both.
    along = np.column_stack([np.outer(np.full_like(t, ahead), out), -(down + GRAVITY * t)])
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    side = np.array([-out[1], out[0], 0.0])
    other = np.cross(along, side)
    rings = middles[:, None] + radii[:, None, None] * (
        np.cos(phi)[:, None] * side + np.sin(phi)[:, None] * other[:, None]
    )
    if t[-1] <= 0.0:
        return ()
    return tuple(np.concatenate(pair) for pair in pairwise(rings))


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
    if "push" in trace.phase or not np.isin(trace.phase, ("lift", "carry", "pour", "lid")).any():
        return at + off, at
    changed = [name for name, volume in trace.contents.items() if volume[0] != volume[-1]]
    places = np.array([trace.poses[n][[0, -1], 4:6] for n in {trace.pushed, *changed}])
    near = np.array([*places.mean(axis=(0, 1)), at[2]])
    return near + 0.7 * off, near


def object_shapes(item: SceneObject, shapes: list[Shape]) -> list[Shape]:
    """The shapes of an object, with what makes it recognisable to the eye alone."""
    truth, form, vessel = item.truth, item.truth.shape, item.truth.vessel
    drawn = []
    for shape in shapes:
        if shape["name"] == "solid" and vessel is not None and form.rim.is_round:
            drawn.append(_hollow(shape, truth, vessel))
        elif shape["name"] == "solid" and vessel is not None:
            drawn.append(shape | {"colour": (*shape["colour"][:3], _SHELL)})
        else:
            drawn.append(shape)
    if item.model in _WITH_HANDLE and form.rim.is_round:
        drawn.append(_handle(form.rim.size, form.top, drawn[0]["colour"]))
    if form.is_labelled:
        drawn += _labels(item.name, form.extents)
        if truth.container is not None and truth.lid is None:
            drawn.append(_spout(truth))
    return drawn


def believed_shapes(name: str, model: ObjectModel) -> list[Shape]:
    """The shapes of an object as it is believed to be, with its name on the sides of a box."""
    drawn = [solid.accept(_BelievedSolid(model)) for solid in model.solids]
    if model.name in _WITH_HANDLE and model.rim.is_round:
        drawn.append(_handle(model.rim.size, model.top, _WHITE))
    return [*drawn, *(_labels(name, model.extents) if model.is_labelled else ())]


@dataclass(frozen=True)
class _BelievedSolid:
    """The shape of a solid of a model."""

    model: ObjectModel

    def cuboid(self, solid: Cuboid) -> Shape:
        """Of cardboard."""
        cardboard = (0.72, 0.62, 0.48, 1.0)
        return _box("solid", tuple(solid.size.tolist()), tuple(solid.middle.tolist()), cardboard)

    def cylinder(self, solid: UprightCylinder) -> Shape:
        """On its foot; hollow if it is a wide container without a lid."""
        container, radius, top = self.model.container, solid.radius, solid.high
        base = self.model.footprint.size
        profile = [(0.0, 0.0), (base, 0.0), (radius, radius - base), (radius, top)]
        if container and self.model.lid is None and container.opening.radius > _WIDE * radius:
            inner, floor = radius - container.wall, container.wall
            profile += [(inner, top), (inner, floor), (0.0, floor)]
        else:
            profile.append((0.0, top))
        rounded = [(round(r, 5), round(z, 5)) for r, z in profile]
        return {
            "name": "solid",
            "kind": "lathe",
            "pose": _HERE,
            "colour": _WHITE,
            "profile": rounded,
        }

    def hull(self, solid: ConvexHull) -> Shape:
        """Its triangles."""
        points, faces = triangles([solid.vertices])
        measures = {"corners": points.ravel().round(5).tolist(), "faces": faces.ravel().tolist()}
        return {"name": "solid", "kind": "mesh", "pose": _HERE, "colour": _WHITE, **measures}


def furniture(scene: Scene, shapes: list[Shape]) -> list[Shape]:
    """The shapes of the world in light wood, with lines, legs and the stand of the arm."""
    table = [shape | {"colour": (0.79, 0.73, 0.65, 1.0)} for shape in shapes]
    return [*table, _grid(scene), *_legs(scene), *_stand(scene)]


def _hollow(shape: Shape, truth: Truth, vessel: Vessel) -> Shape:
    """A round container as a shell: outer side, rim, inner side and floor."""
    assert truth.container is not None
    radius, height, floor = truth.shape.rim.size, truth.shape.top, vessel.floor
    wall, opening = truth.container.wall, truth.container.opening.radius
    base = truth.shape.footprint.size
    wide = opening > _WIDE * radius
    seen_into = wide and truth.lid is None
    off_table = 2e-4  # of the lower side [m]
    outside = [(0.0, off_table), (base, off_table), (radius, floor)]
    if seen_into:
        inner = radius - wall
        profile = [*outside, (radius, height), (inner, height), (inner, floor), (0.0, floor)]
    elif wide:  # an inner side would stripe with the liquid that is seen through the outer one
        profile = [*outside, (radius, height), (opening, height)]
    else:
        neck = opening + 0.0015  # its wall [m]
        shoulder = [(radius, 0.78 * height), (neck, 0.88 * height)]
        profile = [*outside, *shoulder, (neck, height), (opening, height)]
    return shape | {
        "kind": "lathe",
        "profile": [(round(r, 5), round(z, 5)) for r, z in profile],
        "pose": _HERE,
        "colour": (*shape["colour"][:3], 1.0 if seen_into else _SHELL),
    }


def _handle(radius: float, height: float, colour: tuple[float, ...]) -> Shape:
    """An ear on the side of -y."""
    turns = np.linspace(-0.5, 0.5, 9) * math.pi
    out = radius - 0.002 + 0.028 * np.cos(turns)
    points = np.column_stack([0.0 * turns, -out, height * (0.52 + 0.33 * np.sin(turns))])
    return {
        "name": "handle",
        "kind": "tube",
        "points": points.round(5).tolist(),
        "radius": 0.0048,
        "pose": _HERE,
        "colour": colour,
    }


def _spout(truth: Truth) -> Shape:
    """A ring about the opening of a carton."""
    assert truth.container is not None
    opening = truth.container.opening
    inner, outer, up = opening.radius, opening.radius + 0.0015, 0.006
    return {
        "name": "spout",
        "kind": "lathe",
        "profile": [(inner, 0.0), (outer, 0.0), (outer, up), (inner, up), (inner, 0.0)],
        "pose": (*_UPRIGHT, *opening.centre, truth.shape.top),
        "colour": _WHITE,
    }


def _labels(name: str, size: tuple[float, float, float]) -> Iterator[Shape]:
    """Its name on the four sides of a box."""
    length, width, height = size
    for turn in range(4):
        depth, wide = (length, width) if turn % 2 == 0 else (width, length)
        if wide < 0.03:
            continue
        R = rot_z(turn * math.pi / 2.0)
        upright = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
        place = R @ [depth / 2.0 + _LIFTED, 0.0, 0.58 * height]
        pose = np.concatenate([quaternion(R @ upright), place])
        yield {
            "name": "label",
            "kind": "label",
            "text": name,
            "size": [round(0.78 * wide, 5), round(0.42 * height, 5)],
            "pose": pose.round(6).tolist(),
            "colour": _WHITE,
        }


def _box(
    name: str,
    size: Sequence[float],
    middle: Sequence[float],
    colour: tuple[float, ...],
) -> Shape:
    return {
        "name": name,
        "kind": "box",
        "size": size,
        "pose": (*_UPRIGHT, *middle),
        "colour": colour,
    }


def _grid(scene: Scene) -> Shape:
    """Lines 10 cm apart, to see distances by."""
    x, y = scene.table.centre_m
    return {
        "name": "grid",
        "kind": "grid",
        "size": scene.table.size_m,
        "cell": 0.1,
        "pose": (*_UPRIGHT, x, y, _LIFTED),
        "colour": (0.16, 0.12, 0.08, 0.16),
    }


def _legs(scene: Scene) -> Iterator[Shape]:
    (x, y), (length, width) = scene.table.centre_m, scene.table.size_m
    top, thick, inset = -scene.table.thickness_m, 0.06, 0.07
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            middle = (
                x + sx * (length / 2 - inset),
                y + sy * (width / 2 - inset),
                (top + FLOOR) / 2,
            )
            yield _box("leg", (thick, thick, top - FLOOR), middle, (0.60, 0.54, 0.46, 1.0))


def _stand(scene: Scene) -> Iterator[Shape]:
    """A column behind the table with a beam over the base; a plinth below a base that stands."""
    x, y, z = scene.robot.base_m
    roll, pitch, _ = np.radians(scene.robot.base_rpy_deg)
    if math.cos(roll) * math.cos(pitch) > 0.0:
        yield _box("plinth", (0.2, 0.2, z - FLOOR), (x, y, (z + FLOOR) / 2), _STEEL)
        return
    thick, plate, before = 0.1, 0.02, x - 0.11
    column = scene.table.centre_m[0] + scene.table.size_m[0] / 2 + 0.12
    below, behind = z + plate, column + thick / 2
    yield _box("plate", (0.22, 0.22, plate), (x, y, z + plate / 2), _STEEL)
    middle = ((before + behind) / 2, y, below + thick / 2)
    yield _box("beam", (behind - before, thick, thick), middle, _STEEL)
    middle = (column, y, (below + FLOOR) / 2)
    yield _box("column", (thick, thick, below - FLOOR), middle, _STEEL)
    yield _box("foot", (0.34, 0.5, 0.03), (column, y, FLOOR + 0.015), _STEEL)

"""Additions to a scene for the eye alone: a mug's handle, labels, the stand of the arm.

Nothing of this exists for the physics, the planner or the camera. Every shape is plain data as in
`sim.views.viewer_scene`; kinds besides those of the plant are `lathe` (a profile of radius and
height, turned about z), `tube` (through points) and `label` (a sheet with a text, facing z).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from objectmodels.models.object_model import ObjectModel
from objectmodels.models.object_parts import Cavity, Vessel, open_box_parts
from objectmodels.models.shapes import BoxModel, CylinderModel, HullModel
from sim.rotations import quaternion, rot_z
from sim.truth.object_truth import Truth
from sim.truth.scene_file import Scene, SceneObject
from sim.views.liquid_view import triangles

Shape = dict[str, Any]

FLOOR = -0.74
"""Height of the ground below the table top [m]."""

_UPRIGHT = (1.0, 0.0, 0.0, 0.0)
_HERE = (*_UPRIGHT, 0.0, 0.0, 0.0)  # where its body is
_TABLE, _WOOD = (0.79, 0.73, 0.65, 1.0), (0.60, 0.54, 0.46, 1.0)
_CARDBOARD = (0.72, 0.62, 0.48, 1.0)
_STEEL, _WHITE = (0.46, 0.48, 0.51, 1.0), (0.96, 0.95, 0.91, 1.0)
_WITH_HANDLE = frozenset({"mug"})  # models of the registry
_WIDE = 0.7  # share of the radius from which an opening shows what is inside
_SHELL = 0.42  # opacity of what it must be looked through
_SHOULDER, _NECK = 0.78, 0.88  # heights in shares of a bottle's
_LABEL, _NARROW = (0.78, 0.42), 0.03  # label in shares of a side; sides too narrow for one [m]
_LABEL_HEIGHT = 0.58  # of its middle, as a share of the box's
_LIFTED = 4e-4  # of a label above its side [m]
_OFF_TABLE = 2e-4  # of the lower side of a shell [m]
_NECK_WALL = 0.0015  # of a bottle [m]
_FACES_X = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # a sheet upright


def object_shapes(item: SceneObject, shapes: list[Shape]) -> list[Shape]:
    """The shapes of an object, with what makes it recognisable."""
    truth, vessel = item.truth, item.truth.vessel
    drawn = []
    for shape in shapes:
        if shape["name"] == "solid" and vessel is not None and truth.radius_m is not None:
            drawn.append(_hollow(shape, truth, vessel))
        elif shape["name"] == "solid" and vessel is not None:
            drawn.append(shape | {"colour": (*shape["colour"][:3], _SHELL)})
        else:
            drawn.append(shape)
    if item.model in _WITH_HANDLE and truth.radius_m is not None:
        drawn.append(_handle(truth.radius_m, truth.height, drawn[0]["colour"]))
    if truth.size_m is not None:
        drawn += _labels(item.name, truth.size_m)
        if truth.container is not None and truth.lid is None:
            drawn.append(_spout(truth))
    return drawn


def believed_shapes(name: str, model: ObjectModel) -> list[Shape]:
    """The shapes of an object as it is believed to be, with its name on the sides of a box."""
    if isinstance(model, BoxModel):
        if model.inside is not None:
            return _open_box(name, model.extents, model.inside)
        return box_shapes(name, model.extents)
    if isinstance(model, CylinderModel):
        round_shapes = [_turned(model)]
        if model.name in _WITH_HANDLE:
            round_shapes.append(_handle(model.radius, model.top, _WHITE))
        return round_shapes
    corners = np.array([(x, y, z) for z in (0.0, model.top) for x, y in model.outline])
    if isinstance(model, HullModel):
        corners = np.array(model.vertices)
    points, faces = triangles([corners])
    measures = {"corners": points.ravel().round(5).tolist(), "faces": faces.ravel().tolist()}
    return [{"name": "solid", "kind": "mesh", "pose": _HERE, "colour": _WHITE, **measures}]


def _turned(model: CylinderModel) -> Shape:
    """A cylinder on its foot; hollow if it is a wide container without a lid."""
    radius, base = model.radius, model.base_radius or model.radius
    profile = [(0.0, 0.0), (base, 0.0), (radius, radius - base), (radius, model.top)]
    container = model.container
    if container and model.lid is None and container.opening.radius > _WIDE * radius:
        inner, floor = radius - container.wall, container.wall
        profile += [(inner, model.top), (inner, floor), (0.0, floor)]
    else:
        profile.append((0.0, model.top))
    return {
        "name": "solid", "kind": "lathe", "pose": _HERE, "colour": _WHITE,
        "profile": [(round(r, 5), round(z, 5)) for r, z in profile],
    }  # fmt: skip


def box_shapes(name: str, size: Sequence[float]) -> list[Shape]:
    """A box that stands on the table, with its name on it; its edges are along x, y and z [m]."""
    x, y, z = size
    return [_box("solid", (x, y, z), (0.0, 0.0, z / 2), _CARDBOARD), *_labels(name, (x, y, z))]


def _open_box(name: str, size: tuple[float, float, float], inside: Cavity) -> list[Shape]:
    """The floor and the walls of an open box, with its name on them."""
    parts = [
        _box("solid", (high - low).tolist(), ((low + high) / 2.0).tolist(), _CARDBOARD)
        for low, high in open_box_parts(size, inside)
    ]
    return [*parts, *_labels(name, size)]


def furniture(scene: Scene, shapes: list[Shape]) -> list[Shape]:
    """The shapes of the world in light wood, with lines, legs and the stand of the arm."""
    table = [shape | {"colour": _TABLE} for shape in shapes]
    return [*table, _grid(scene), *_legs(scene), *_stand(scene)]


# -- objects --------------------------------------------------------------------------------------


def _hollow(shape: Shape, truth: Truth, vessel: Vessel) -> Shape:
    """A round container as a shell: outer side, rim, inner side and floor."""
    assert truth.radius_m is not None
    assert truth.container is not None
    radius, height, floor = truth.radius_m, truth.height, vessel.floor
    wall, opening = truth.container.wall, truth.container.opening.radius
    base = truth.base_radius_m or radius
    wide = opening > _WIDE * radius
    seen_into = wide and truth.lid is None
    outside = [(0.0, _OFF_TABLE), (base, _OFF_TABLE), (radius, floor)]
    if seen_into:
        inner = radius - wall
        profile = [*outside, (radius, height), (inner, height), (inner, floor), (0.0, floor)]
    elif wide:  # an inner side would stripe with the liquid that is seen through the outer one
        profile = [*outside, (radius, height), (opening, height)]
    else:
        neck = opening + _NECK_WALL
        shoulder = [(radius, _SHOULDER * height), (neck, _NECK * height)]
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
        "pose": (*_UPRIGHT, *opening.centre, truth.height),
        "colour": _WHITE,
    }


def _labels(name: str, size: tuple[float, float, float]) -> Iterator[Shape]:
    """Its name on the four sides of a box."""
    length, width, height = size
    for turn in range(4):
        depth, wide = (length, width) if turn % 2 == 0 else (width, length)
        if wide < _NARROW:
            continue
        R = rot_z(turn * math.pi / 2.0)
        place = R @ [depth / 2.0 + _LIFTED, 0.0, _LABEL_HEIGHT * height]
        pose = np.concatenate([quaternion(R @ _FACES_X), place])
        yield {
            "name": "label",
            "kind": "label",
            "text": name,
            "size": [round(_LABEL[0] * wide, 5), round(_LABEL[1] * height, 5)],
            "pose": pose.round(6).tolist(),
            "colour": _WHITE,
        }


# -- furniture ------------------------------------------------------------------------------------


def _box(
    name: str,
    size: tuple[float, float, float],
    middle: tuple[float, float, float],
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
    return {"name": "grid", "kind": "grid", "size": scene.table.size_m, "cell": 0.1,
            "pose": (*_UPRIGHT, x, y, _LIFTED), "colour": (0.16, 0.12, 0.08, 0.16)}  # fmt: skip


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
            yield _box("leg", (thick, thick, top - FLOOR), middle, _WOOD)


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

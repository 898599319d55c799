"""From a mesh to a model: the base it stands on, its volume and its centre of mass.

Model: the object is the convex hull of the mesh, or the box, cylinder or prism that this nearly is;
its volume and centre of mass are those of the mesh itself where that is closed, at uniform density.
Mesh files state no units and often no upward direction; both are asked for.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from objectmodels.errors import ModelError, printable
from objectmodels.files.yaml_documents import LIMITS, first_fault, read_bytes
from objectmodels.geometry.base_shapes import Array, hull_polygon
from objectmodels.geometry.solids import hull_facets, lowest_places, turning_down, volume_and_centre
from objectmodels.models.kinds import BoxModel, CylinderModel, HullModel, PrismModel
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.parameters import Provenance
from objectmodels.models.shapes import WIDE

# The plain solid that a convex hull nearly is: a box, a cylinder or a prism.
#
# A hull counts as one if nowhere the one sticks out of the other by more than `LARGEST_RESIDUAL`,
# measured along the normals of the faces that it sticks out of.

LARGEST_RESIDUAL = 0.02
"""Share of the smallest extent: edges of usual roundness stay below it."""

_ROUND = 48  # corners of the polygon that stands for a circle


@dataclass(frozen=True)
class PlainSolid:
    """A solid in place of a hull.

    Attributes:
        kind: the model that has this shape.
        shape: fields of that model.
        vertices: of it, in the hull's frame, shape (k, 3) [m].
        origin: middle of its base in the hull's frame, shape (2,) [m].
        yaw: turn of its axes against those of the hull's frame [rad].
        residual: by how much hull and solid stick out of each other at most [m].
    """

    kind: type[ObjectModel]
    shape: dict[str, Any]
    vertices: Array
    origin: Array = field(default_factory=lambda: np.zeros(2))
    yaw: float = 0.0
    residual: float = 0.0

    @property
    def extents(self) -> Array:
        """Its size along its own axes, shape (3,) [m]."""
        turned = self.vertices[:, :2] @ _turn(self.yaw)
        return np.append(np.ptp(turned, axis=0), np.ptp(self.vertices[:, 2]))

    def method_texts(self) -> tuple[str, ...]:
        """The finding in words, for a provenance; nothing of a hull."""
        if self.kind is HullModel:
            return ()
        kind = self.kind.model_fields["kind"].default
        apart = max(round(1e3 * self.residual, 2), 0.01)
        return (f"a {kind}, from which the hull of the mesh differs by {apart:g} mm at most",)

    def in_own_frame(self, point: Array) -> Array:
        """A point of the hull's frame in that of the solid, shape (3,) [m]."""
        return np.append((point[:2] - self.origin) @ _turn(self.yaw), point[2])


def plain_solid(vertices: Array) -> PlainSolid:
    """The plain solid that a hull is, or the hull itself.

    Args:
        vertices: of the hull, standing on z = 0, shape (k, 3) [m].
    """
    most = LARGEST_RESIDUAL * float(np.ptp(vertices, axis=0).min())
    for solid in _candidates(vertices, most):
        residual = max(_outside(vertices, solid.vertices), _outside(solid.vertices, vertices))
        if residual <= most:
            return replace(solid, residual=residual)
    return the_hull(vertices)


def the_hull(vertices: Array) -> PlainSolid:
    """The hull itself, of vertices, shape (k, 3) [m]."""
    return PlainSolid(HullModel, {"vertices": tuple(map(tuple, vertices.tolist()))}, vertices)


def _candidates(vertices: Array, most: float) -> Iterator[PlainSolid]:
    outline = hull_polygon(vertices[:, :2]).vertices
    height = float(vertices[:, 2].max())
    box = _box(outline, height)
    if round(min(box.shape["size"][:2]), 6) >= WIDE:
        yield box
    yield _cylinder(vertices, outline, height, most)
    # Of a prism; what has more is better told by its hull.
    if len(outline) <= 12 and _has_wide_sides(outline):
        outer = hull_polygon(outline)
        origin = outer.centroid if (outer.offsets <= 0.0).any() else np.zeros(2)
        shape = {"corners": (outline - origin).tolist(), "height": height}
        yield PlainSolid(PrismModel, shape, _ends(outline, 0.0, height), origin)


def _has_wide_sides(outline: Array) -> bool:
    """Check that edges as wide as a fingertip make up half of an outline or more."""
    lengths = np.linalg.norm(np.roll(outline, -1, axis=0) - outline, axis=1)
    return bool(lengths[lengths >= WIDE].sum() >= 0.5 * lengths.sum())


def _box(outline: Array, height: float) -> PlainSolid:
    """The smallest upright box around an outline; one of its sides lies along one of that."""
    edges = np.roll(outline, -1, axis=0) - outline
    quarter = np.pi / 2.0
    yaws = (np.arctan2(edges[:, 1], edges[:, 0]) + quarter / 2.0) % quarter - quarter / 2.0
    boxes = []
    for yaw in yaws.tolist():
        turned = outline @ _turn(yaw)
        low, high = turned.min(axis=0), turned.max(axis=0)
        boxes.append((float(np.prod(high - low)), yaw, low, high))
    _, yaw, low, high = min(boxes, key=lambda box: box[0])
    corners = np.array([low, [high[0], low[1]], high, [low[0], high[1]]]) @ _turn(yaw).T
    size = (*(high - low).tolist(), height)
    origin = (low + high) / 2.0 @ _turn(yaw).T
    return PlainSolid(BoxModel, {"size": size}, _ends(corners, 0.0, height), origin, yaw)


def _cylinder(vertices: Array, outline: Array, height: float, most: float) -> PlainSolid:
    """The upright cylinder through an outline; on a narrower foot if it stands on one."""
    # x² + y² = 2 x₀ x + 2 y₀ y + (r² − x₀² − y₀²), linear in what is looked for.
    design = np.column_stack((2.0 * outline, np.ones(len(outline))))
    (x, y, rest), *_ = np.linalg.lstsq(design, np.sum(outline**2, axis=1), rcond=None)
    radius = float(np.sqrt(rest + x * x + y * y))
    origin = np.array([x, y])
    phi = 2.0 * np.pi * np.arange(_ROUND) / _ROUND
    rim = origin + radius * np.column_stack((np.cos(phi), np.sin(phi)))
    shape: dict[str, Any] = {"radius": radius, "height": height}
    foot = np.hypot(*(hull_polygon(lowest_places(vertices)[1]).vertices - origin).T)
    begins = vertices[np.hypot(*(vertices[:, :2] - origin).T) >= radius - most, 2].min()
    # Share of the height below which a cylinder may be narrower.
    if np.ptp(foot) > most or foot.max() > radius - most or begins > 0.15 * height:
        return PlainSolid(CylinderModel, shape, _ends(rim, 0.0, height), origin)
    shape["base_radius"] = float(foot.max())
    base = origin + foot.max() / radius * (rim - origin)
    solid = np.concatenate((_ends(base, 0.0), _ends(rim, begins, height)))
    return PlainSolid(CylinderModel, shape, solid, origin)


def _ends(corners: Array, *heights: float) -> Array:
    """Vertices above corners (k, 2) at n heights, shape (n k, 3) [m]."""
    ends = [np.column_stack((corners, np.full(len(corners), z))) for z in heights]
    return np.concatenate(ends)


def _outside(solid: Array, points: Array) -> float:
    """Distance by which the furthest of points sticks out of a face of the hull of others [m]."""
    from scipy.spatial import ConvexHull  # takes a while to import

    planes = ConvexHull(solid).equations
    return float((points @ planes[:, :3].T + planes[:, 3]).max())


def _turn(yaw: float) -> Array:
    """Rotation by an angle: rows times it are in axes that are turned so, shape (2, 2)."""
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s], [s, c]])


UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254}
"""Lengths of the units that a mesh may be in [m]."""

AXES = {
    "+x": (1, 0, 0),
    "-x": (-1, 0, 0),
    "+y": (0, 1, 0),
    "-y": (0, -1, 0),
    "+z": (0, 0, 1),
    "-z": (0, 0, -1),
}
"""Directions in the mesh that may be upwards."""

FORMATS = ("stl", "obj", "ply", "off", "glb", "3mf")
"""Formats that are read, by the ending of a file's name."""

LARGEST, SMALLEST = 2.0, 0.005
"""Extents that an object on a table has [m]; others are a mistaken unit."""

FRICTION, FRICTION_SD = 0.35, 0.105
"""Friction at the table if nothing is stated: an estimate with a deviation of 30 %."""

FINGER, FINGER_SHARE_SD = 0.6, 0.2
"""Friction at the fingertip, which no file of a shape tells, and its deviation as a share of it."""

COM_SHARE_SD = 0.08
"""Standard deviation of a centre of mass at uniform density, as a share of the extents."""

_LARGEST_NUMBER = 1e9  # of an argument; formulae would overflow with some
_MOST_VERTICES = 400
_DIRECTIONS = 1000
_FLAT = 1e-6


@dataclass(frozen=True)
class Solid:
    """A mesh as it stands on the table.

    Attributes:
        vertices: of its convex hull in B, shape (k, 3) [m].
        com: centre of mass at uniform density in B, shape (3,) [m].
        volume: of the mesh if it is closed, else of its hull [m³].
        closed: whether the mesh encloses a volume.
        stood: how the base was found.
    """

    vertices: Array
    com: Array
    volume: float
    closed: bool
    stood: str

    def method_text(self) -> str:
        """Method by which shape and centre of mass were found."""
        hull_only = "" if self.closed else " of the convex hull"
        return (
            f"shape from a mesh, standing on {self.stood}; "
            f"centre of mass at uniform density{hull_only}"
        )


def read_mesh(path: Path, *, unit: str = "m", up: str = "+z") -> Solid:
    """Reads a mesh and stands it on the table.

    Args:
        path: a file in one of the `FORMATS`.
        unit: length unit of the file, one of `UNITS`.
        up: direction in the file that is upwards, one of `AXES`.

    Raises:
        ModelError: `missing_extra` without trimesh; `unreadable_file`; `bad_mesh` if nothing solid
            is in it, it is too large, or its size is that of a mistaken unit; `bad_value` for a
            unit or a direction that is none.
    """
    for value, known in ((unit, tuple(UNITS)), (up, tuple(AXES))):
        if value not in known:
            found = f"found {value!r}, expected one of: {', '.join(known)}"
            raise ModelError("bad_value", found, suggestions=(f"take {known[0]!r}",))
    mesh = _load_mesh(path)
    points = _usable_points(mesh, path) * UNITS[unit]
    extents = np.ptp(points, axis=0)
    if not (extents.max() <= LARGEST and extents.min() >= SMALLEST):
        size = " × ".join(f"{x:.4g}" for x in extents)
        what = f"is {size} m large, expected between {SMALLEST} m and {LARGEST} m"
        raise _mesh_error(path, what, "state its unit, e.g. --unit mm")
    try:
        return _standing_solid(mesh, _outermost(points), UNITS[unit], np.array(AXES[up], float))
    except ModelError as error:  # of its hull
        raise _mesh_error(path, error.message, "export it as a closed solid") from error


def _standing_solid(mesh: Any, points: Array, scale: float, up: Array) -> Solid:
    """The solid with those hull points (n, 3) [m], turned so that it stands on the table."""
    volume, com = volume_and_centre(points)
    closed = bool(mesh.is_watertight) and abs(float(mesh.volume)) > 0.0
    if closed:
        volume, com = abs(float(mesh.volume)) * scale**3, mesh.center_mass * scale
    # The file's upward direction becomes z first, then the face it stands on looks down.
    R = turning_down(-up)
    points, com = points @ R.T, R @ com
    normal, stood = standing_face(points, com)
    R = turning_down(normal)
    points, com = points @ R.T, R @ com
    low, on_table = lowest_places(points)
    origin = np.append(hull_polygon(on_table).centroid, low)
    vertices = np.round(thin_vertices(points - origin), 6)
    return Solid(vertices, com - origin, volume, closed, stood)


def mesh_points(path: Path) -> Array:
    """Points of the mesh in a file, as many as its hull needs, shape (k, 3), in its unit.

    Raises:
        ModelError: as `read_mesh`.
    """
    return _outermost(_usable_points(_load_mesh(path), path))


def _usable_points(mesh: Any, path: Path) -> Array:
    points = np.asarray(mesh.vertices, dtype=np.float64)
    if points.shape[1:] != (3,) or len(points) < 4 or not np.isfinite(points).all():
        raise _mesh_error(path, f"holds {len(points)} usable vertices", "export it once more")
    return points


def _load_mesh(path: Path) -> Any:
    """The one mesh of a file; what the file refers to outside of itself is not read."""
    try:
        import trimesh
    except ImportError as error:
        raise ModelError(
            "missing_extra",
            "reading meshes needs the package trimesh",
            suggestions=("in nlcontrol's checkout: pip install '.[mesh]'",),
        ) from error
    content = read_bytes(path, "mesh_file")
    ending = path.suffix.lower().removeprefix(".")
    readable = [name for name in FORMATS if name in trimesh.available_formats()]
    hint = f"these formats are read: {', '.join(readable).upper()}"
    if ending not in readable:
        raise ModelError(
            "unreadable_file",
            f"has the ending {ending!r}, which is not that of a mesh",
            path=str(path),
            suggestions=(hint,),
        )
    try:
        if ending == "3mf":  # packed
            with zipfile.ZipFile(io.BytesIO(content)) as parts:
                size = sum(part.file_size for part in parts.infolist())
            if size > LIMITS["mesh_file"].most:
                raise ValueError(f"{size} bytes when unpacked")
        mesh: Any = trimesh.load(io.BytesIO(content), ending, force="mesh", process=False)
        count = len(mesh.faces)
        if count <= LIMITS["mesh_triangles"].most:
            mesh.process()
    except Exception as error:  # readers of several formats fail in several ways
        raise ModelError(
            "unreadable_file",
            f"is no mesh in the format {ending.upper()}",
            path=str(path),
            suggestions=("its ending must be that of its format", hint),
        ) from error
    if count > LIMITS["mesh_triangles"].most:
        what = f"has {count} triangles, expected at most {LIMITS['mesh_triangles'].most}"
        raise _mesh_error(path, what, "reduce it in the program that it is from")
    return mesh


def _mesh_error(path: Path, what: str, hint: str) -> ModelError:
    return ModelError("bad_mesh", what, path=str(path), suggestions=(hint,))


def _outermost(points: Array) -> Array:
    """The points, or of very many those extreme in many directions, shape (k, 3)."""
    if len(points) <= 20_000:  # of more, those extreme in so many directions are looked at
        return points
    columns = np.ascontiguousarray(points.T)
    kept = [int(np.argmax(direction @ columns)) for direction in _directions(_DIRECTIONS)]
    return np.asarray(points[np.unique(kept)])


def _directions(count: int) -> Array:
    """Unit vectors spread evenly, by the golden angle, shape (count, 3)."""
    k = np.arange(count) + 0.5
    z, phi = 1.0 - 2.0 * k / count, np.pi * (1.0 + 5.0**0.5) * k
    r = np.sqrt(1.0 - z * z)
    return np.stack((r * np.cos(phi), r * np.sin(phi), z), axis=-1)


def standing_face(points: Array, com: Array) -> tuple[Array, str]:
    """Outward normal of the face that it stands on, and how that was found.

    Raises:
        ModelError: `bad_mesh` if there is none.
    """
    faces = [face for face in hull_facets(points) if _rests_on(face, com)]
    if not faces:
        raise ModelError(
            "bad_mesh",
            "has no flat face that it could stand on",
            suggestions=("cut the mesh flat where it stands on the table",),
        )
    down = max(faces, key=lambda face: -face[0][2])[0]
    # A face this near to looking down is what it stands on.
    if -down[2] >= np.cos(np.radians(10.0)):
        return down, "the face below"
    return faces[0][0], "its largest face; none looks down"


def _rests_on(face: tuple[Array, Array], com: Array) -> bool:
    """Return True if the centre of mass lies over a face, well inside."""
    normal, corners = face
    R = turning_down(normal)
    base = hull_polygon((corners @ R.T)[:, :2])
    return base.contains((R @ com)[None, :2], -0.02 * base.size)


def thin_vertices(points: Array) -> Array:
    """The vertices of the hull, or those extreme in many directions if they are very many."""
    from scipy.spatial import ConvexHull

    solid = points[ConvexHull(points).vertices]
    solid[np.abs(solid[:, 2]) < _FLAT * np.ptp(solid[:, 2]), 2] = 0.0
    if len(solid) <= _MOST_VERTICES:
        return np.asarray(solid)
    kept = set(np.argmax(solid @ _directions(_MOST_VERTICES // 2).T, axis=0).tolist())
    # What it stands on is kept with more care.
    (base,) = np.nonzero(solid[:, 2] == 0.0)
    turn = 4.0 * np.pi * np.arange(_MOST_VERTICES // 2) / _MOST_VERTICES
    around = np.argmax(solid[base, :2] @ np.stack((np.cos(turn), np.sin(turn))), axis=0)
    kept |= set(base[around].tolist())
    return np.asarray(solid[sorted(kept)])


def import_mesh(
    path: Path,
    *,
    name: str,
    mass: float | None = None,
    density: float | None = None,
    unit: str = "m",
    up: str = "+z",
    friction: float | None = None,
    synonyms: tuple[str, ...] = (),
    hull: bool = False,
) -> ObjectModel:
    """A model of the object that a mesh shows.

    Args:
        path: see `read_mesh`.
        unit: see `read_mesh`.
        up: see `read_mesh`.
        name: what it is to be called.
        mass: [kg], or
        density: its mean density [kg/m³].
        friction: coefficient at the table; an estimate if not given.
        synonyms: other names.
        hull: whether to keep the convex hull even if it nearly is a plain solid.

    Raises:
        ModelError: what `read_mesh` raises; `bad_value` unless just one of mass and density is
            given and positive, or if another argument is out of its range.
    """
    given = [value for value in (mass, density) if value is not None]
    if len(given) != 1 or not 0.0 < given[0] <= _LARGEST_NUMBER:
        raise ModelError(
            "bad_value",
            "state either the mass [kg] or the density [kg/m³], a positive number",
            suggestions=("a full carton has about 900 kg/m³",),
        )
    if friction is not None and not abs(friction) <= _LARGEST_NUMBER:
        hint = "leave it out if it is not known"
        raise ModelError("bad_value", "expected a number", path="friction", suggestions=(hint,))
    solid = read_mesh(path, unit=unit, up=up)
    shape = the_hull(solid.vertices) if hull else plain_solid(solid.vertices)
    heavy = mass if density is None else density * solid.volume
    assert heavy is not None
    mu = FRICTION if friction is None else friction
    how = "mass stated" if density is None else f"mass from {density:g} kg/m³"
    sure = "friction estimated (30 %)" if friction is None else "friction stated"
    fields: dict[str, Any] = {
        "name": name,
        "synonyms": synonyms,
        "mass": round(heavy, 6),
        "mass_sd": round((0.02 if density is None else 0.1) * heavy, 6),
        "friction": mu,
        "friction_sd": round(FRICTION_SD / FRICTION * mu, 6),
        "finger_friction": FINGER,
        "finger_friction_sd": FINGER_SHARE_SD * FINGER,
        "com": tuple(np.round(shape.in_own_frame(solid.com), 6).tolist()),
        "com_sd": tuple(np.round(COM_SHARE_SD * shape.extents, 6).tolist()),
        "provenance": Provenance(
            source=f"mesh {printable(path.name)}",
            method="; ".join((*shape.method_texts(), solid.method_text(), how, sure)),
        ),
    }
    try:
        rounded = {key: np.round(value, 6).tolist() for key, value in shape.shape.items()}
        return shape.kind(**fields, **rounded)
    except ValidationError as error:
        fault = first_fault(error, shape.kind)
        raise ModelError(
            fault.code, fault.message, path=fault.key, suggestions=fault.suggestions
        ) from error

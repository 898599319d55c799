"""From the file of another simulator to a model.

Model: what touches is one solid, or the convex hull of several. Small spheres below it are feet:
they alone touch the table, have its coefficient, and end where the table is; the solid then has the
finger's. Without feet the coefficient of the solid is taken for the table's.

Frame: B has the origin of the file's frame in prisms and hulls where that lies over the base, and
the middle of the base else.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from objectmodels.descriptions.description_reading import read_link
from objectmodels.descriptions.mesh_import import (
    COM_SHARE_SD,
    FINGER,
    FINGER_SHARE_SD,
    FRICTION,
    FRICTION_SD,
    LARGEST,
    SMALLEST,
    PlainSolid,
    mesh_points,
    plain_solid,
    standing_face,
    thin_vertices,
)
from objectmodels.descriptions.rigid_body import LinkDescription, LinkShape, unsupported_shape
from objectmodels.errors import ModelError, printable
from objectmodels.files.yaml_documents import LIMITS, first_fault
from objectmodels.geometry.base_shapes import (
    Array,
    Base,
    Disc,
    Support,
    hull_polygon,
    support_points,
)
from objectmodels.geometry.solids import lowest_places, turning_down, volume_and_centre
from objectmodels.models.kinds import BoxModel, CylinderModel
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.parameters import Provenance

FOOT = 0.005
"""Largest radius of a sphere that counts as a foot, and of the gap above the table [m]."""

STATED_SD = 0.02
"""Standard deviation of a mass that is stated, as a share of it, and of a centre of mass in that of
the extents."""

_SAME = 1e-9  # relative difference of what counts as equal
_FLAT = 1e-6  # share of the size within which points lie in a plane, or at a place
_ROUND = 48  # corners of the polygon that stands for a circle


@dataclass(frozen=True)
class _Standing:
    """A link as it stands on the table.

    Attributes:
        solid: its shape.
        turn: orientation of L on the table, shape (3, 3): the face below lies flat.
        origin: of the frame of the solid in L, turned so, shape (3,) [m].
        feet: places of its feet in L, shape (k, 3) [m]; none of them if it stands on its base.
        weights: their stiffnesses, shape (k,).
        friction: at the table, and at the finger; None where it is not stated.
    """

    solid: PlainSolid
    turn: Array
    origin: Array
    feet: Array
    weights: Array
    friction: tuple[float | None, float | None]


def import_description(
    path: Path,
    *,
    name: str | None = None,
    mass: float | None = None,
    friction: float | None = None,
    synonyms: tuple[str, ...] = (),
) -> ObjectModel:
    """A model of the object that a file of URDF, SDF or MJCF describes.

    Args:
        path: of the file.
        name: what it is to be called; the file's name for it if not given.
        mass: [kg], instead of the file's.
        friction: coefficient at the table, instead of the file's.
        synonyms: other names.

    Raises:
        ModelError: what `read_link` raises; `bad_description` without a mass, or if the size is
            that of a mistaken unit; `bad_mesh`, `missing_extra` of a mesh; what a model refuses.
    """
    link = read_link(path)
    heavy = link.mass if mass is None else mass
    if heavy is None:
        raise _error(path, "bad_description", "has no mass", "state it: --mass 0.4")
    for value, key in ((heavy, "mass"), (friction, "friction")):
        limit = LIMITS[key]
        if value is not None and not limit.least <= value <= limit.most:
            raise _error(path, "bad_value", f"found a {key} out of its range", "correct it")
    try:
        standing = _stand(link)
    except ModelError as error:
        raise _error(path, error.code, error.message, *error.suggestions) from error
    solid = standing.solid
    if not (solid.extents.max() <= LARGEST and solid.extents.min() >= SMALLEST):
        size = " × ".join(f"{x:.4g}" for x in solid.extents)
        hint = "its lengths are metres: give its mesh a scale"
        raise _error(path, "bad_description", f"is {size} m large", hint)
    fields = _beliefs(link, standing, mass, friction)
    fields |= {"name": name or link.name.replace("_", " ").strip() or path.stem, "mass": heavy}
    fields |= {"mass_sd": round(STATED_SD * heavy, 6), "synonyms": synonyms}
    source = f"description {printable(path.name)}"
    fields["provenance"] = Provenance(source=source, method=fields.pop("method"))
    try:
        model = solid.kind(**fields, **solid.shape)
        return solid.kind(**fields, **solid.shape, **_footing(model, standing))
    except ValidationError as error:
        fault = first_fault(error, solid.kind)
        what = f"{fault.key}: {fault.message}"
        raise _error(path, fault.code, what, *fault.suggestions) from error


def _beliefs(
    link: LinkDescription, standing: _Standing, mass: float | None, friction: float | None
) -> dict[str, Any]:
    """Fields of friction and of the centre of mass, and `method`, which says how all were found."""
    (table, finger), solid = standing.friction, standing.solid
    told = table if friction is None else friction
    mu = FRICTION if told is None else told
    com_share = COM_SHARE_SD if link.com is None else STATED_SD
    methods = (
        *(solid.method_texts() if solid.residual else ()),
        f"mass {'of the file' if mass is None else 'stated'}",
        f"centre of mass {'at mid-volume' if link.com is None else 'of the file'}",
        f"friction {'estimated (30 %)' if told is None else 'stated'}",
    )
    fields: dict[str, Any] = {
        "friction": mu,
        "friction_sd": round(FRICTION_SD / FRICTION * mu, 6),
        "finger_friction": FINGER if finger is None else finger,
        "finger_friction_sd": round(FINGER_SHARE_SD * (finger or FINGER), 6),
        "com_sd": np.round(com_share * solid.extents, 6).tolist(),
        "method": "; ".join(methods),
    }
    if link.com is not None:
        com = standing.turn @ link.com - standing.origin
        fields["com"] = solid.in_own_frame(com).tolist()
    return fields


def _error(path: Path, code: str, message: str, *hints: str) -> ModelError:
    return ModelError(code, message, path=str(path), suggestions=hints)


def _stand(link: LinkDescription) -> _Standing:
    """The link on a table below it."""
    feet = [s for s in link.shapes if s.kind == "sphere" and s.size[0] <= FOOT]
    solids = [shape for shape in link.shapes if shape not in feet]
    if not solids or any(shape.kind == "sphere" for shape in solids):
        raise unsupported_shape("sphere")
    points, turn = np.concatenate([_vertices(shape) for shape in solids]), np.eye(3)
    low = min((float(foot.p[2] - foot.size[0]) for foot in feet), default=np.inf)
    if len(feet) < 3 or not 0.0 <= points[:, 2].min() - low <= FOOT:
        feet = []
        com = volume_and_centre(points)[1] if link.com is None else link.com
        turn = turning_down(standing_face(points, com)[0])
        points = points @ turn.T
        low = float(points[:, 2].min())
    base = hull_polygon(lowest_places(points)[1])
    inside = base.contains(np.zeros((1, 2)), -_FLAT * base.size)
    origin = np.append(np.zeros(2) if inside else base.centroid, low)
    points = points - origin
    # With feet the solid ends above the table.
    points[points[:, 2] <= points[:, 2].min() + _FLAT * np.ptp(points[:, 2]), 2] = 0.0
    stated = [shape.friction for shape in solids if shape.friction is not None]
    mu = stated[0] if stated else None
    return _Standing(
        solid=_exact_solid(solids, turn, origin, points) or plain_solid(thin_vertices(points)),
        turn=turn,
        origin=origin,
        feet=np.array([foot.p - origin for foot in feet]).reshape(-1, 3),
        weights=np.array([foot.stiffness for foot in feet]),
        friction=(feet[0].friction, mu) if feet else (mu, None),
    )


def _vertices(shape: LinkShape) -> Array:
    """Points of a shape in L whose hull it is, or nearly, shape (k, 3) [m]."""
    if shape.kind == "box":
        corners = np.array(np.meshgrid(*3 * [[-0.5, 0.5]])).reshape(3, -1).T * shape.size
    elif shape.kind == "cylinder":
        phi = 2.0 * np.pi * np.arange(_ROUND) / _ROUND
        rim = shape.size[0] * np.column_stack((np.cos(phi), np.sin(phi)))
        ends = [np.column_stack((rim, np.full(_ROUND, z))) for z in (-0.5, 0.5)]
        corners = np.concatenate(ends) * [1.0, 1.0, shape.size[1]]
    else:
        found = mesh_points(shape.mesh) if shape.vertices is None and shape.mesh else shape.vertices
        assert found is not None
        corners = found * shape.size
    return np.asarray(corners @ shape.R.T + shape.p)


def _exact_solid(
    solids: list[LinkShape], turn: Array, origin: Array, points: Array
) -> PlainSolid | None:
    """The one upright box or cylinder, to the digit."""
    shape, height = solids[0], round(float(points[:, 2].max()), 12)
    R, middle = turn @ shape.R, (turn @ shape.p - origin)[:2]
    if len(solids) > 1 or abs(abs(R[2, 2]) - 1.0) > _SAME:
        return None
    if shape.kind == "cylinder":
        upright = {"radius": float(shape.size[0]), "height": height}
        return PlainSolid(CylinderModel, upright, points, middle)
    if shape.kind != "box":
        return None
    size = {"size": (*shape.size[:2].tolist(), height)}
    return PlainSolid(BoxModel, size, points, middle, float(np.arctan2(R[1, 0], R[0, 0])))


def _footing(model: ObjectModel, standing: _Standing) -> dict[str, Any]:
    """Fields that say on what a model stands, if it has feet."""
    if not len(standing.feet):
        return {}
    feet = np.array([standing.solid.in_own_frame(foot)[:2] for foot in standing.feet])
    fields: dict[str, Any] = {}
    base = model.footprint
    widest = float(np.hypot(*feet.T).max())
    if base.is_round and widest < (1.0 - _SAME) * base.size:
        base = Disc(widest)
        fields["base_radius"] = base.radius
    weights = standing.weights / standing.weights.max()
    points = np.column_stack((feet, weights)).tolist()
    names: tuple[Support, ...] = ("corners", "uniform")
    named = (name for name in names if _is_support(name, base, feet, weights))
    return fields | {"support": next(named, tuple(map(tuple, points)))}


def _is_support(support: Support, base: Base, feet: Array, weights: Array) -> bool:
    """Check that feet of some weights, (k, 2) and (k,), are those of a support by its name."""
    points, shares = support_points(support, base)
    if len(points) != len(feet):
        return False
    apart = np.linalg.norm(points[:, None] - feet, axis=2)
    which = apart.argmin(axis=1)
    near = apart.min(axis=1) <= _FLAT * base.size
    return bool(near.all() and np.allclose(shares, weights[which] / weights.sum(), rtol=_FLAT))

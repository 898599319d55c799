"""A model as a rigid body on feet, which is what files of simulators describe.

The feet are small spheres whose lowest points are the support points of the model; they alone touch
the table, with the table's coefficient and with stiffnesses in the ratio of the support's weights,
so that loads follow the centre of pressure as they do in the exact tier. The solids above them have
the finger's coefficient and end a little above the table: one, or the floor and walls of an open
box.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.support_points import support_points
from objectmodels.mechanics.push_thresholds import GRAVITY
from objectmodels.models.convex_hull import HullModel
from objectmodels.models.open_box import open_box_parts
from objectmodels.models.upright_solids import BoxModel, CylinderModel

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel

FOOT = 0.0005
"""Radius of a foot [m]: small beside any base, so that it topples where the model does."""

GAP = 0.001
"""Height of the solid's lower end above the table, which only the feet touch [m]."""

SINKS = 1e-6
"""Depth to which the feet sink in under the weight [m]: slender objects rock on softer ones."""

RELAXATION = 0.002
"""Time in which Drake's contacts lose their energy [s]; with more, sliding lifts a body."""

_NO_NAME = re.compile(r"\W+")


Shape = Literal["box", "cylinder", "hull"]


@dataclass(frozen=True)
class Solid:
    """A convex part that a finger touches, in B.

    Attributes:
        name: among the parts of a body.
        shape: of it.
        vertices: its corners, or those of what encloses it, shape (n, 3) [m].
    """

    name: str
    shape: Shape
    vertices: Array

    @property
    def size(self) -> Array:
        """Extents, shape (3,) [m]."""
        return np.asarray(np.ptp(self.vertices, axis=0))

    @property
    def middle(self) -> Array:
        """Middle of its extents, shape (3,) [m]."""
        return np.asarray((self.vertices.min(axis=0) + self.vertices.max(axis=0)) / 2.0)


@dataclass(frozen=True)
class RigidBody:
    """A rigid body on feet, in B: origin in the middle of the base, z up.

    Attributes:
        name: of letters, digits and underscores.
        mass: [kg].
        com: centre of mass, shape (3,) [m].
        inertia: moments about axes x, y, z through the centre of mass, shape (3,) [kg m²].
        feet: centres of the feet, shape (k, 3) [m].
        weights: shares of the feet in the stiffness, shape (k,).
        friction: static coefficient at the table.
        finger_friction: static coefficient at the solids.
        solids: of which it consists; a hull is the only one.
    """

    name: str
    mass: float
    com: Array
    inertia: Array
    feet: Array
    weights: Array
    friction: float
    finger_friction: float
    solids: tuple[Solid, ...]

    @property
    def stiffness(self) -> float:
        """Stiffness of all feet together [N/m]."""
        return self.mass * GRAVITY / SINKS


def numbers_text(values: Array) -> str:
    """Numbers with fifteen digits, as attributes of these files have them."""
    return " ".join(f"{value:.15g}" for value in values.tolist())


def rigid_body(model: ObjectModel) -> RigidBody:
    """The rigid body that a model describes; standard deviations are left behind."""
    points, weights = support_points(model.support, model.footprint)
    return RigidBody(
        name=_NO_NAME.sub("_", model.name).strip("_") or "object",
        mass=model.mass,
        com=np.array(model.com),
        inertia=model.mass * np.array(model.gyration),
        feet=np.column_stack((points, np.full(len(points), FOOT))),
        weights=weights,
        friction=model.friction,
        finger_friction=model.finger_friction,
        solids=tuple(_solids(model)),
    )


def _solids(model: ObjectModel) -> Iterator[Solid]:
    """Solids that a finger touches; each ends at least so much above the table as `GAP` says."""
    outline, shape = model.outline, _shape(model)
    if isinstance(model, HullModel):
        vertices = np.array(model.vertices)
    elif isinstance(model, BoxModel) and model.inside is not None:
        for k, (low, high) in enumerate(open_box_parts(model.extents, model.inside)):
            yield Solid(f"part_{k}", "box", _raised(np.array([low, high])))
        return
    else:
        if isinstance(model, CylinderModel):
            r = model.radius
            outline = np.array([[-r, -r], [r, -r], [r, r], [-r, r]])
        ends = [np.column_stack((outline, np.full(len(outline), z))) for z in (0.0, model.top)]
        vertices = np.vstack(ends)
    yield Solid("solid", shape, _raised(vertices))


def _shape(model: ObjectModel) -> Shape:
    if isinstance(model, BoxModel):
        return "box"
    return "cylinder" if isinstance(model, CylinderModel) else "hull"


def _raised(vertices: Array) -> Array:
    """Corners, shape (n, 3) [m], none of which is lower than the gap above the table."""
    return np.column_stack((vertices[:, :2], np.maximum(vertices[:, 2], GAP)))

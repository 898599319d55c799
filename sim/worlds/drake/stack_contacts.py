"""Contacts of objects that stand on one another.

Model: two flat faces press on each other wherever they overlap, and Drake's point contact has one
point of two solids only. So each object has a slab besides, its solid a little drawn in at the
sides, which meets nothing but other slabs, in Drake's compliant hydroelastic contact. It stands out
at top and bottom, so that solids which are stacked do not meet. That of an open box is its floor.
Things that stand side by side touch with their solids, as if there were no slabs.

Drake combines the friction coefficients a and b of two slabs as 2ab/(a+b).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from objectmodels.models.object_parts import inner_floor
from sim.cell.strict_model import Point3
from sim.truth.object_truth import Truth

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from pydrake.geometry import GeometryId, SceneGraph
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import RigidBody

STANDS_OUT = 5e-5
"""How far a slab stands out at top and bottom [m]."""

_DRAWN_IN = 5e-4  # at the sides, more than solids ever overlap there [m]
_STIFFNESS = 5e12  # so that what presses on an edge leans by less than a tenth of a degree [Pa/m]
_DISSIPATION = 2e3  # a box that rocks by a degree stands still after half a second [s/m]


def add_slab(plant: MultibodyPlant, truth: Truth, body: RigidBody) -> GeometryId:
    """Adds the slab of an object to its body."""
    from pydrake.geometry import (
        AddCompliantHydroelasticProperties,
        AddContactMaterial,
        Convex,
        ProximityProperties,
    )
    from pydrake.math import RigidTransform
    from pydrake.multibody.plant import CoulombFriction

    corners = np.array([*hull_points(truth)])
    middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    off = corners - middle
    around = np.hypot(*off[:, :2].T)
    off[:, :2] *= np.maximum(0.0, 1.0 - _DRAWN_IN / np.maximum(around, _DRAWN_IN))[:, None]
    off[:, 2] += np.sign(off[:, 2]) * STANDS_OUT
    slab = Convex((middle + off).T, "slab")
    properties = ProximityProperties()
    friction = CoulombFriction(truth.friction_table, truth.friction_table)
    AddContactMaterial(dissipation=_DISSIPATION, friction=friction, properties=properties)
    # The pressure grows from the faces to the middle of the slab.
    AddCompliantHydroelasticProperties(1.0, 0.5 * _STIFFNESS * np.ptp(corners[:, 2]), properties)
    return plant.RegisterCollisionGeometry(body, RigidTransform(), slab, "slab", properties)


def hull_points(truth: Truth) -> Iterator[Point3]:
    """Corners in B of the hull of what it stands on, and of what others stand on [m]."""
    yield from ((x, y, 0.0) for x, y in truth.support)
    if truth.inside is not None:
        floor = inner_floor(truth.inside)
        yield from ((x, y, truth.inside.floor) for x, y in floor.vertices.tolist())
        return
    yield from truth.vertices_m or ((x, y, truth.height) for x, y in truth.upper_points)


def filter_slabs(
    scene_graph: SceneGraph, slabs: Iterable[GeometryId], others: Iterable[GeometryId]
) -> None:
    """Slabs meet none of the others."""
    from pydrake.geometry import CollisionFilterDeclaration, GeometrySet

    pairs = CollisionFilterDeclaration()
    pairs.ExcludeBetween(GeometrySet(list(slabs)), GeometrySet(list(others)))
    scene_graph.collision_filter_manager().Apply(pairs)

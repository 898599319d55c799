"""The edge of the table: what hangs over it is carried by what lies on it, and tips over it.

Model: feet carry an object at single points, which do not tell where the table ends between them.
So the table has a rigid rim along each edge, level with its top, and each object a sole of its own
shape, which meets nothing but rims, in Drake's hydroelastic contact. Away from the edges nothing
changes; over an edge an object stands on its feet that the table has below them, and on the rim.

Friction is that of the feet, as on the table (`sim.worlds.drake.body_contacts`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sim.cell.cell_description import Table
from sim.truth.object_truth import Truth
from sim.worlds.drake.body_contacts import ROUGH
from sim.worlds.drake.stack_contacts import hull_points

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pydrake.geometry import GeometryId, SceneGraph
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import RigidBody

RIM = 0.02
"""Width of a rim [m]."""

_STIFFNESS = (
    5e9  # so that what nearly falls leans by less than 0.1°, and what slides on slides [Pa/m]
)
_DISSIPATION = 200.0  # more holds fast what slides onto the rim [s/m]


def add_rims(plant: MultibodyPlant, table: Table) -> list[GeometryId]:
    """Adds a rim along each edge of the table, fixed to the world."""
    from pydrake.geometry import (
        AddContactMaterial,
        AddRigidHydroelasticProperties,
        Box,
        ProximityProperties,
    )
    from pydrake.math import RigidTransform
    from pydrake.multibody.plant import CoulombFriction

    (x, y), (width, depth), thick = table.centre_m, table.size_m, table.thickness_m
    properties = ProximityProperties()
    friction = CoulombFriction(ROUGH, ROUGH)
    AddContactMaterial(dissipation=_DISSIPATION, friction=friction, properties=properties)
    AddRigidHydroelasticProperties(1.0, properties)
    along_x, along_y = 0.5 * (width - RIM), 0.5 * (depth - RIM)
    strips = [
        ((x + along_x, y), (RIM, depth)),
        ((x - along_x, y), (RIM, depth)),
        ((x, y + along_y), (width, RIM)),
        ((x, y - along_y), (width, RIM)),
    ]
    return [
        plant.RegisterCollisionGeometry(
            plant.world_body(), RigidTransform(np.array([*middle, -0.5 * thick])),
            Box(*size, thick), f"rim_{k}", properties,
        )
        for k, (middle, size) in enumerate(strips)
    ]  # fmt: skip


def add_sole(plant: MultibodyPlant, truth: Truth, body: RigidBody) -> GeometryId:
    """Adds the sole of an object to its body."""
    from pydrake.geometry import (
        AddCompliantHydroelasticProperties,
        AddContactMaterial,
        Convex,
        ProximityProperties,
    )
    from pydrake.math import RigidTransform
    from pydrake.multibody.plant import CoulombFriction

    corners = np.array([*hull_points(truth)])
    properties = ProximityProperties()
    friction = CoulombFriction(truth.friction_table / 2, truth.friction_table / 2)
    AddContactMaterial(dissipation=_DISSIPATION, friction=friction, properties=properties)
    AddCompliantHydroelasticProperties(1.0, 0.5 * _STIFFNESS * np.ptp(corners[:, 2]), properties)
    sole = Convex(corners.T, "sole")
    return plant.RegisterCollisionGeometry(body, RigidTransform(), sole, "sole", properties)


def filter_rims(
    scene_graph: SceneGraph,
    rims: Iterable[GeometryId],
    soles: Iterable[GeometryId],
    others: Iterable[GeometryId],
) -> None:
    """Rims and soles meet each other alone."""
    from pydrake.geometry import CollisionFilterDeclaration, GeometrySet

    pairs = CollisionFilterDeclaration()
    rim_set, sole_set, rest = (GeometrySet(list(each)) for each in (rims, soles, others))
    pairs.ExcludeBetween(rim_set, rest)
    pairs.ExcludeBetween(sole_set, rest)
    pairs.ExcludeWithin(sole_set)
    scene_graph.collision_filter_manager().Apply(pairs)

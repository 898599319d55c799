"""Face of an object on which another one may stand: its top, or the floor of an open box."""

from __future__ import annotations

import numpy as np

from objectmodels.geometry.base_shapes import Polygon
from objectmodels.geometry.support_points import hull_polygon
from objectmodels.models.convex_hull import HullModel
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.open_box import inner_floor

_LEVEL = 1e-4  # heights of a hull's corners that differ by less are one [m]


def top_face(model: ObjectModel) -> Polygon | None:
    """The level face on top of an object in its frame; None if its top is round or an edge.

    That of a container of liquids is the face within its rim, as if it were closed.
    """
    if not isinstance(model, HullModel):
        return Polygon.convex(model.section.corners)
    vertices = np.array(model.vertices)
    highest = vertices[vertices[:, 2] > model.top - _LEVEL, :2]
    return hull_polygon(highest) if len(highest) > 2 else None


def standing_face(model: ObjectModel) -> Polygon | None:
    """The face on which others stand in its frame: the inner floor of an open box, or its top."""
    return top_face(model) if model.inside is None else inner_floor(model.inside)


def standing_height(model: ObjectModel) -> float:
    """Height of that face over its base [m]."""
    return model.top if model.inside is None else model.inside.floor

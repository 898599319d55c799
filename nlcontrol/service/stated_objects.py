"""Objects that a caller states, checked and put on the table of a cell."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import TYPE_CHECKING

from nlcontrol.errors import ControlError, ErrorInfo
from objectmodels import ModelError, Registry
from planner.problem.footprints import footprint, gap, room_to_edge
from planner.types.world_state import PlanarPose, SeenObject
from sim.robots.cell_description import CellDescription, CellObject
from sim.stated_table import StatedTable

if TYPE_CHECKING:
    from nlcontrol.service.documents import StatedObject

SEEN_OVERLAP = 0.005
"""Overlap of two objects that a camera's errors explain [m]."""


def stated_table(
    cell: CellDescription, objects: Sequence[StatedObject], registry: Registry
) -> StatedTable:
    """The table of a cell, with nothing on it but what is stated.

    Raises:
        ControlError: `bad_table`, with the place in the document.
    """
    taken: dict[str, int] = {}
    for index, item in enumerate(objects):
        first = taken.setdefault(item.name.casefold(), index)
        if first != index:
            raise _bad_table(
                f"objects[{index}].name",
                f"'{item.name}' is the name of objects[{first}] too",
                "give each object a name of its own, as 'left mug', and its `model`",
            )
    seen = [_seen(index, item, cell, registry) for index, item in enumerate(objects)]
    for (i, one), (k, other) in combinations(enumerate(seen), 2):
        apart = gap(footprint(one), footprint(other))
        if apart < -SEEN_OVERLAP:
            raise _bad_table(
                f"objects[{k}]",
                f"it stands {-1e3 * apart:.0f} mm deep in objects[{i}], the {one.name}",
                "poses are those of the middles of their bases, in metres and radians",
                numbers={"overlap": -apart},
            )
    standing = tuple(
        CellObject(
            name=item.name,
            model=item.model or item.name,
            synonyms=item.synonyms,
            fragile=item.fragile,
            fixed=item.fixed,
        )
        for item in objects
    )
    poses = {item.name: item.pose for item in seen}
    return StatedTable(cell.model_copy(update={"objects": standing}), poses)


def _seen(index: int, item: StatedObject, cell: CellDescription, registry: Registry) -> SeenObject:
    """An object as it is stated, on the table."""
    try:
        model = registry.get(item.model or item.name)
    except ModelError as raised:
        key = "name" if item.model is None else "model"
        hints = (*raised.suggestions, "`nlcontrol objects list` tells the models")
        raise _bad_table(f"objects[{index}].{key}", raised.message, *hints) from raised
    seen = SeenObject(item.name, PlanarPose(item.x, item.y, item.yaw), model)
    table = cell.table.extent
    beyond = -room_to_edge(footprint(seen), table)
    if beyond > 0.0:
        raise _bad_table(
            f"objects[{index}]",
            f"the {item.name} stands {1e3 * beyond:.0f} mm beyond the edge of the table",
            f"x is from {table.x_min:g} to {table.x_max:g} m, y from {table.y_min:g} to "
            f"{table.y_max:g} m, in W",
            numbers={"beyond": beyond},
        )
    return seen


def _bad_table(
    path: str, message: str, *suggestions: str, numbers: dict[str, float] | None = None
) -> ControlError:
    return ControlError(
        ErrorInfo(
            code="bad_table",
            message=message,
            suggestions=suggestions,
            numbers=numbers or {},
            path=path,
        )
    )

"""Beliefs at the beginning: the registry's model of every object of a cell."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nlcontrol.errors import error
from objectmodels import ModelError, ObjectModel, Registry

if TYPE_CHECKING:
    from sim.robots.cell_description import CellDescription, CellObject


def initial_models(cell: CellDescription, registry: Registry) -> dict[str, ObjectModel]:
    """The models of a cell's objects, by the names of the objects.

    Raises:
        ControlError: `scene_and_registry_differ`.
    """
    return {item.name: _initial_model(item, registry) for item in cell.objects}


def _initial_model(item: CellObject, registry: Registry) -> ObjectModel:
    try:
        return registry.get(item.model)
    except ModelError as raised:
        message = f"the scene's '{item.name}' is a '{item.model}', but {raised.message}"
        raise error(
            "scene_and_registry_differ", message, suggestions=raised.suggestions
        ) from raised

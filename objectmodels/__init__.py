"""Mechanical models of pushed objects, and the registry that serves them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from objectmodels.lazy import lazy_names

if TYPE_CHECKING:
    from objectmodels.errors import ModelError as ModelError
    from objectmodels.errors import suggest as suggest
    from objectmodels.geometry.base_shapes import Base as Base
    from objectmodels.geometry.base_shapes import Disc as Disc
    from objectmodels.geometry.base_shapes import Polygon as Polygon
    from objectmodels.geometry.side_faces import Face as Face
    from objectmodels.geometry.side_faces import sides as sides
    from objectmodels.mechanics.friction_cone import ConeThresholds as ConeThresholds
    from objectmodels.mechanics.push_outcomes import Prediction as Prediction
    from objectmodels.mechanics.push_outcomes import Thresholds as Thresholds
    from objectmodels.models.kinds import BoxModel as BoxModel
    from objectmodels.models.kinds import CylinderModel as CylinderModel
    from objectmodels.models.kinds import HullModel as HullModel
    from objectmodels.models.kinds import PrismModel as PrismModel
    from objectmodels.models.object_model import ObjectModel as ObjectModel
    from objectmodels.models.parameters import Provenance as Provenance
    from objectmodels.registry.model_registry import Registry as Registry

_HOMES = {
    "errors": ["ModelError", "suggest"],
    "geometry.base_shapes": ["Base", "Disc", "Polygon"],
    "geometry.side_faces": ["Face", "sides"],
    "mechanics.friction_cone": ["ConeThresholds"],
    "mechanics.push_outcomes": ["Prediction", "Thresholds"],
    "models.kinds": ["HullModel", "BoxModel", "CylinderModel", "PrismModel"],
    "models.object_model": ["ObjectModel"],
    "models.parameters": ["Provenance"],
    "registry.model_registry": ["Registry"],
}

__all__ = [name for names in _HOMES.values() for name in names]
__getattr__ = lazy_names(__name__, _HOMES)

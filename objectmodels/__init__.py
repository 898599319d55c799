"""Mechanical models of pushed objects, and the registry that serves them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from objectmodels.lazy_names import lazy_names

if TYPE_CHECKING:
    from objectmodels.errors import ModelError, suggest
    from objectmodels.geometry.base_shapes import Base, Disc, Polygon
    from objectmodels.geometry.side_faces import Face, sides
    from objectmodels.mechanics.friction_cone import ConeThresholds
    from objectmodels.mechanics.push_outcomes import Prediction, Thresholds
    from objectmodels.models.convex_hull import HullModel
    from objectmodels.models.object_model import ObjectModel
    from objectmodels.models.parameters import Provenance
    from objectmodels.models.upright_solids import BoxModel, CylinderModel, PrismModel
    from objectmodels.registry.model_registry import Registry

__all__ = [
    "Base",
    "BoxModel",
    "ConeThresholds",
    "CylinderModel",
    "Disc",
    "Face",
    "HullModel",
    "ModelError",
    "ObjectModel",
    "Polygon",
    "Prediction",
    "PrismModel",
    "Provenance",
    "Registry",
    "Thresholds",
    "sides",
    "suggest",
]

_HOMES = {
    "Base": "objectmodels.geometry.base_shapes",
    "BoxModel": "objectmodels.models.upright_solids",
    "ConeThresholds": "objectmodels.mechanics.friction_cone",
    "CylinderModel": "objectmodels.models.upright_solids",
    "Disc": "objectmodels.geometry.base_shapes",
    "Face": "objectmodels.geometry.side_faces",
    "HullModel": "objectmodels.models.convex_hull",
    "ModelError": "objectmodels.errors",
    "ObjectModel": "objectmodels.models.object_model",
    "Polygon": "objectmodels.geometry.base_shapes",
    "Prediction": "objectmodels.mechanics.push_outcomes",
    "PrismModel": "objectmodels.models.upright_solids",
    "Provenance": "objectmodels.models.parameters",
    "Registry": "objectmodels.registry.model_registry",
    "Thresholds": "objectmodels.mechanics.push_outcomes",
    "sides": "objectmodels.geometry.side_faces",
    "suggest": "objectmodels.errors",
}

__getattr__ = lazy_names(__name__, _HOMES)

"""Mechanical models of pushed objects, and the registry that serves them."""

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Base, Disc, Polygon
from objectmodels.geometry.side_faces import Face, sides
from objectmodels.mechanics.friction_cone import ConeThresholds
from objectmodels.mechanics.push_outcomes import Prediction, Thresholds
from objectmodels.models.box import BoxModel
from objectmodels.models.convex_hull import HullModel
from objectmodels.models.cylinder import CylinderModel
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.parameters import Provenance
from objectmodels.models.prism import PrismModel
from objectmodels.name_suggestions import suggest
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

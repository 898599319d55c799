"""Mechanical models of pushed objects, and the registry that serves them."""

from objectmodels.base import Base, Disc, Polygon
from objectmodels.box import BoxModel
from objectmodels.cone import ConeThresholds
from objectmodels.cylinder import CylinderModel
from objectmodels.errors import ModelError
from objectmodels.faces import Face, sides
from objectmodels.hull import HullModel
from objectmodels.model import ObjectModel
from objectmodels.parameters import Provenance
from objectmodels.prediction import Prediction, Thresholds
from objectmodels.prism import PrismModel
from objectmodels.registry import Registry
from objectmodels.suggest import suggest

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

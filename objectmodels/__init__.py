"""Mechanical models of pushed objects, and the registry that serves them."""

from objectmodels.box import BoxModel, Provenance
from objectmodels.cone import ConeThresholds
from objectmodels.errors import ModelError
from objectmodels.prediction import Face, Prediction, Thresholds
from objectmodels.registry import Registry
from objectmodels.suggest import suggest

__all__ = [
    "BoxModel",
    "ConeThresholds",
    "Face",
    "ModelError",
    "Prediction",
    "Provenance",
    "Registry",
    "Thresholds",
    "suggest",
]

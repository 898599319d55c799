"""Models of objects, and what they predict."""

from __future__ import annotations

from objectmodels.errors import ModelError as ModelError
from objectmodels.geometry.base_shapes import Base as Base
from objectmodels.geometry.base_shapes import Disc as Disc
from objectmodels.geometry.base_shapes import Polygon as Polygon
from objectmodels.geometry.pushed_body import PushedBody as PushedBody
from objectmodels.geometry.side_faces import Face as Face
from objectmodels.geometry.solids import ConvexHull as ConvexHull
from objectmodels.geometry.solids import Cuboid as Cuboid
from objectmodels.geometry.solids import Solid as Solid
from objectmodels.geometry.solids import UprightCylinder as UprightCylinder
from objectmodels.identification.joint_fit import Fit as Fit
from objectmodels.identification.least_squares import Solution as Solution
from objectmodels.identification.measurement_model import Linear as Linear
from objectmodels.identification.trial import Statistics as Statistics
from objectmodels.mechanics.friction_cone import ConeThresholds as ConeThresholds
from objectmodels.mechanics.outcome_map import MappedObject as MappedObject
from objectmodels.mechanics.outcome_map import OutcomeMap as OutcomeMap
from objectmodels.mechanics.outcome_probability import Likelihood as Likelihood
from objectmodels.mechanics.push_motion import Stroke as Stroke
from objectmodels.mechanics.push_outcomes import MarginSearch as MarginSearch
from objectmodels.mechanics.push_outcomes import Prediction as Prediction
from objectmodels.mechanics.push_outcomes import SuddenPush as SuddenPush
from objectmodels.mechanics.push_outcomes import Thresholds as Thresholds
from objectmodels.models.kinds import CylinderModel as CylinderModel
from objectmodels.models.kinds import HullModel as HullModel
from objectmodels.models.kinds import PrismModel as PrismModel
from objectmodels.models.object_model import Resting as Resting
from objectmodels.models.object_parts import Cavity as Cavity
from objectmodels.models.object_parts import Container as Container
from objectmodels.models.object_parts import FlipLid as FlipLid
from objectmodels.models.object_parts import Graspable as Graspable
from objectmodels.models.object_parts import LiftOffLid as LiftOffLid
from objectmodels.models.object_parts import Opening as Opening
from objectmodels.models.object_parts import ScrewCap as ScrewCap
from objectmodels.models.object_parts import TiltedStrips as TiltedStrips
from objectmodels.models.object_parts import Vessel as Vessel
from objectmodels.models.object_parts import VesselStrips as VesselStrips
from objectmodels.models.parameters import Provenance as Provenance
from objectmodels.models.predictor import SeenPushes as SeenPushes
from objectmodels.models.shapes import Box as Box
from objectmodels.models.shapes import Cylinder as Cylinder
from objectmodels.models.shapes import Hull as Hull
from objectmodels.models.shapes import Prism as Prism
from objectmodels.models.shapes import ShapeKeys as ShapeKeys

"""An object alone on a plane in Drake: discrete plant, SAP, point contact at its base corners.

SAP lifts a contact by μ × slip × (step + relaxation time), which moves load between corners that
slip at different speeds. Drake's relaxation time, 0.1 s unless stated, would make a slow slide look
like one in oil; it is set to zero, and corners sink in by more than that lift. Sinking in tilts a
slender object whose load nears an edge: of such prisms a few in a thousand move 2 to 5 % early, and
less the stiffer the contact.
"""

from __future__ import annotations

import numpy as np
from pydrake.geometry import AddContactMaterial, HalfSpace, ProximityProperties, Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    CoulombFriction,
    ExternallyAppliedSpatialForce,
    MultibodyPlant,
    MultibodyPlantConfig,
)
from pydrake.multibody.tree import RigidBody, SpatialInertia, UnitInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from benchmarks.pushes import SPHERE, STEP, Array
from objectmodels.models.object_model import ObjectModel

SINKS = 3e-6
"""Depth to which the corners sink in under the weight [m]; they are springs of one stiffness."""


class BodyInDrake:
    """A body of a plant that is complete; a `benchmarks.pushes.World`."""

    def __init__(self, builder: DiagramBuilder, plant: MultibodyPlant, body: RigidBody) -> None:
        plant.Finalize()
        self.plant, self.body = plant, body
        self.simulator = Simulator(builder.Build())
        self.context = plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        self.push = ExternallyAppliedSpatialForce()
        self.push.body_index = body.index()
        self.applied = plant.get_applied_spatial_force_input_port()
        self.steps = 0

    def step(self, point: Array, force: Array) -> tuple[Array, Array]:
        """See `benchmarks.pushes.World`."""
        self.push.p_BoBq_B = point
        self.push.F_Bq_W = SpatialForce(np.zeros(3), force)
        self.applied.FixValue(self.context, [self.push])
        self.steps += 1
        self.simulator.AdvanceTo(self.steps * STEP, interruptible=False)
        velocity = self.plant.EvalBodySpatialVelocityInWorld(self.context, self.body)
        return velocity.rotational(), velocity.translational()


class DrakeWorld(BodyInDrake):
    """An object on its base corners in Drake."""

    def __init__(self, model: ObjectModel) -> None:
        builder = DiagramBuilder()
        config = MultibodyPlantConfig(time_step=STEP, discrete_contact_approximation="sap")
        plant, _ = AddMultibodyPlant(config, builder)
        contact = _contact(model)
        com = np.array(model.com)
        inertia = UnitInertia(*model.gyration).ShiftFromCenterOfMass(com)
        body = plant.AddRigidBody("object", SpatialInertia(model.mass, com, inertia))
        for i, (x, y) in enumerate(model.footprint.corners):
            centre = RigidTransform(np.array([x, y, SPHERE]))
            plant.RegisterCollisionGeometry(body, centre, Sphere(SPHERE), f"corner{i}", contact)
        plant.RegisterCollisionGeometry(
            plant.world_body(), RigidTransform(), HalfSpace(), "table", contact
        )
        super().__init__(builder, plant, body)


def _contact(model: ObjectModel) -> ProximityProperties:
    """What both the corners and the table are made of."""
    properties = ProximityProperties()
    # Two in a row have half the stiffness of each, and the coefficient 2ab/(a + b).
    AddContactMaterial(
        point_stiffness=2.0 * model.weight / (len(model.footprint.corners) * SINKS),
        friction=CoulombFriction(model.friction, model.friction),
        properties=properties,
    )
    properties.AddProperty("material", "relaxation_time", 0.0)
    return properties

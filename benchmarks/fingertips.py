"""Fingertips of benchmarks that press on things in Drake: spheres on springs."""

from __future__ import annotations

from typing import Any

import numpy as np

from objectmodels.geometry.base_shapes import Array
from sim.robots.robots import HAND
from sim.worlds.drake.drake_bodies import ROUGH, surface

# On a light fingertip Drake's friction creeps by a tenth of the way.
_MASS = 1.0  # [kg]


class Fingertip:
    """A sphere that springs lead along some axes of W, and that a force presses down.

    Args:
        plant: to which it is added.
        name: of it.
        led: axes along which springs lead it; along the others it is free.
        stiffness: of the springs, critically damped [N/m].
    """

    def __init__(self, plant: Any, name: str, led: str = "xy", stiffness: float = 2e4) -> None:
        from pydrake.geometry import Sphere
        from pydrake.math import RigidTransform
        from pydrake.multibody.tree import (
            PdControllerGains,
            PrismaticJoint,
            SpatialInertia,
            UnitInertia,
        )

        self._plant, self._instance = plant, plant.AddModelInstance(name)
        self._axes = ["xyz".index(axis) for axis in led]
        share = SpatialInertia(_MASS / 3.0, np.zeros(3), UnitInertia.SolidSphere(HAND.tip_radius))
        gains = PdControllerGains(p=stiffness, d=2.0 * (stiffness * _MASS) ** 0.5)
        frame = plant.world_frame()
        for direction, axis in zip(np.eye(3), "xyz", strict=True):
            body = plant.AddRigidBody(f"{name} {axis}", self._instance, share)
            joint = plant.AddJoint(
                PrismaticJoint(f"{name} {axis}", frame, body.body_frame(), direction)
            )
            if axis in led:
                actuator = plant.AddJointActuator(f"{name} {axis}", joint, np.inf)
                actuator.set_controller_gains(gains)
            frame = body.body_frame()
        self._body = body
        self.solid = plant.RegisterCollisionGeometry(
            body, RigidTransform(), Sphere(HAND.tip_radius), name, surface(ROUGH)
        )
        plant.set_gravity_enabled(self._instance, False)

    def put(self, context: Any, place: Array) -> None:
        """Puts it somewhere at rest."""
        self._plant.SetPositions(context, self._instance, place)

    def command(self, context: Any, place: Array, velocity: Array) -> None:
        """Leads it to a place in W, shape (3,) [m], with a velocity."""
        if not self._axes:
            return
        port = self._plant.get_desired_state_input_port(self._instance)
        port.FixValue(context, np.concatenate([place[self._axes], velocity[self._axes]]))

    def pressing(self, force: float) -> Any:
        """A force on it, downwards [N], for the plant's port of applied forces."""
        from pydrake.multibody.math import SpatialForce
        from pydrake.multibody.plant import ExternallyAppliedSpatialForce

        push = ExternallyAppliedSpatialForce()
        push.body_index = self._body.index()
        push.F_Bq_W = SpatialForce(np.zeros(3), np.array([0.0, 0.0, -force]))
        return push

    def place(self, context: Any) -> Array:
        """Its centre in W, shape (3,) [m]."""
        return np.array(self._plant.GetPositions(context, self._instance))

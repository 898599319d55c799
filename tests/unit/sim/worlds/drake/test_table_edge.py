"""The table's edge in Drake: what hangs over it lies or falls as its margins say."""

from __future__ import annotations

import json

import numpy as np
import pytest

from objectmodels import BoxModel
from objectmodels.geometry.base_shapes import Array
from objectmodels.mechanics.standing_balance import TableEdge, edge_margins
from sim.robots.robots import HAND
from sim.truth.scene_file import Scene, parse_scene
from sim.worlds.drake.drake_plant import add_plant

GRAVITY = 9.81
SIZE, COM_X, FRICTION = (0.15, 0.22, 0.03), 0.012, 0.3
EDGE = 1.2  # of the standard table, along x [m]


def scene_with_plate(x: float, yaw: float = 0.0) -> Scene:
    """A plate whose centre of mass is off its middle."""
    truth = {
        "size_m": SIZE, "mass_kg": 0.6, "friction_table": FRICTION, "friction_finger": 0.6,
        "centre_of_mass_m": (COM_X, 0.0, 0.015),
    }  # fmt: skip
    plate = {"name": "plate", "model": "book", "truth": truth,
             "pose": {"x_m": x, "y_m": 0.1, "yaw_deg": yaw}}  # fmt: skip
    return parse_scene(json.dumps({"version": 1, "name": "edge", "objects": [plate]}))


def motion(scene: Scene, seconds: float, speed: float = 0.0) -> tuple[Array, float]:
    """Way [m] and tilt [rad] of the plate, if it is let go with a speed along x."""
    from pydrake.multibody.math import SpatialVelocity
    from pydrake.systems.analysis import Simulator
    from pydrake.systems.framework import DiagramBuilder

    builder = DiagramBuilder()
    model = add_plant(builder, scene)
    simulator = Simulator(builder.Build())
    plant, body = model.plant, model.bodies["plate"]
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    arm, fingers = np.radians(scene.robot.home_deg), HAND.resting.joint_angles
    for i, angle in enumerate(arm, start=1):
        plant.GetJointByName(f"arm_joint_{i}").set_angle(context, angle)
    for part, q in ((model.arm, arm), (model.hand, fingers)):
        port = plant.get_desired_state_input_port(part)
        port.FixValue(context, np.concatenate([q, np.zeros(len(q))]))
    plant.SetFreeBodySpatialVelocity(
        context, body, SpatialVelocity(np.zeros(3), np.array([speed, 0.0, 0.0]))
    )
    start = plant.EvalBodyPoseInWorld(context, body).translation()
    simulator.AdvanceTo(seconds)
    X_WB = plant.EvalBodyPoseInWorld(context, body)
    tilt = float(np.arccos(np.clip(X_WB.rotation().matrix()[2, 2], -1.0, 1.0)))
    return X_WB.translation() - start, tilt


@pytest.mark.parametrize("yaw", [0.0, 90.0, 30.0])
@pytest.mark.parametrize("spare", [0.003, -0.003])
def test_what_hangs_over_lies_while_its_mass_is_over_the_table(yaw: float, spare: float) -> None:
    model = BoxModel(name="plate", size=SIZE, mass=0.6, friction=FRICTION, finger_friction=0.6,
                     com=(COM_X, 0.0, 0.015))  # fmt: skip
    n = np.array([np.cos(np.radians(yaw)), -np.sin(np.radians(yaw))])  # of the edge, in B
    x = EDGE - float(n @ (COM_X, 0.0)) - spare
    assert edge_margins(model, TableEdge(n, EDGE - x))[-1] == pytest.approx(spare)
    moved, tilt = motion(scene_with_plate(x, yaw), 0.8)
    if spare > 0.0:
        # Rim and feet give way by micrometres.
        assert tilt < 1.7e-3
        assert np.abs(moved).max() < 1e-4
    else:
        # A plate that begins to fall from 3 mm takes 0.4 s for the first ten degrees.
        assert tilt > 0.3
        assert moved[2] < -0.005


@pytest.mark.parametrize("left", [0.01, 0.06])
def test_friction_at_the_edge_is_that_of_the_table(left: float) -> None:
    # It slides onto the rim, or over it until its mass is 1 cm from the edge.
    way = 0.05
    start = EDGE - COM_X - left - way
    moved, tilt = motion(scene_with_plate(start), 1.0, np.sqrt(2.0 * FRICTION * GRAVITY * way))
    # The time step takes a hundredth; what meets the rim fast is held by it for some steps more.
    assert moved[0] == pytest.approx(way, rel=0.06)
    assert tilt < 2e-3


def test_off_the_edge_nothing_is_touched() -> None:
    beyond = EDGE + 0.5 * SIZE[0] + 0.001
    moved, _ = motion(scene_with_plate(beyond), 0.3)
    assert moved[2] == pytest.approx(-0.5 * GRAVITY * 0.3**2, rel=0.02)

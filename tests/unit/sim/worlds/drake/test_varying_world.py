"""Friction that varies and contents that shift: measured by forces on a free box in Drake."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.random_streams import RandomStream, source
from sim.robots.robots import HAND
from sim.truth.scene_file import FrictionVariation, Scene, VaryingTable, parse_scene
from sim.worlds.drake.drake_plant import Plant, add_plant
from sim.worlds.drake.world_variation import FrictionField, ShiftingContents, VaryingFriction

GRAVITY = 9.81
PERIOD = 0.01
SIZE, MASS, FRICTION = (0.04, 0.04, 0.10), 0.2, 0.3
SCENE = """
version: 1
name: one
robot: {home_deg: [41.0, -95.0, 75.0, -87.0, 110.0, -90.0, 42.0]}
table: {friction_variation: {over_table: 0.18, length_m: 0.2, per_trial: 0.2}}
objects:
  - name: box
    model: coffee box
    pose: {x_m: 0.5, y_m: 0.0}
    truth: {size_m: [0.04, 0.04, 0.10], mass_kg: 0.2, friction_table: 0.3, friction_finger: 0.7,
            contents_shift_m: 0.004}
"""


@dataclass
class Free:
    """The scene's box with a force on it; the robot waits aside."""

    scene: Scene

    def __post_init__(self) -> None:
        from pydrake.systems.analysis import Simulator
        from pydrake.systems.framework import DiagramBuilder

        builder = DiagramBuilder()
        self.model: Plant = add_plant(builder, self.scene)
        self.simulator = Simulator(builder.Build())
        self.root = self.simulator.get_mutable_context()
        self.plant, self.body = self.model.plant, self.model.bodies["box"]
        self.context = self.plant.GetMyMutableContextFromRoot(self.root)
        arm = np.radians(self.scene.robot.home_deg)
        for i, angle in enumerate(arm, start=1):
            self.plant.GetJointByName(f"arm_joint_{i}").set_angle(self.context, angle)
        for finger, resting in HAND.resting.angles.items():
            angles = HAND.model_angles(resting)
            for name, angle in zip(HAND.model_joints(finger), angles, strict=True):
                self.plant.GetJointByName(name).set_angle(self.context, angle)
        for part, q in ((self.model.arm, arm), (self.model.hand, HAND.resting.joint_angles)):
            port = self.plant.get_desired_state_input_port(part)
            port.FixValue(self.context, np.concatenate([q, np.zeros(len(q))]))

    def put(self, x: float, y: float) -> dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]:
        """Stands the box at a place and returns its pose as a world tells it."""
        from pydrake.math import RigidTransform

        p_WB = np.array([x, y, 0.0])
        self.plant.SetFreeBodyPose(self.context, self.body, RigidTransform(p_WB))
        self.plant.SetVelocities(self.context, np.zeros(self.plant.num_velocities()))
        return {"box": (np.eye(3), p_WB)}

    def onset(self, height: float, expected: float) -> float:
        """The force along x at a height at which the box starts to move [N]."""
        self._push(0.0, height)
        self._advance(0.1)
        for force in np.arange(0.85, 1.15, 0.002) * expected:
            self._push(float(force), height)
            self._advance(PERIOD)
            motion = self.plant.EvalBodySpatialVelocityInWorld(self.context, self.body)
            if abs(motion.translational()[0]) > 2e-3 or abs(motion.rotational()[1]) > 0.02:
                return float(force)
        return np.inf

    def _advance(self, seconds: float) -> None:
        self.simulator.AdvanceTo(self.root.get_time() + seconds)

    def _push(self, force: float, height: float) -> None:
        from pydrake.multibody.math import SpatialForce
        from pydrake.multibody.plant import ExternallyAppliedSpatialForce

        applied = ExternallyAppliedSpatialForce()
        applied.body_index = self.body.index()
        applied.p_BoBq_B = np.array([0.0, 0.0, height])
        applied.F_Bq_W = SpatialForce(np.zeros(3), np.array([force, 0.0, 0.0]))
        self.plant.get_applied_spatial_force_input_port().FixValue(self.context, [applied])


@pytest.fixture(scope="module")
def free() -> Free:
    return Free(parse_scene(SCENE))


def test_the_force_to_slide_is_that_of_the_place_and_of_the_trial(free: Free) -> None:
    seed = 1
    varying = VaryingFriction(free.model, free.root, free.scene, seed)
    field = FrictionField(free.scene.table, seed)
    spots = [(0.30, -0.45), (0.50, 0.0), (0.80, 0.40), (0.30, 0.50)]
    factors, onsets = [], []
    for i, (x, y) in enumerate(spots):
        poses = free.put(x, y)
        varying.prepare(["box"] if i == 2 else [], poses)
        corners = np.array([[x + a, y + b] for a in (-0.02, 0.02) for b in (-0.02, 0.02)])
        here = FRICTION * float(field.at(corners).mean())
        now = varying.present("box", free.scene.objects[0].truth).friction_table
        factors.append(now / here)
        onsets.append(free.onset(0.005, now * MASS * GRAVITY))
        # A force that grows by 0.2 % in 10 ms takes nine such steps to make 2 mm/s of 0.2 kg.
        assert onsets[-1] == pytest.approx(now * MASS * GRAVITY * 1.009, rel=0.009)
    assert np.ptp(onsets) > 0.1 * np.mean(onsets)
    # Only the third trial began with a touch; changes below 0.1 % are not carried out.
    np.testing.assert_allclose(factors[:2], 1.0, rtol=1e-3)
    drawn = source(seed, RandomStream.TRIAL_FRICTION).standard_normal() * np.sqrt(np.log1p(0.2**2))
    np.testing.assert_allclose(factors[2:], np.exp(drawn) / np.sqrt(1.04), rtol=2e-3)
    assert abs(factors[2] - 1.0) > 0.05


def test_shifted_contents_move_the_force_that_topples(free: Free) -> None:
    contents = ShiftingContents(free.model, free.root, free.scene, seed=1)
    varying = VaryingFriction(free.model, free.root, free.scene, seed=1)
    truth = free.scene.objects[0].truth
    onsets = []
    for _ in range(3):
        poses = free.put(0.5, 0.0)
        varying.prepare([], poses)
        contents.prepare(["box"], poses)
        now = contents.present("box", truth)
        x, _, _ = now.centre_of_mass
        # Feet of 0.1 mm radius stand that much inside the corners.
        expected = MASS * GRAVITY * (SIZE[0] / 2 - 1e-4 - x) / 0.098
        onsets.append(expected)
        # It shows at 0.02 rad/s, up to a few steps of 0.2 % late.
        assert free.onset(0.098, expected) == pytest.approx(expected, rel=0.02)
    assert np.ptp(onsets) > 0.05 * np.mean(onsets)


def test_the_field_has_its_mean_and_its_spread_over_the_table() -> None:
    table = VaryingTable(friction_variation=FrictionVariation(over_table=0.18, length_m=0.1))
    grid = np.stack(np.meshgrid(np.linspace(-0.2, 1.2, 140), np.linspace(-0.8, 0.8, 160)), axis=-1)
    for seed in range(5):
        values = FrictionField(table, seed).at(grid)
        assert values.min() > 0.0
        # The field is scaled on a coarser grid, and its logarithm not exactly normal.
        assert values.mean() == pytest.approx(1.0, abs=0.002)
        assert values.std() == pytest.approx(0.18, rel=0.05)


def test_friction_changes_over_the_stated_length() -> None:
    table = VaryingTable(friction_variation=FrictionVariation(over_table=0.3, length_m=0.1))
    rng = np.random.default_rng(0)
    here = rng.uniform((0.0, -0.6), (1.0, 0.6), (400, 2))
    distances = (0.0, 0.03, 0.1, 0.3)
    logs = np.array(
        [
            [np.log(FrictionField(table, seed).at(here + np.array([r, 0.0]))) for r in distances]
            for seed in range(30)
        ]
    )
    flat = logs.transpose(1, 0, 2).reshape(4, -1)
    correlation = np.corrcoef(flat)[0]
    # exp(−r²/2ℓ²). Thirty tables of 64 waves each leave some 0.03 far apart, and taking out the
    # table's mean a few hundredths; two of both.
    np.testing.assert_allclose(correlation, [1.0, 0.956, 0.607, 0.011], atol=0.10)


def test_a_table_that_varies_by_trial_only_is_even() -> None:
    table = VaryingTable(friction_variation=FrictionVariation(per_trial=0.2))
    np.testing.assert_array_equal(FrictionField(table, 0).at(np.zeros((3, 2))), np.ones(3))

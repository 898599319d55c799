"""Open boxes in Drake are hollow: what stands in them touches their walls alone."""

from __future__ import annotations

import numpy as np
import pytest
from pydrake.math import RigidTransform
from pydrake.systems.framework import DiagramBuilder

from sim.truth.scene_file import Scene, parse_scene
from sim.worlds.drake.drake_plant import add_plant, inertia
from sim.worlds.drake.drake_world import DrakeWorld

SCENE = """
version: 1
name: bin
objects:
  - {name: bin, model: storage bin, pose: {x_m: 0.5, y_m: 0.0, yaw_deg: 30.0}}
  - {name: can, model: soup can, pose: {x_m: 0.5, y_m: 0.0, z_m: 0.004}}
"""


@pytest.fixture
def scene() -> Scene:
    return parse_scene(SCENE)


def test_a_can_stands_still_on_its_floor(scene: Scene) -> None:
    world = DrakeWorld(scene)
    q_arm, q_hand = world.robot.commanded
    for _ in range(100):
        world.robot.step(q_arm, q_hand)
    sample = world.sample
    # Its slab and that of the floor stand out by a tenth of a millimetre; feet sink in by less.
    assert sample.poses["can"][6] == pytest.approx(0.004, abs=2e-4)
    np.testing.assert_allclose(sample.poses["can"][4:6], [0.5, 0.0], atol=1e-4)


@pytest.mark.parametrize(("off", "touches"), [(0.0, False), (0.070, False), (0.075, True)])
def test_a_can_touches_the_walls_only(scene: Scene, off: float, touches: bool) -> None:
    builder = DiagramBuilder()
    model = add_plant(builder, scene)
    diagram = builder.Build()
    root = diagram.CreateDefaultContext()
    context = model.plant.GetMyMutableContextFromRoot(root)
    aside = np.array([np.cos(np.radians(30.0)), np.sin(np.radians(30.0)), 0.0])
    there = RigidTransform(np.array([0.5, 0.0, 0.0042]) + off * aside)
    model.plant.SetFreeBodyPose(context, model.bodies["can"], there)
    query = model.plant.get_geometry_query_input_port().Eval(context)
    ids = {g for n in ("bin", "can") for g in model.plant.GetCollisionGeometriesForBody(
        model.bodies[n])}  # fmt: skip
    pairs = [pair for pair in query.ComputePointPairPenetration() if {pair.id_A, pair.id_B} <= ids]
    # Half the inside is 106 mm, the can's radius 33 mm.
    assert bool(pairs) == touches
    for pair in pairs:
        np.testing.assert_allclose(np.abs(pair.nhat_BA_W @ aside), 1.0, atol=1e-6)
        assert pair.depth == pytest.approx(0.033 + off - 0.106, abs=1e-6)


def test_its_mass_is_in_floor_and_walls(scene: Scene) -> None:
    truth = scene.object("bin").truth
    M = inertia(truth)
    np.testing.assert_allclose(M.get_com(), truth.centre_of_mass, atol=1e-12)
    # About z a frame of thin walls has more than the solid box: its mass is farther out.
    x, y, _ = truth.shape.extents
    about_z = M.CalcRotationalInertia().get_moments()[2]
    solid = truth.mass_kg * (x * x + y * y) / 12.0
    assert 1.3 * solid < about_z < 2.0 * solid

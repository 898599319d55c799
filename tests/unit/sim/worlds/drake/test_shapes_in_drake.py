"""Round and prismatic objects in the simulated world: read, standing, and refused if wrong."""

from __future__ import annotations

import numpy as np
import pytest

from sim import load_scene
from sim.errors import SceneError
from sim.truth.scene_file import Scene, parse_scene
from sim.worlds.drake.drake_world import DrakeWorld
from tests.fakes.robots import poses_in

HEAD = """\
version: 1
name: one
robot: {home_deg: [41.0, -95.0, 75.0, -87.0, 110.0, -90.0, 42.0]}
objects:
  - name: thing
    model: mug
    pose: {x_m: 0.45, y_m: 0.0}
    truth: {mass_kg: 0.5, friction_table: 0.3, friction_finger: 0.6, %s}
"""


def scene(shape: str) -> Scene:
    return parse_scene(HEAD % shape)


@pytest.fixture(scope="module")
def world() -> DrakeWorld:
    return DrakeWorld(load_scene("counter"), seed=0)


@pytest.mark.parametrize("name", ["soup can", "mug", "tea tin"])
def test_things_stand_where_the_scene_puts_them(world: DrakeWorld, name: str) -> None:
    pose = load_scene("counter").object(name).pose
    seen = poses_in(world, 0.5)[name]
    # The mean of fifteen looks with 2 mm of noise each.
    assert (seen.x, seen.y) == pytest.approx((pose.x_m, pose.y_m), abs=0.0025)


@pytest.mark.parametrize(
    ("shape", "corners", "height"),
    [
        ("size_m: [0.1, 0.2, 0.3]", 4, 0.3),
        ("radius_m: 0.04, height_m: 0.1", 16, 0.1),
        ("radius_m: 0.04, base_radius_m: 0.02, height_m: 0.1", 16, 0.1),
        ("corners_m: [[0.05, 0], [0, 0.05], [-0.05, 0]], height_m: 0.1,"
         " centre_of_mass_m: [0, 0.01, 0.05]", 3, 0.1),
    ],
)  # fmt: skip
def test_shapes_are_read(shape: str, corners: int, height: float) -> None:
    truth = scene(shape).object("thing").truth
    assert (len(truth.shape.silhouette), truth.shape.top) == (corners, height)
    rim = 0.02 if "base_radius" in shape else None
    if rim:
        np.testing.assert_allclose(np.hypot(*np.array(truth.support).T), rim)


@pytest.mark.parametrize(
    ("shape", "words"),
    [
        ("height_m: 0.1", "one shape"),
        ("size_m: [0.1, 0.1, 0.1], radius_m: 0.1, height_m: 0.1", "one shape"),
        ("radius_m: 0.1", "height_m belongs"),
        ("size_m: [0.1, 0.1, 0.1], height_m: 0.1", "height_m belongs"),
        ("size_m: [0.1, 0.1, 0.1], base_radius_m: 0.1", "base_radius_m belongs"),
        ("corners_m: [[0, 0], [1, 0], [0.1, 0.1], [0, 1]], height_m: 0.1", "convex"),
        ("radius_m: 0.04, height_m: 0.1, centre_of_mass_m: [0.05, 0, 0.05]", "outside"),
        ("radius_m: 0.04, height_m: 0.1, support_m: [[0, 0], [0.01, 0]]", "at least 3"),
    ],
)
def test_shapes_that_make_no_sense_are_refused(shape: str, words: str) -> None:
    with pytest.raises(SceneError, match=words):
        scene(shape)


def test_the_solids_in_drake_are_those_of_the_scene(world: DrakeWorld) -> None:
    """A tall look at what was registered: radius, height, corners."""
    from pydrake.geometry import Convex, Cylinder
    from pydrake.systems.framework import DiagramBuilder

    from sim.worlds.drake.drake_plant import add_plant

    made = add_plant(DiagramBuilder(), load_scene("counter"))
    inspector = made.scene_graph.model_inspector()
    shapes = {}
    for name, body in made.bodies.items():
        for geometry in made.plant.GetCollisionGeometriesForBody(body):
            if inspector.GetName(geometry).endswith("solid"):
                shapes[name] = inspector.GetShape(geometry)
    can, tin = shapes["soup can"], shapes["tea tin"]
    assert isinstance(can, Cylinder)
    assert (can.radius(), can.length()) == (0.033, 0.101)
    assert isinstance(tin, Convex)

"""What is in the hand's way: clearances, round things, things that were toppled."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nlcontrol.session.controller import Controller
from objectmodels import ObjectModel, Registry
from objectmodels.geometry.rotations import rot_y, rot_z
from planner.types.actions import Push
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim import load_scene
from sim.control.plan_execution import PushExecution
from sim.motion.collision_scene import (
    FRAGILE_CLEARANCE,
    OBJECT_CLEARANCE,
    CollisionScene,
    Obstacle,
)
from sim.robots.collision_spheres import distance_to_cylinder, distance_to_prism, place_spheres
from sim.simulated_executor import simulation

REGISTRY = Registry.built_in()
CAN, TEA = REGISTRY.get("soup can"), REGISTRY.get("ice tea box")


def _sphere(x: float, y: float, z: float, radius: float = 0.01) -> np.ndarray:
    return np.array([[x, y, z, radius]])


@given(x=st.floats(-0.2, 0.2), y=st.floats(-0.2, 0.2), z=st.floats(-0.1, 0.3))
@pytest.mark.slow
def test_a_cylinder_is_a_prism_of_many_corners(x: float, y: float, z: float) -> None:
    radius, height = 0.04, 0.1
    phi = 2.0 * np.pi * np.arange(720) / 720
    rim = radius * np.column_stack([np.cos(phi), np.sin(phi)])
    sphere = _sphere(x, y, z)
    prism = distance_to_prism(sphere, rim, height)
    # A chord of half a degree lies r (1 − cos 0.25°) = 0.4 µm inside the rim.
    np.testing.assert_allclose(distance_to_cylinder(sphere, radius, height), prism, atol=1e-6)


def test_more_clearance_is_kept_from_what_is_fragile() -> None:
    edge = TEA.extents[0] / 2.0
    for fragile, clearance in ((False, OBJECT_CLEARANCE), (True, FRAGILE_CLEARANCE)):
        tea = SeenObject("tea", PlanarPose(0.5, 0.1), TEA, fragile=fragile)
        scenery = CollisionScene.from_state(
            WorldState({"tea": tea, "can": SeenObject("can", PlanarPose(0, 0), CAN)}), "can"
        )
        near, far = (
            _sphere(0.5 + edge + 0.01 + clearance + off, 0.1, 0.1) for off in (-1e-3, 1e-3)
        )
        assert not scenery.is_free(near)
        assert scenery.is_free(far)
        assert (scenery.hit_by(near), scenery.hit_by(far)) == ("tea", None)


def test_the_pushed_object_counts_where_it_is_by_then() -> None:
    can = SeenObject("can", PlanarPose(0.5, 0.0), CAN)
    scenery = CollisionScene.from_state(WorldState({"can": can}), "can")
    there = scenery.pushed.after_motion(np.zeros(3), np.array([0.2, 0.0, 0.0]), 0.0)
    at_first, later = _sphere(0.5, 0.0, 0.05), _sphere(0.7, 0.0, 0.05)
    assert not scenery.is_free(at_first)
    moved = replace(scenery, pushed=there)
    assert moved.is_free(at_first)
    assert not moved.is_free(later)


@pytest.mark.parametrize("poses", [60, 400])  # few spheres are looked at otherwise than many
@pytest.mark.parametrize("model", [TEA, CAN])
def test_clear_all_along_is_clear_at_each_place(model: ObjectModel, poses: int) -> None:
    rng = np.random.default_rng(0)
    obstacle = Obstacle.from_seen(SeenObject("it", PlanarPose(0.5, 0.1, 0.4), model), 0.01)
    low, high = (0.3, -0.1, 0.0, 0.005), (0.7, 0.3, 0.3, 0.03)
    robot = rng.uniform(low, high, (poses, 3, 4))
    points, R_WD = rng.uniform(-0.1, 0.1, (5, 3)), rot_z(rng.uniform(-0.3, 0.3, 5))
    moved = place_spheres(robot[:, None], R_WD, points)
    each = obstacle.is_clear(moved, 0.004).all(axis=1)
    assert 0.1 < each.mean() < 0.9
    np.testing.assert_array_equal(obstacle.is_clear_along(robot, R_WD, points, 0.004), each)


@pytest.mark.parametrize("yaw", [0.0, 0.7])
def test_a_toppled_can_is_long_and_flat(yaw: float) -> None:
    # It fell along its own x axis; B's origin is the middle of what was its base.
    attitude = tuple(rot_y(np.pi / 2).ravel().tolist())
    seen = SeenObject.lying("can", PlanarPose(0.5, 0.0, yaw, attitude), CAN, fragile=True)
    assert seen.fragile
    obstacle = Obstacle.from_seen(seen, OBJECT_CLEARANCE)
    along = np.array([np.cos(yaw), np.sin(yaw)])
    radius, length = CAN.extents[0] / 2.0, CAN.top
    assert obstacle.height == pytest.approx(2.0 * radius, rel=0.01)  # its outline has corners
    end = np.array([0.5, 0.0]) + (length + 0.02) * along
    beyond, above = _sphere(end[0], end[1], radius), _sphere(0.5, 0.0, 2.0 * radius + 0.02)
    # The far end is 20 mm from the sphere's centre, its top 20 mm below; less the sphere's 10 mm.
    np.testing.assert_allclose(obstacle.distance_to(beyond), 0.01, atol=1e-9)
    np.testing.assert_allclose(obstacle.distance_to(above), 0.01, atol=0.001)
    assert not obstacle.is_clear(beyond)


def test_a_toppled_box_lies_on_its_side() -> None:
    attitude = tuple(rot_y(np.pi / 2).ravel().tolist())
    seen = SeenObject.lying("tea", PlanarPose(0.5, 0.0, 0.0, attitude), TEA)
    x, _, z = TEA.extents
    corners, height = seen.bulk()
    assert height == pytest.approx(x)
    assert np.ptp(corners[:, 0]) == pytest.approx(z)


def test_the_robot_is_told_what_is_fragile() -> None:
    scene = load_scene("counter")
    objects = tuple(
        item.model_copy(update={"fragile": item.name == "mug"}) for item in scene.objects
    )
    scene = scene.model_copy(update={"objects": objects})
    controller = Controller(scene=scene)
    told = {name: seen.fragile for name, seen in controller.look().objects.items()}
    assert told == {"soup can": False, "mug": True, "tea tin": False}
    push = Push(
        object="mug",
        face="front",
        p_BC=(-0.04, 0.0, 0.03),
        normal_W=(-1.0, 0.0, 0.0),
        direction_W=(1.0, 0.0, 0.0),
        force_limit=2.0,
        speed=0.05,
        stroke=0.05,
        fingers=1,
        spread=0.0,
        ends_on="stroke",
    )
    setup = simulation(controller.executor).setup
    execution = PushExecution(push, setup, controller.models)
    assert {name: seen.fragile for name, seen in execution.look().objects.items()} == told


def test_an_open_box_is_hollow() -> None:
    bin_ = SeenObject("bin", PlanarPose(0.5, 0.1, 0.5), REGISTRY.get("storage bin"))
    can = SeenObject("can", PlanarPose(0.0, 0.0), CAN)
    scenery = CollisionScene.from_state(WorldState({"bin": bin_, "can": can}), "can")
    aside = np.array([np.cos(0.5), np.sin(0.5)])
    # Half the inside is 106 mm, the wall 4 mm, the rim 60 mm high.
    reach = OBJECT_CLEARANCE + 0.01
    for off, height, hit in (
        (0.0, 0.04, False),
        (0.0, 0.004 + reach - 1e-3, True),
        (0.106 - reach + 1e-3, 0.04, True),
        (0.106 - reach - 1e-3, 0.04, False),
        (0.108, 0.06 + reach - 1e-3, True),
        (0.108, 0.06 + reach + 1e-3, False),
    ):
        x, y = (np.array([0.5, 0.1]) + off * aside).tolist()
        sphere = _sphere(x, y, height)
        assert (scenery.hit_by(sphere) == "bin") == hit, (off, height)

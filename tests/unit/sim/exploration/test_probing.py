"""Touches in worlds that are not as believed: each ends early, says why, and topples nothing."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from objectmodels import Registry
from planner.touch_experiments import Experiment, Kind, experiments
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim import load_scene
from sim.exploration.probe_control import probe
from sim.exploration.trial_extraction import Recording, extract_trials
from sim.motion.robot_reach import ArmHandReach
from sim.robots.robots import ARM, HAND
from sim.truth.scene_file import Scene
from sim.worlds.drake.drake_world import DrakeWorld
from tests.fakes.robots import poses_in, robot_in

BOX = "ice tea box"
REACH = ArmHandReach(load_scene("kitchen").cell, ARM, HAND)


def scene(**truth: Any) -> Scene:
    """The kitchen with nothing but the box, whose truth is changed."""
    kitchen = load_scene("kitchen")
    box = kitchen.object(BOX)
    item = box.model_copy(update={"truth": box.truth.model_copy(update=truth)})
    return kitchen.model_copy(update={"objects": (item,)})


def seen(world: DrakeWorld, *, off: float = 0.0, far: float = 0.0) -> WorldState:
    """What is believed: the built-in model where the camera sees it, or somewhere else."""
    pose = poses_in(world, 1.0)[BOX]
    pose = PlanarPose(pose.x + far, pose.y + off, pose.yaw)
    return WorldState({BOX: SeenObject(BOX, pose, Registry.built_in().get(BOX))})


def experiment(state: WorldState, kind: Kind, **changes: Any) -> Experiment:
    """The one at the left."""
    found = experiments(state.objects[BOX], REACH.limits)
    one = next(e for e in found if (e.kind, e.push.face) == (kind, "left"))
    if not changes:
        return one
    x, y, _ = one.push.p_BC
    push = one.push.model_copy(update={"p_BC": (x, y, changes["height"])})
    return replace(one, push=push)


def touched(tried: Experiment, world: DrakeWorld, state: WorldState) -> Recording:
    """The recording; afterwards the box stands."""
    recording = probe(tried, robot_in(world), state)
    after = poses_in(world, 1.0)[BOX]
    assert after.attitude is None
    return recording


@pytest.mark.slow
def test_a_slippery_object_slides_where_it_should_tilt() -> None:
    # At 22 cm a box of half the depth 4.5 cm tilts with μ > 0.2 alone.
    world = DrakeWorld(scene(friction_table=0.12), seed=0)
    state = seen(world)
    found = touched(experiment(state, "tilt"), world, state)
    assert (found.end, found.moved) == ("guard", "slide")
    assert found.detail == "it slides where it should tilt"
    # What it showed counts: the force is that of the sliding friction.
    (trial,) = extract_trials(found)
    assert trial.moved == "slide"
    assert np.linalg.norm(trial.force) == pytest.approx(0.12 * 1.06 * 9.81, rel=0.05)


@pytest.mark.slow
def test_pressed_too_low_it_slides_where_it_should_tilt() -> None:
    world = DrakeWorld(scene(), seed=0)
    state = seen(world)
    found = touched(experiment(state, "tilt", height=0.05), world, state)
    assert (found.end, found.moved) == ("guard", "slide")
    moved = poses_in(world, 1.0)[BOX]
    assert abs(moved.y) < 0.05  # stopped soon


@pytest.mark.slow
def test_a_sticky_object_tilts_where_it_should_slide() -> None:
    # Pressed 25 mm above the table a base of half the depth 45 mm slides with μ < 1.8 alone.
    world = DrakeWorld(scene(friction_table=2.5, mass_kg=0.4), seed=0)
    state = seen(world)
    found = touched(experiment(state, "slide"), world, state)
    assert (found.end, found.moved) == ("guard", "topple")
    assert "where it should slide" in found.detail


@pytest.mark.slow
def test_pressed_too_high_it_tilts_where_it_should_slide() -> None:
    world = DrakeWorld(scene(), seed=0)
    state = seen(world)
    found = touched(experiment(state, "slide", height=0.2), world, state)
    assert (found.end, found.moved) == ("guard", "topple")
    assert all(trial.moved == "topple" for trial in extract_trials(found))


@pytest.mark.slow
def test_what_is_too_heavy_does_not_move() -> None:
    world = DrakeWorld(scene(mass_kg=6.0), seed=0)
    state = seen(world)
    found = touched(experiment(state, "slide"), world, state)
    assert (found.end, found.moved) == ("force", None)
    assert "does not move with 1" in found.detail
    assert extract_trials(found) == ()


@pytest.mark.slow
def test_nothing_where_it_should_be() -> None:
    world = DrakeWorld(scene(), seed=0)
    state = seen(world, off=0.04)
    found = touched(experiment(state, "slide"), world, state)
    assert (found.end, found.moved, found.after) == ("no_touch", None, None)
    assert "nothing was felt" in found.detail
    assert extract_trials(found) == ()


def test_out_of_reach_nothing_moves() -> None:
    world = DrakeWorld(scene(), seed=0)
    state = seen(world, far=1.2)
    before = world.robot.commanded[0]
    found = touched(experiment(state, "slide"), world, state)
    assert (found.end, found.moved) == ("unreachable", None)
    assert found.detail
    assert len(found.time) == 0
    np.testing.assert_array_equal(world.robot.commanded[0], before)

"""Lids of a world: as they stand, as the camera sees them, and as they are drawn again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from nlcontrol.session.controller import Controller
from objectmodels.geometry.rotations import rot_x
from planner.types.world_state import SeenObject
from sim import SceneError, load_scene, save_replay
from sim.control.free_motion import watch
from sim.control.object_estimate import estimate_objects, mean_lids
from sim.traces.trace import Trace, join_traces
from sim.truth.scene_file import Scene, parse_scene
from sim.views.trace_scene import TraceScene
from sim.worlds.camera import camera_port, initial_frames
from sim.worlds.drake.drake_world import DrakeWorld
from tests.fakes.robots import frames_in, robot_in

LIDS = {"jar", "fixed bottle", "free bottle", "ice tea cup"}


@pytest.fixture(scope="module")
def pantry() -> Scene:
    return load_scene("pantry")


@pytest.fixture(scope="module")
def trace(pantry: Scene) -> Trace:
    world = DrakeWorld(pantry, seed=1)
    recorder = robot_in(world).recorder(np.array([1.0, 0.0, 0.0]))
    watch(recorder, 0.3)
    return recorder.trace("jar", np.array([1.0, 0.0, 0.0]), end="handled", detail="looked")


def test_closed_lids_stay_closed_and_stand_still(trace: Trace) -> None:
    assert set(trace.lids) == set(trace.seen_lids) == LIDS
    assert set(trace.lid_poses) == LIDS - {"ice tea cup"}
    for name in LIDS:
        assert np.abs(trace.lids[name]).max() < 1e-4
        # Twelve frames of 1° or 2 mm; five deviations of one of them.
        noise = 0.002 if name == "jar" else np.radians(1.0)
        assert 0.0 < np.abs(trace.seen_lids[name]).max() < 5 * noise
    for name, poses in trace.poses.items():
        np.testing.assert_allclose(poses[-1], poses[0], atol=1e-4, err_msg=name)
    assert trace.contacts == ()


def test_traces_of_lids_are_joined(trace: Trace) -> None:
    twice = join_traces([trace, trace])
    assert len(twice.lids["jar"]) == len(twice.seen_lids["jar"]) == 2 * len(trace.time)
    assert twice.lid_poses["jar"].shape == (2 * len(trace.time), 7)


def test_mass_and_centre_of_mass_include_the_lid(pantry: Scene) -> None:
    cup = pantry.object("ice tea cup").truth
    assert cup.lid is not None
    left = cup.without_lid
    assert left.lid is None
    assert left.mass_kg + cup.lid.mass == pytest.approx(cup.mass_kg)
    moment = left.mass_kg * left.centre_of_mass[2] + cup.lid.mass * (0.12 + 0.0015)
    assert moment == pytest.approx(cup.mass_kg * cup.centre_of_mass[2])
    assert left.without_lid is left
    with pytest.raises(SceneError, match="mass_kg"):
        parse_scene(
            "version: 1\nname: x\nrobot: {home_deg: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]}\n"
            "objects:\n- {name: a, model: jar, pose: {x_m: 0.5, y_m: 0.0}, truth: {radius_m: 0.04,"
            " height_m: 0.1, mass_kg: 0.05, friction_table: 0.3, friction_finger: 0.5,"
            " lid: {kind: screw, mass_kg: 0.06, friction_torque_nm: 0.1, radius_m: 0.02,"
            " height_m: 0.02}}}\n"
        )


def test_what_is_seen_of_lids_and_holders(pantry: Scene) -> None:
    controller = Controller(scene=pantry, seed=3)
    seen = controller.look().objects
    assert {name for name, each in seen.items() if each.lid is not None} == LIDS
    assert {name for name, each in seen.items() if each.fixed} == {"fixed bottle"}
    world = DrakeWorld(pantry, seed=3)
    first, then = initial_frames(pantry, 1.0, seed=3), frames_in(world, 1.0)
    expected = mean_lids(first)
    for name, value in mean_lids(then).items():
        # They settle by micrometres and microradians.
        assert value == pytest.approx(expected[name], abs=1e-4)
        assert seen[name].lid == pytest.approx(expected[name], abs=1e-12)


def test_a_lid_rises_above_its_object(pantry: Scene) -> None:
    seen = Controller(scene=pantry, seed=0).look().objects
    assert seen["jar"].bulk()[1] == pytest.approx(0.11 + 0.008 + 0.025)
    assert seen["free bottle"].bulk()[1] == pytest.approx(0.21 + 0.021)
    cup = replace(seen["ice tea cup"], lid=np.radians(100.0))
    assert cup.bulk()[1] == pytest.approx(0.12 + 0.003 + 0.07 + 0.02)
    assert replace(cup, lid=None).bulk()[1] == 0.12


def _seen_off(scene: Scene, X_WL: tuple[np.ndarray, np.ndarray]) -> dict[str, SeenObject]:
    """The pantry with the jar's lid off."""
    port = camera_port(scene, seed=2)
    poses = {
        item.name: (np.eye(3), np.array([item.pose.x_m, item.pose.y_m, 0.0]))
        for item in scene.objects
    }
    for k in range(100):
        port.observe(0.01 * k, poses, {"jar": 0.2}, {"jar": X_WL})
    return estimate_objects(
        scene.cell, port.take_arrived_frames(2.0), Controller(scene=scene).models
    )


def test_a_lid_that_is_off_is_seen_where_it_lies(pantry: Scene) -> None:
    seen = _seen_off(pantry, (np.eye(3), np.array([0.4, -0.3, 0.0])))
    assert seen.keys() == {*pantry.names, "jar lid"}
    # Thirty frames of 2 mm; five deviations of their mean.
    assert seen["jar"].lid_at == pytest.approx((0.4, -0.3, 0.0), abs=5 * 0.002 / np.sqrt(30))
    assert seen["jar"].bulk()[1] == pytest.approx(0.11)
    outline, height = seen["jar lid"].bulk()
    assert height == pytest.approx(0.033)
    assert np.ptp(outline, axis=0) == pytest.approx(0.084, rel=0.02)  # a polygon about a disc


def test_a_lid_that_leans_is_not_taken_for_one_that_lies(pantry: Scene) -> None:
    seen = _seen_off(pantry, (rot_x(np.pi / 2.0), np.array([0.4, -0.3, 0.042])))
    assert seen["jar"].lid_at is None
    assert "jar lid" in seen


def test_noise_on_lids_leaves_that_on_poses_as_it_was(pantry: Scene) -> None:
    bare = pantry.model_copy(
        update={
            "objects": tuple(
                item.model_copy(update={"truth": item.truth.without_lid}) for item in pantry.objects
            )
        }
    )
    with_lids, without = (initial_frames(scene, 0.5, seed=4) for scene in (pantry, bare))
    for one, other in zip(with_lids, without, strict=True):
        assert one.lids.keys() == LIDS
        assert other.lids == {}
        for name in pantry.names:
            np.testing.assert_array_equal(one.poses[name].p_WB, other.poses[name].p_WB)


def test_what_stands_in_a_holder_does_not_move(pantry: Scene) -> None:
    world = DrakeWorld(pantry, seed=1)
    body = world._model.bodies["fixed bottle"]
    assert not body.is_floating_base_body()
    assert world._model.bodies["free bottle"].is_floating_base_body()


def test_a_replay_draws_lids_where_they_were(pantry: Scene, trace: Trace, tmp_path: Path) -> None:
    trace.lids["ice tea cup"][-1] = 1.5
    trace.lid_poses["jar"][-1, 4:] = (0.3, 0.3, 0.0)
    stage = TraceScene(pantry, lambda builder, model: None)
    stage.show(trace, len(trace.time) - 1)
    plant, context = stage.model.plant, stage.plant_context
    lids = stage.model.lids
    assert lids["ice tea cup"].joint.GetOnePosition(context) == pytest.approx(1.5)
    p_WL = plant.EvalBodyPoseInWorld(context, lids["jar"].body).translation()
    np.testing.assert_allclose(p_WL, (0.3, 0.3, 0.0), atol=1e-12)
    path = tmp_path / "pantry.html"
    save_replay(trace, pantry, path)
    assert path.stat().st_size > 100_000

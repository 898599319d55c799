"""The world behind the ports: what is seen, felt and recorded; replay and pictures."""

from __future__ import annotations

import gc
import weakref
from pathlib import Path

import numpy as np
import pytest

from sim import PictureError, load_scene, save_picture, save_replay
from sim.control.object_estimate import mean_poses
from sim.robots.finger_kinematics import JOINT_NAMES
from sim.traces.trace import Trace
from sim.truth.scene_file import ScaledTorqueSensor
from sim.views.trace_picture import missing_libraries
from sim.views.trace_scene import samples
from sim.worlds.camera import initial_frames
from sim.worlds.drake.drake_world import DrakeWorld
from sim.worlds.ports import WorldRecord
from tests.fakes.robots import poses_in


@pytest.fixture(scope="module")
def still() -> DrakeWorld:
    return DrakeWorld(load_scene("kitchen"), seed=3)


@pytest.fixture(scope="module")
def half_a_second(still: DrakeWorld) -> WorldRecord:
    """In which nothing is done."""
    record = still.record()
    poses_in(still, 0.5)
    return record


@pytest.fixture
def trace(still: DrakeWorld, half_a_second: WorldRecord) -> Trace:
    samples, world = half_a_second.samples, still
    n = len(samples)
    poses = {name: np.array([s.poses[name] for s in samples]) for name in world.scene.names}
    return Trace(
        time=np.array([s.time for s in samples]),
        phase=np.full(n, "look"),
        poses=poses,
        seen=poses,
        joints=np.array([s.joints for s in samples]),
        joint_names=world.robot.joint_names,
        tips={},
        felt={},
        force_limit=np.zeros(n),
        contacts=(),
        pushed="ice tea box",
        direction=np.array([1.0, 0.0, 0.0]),
        end="stroke",
        detail="",
        seed=world.seed,
    )


def test_nothing_moves_by_itself(half_a_second: WorldRecord) -> None:
    first, last = half_a_second.samples[0], half_a_second.samples[-1]
    for name in first.poses:
        # Contacts settle by micrometres.
        np.testing.assert_allclose(last.poses[name], first.poses[name], atol=2e-5)
    np.testing.assert_allclose(last.joints, first.joints, atol=1e-6)
    assert half_a_second.contacts == []


def test_first_look_is_what_the_world_shows_first() -> None:
    scene = load_scene("kitchen")
    before, after = (
        mean_poses(initial_frames(scene, 0.5, seed=5)),
        poses_in(DrakeWorld(scene, seed=5), 0.5),
    )
    for name in scene.names:
        # They differ by what objects settle.
        assert before[name].x == pytest.approx(after[name].x, abs=1e-5)
        assert before[name].yaw == pytest.approx(after[name].yaw, abs=1e-5)


def test_fingers_that_touch_nothing_feel_a_constant_and_noise(still: DrakeWorld) -> None:
    readings = np.array([still.robot.finger_torques("index") for _ in range(400)])
    sensor = still.scene.torque_sensor
    early, late = readings[:200].mean(axis=0), readings[200:].mean(axis=0)
    # A mean of 200 readings has a fourteenth of their deviation; five of those for a difference.
    np.testing.assert_allclose(early, late, atol=still.robot.torque_noise / 2)
    assert np.abs(early).max() < 4.0 * sensor.bias_nm
    # Steps of 2 mN·m add a twelfth of their square: 0.7 % here.
    np.testing.assert_allclose(readings.std(axis=0), still.robot.torque_noise, rtol=0.15)


@pytest.mark.parametrize("time_step", [0.001, 0.002])
def test_a_finger_that_swings_evenly_feels_next_to_nothing(time_step: float) -> None:
    ideal = ScaledTorqueSensor(noise_nm=0.0, resolution_nm=0.0, bias_nm=0.0)
    kitchen = load_scene("kitchen")
    world = DrakeWorld(
        kitchen.model_copy(update={"torque_sensor": ideal, "time_step_s": time_step})
    )
    q_arm, q_hand = world.robot.commanded
    proximal = np.array(JOINT_NAMES) == "index_proximal"
    for _ in range(40):
        q_hand = q_hand - 0.002 * proximal
        world.robot.step(q_arm, q_hand)
    # Commands in steps make a saw tooth of ±1.5 mN·m; its middle is the joint's damping, 0.1 mN·m.
    assert np.abs(world.robot.finger_torques("index")).max() < 3e-4


def test_the_same_seed_gives_the_same_noise_and_another_seed_another() -> None:
    scene = load_scene("kitchen")
    one, same, other = (poses_in(DrakeWorld(scene, seed=seed), 0.2) for seed in (1, 1, 2))
    assert one == same
    assert one != other


def test_replay_is_one_file_without_links(still: DrakeWorld, trace: Trace, tmp_path: Path) -> None:
    path = tmp_path / "run.html"
    save_replay(trace, still.scene, path)
    html = path.read_text(encoding="utf-8")
    assert html.lstrip().lower().startswith("<!doctype html>")
    # Scripts and styles stand in the file itself.
    assert "<script src" not in html
    assert "<link" not in html
    assert 200_000 < len(html) < 1_000_000  # the viewer and the recording


@pytest.mark.skipif(bool(missing_libraries()), reason="this machine has no EGL to draw with")
def test_picture_and_moving_picture(still: DrakeWorld, trace: Trace, tmp_path: Path) -> None:
    from PIL import Image

    save_picture(trace, still.scene, tmp_path / "run.png", title="push the mug away")
    save_picture(trace, still.scene, tmp_path / "run.gif")
    with Image.open(tmp_path / "run.png") as picture:
        # Four frames of 640 × 480, a line of 34 below each, and the title of 48 above them.
        assert picture.size == (1280, 960 + 2 * 34 + 48)
        for line in (picture.crop((0, 0, 1280, 48)), picture.crop((0, 528, 640, 562))):
            darkest, lightest = np.array(line.convert("L")).min(), np.array(line).max()
            assert darkest < 80  # the letters
            assert lightest > 250
        # More than a flat background: table, boxes and arm have colours of their own.
        assert len(picture.convert("RGB").quantize(64).getcolors() or []) > 20
    with Image.open(tmp_path / "run.gif") as moving:
        assert getattr(moving, "n_frames", 0) >= 1


def test_a_picture_of_another_kind(still: DrakeWorld, trace: Trace, tmp_path: Path) -> None:
    with pytest.raises(PictureError) as raised:
        save_picture(trace, still.scene, tmp_path / "run.bmp")
    assert raised.value.code == "bad_picture"


def test_a_machine_that_cannot_draw_says_what_is_missing(
    still: DrakeWorld, trace: Trace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sim.views.trace_picture._LIBRARIES", ("libNoSuchThing.so.1",))
    with pytest.raises(PictureError) as raised:
        save_picture(trace, still.scene, tmp_path / "run.png")
    assert raised.value.code == "no_pictures"
    assert "libNoSuchThing" in raised.value.message
    assert "libegl1" in " ".join(raised.value.suggestions)


def test_frames_of_a_recording(still: DrakeWorld, trace: Trace) -> None:
    chosen = samples(trace, 10.0)
    assert chosen[0] == 0
    assert chosen[-1] == len(trace.time) - 1
    np.testing.assert_allclose(np.diff(trace.time[chosen])[:-1], 0.1, atol=still.robot.period)


def test_a_record_has_what_happened_while_somebody_kept_it() -> None:
    world = DrakeWorld(load_scene("kitchen"))
    first = world.record()
    world.robot.step(*world.robot.commanded)
    second = world.record()
    world.robot.step(*world.robot.commanded)
    period = world.robot.period
    assert [sample.time for sample in first.samples] == [0.0, period, 2 * period]
    assert [sample.time for sample in second.samples] == [period, 2 * period]
    assert first.samples[-1] is second.samples[-1] is world.sample


def test_a_world_keeps_nothing_of_what_was() -> None:
    world = DrakeWorld(load_scene("kitchen"))
    record, old = world.record(), weakref.ref(world.sample)
    world.robot.step(*world.robot.commanded)
    assert old() is record.samples[0]
    del record
    assert old() is None


def test_a_world_is_freed_with_its_last_user() -> None:
    """Its port does not keep it: no cycle is left to the garbage collector."""
    world = DrakeWorld(load_scene("kitchen"))
    freed = weakref.ref(world)
    gc.collect()
    gc.disable()
    try:
        world.robot.step(*world.robot.commanded)
        del world
        assert freed() is None
    finally:
        gc.enable()

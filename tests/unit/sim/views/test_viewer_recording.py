"""A trace as a viewer plays it: what is packed_series is what was recorded."""

from __future__ import annotations

import base64
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from objectmodels.geometry.rotations import from_quaternion
from sim import load_scene
from sim.truth.scene_file import Scene
from sim.views.viewer_recording import packed_series, scene_and_recording
from tests.fakes.pushed_trace import DURATION, FORCE, PHASES, pushed_trace

BOX = "ice tea box"


def _unpacked(series: dict[str, Any]) -> NDArray[np.float64]:
    """Rows over time, as `page/frame_track.js` reads them."""
    steps = np.frombuffer(base64.b64decode(series["data"]), "<i2").reshape(series["rows"], -1)
    return np.asarray(np.cumsum(steps, axis=1, dtype=np.int16) * series["step"])


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load_scene("kitchen")


@pytest.fixture(scope="module")
def recorded(scene: Scene) -> tuple[dict[str, Any], dict[str, Any]]:
    return scene_and_recording(pushed_trace(scene, BOX), scene)


def test_packing_keeps_values_to_half_a_step() -> None:
    values = np.random.default_rng(0).uniform(-3.2, 3.2, (50, 4, 3))
    rows = _unpacked(packed_series(values, 1e-4))
    np.testing.assert_allclose(rows, values.reshape(50, 12).T, atol=0.51e-4)


def test_what_is_out_of_range_stays_at_its_end() -> None:
    assert _unpacked(packed_series(np.array([[1.0], [-9.0], [1.0]]), 1e-4))[
        0
    ].tolist() == pytest.approx([1.0, -3.2768, 1.0])


def test_bodies_are_where_the_trace_says(
    scene: Scene, recorded: tuple[dict[str, Any], dict[str, Any]]
) -> None:
    document, recording = recorded
    names = [body["object"] or body["name"] for body in document["bodies"]]
    places = _unpacked(recording["places"]).reshape(len(names), 3, -1)
    turns = _unpacked(recording["turns"]).reshape(len(names), 4, -1)
    box = names.index(BOX)
    start = scene.object(BOX).pose
    np.testing.assert_allclose(places[box, :, 0], [start.x_m, start.y_m, 0.0], atol=1e-4)
    np.testing.assert_allclose(places[box, 0, -1], start.x_m + 0.1, atol=1e-4)
    R = from_quaternion(turns[box, :, 0])
    assert np.degrees(np.arctan2(R[1, 0], R[0, 0])) == pytest.approx(start.yaw_deg, abs=0.01)
    assert names[recording["pushed"]] == BOX
    assert len(recording["times"]) == places.shape[2]
    assert recording["times"][-1] == pytest.approx(DURATION)
    assert np.diff(recording["times"]).max() < 0.05


def test_quaternions_do_not_jump_to_their_negatives(scene: Scene) -> None:
    trace = pushed_trace(scene, BOX)
    half = np.radians(np.linspace(85.0, 95.0, len(trace.time)))
    trace.poses[BOX][:, [0, 3]] = np.column_stack([np.cos(half), np.sin(half)])
    _, recording = scene_and_recording(trace, scene)
    turns = _unpacked(recording["turns"])
    assert 0.0 < np.abs(np.diff(turns, axis=1)).max() < 0.01


def test_phases_touches_and_forces_are_told(
    recorded: tuple[dict[str, Any], dict[str, Any]],
) -> None:
    _, recording = recorded
    assert [each["phase"] for each in recording["phases"]] == list(PHASES)
    assert recording["touches"] == [{"time": 2.4, "bodies": [BOX, "index_tip"]}]
    felt = _unpacked(recording["force"]["felt"])[0]
    assert felt.max() == pytest.approx(2.0 * FORCE, abs=0.01)
    assert felt[0] == 0.0
    assert _unpacked(recording["force"]["limit"])[0].max() == pytest.approx(10.0, abs=0.01)
    assert [finger["name"] for finger in recording["fingers"]] == ["index", "ring"]


def test_liquid_that_keeps_its_form_is_told_once(
    scene: Scene, recorded: tuple[dict[str, Any], dict[str, Any]]
) -> None:
    document, recording = recorded
    forms = recording["liquid"]
    assert len(forms) == sum(item.truth.vessel is not None for item in scene.objects)
    frames = len(recording["times"])
    for form in forms:
        assert (form["from"], form["to"]) == (0, frames - 1)
        corners = np.frombuffer(base64.b64decode(form["corners"]), "<i2") * form["step"]
        vessel = scene.object(document["bodies"][form["body"]]["object"]).truth.vessel
        assert vessel is not None
        assert corners.reshape(-1, 3)[:, 2].min() == pytest.approx(vessel.floor, abs=1e-4)
        faces = np.frombuffer(base64.b64decode(form["faces"]), "<u2")
        assert faces.max() < len(corners) // 3


def test_a_push_is_seen_from_beside(recorded: tuple[dict[str, Any], dict[str, Any]]) -> None:
    azimuth = recorded[1]["view"]["azimuth"]
    assert abs(np.cos(azimuth)) < 0.7  # along x it is pushed


def test_a_run_that_nobody_observed_is_shown_as_the_camera_saw_it(scene: Scene) -> None:
    trace = pushed_trace(scene, "mug")
    trace = replace(trace, seen=trace.poses)
    _, observed = scene_and_recording(trace, scene)
    _, perceived = scene_and_recording(trace.perceived, scene)
    for key in ("turns", "places"):
        assert perceived[key] == observed[key]

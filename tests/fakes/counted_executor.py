"""An executor without a world that notes each motion, for services that are attacked.

Two files stand in the folder named by `NLCONTROL_TEST_TABLE`: `poses.json`, where everything stands
(x [m], y [m], yaw [rad] by name), which anyone may write as a hand may move things; and `motions`,
to which each motion adds a line. A push does what was planned.
"""

from __future__ import annotations

import json
import math
import os
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from objectmodels import ObjectModel
from objectmodels.geometry.rotations import rot_z
from planner.touch_experiments import Experiment
from planner.types.world_state import Held, WorldState
from sim.control.object_estimate import estimate_objects
from sim.exploration.trial_extraction import Recording
from sim.motion.robot_reach import ArmHandReach
from sim.robots.robots import ARM, HAND
from sim.traces.trace import Trace
from sim.truth.scene_file import load_scene
from sim.worlds.ports import Frame, SeenPose

FOLDER_VARIABLE = "NLCONTROL_TEST_TABLE"
POSES, MOTIONS = "poses.json", "motions"

Poses = dict[str, tuple[float, float, float]]

RATE = 100.0
PHASES = ["look"] * 60 + ["approach"] * 5 + ["touch"] * 15 + ["push"] * 40 + ["settle"] * 90


def first_poses() -> Poses:
    """Where everything stands at the beginning."""
    scene = load_scene("kitchen")
    return {
        item.name: (item.pose.x_m, item.pose.y_m, math.radians(item.pose.yaw_deg))
        for item in scene.objects
    }


def write_poses(folder: Path, poses: Poses) -> None:
    """Moves everything; nobody ever sees half of it."""
    written = folder / f"{POSES}.new"
    written.write_text(json.dumps(poses))
    written.replace(folder / POSES)


def motions_in(folder: Path) -> int:
    """Motions so far."""
    try:
        return len((folder / MOTIONS).read_bytes().splitlines())
    except FileNotFoundError:
        return 0


class CountedExecutor:
    """A robot in the kitchen whose camera is perfect and whose motions are counted."""

    def __init__(self) -> None:
        self.folder = Path(os.environ[FOLDER_VARIABLE])
        self.cell = load_scene("kitchen").cell
        self.robot = ArmHandReach(self.cell, ARM, HAND)
        self.seed = 0
        self.held: Held | None = None
        self._recorded = 0.0

    @property
    def time(self) -> float:
        return time.monotonic()  # a hand may move things at any time

    def poses(self) -> Poses:
        return {
            k: (x, y, a) for k, (x, y, a) in json.loads((self.folder / POSES).read_text()).items()
        }

    def note_motion(self, what: str) -> None:
        with (self.folder / MOTIONS).open("a", encoding="utf-8") as file:
            file.write(f"{what}\n")

    def look(self, models: Mapping[str, ObjectModel], duration: float = 1.0) -> WorldState:
        seen = {
            name: SeenPose(rot_z(yaw), np.array([x, y, 0.0]))
            for name, (x, y, yaw) in self.poses().items()
        }
        objects = estimate_objects(self.cell, [Frame(0.0, duration, seen)], models)
        return WorldState(objects, self.cell.table.extent, self.held)

    def execute(self, plan: Any, models: Mapping[str, ObjectModel], progress: Any = None) -> Trace:
        self.note_motion(plan.object)
        if progress is not None:
            progress("push", self.time, "in contact")
        poses = self.poses()
        travel = np.array((plan.push.displacement or (0.0, 0.0, 0.0))[:2])
        trace = _pushed(plan, poses, travel, self._recorded)
        self._recorded = float(trace.time[-1]) + 1.0 / RATE
        x, y, yaw = poses[plan.object]
        after = (x + travel[0], y + travel[1], yaw + plan.push.turn)
        write_poses(self.folder, {**poses, plan.object: after})
        return trace

    def watch(self, name: str, duration: float = 1.0) -> Trace:
        raise AssertionError(f"nobody watches the {name} in these tests")

    def touch(self, experiment: Experiment, state: WorldState, progress: Any = None) -> Recording:
        self.note_motion(f"touch {experiment.push.object}")
        pose = state.objects[experiment.push.object].pose
        return Recording(experiment, "unreachable", "the arm does not reach", pose)


def _pushed(plan: Any, poses: Poses, travel: Any, begin: float) -> Trace:
    """The record of a push that went as planned, from a time of the robot's clock on [s]."""
    n = len(PHASES)
    phase = np.array(PHASES)
    share = np.cumsum(phase == "push") / np.sum(phase == "push")
    tracks = {}
    for name, (x, y, yaw) in poses.items():
        moved = share if name == plan.object else 0.0 * share
        half = (yaw + plan.push.turn * moved) / 2.0
        flat = 0.0 * share
        tracks[name] = np.column_stack(
            [
                np.cos(half),
                flat,
                flat,
                np.sin(half),
                x + travel[0] * moved,
                y + travel[1] * moved,
                flat,
            ]
        )
    push = plan.push
    u = np.array(push.direction_W)
    force = (push.prediction.slide_force or 1.0) * (phase == "push")
    start = np.array([*poses[plan.object][:2], 0.05]) - 0.06 * u
    tips = start + share[:, None] * np.array([*travel, 0.0])
    fingers = [f"finger_{i}" for i in range(push.fingers)]
    at = begin + np.arange(n) / RATE
    return Trace(
        time=at,
        phase=phase,
        poses=tracks,
        seen=tracks,
        sightings={k: np.column_stack([at, track])[::3] for k, track in tracks.items()},
        joints=np.zeros((n, 0)),
        joint_names=(),
        tips=dict.fromkeys(fingers, tips),
        felt=dict.fromkeys(fingers, (force / push.fingers)[:, None] * u),
        force_limit=np.full(n, push.force_limit),
        contacts=(),
        pushed=plan.object,
        direction=u,
        end="turned" if push.ends_on == "turned" else "stroke",
        detail="as planned",
        seed=0,
    )

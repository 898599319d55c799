"""One push by a force that is applied directly, without a robot.

Model: an object of a scene stands alone on the table, as it truly is in the world of a seed at its
first touch: what the scene hides is drawn, its friction is that of its place and trial, its
contents lie as they then do. A force acts at a
material point of it, in a direction that stays; at first it grows quickly until the object moves,
which tells its size roughly, then, from rest again, slowly through that size. A force acts along
its line, so that a point believed a little beside the true surface makes no difference.

Past the onset the force that is not balanced grows evenly, so that speed grows with the square of
time: v ∝ (t − t0)². The onset is the force at t0, where the straight line through √v over the last
part of its way is zero. That takes out what the force gains until the motion is seen, about 1 %.

The object in Drake stands in `sim.worlds.drake.single_object`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.geometry.base_shapes import Polygon
from objectmodels.mechanics.push_thresholds import GRAVITY
from planner.touch_experiments import press as press_at
from planner.types.end_reasons import EndReason
from planner.types.world_state import SeenObject, WorldState
from sim.control.free_motion import RobotSetup
from sim.control.guarded_touch import PAUSE
from sim.control.object_estimate import mean_poses
from sim.exploration.probe_control import ProbeControl, probe
from sim.exploration.trial_extraction import force_curve
from sim.robots.cell_description import LOOK
from sim.truth.object_truth import Truth
from sim.truth.observer import Moved, Verdict, first_motion
from sim.truth.scene_file import Scene, sample_world
from sim.worlds.camera import initial_frames
from sim.worlds.drake.single_object import SingleObjectWorld, single_object_world

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel


_SLOWNESS = 10.0  # time in which the slow force would grow by as much as moves the object [s]
_RISE = 0.2  # time in which the slow force gets near the onset [s]

Way = Literal["force", "robot"]
"""A force applied directly, or the robot's finger."""

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Contact:
    """Place and direction of a push on an object; B is its frame in the scene.

    Attributes:
        object: its name in the scene.
        face: how the face is called.
        point: p_BC [m].
        normal: outward unit normal of the face there, in B.
        direction: unit direction of the force in B.
    """

    object: str
    face: str
    point: Vector
    normal: Vector
    direction: Vector


@dataclass(frozen=True)
class TouchResult:
    """The outcome of a push.

    Attributes:
        outcome: what the observer saw move first; None if the push could not be carried out.
        force: at which it began to move [N]; None if nothing moved.
        detail: what else there is to say, such as why it was not carried out.
    """

    outcome: Moved | None
    force: float | None
    detail: str = ""


class Touch(Protocol):
    """A way of pushing.

    It builds its own world from plain data, so that it may run in any process, and its answer
    depends on its arguments alone, and on what a robot that pushes believes.
    """

    def __call__(self, scene: Scene, contact: Contact, *, seed: int) -> TouchResult:
        """Pushes once in a fresh world of a scene and a seed."""


def touch(scene: Scene, contact: Contact, *, seed: int = 0) -> TouchResult:
    """Pushes an object by a force alone; a `sim.face_experiment.Touch`."""
    world = single_object_world(scene, contact.object, seed)
    truth = world.scene.object(contact.object).truth
    if not _meets(truth, contact):
        return TouchResult(None, None, f"it misses the {contact.object}")
    weight = GRAVITY * truth.mass_kg
    # The quick force: shares of the weight, and the time to grow by e [s].
    weakest, strongest, growth = 0.01, 10.0, 0.2
    quick = _Roll(world, contact, lambda t: weakest * weight * math.exp(t / growth))
    quick.run(growth * math.log(strongest / weakest))
    if quick.verdict.outcome == "none":
        return TouchResult("none", None)
    rough = quick.onset
    # Shares of the rough onset where the slow force begins; the next one if it moved before.
    for near in (0.92, 0.7, 0.4):
        slow = _Roll(world, contact, partial(_slow, near=near, rough=rough))
        slow.run(_RISE + _SLOWNESS * (1.3 - near))
        if slow.verdict.outcome == "none":
            return TouchResult("none", None, "it moved only as long as the force grew quickly")
        # The slow force must have grown by a hundredth of the rough onset first.
        if slow.onset > (near + 0.01) * rough:
            break
    return TouchResult(slow.verdict.outcome, slow.onset)


def _meets(truth: Truth, contact: Contact) -> bool:
    """True if the line of the push goes through the object."""
    p, u = np.array(contact.point), np.array(contact.direction)
    sides = Polygon.convex(truth.shape.silhouette)
    normals = np.vstack((np.pad(sides.normals, ((0, 0), (0, 1))), [[0, 0, 1], [0, 0, -1]]))
    # To meet it within 1 mm will do.
    room = np.append(sides.offsets, [truth.shape.top, 0.0]) - normals @ p + 1e-3
    closing = normals @ u
    with np.errstate(divide="ignore", invalid="ignore"):
        at = room / closing
    enters = np.max(at, where=closing < 0.0, initial=-np.inf)
    leaves = np.min(at, where=closing > 0.0, initial=np.inf)
    beside = (closing == 0.0) & (room < 0.0)
    return bool(enters <= leaves and not beside.any())


def _slow(time: float, *, near: float, rough: float) -> float:
    """The slow force [N]: quickly near the rough onset, then evenly through it."""
    if time < _RISE:
        return rough * near * time / _RISE
    return rough * (near + (time - _RISE) / _SLOWNESS)


class _Roll:
    """An object that begins at rest, under a force [N] that grows with time, until it moves."""

    def __init__(
        self, world: SingleObjectWorld, contact: Contact, force: Callable[[float], float]
    ) -> None:
        self._world, self._contact, self._force = world, contact, force
        self.verdict: Verdict

    def run(self, most: float) -> None:
        """Rolls out until the object moves, or for a time [s]."""
        world, contact = self._world, self._contact
        truth = world.scene.object(contact.object).truth
        point, along = np.array(contact.point), world.R_WB @ np.array(contact.direction)
        poses = [world.restart()]
        steps = 20  # after which the observer looks
        for start in range(0, math.ceil(most / world.step_time), steps):
            poses += [
                world.step(point, self._force(k * world.step_time) * along)
                for k in range(start + 1, start + steps + 1)
            ]
            # The object creeps by a tenth of the bound.
            self.verdict = first_motion(truth, np.array(poses), bound=1e-4)
            if self.verdict.outcome != "none":
                return

    @property
    def onset(self) -> float:
        """Force at which it began to move [N]."""
        seen, step = self.verdict, self._world.step_time
        way = seen.slip if seen.outcome == "slide" else seen.lift
        speeds = np.diff(way[: seen.sample + 1]) / step
        middles = step * (np.arange(seen.sample) + 0.5)
        return self._force(max(onset_time(middles, speeds), 0.0))


def onset_time(times: ArrayLike, speeds: ArrayLike) -> float:
    """When a speed that last grew as v ∝ (t − t0)² was zero [s].

    Args:
        times: of every step, shape (n,) [s].
        speeds: at these times, shape (n,) [m/s].
    """
    t, root = np.asarray(times, float), np.sqrt(np.maximum(speeds, 0.0))
    # The line is fitted to the upper half of √v.
    before = (root < 0.5 * root[-1]) | (np.diff(root, append=np.inf) < 0.0)
    first = int(np.flatnonzero(before)[-1]) + 1 if before.any() else 0
    if len(root) - first < 4:
        return float(t[-1])  # a body that breaks away in so few steps has no delay
    slope, offset = np.polyfit(t[first:], root[first:], 1)
    return float(-offset / slope)


@dataclass(frozen=True)
class FingerTouch:
    """Pushes with the robot's finger; a `sim.face_experiment.Touch`.

    This is the robot's half of the paper's Fig. 7. The robot looks, goes where it believes the
    contact to be, presses straight in and feels when the object begins to move. Along the face the
    fingertip gives way, so that the force stays normal to it. The robot knows nothing else: what
    moved is judged by the observer of the simulated world, as a person did it for the paper. The
    hand stays where it is then: a press is the last thing done in its world.

    Attributes:
        believed: the robot's models of all objects, by their names in the scene.
        build: the robot in a fresh world of a scene and a seed.
    """

    believed: Mapping[str, ObjectModel]
    build: Callable[[Scene, int], RobotSetup]

    def __call__(self, scene: Scene, contact: Contact, *, seed: int = 0) -> TouchResult:
        """Pushes once in a fresh world; see `Touch`."""
        normal = np.array(contact.normal)
        square = np.radians(1.0)
        if abs(normal[2]) > np.sin(square) or -normal @ contact.direction < np.cos(square):
            return TouchResult(None, None, "the finger presses upright faces straight in only")
        setup = self.build(scene, seed)
        poses = mean_poses(initial_frames(scene, LOOK, seed=seed))
        state = WorldState(
            {n: SeenObject.lying(n, pose, self.believed[n]) for n, pose in poses.items()}
        )
        experiment = press_at(
            state.objects[contact.object], np.array(contact.point), normal, setup.reach.limits
        )
        record = setup.observer.record()
        recording = probe(experiment, setup, state, control=_PressControl)
        if not len(recording.time):
            return TouchResult(None, None, recording.detail)
        true_poses = np.array([sample.poses[contact.object] for sample in record.samples])
        seen = first_motion(sample_world(scene, seed).object(contact.object).truth, true_poses)
        if seen.outcome == "none":
            return TouchResult(None, None, recording.detail)
        onset = force_curve(recording).onset
        felt = onset.force if onset is not None and onset.moved else None
        return TouchResult(seen.outcome, felt, recording.detail)


class _PressControl(ProbeControl):
    """One press, from before the face until something has moved."""

    pause = PAUSE
    # What a sticking fingertip drags along the face would add to the force: percents of it.
    gives_way = 0.03
    stays = True

    def run(self) -> tuple[EndReason, str]:
        self._begin()
        return self._slide()

    def _tilts(self) -> None:
        """An object may tilt as well."""

"""The port through which the robot sees: poses at a rate, late, with noise and bias; and colours.

Frames: poses are X_WB; noise on the position is in W, noise on the orientation a rotation about
W's axes. A bias is constant for each object of a world: a shift in W and a turn about the
vertical. Every frame shows all objects and draws its noise in their order, so that the same seed
and the same times give the same frames. How far lids are open is seen with the noise of an
angle, of one that lifts off with that of a position, drawn from a stream of its own; so is the
noise on the pose of a lid that is off, which has the bias of its object.
"""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from objectmodels.containers.lid_geometry import detached_lid, lid_name
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.object_parts import Lid, LiftOffLid
from objectmodels.models.resting_faces import LEVEL
from planner.types.world_state import Colour, PlanarPose, SeenObject
from sim.cell.cell_description import Vision
from sim.random_streams import Stream, source
from sim.rotations import Array, rot_x, rot_y, rot_z, yaw_of
from sim.truth.scene_file import Scene

_SAME_TIME = 1e-9
"""Times that differ by less are equal [s]; far below any step, far above rounding."""


@dataclass(frozen=True)
class SeenPose:
    """A pose as seen: R_WB, shape (3, 3), and p_WB, shape (3,) [m]."""

    R_WB: Array
    p_WB: Array

    @property
    def tilt(self) -> float:
        """Angle between B's z axis and the vertical [rad]."""
        return float(np.arccos(np.clip(self.R_WB[2, 2], -1.0, 1.0)))


@dataclass(frozen=True)
class Frame:
    """What the camera saw at `time` [s]; it can be read from `arrival` [s] on.

    Attributes:
        poses: of all objects, and of lids that are off by their own names.
        lids: how far each lid is open, as in `sim.traces.trace.Trace.lids`.
    """

    time: float
    arrival: float
    poses: Mapping[str, SeenPose]
    lids: Mapping[str, float] = field(default_factory=dict)


class VisionPort:
    """Frames of all objects, in order of time.

    Args:
        vision: noise, bias, rate and delay.
        names: objects, in the order in which noise is drawn.
        lids: of those that have one, in the same order.
        seed: of the world.
    """

    def __init__(
        self,
        vision: Vision,
        names: Iterable[str],
        lids: Mapping[str, Lid] | None = None,
        *,
        seed: int,
    ) -> None:
        self.vision = vision
        self.names = tuple(names)
        self._lid_noise = {
            name: vision.position_noise_m
            if isinstance(lid, LiftOffLid)
            else np.radians(vision.angle_noise_deg)
            for name, lid in (lids or {}).items()
        }
        self._lid_rng = source(seed, Stream.LID_NOISE)
        self._rng = source(seed, Stream.VISION_NOISE)
        drawn = source(seed, Stream.VISION_BIAS).standard_normal((len(self.names), 4))
        angle = np.radians(vision.angle_bias_deg)
        self._bias = {
            name: (rot_z(angle * turn), vision.position_bias_m * np.array(shift))
            for name, (*shift, turn) in zip(self.names, drawn, strict=True)
        }
        self._frames: deque[Frame] = deque()
        self._taken = 0

    def observe(
        self,
        time: float,
        poses: Mapping[str, tuple[Array, Array]],
        lids: Mapping[str, float] | None = None,
        loose: Mapping[str, tuple[Array, Array]] | None = None,
    ) -> None:
        """Takes a frame if one is due.

        Args:
            time: now [s].
            poses: true R_WB and p_WB.
            lids: how far lids truly are open; closed if not given.
            loose: true R_WL and p_WL of lids that are off, by the names of their objects.
        """
        while self._taken / self.vision.rate_hz <= time + _SAME_TIME:
            self._taken += 1
            seen = {name: self._seen(name, *poses[name], self._rng) for name in self.names}
            opened = {
                name: (lids or {}).get(name, 0.0) + self._lid_rng.normal(0.0, noise)
                for name, noise in self._lid_noise.items()
            }
            for name, pose in (loose or {}).items():
                seen[lid_name(name)] = self._seen(name, *pose, self._lid_rng)
            self._frames.append(Frame(time, time + self.vision.delay_s, seen, opened))

    def arrived(self, time: float) -> list[Frame]:
        """Frames that can be read by `time` and were not read before."""
        ready = []
        while self._frames and self._frames[0].arrival <= time + _SAME_TIME:
            ready.append(self._frames.popleft())
        return ready

    def _seen(self, name: str, R_WB: Array, p_WB: Array, rng: np.random.Generator) -> SeenPose:
        """A pose of an object or of its lid, with its bias and with noise."""
        turned, moved = self._bias[name]
        shift = rng.normal(0.0, self.vision.position_noise_m, 3)
        x, y, z = rng.normal(0.0, np.radians(self.vision.angle_noise_deg), 3)
        return SeenPose(rot_z(z) @ rot_y(y) @ rot_x(x) @ turned @ R_WB, p_WB + moved + shift)


def mean_pose(poses: Iterable[SeenPose]) -> PlanarPose:
    """Mean of several views of an object that stands still."""
    seen = list(poses)
    x, y, _ = np.mean([pose.p_WB for pose in seen], axis=0)
    R_WB = np.mean([pose.R_WB for pose in seen], axis=0)
    yaw = float(yaw_of(R_WB))
    if R_WB[2, 2] > np.cos(LEVEL):
        return PlanarPose(float(x), float(y), yaw)
    # The nearest rotation to a mean of rotations.
    left, _, right = np.linalg.svd(R_WB)
    attitude = rot_z(-yaw) @ left @ right
    return PlanarPose(float(x), float(y), yaw, tuple(attitude.ravel().tolist()))


def first_look(scene: Scene, seconds: float, *, seed: int) -> dict[str, PlanarPose]:
    """What the robot sees at the very start, without a simulation: everything stands still.

    It is what `DrakeWorld.look` returns as its first answer in a world of the same seed, but for
    the micrometres by which objects settle.

    Args:
        scene: where things stand.
        seconds: how long to look [s].
        seed: of the world.
    """
    return averaged(first_frames(scene, seconds, seed=seed))


def first_frames(scene: Scene, seconds: float, *, seed: int) -> list[Frame]:
    """The frames of `first_look`; all lids are closed."""
    port = VisionPort(scene.vision, scene.names, lids_in(scene), seed=seed)
    poses = {
        item.name: (
            rot_z(np.radians(item.pose.yaw_deg)),
            np.array([item.pose.x_m, item.pose.y_m, 0.0]),
        )
        for item in scene.objects
    }
    frames: list[Frame] = []
    for tick in itertools.count():
        time = tick / scene.control_rate_hz
        port.observe(time, poses)
        frames += port.arrived(time)
        if frames and time + _SAME_TIME > seconds:
            break
    return frames


def lids_in(scene: Scene) -> dict[str, Lid]:
    """The true lids of a scene by the names of their objects."""
    return {item.name: item.truth.lid for item in scene.objects if item.truth.lid is not None}


def beheld(
    scene: Scene, frames: Iterable[Frame], models: Mapping[str, ObjectModel]
) -> dict[str, SeenObject]:
    """The objects of a scene as the robot knows them from frames in which everything stands still.

    A lid that is off is one more object.

    Args:
        scene: for what the robot is told of its objects and what the camera sees of their colours.
        frames: at least one.
        models: what the robot believes of every object.
    """
    seen = list(frames)
    poses, lids, colours = averaged(seen), averaged_lids(seen), seen_colours(scene)
    found = {
        item.name: SeenObject.lying(
            item.name,
            poses[item.name],
            models[item.name],
            colours[item.name],
            fragile=item.fragile,
            fixed=item.fixed,
            lid=lids.get(item.name),
        )
        for item in scene.objects
    }
    for name, seen_object in list(found.items()):
        lid = detached_lid(models[name], name)
        if lid is not None and lid.name in poses:
            found[name] = replace(seen_object, lid_at=_lid_at(seen, lid.name, poses[lid.name]))
            found[lid.name] = SeenObject.lying(lid.name, poses[lid.name], lid)
    return found


def _lid_at(frames: list[Frame], name: str, pose: PlanarPose) -> tuple[float, float, float] | None:
    """Where a lid that is off lies; None if it does not lie level."""
    if pose.attitude is not None:
        return None
    heights = [frame.poses[name].p_WB[2] for frame in frames if name in frame.poses]
    return pose.x, pose.y, max(0.0, float(np.mean(heights)))


def seen_colours(scene: Scene) -> dict[str, Colour]:
    """What the camera sees of each object's colour, sRGB in 0…1; light and noise do not count."""
    return {item.name: item.truth.colour for item in scene.objects}


def averaged(frames: Iterable[Frame]) -> dict[str, PlanarPose]:
    """Mean pose of each object over frames in which everything stands still."""
    seen = list(frames)
    return {
        name: mean_pose(f.poses[name] for f in seen if name in f.poses) for name in seen[-1].poses
    }


def averaged_lids(frames: Iterable[Frame]) -> dict[str, float]:
    """Mean of how far each lid is open over frames in which everything stands still."""
    seen = list(frames)
    return {name: float(np.mean([f.lids[name] for f in seen])) for name in seen[0].lids}

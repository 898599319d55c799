"""The simulated camera: poses at a rate, late, with noise and bias; and colours.

Frames: poses are X_WB; noise on the position is in W, noise on the orientation a rotation about
W's axes. A bias is constant for each object of a world: a shift in W and a turn about the
vertical. Every frame shows all objects and draws its noise in their order, so that the same seed
and the same times give the same frames. How far lids are open is seen with the noise of an
angle, of one that lifts off with that of a position, drawn from a stream of its own; so is the
noise on the pose of a lid that is off, which has the bias of its object. The level of what is in an
open container is seen with the noise and the bias of a position.
"""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Iterable, Mapping

import numpy as np

from objectmodels.containers.lids import lid_name
from objectmodels.geometry.rotations import Array, rot_x, rot_y, rot_z
from objectmodels.models.object_parts import Lid, LiftOffLid
from planner.types.world_state import Colour
from sim.random_streams import RandomStream, source
from sim.robots.cell_description import Vision
from sim.truth.scene_file import Scene
from sim.worlds.ports import Frame, SeenPose

_SAME_TIME = 1e-9
"""Times that differ by less are equal [s]; far below any step, far above rounding."""


class CameraPort:
    """Frames of all objects, in order of time.

    Args:
        vision: noise, bias, rate and delay.
        names: objects, in the order in which noise is drawn.
        lids: of those that have one, in the same order.
        colours: of the objects.
        seed: of the world.
    """

    def __init__(
        self,
        vision: Vision,
        names: Iterable[str],
        lids: Mapping[str, Lid] | None = None,
        colours: Mapping[str, Colour] | None = None,
        *,
        seed: int,
    ) -> None:
        self.vision = vision
        self.names = tuple(names)
        self._colours = dict(colours or {})
        self._lid_noise = {
            name: vision.position_noise_m
            if isinstance(lid, LiftOffLid)
            else np.radians(vision.angle_noise_deg)
            for name, lid in (lids or {}).items()
        }
        self._lid_rng = source(seed, RandomStream.LID_NOISE)
        self._level_rng = source(seed, RandomStream.LEVEL_NOISE)
        self._level_bias: dict[str, float] = {}
        self._rng = source(seed, RandomStream.VISION_NOISE)
        drawn = source(seed, RandomStream.VISION_BIAS).standard_normal((len(self.names), 4))
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
        levels: Mapping[str, float] | None = None,
    ) -> None:
        """Takes a frame if one is due.

        Args:
            time: now [s].
            poses: true R_WB and p_WB.
            lids: how far lids truly are open; closed if not given.
            loose: true R_WL and p_WL of lids that are off, by the names of their objects.
            levels: true heights of what is in open containers [m].
        """
        while self._taken / self.vision.rate_hz <= time + _SAME_TIME:
            self._taken += 1
            seen = {name: self._seen_pose(name, *poses[name], self._rng) for name in self.names}
            opened = {
                name: (lids or {}).get(name, 0.0) + self._lid_rng.normal(0.0, noise)
                for name, noise in self._lid_noise.items()
            }
            for name, pose in (loose or {}).items():
                seen[lid_name(name)] = self._seen_pose(name, *pose, self._lid_rng)
            shown = {}
            for name, level in (levels or {}).items():
                if name not in self._level_bias:
                    self._level_bias[name] = self.vision.position_bias_m * self._level_rng.normal()
                noise = self._level_rng.normal(0.0, self.vision.position_noise_m)
                shown[name] = level + self._level_bias[name] + noise
            arrival = time + self.vision.delay_s
            self._frames.append(Frame(time, arrival, seen, opened, self._colours, shown))

    def take_arrived_frames(self, time: float) -> list[Frame]:
        """Frames that can be read by `time` and were not read before."""
        ready = []
        while self._frames and self._frames[0].arrival <= time + _SAME_TIME:
            ready.append(self._frames.popleft())
        return ready

    def _seen_pose(self, name: str, R_WB: Array, p_WB: Array, rng: np.random.Generator) -> SeenPose:
        """A pose of an object or of its lid, with its bias and with noise."""
        turned, moved = self._bias[name]
        shift = rng.normal(0.0, self.vision.position_noise_m, 3)
        x, y, z = rng.normal(0.0, np.radians(self.vision.angle_noise_deg), 3)
        return SeenPose(rot_z(z) @ rot_y(y) @ rot_x(x) @ turned @ R_WB, p_WB + moved + shift)


def camera_port(scene: Scene, *, seed: int) -> CameraPort:
    """The camera port of the world of a seed."""
    lids = {item.name: item.truth.lid for item in scene.objects if item.truth.lid is not None}
    colours = {item.name: item.truth.colour for item in scene.objects}
    return CameraPort(scene.vision, scene.names, lids, colours, seed=seed)


def initial_frames(scene: Scene, seconds: float, *, seed: int) -> list[Frame]:
    """The camera frames of the first seconds, in which everything stands still and is closed.

    No simulation is made for them. A world of the same seed shows the same, but for the
    micrometres by which objects settle.
    """
    port = camera_port(scene, seed=seed)
    poses = {item.name: (item.pose.R_WB, item.p_WB) for item in scene.objects}
    frames: list[Frame] = []
    for tick in itertools.count():
        time = tick / scene.control_rate_hz
        port.observe(time, poses)
        frames += port.take_arrived_frames(time)
        if frames and time + _SAME_TIME > seconds:
            break
    return frames

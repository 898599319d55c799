"""Estimates of objects: where they are, how they turn, what the fingertips tell of them.

What guards of a push read is an `ObjectEstimate`; of what is tilted, besides, a `TiltEstimator`.

Estimate of the turn of an object while one fingertip pushes it around.

Model: the fingertip sticks to the object and moves in a direction that is fixed in B, so the object
turns at a constant rate κ per travel s of the contact (see `objectmodels.mechanics.push_motion`);
the object model knows κ roughly. A Kalman filter estimates the turn θ, κ, and the slip y along the
face, from the fingertip's motion and from late camera frames:

    θ′ = κ,    κ′ = 0,    y′ = 0

A frame of an earlier time shows θ − κ (s − s_then), so that it needs no state of the past but the
travel and the fingertip's place.

Frame: W; θ is relative to the object as it was seen before the push.
"""

from __future__ import annotations

import functools
import math
from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import NamedTuple, Protocol

import numpy as np

from objectmodels.containers.lids import detached_lid
from objectmodels.geometry.rotations import Array, rot_z, wrap, yaw_of
from objectmodels.models.object_model import LEVEL, ObjectModel, Resting
from planner.problem.footprints import footprint, gap
from planner.problem.stacks import with_supports
from planner.types.actions import Push
from planner.types.world_state import Held, PlanarPose, SeenObject, WorldState
from sim.robots.cell_description import CellDescription, Vision
from sim.robots.hand import Mount
from sim.worlds.ports import Frame, RobotPort, SeenPose
from sim.worlds.sensors import noise_left

# Growth of the filter's doubt per centimetre of way, from friction that varies.
_TURN_DRIFT = 0.004  # [rad]
_RATE_DRIFT = 0.05  # share of the rate
_SLIP_DRIFT = 0.0008  # [m]
_RATE_DOUBT = 0.4  # share of the rate that is not known at first


@dataclass(frozen=True)
class TurnedObject:
    """The robot's beliefs when the finger begins to push.

    Attributes:
        yaw: of the object as seen before [rad].
        inward: unit normal into the touched face, shape (2,).
        middle: from the fingertip's centre to B's origin, shape (2,) [m].
        direction: unit direction of the contact's motion, shape (2,).
        radius: of the fingertip [m].
        rate: κ, how far the object turns per travel of the contact [rad/m].
    """

    yaw: float
    inward: Array
    middle: Array
    direction: Array
    radius: float
    rate: float

    @property
    def along(self) -> Array:
        """Unit vector along the face, ẑ × inward, shape (2,)."""
        return np.array([-self.inward[1], self.inward[0]])


@dataclass(frozen=True)
class _Past:
    """A time, and the contact's travel and the fingertip's centre then."""

    time: float
    travel: float
    tip: Array


class TurnEstimator:
    """Estimates the turn of an object.

    Args:
        body: what is pushed.
        tip: centre of the fingertip in W when it touches, shape (2,) [m].
        slip: how far along the face it is from where the body has it [m].
        deviations: standard deviations of the seen heading [rad] and of the slip [m].
        camera: standard deviations of a frame's position [m] and heading [rad].

    Attributes:
        travel: of the contact [m].
    """

    def __init__(
        self,
        body: TurnedObject,
        tip: Array,
        slip: float,
        *,
        deviations: tuple[float, float],
        camera: tuple[float, float],
    ) -> None:
        self._body = body
        self._x = np.array([0.0, body.rate, slip])
        turn, along = deviations
        self._P = np.diag(np.square([turn, _RATE_DOUBT * body.rate, along]))
        self._R = np.diag(np.square([camera[0], camera[0], max(camera[1], 1e-4)])) + 1e-12 * np.eye(
            3
        )
        self._past: list[_Past] = []
        self._tip = tip
        self.travel = 0.0

    @property
    def turn_angle(self) -> float:
        """θ [rad]."""
        return float(self._x[0])

    @property
    def rate(self) -> float:
        """κ [rad/m]."""
        return float(self._x[1])

    @property
    def slip(self) -> float:
        """Offset of the contact along the face from where it was to be, along ẑ × inward [m]."""
        return float(self._x[2])

    def update_from_tip(self, time: float, tip: Array) -> None:
        """Takes the fingertip's centre in W, shape (2,) [m], at a time [s]."""
        body, step = self._body, tip - self._tip
        # The contact moves as the tip's centre does, and around it.
        around = self.rate * body.radius * float(body.along @ body.direction)
        way = float(step @ (rot_z(self.turn_angle)[:2, :2] @ body.direction)) / (1.0 - around)
        self._tip = tip
        self.travel += way
        F = np.array([[1.0, way, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        drift = np.square([_TURN_DRIFT, _RATE_DRIFT * body.rate, _SLIP_DRIFT])
        self._x = F @ self._x
        self._P = F @ self._P @ F.T + np.diag(drift) * abs(way) / 0.01
        self._past.append(_Past(time, self.travel, tip))

    def update_from_camera(self, time: float, pose: SeenPose) -> None:
        """Takes a camera frame of an earlier time."""
        body = self._body
        then = next((past for past in self._past if past.time >= time - 1e-9), None)
        if then is None or then is self._past[0]:
            return
        since = self.travel - then.travel
        turned = self.turn_angle - self.rate * since
        R = rot_z(turned)[:2, :2]
        arm = body.middle - self.slip * body.along
        error = np.array(
            [
                *(pose.p_WB[:2] - then.tip - R @ arm),
                wrap(float(yaw_of(pose.R_WB)) - body.yaw - turned),
            ]
        )
        swing = R @ np.array([-arm[1], arm[0]])
        H = np.zeros((3, 3))
        H[:2, 0], H[2, 0] = swing, 1.0
        H[:, 1] = -since * H[:, 0]
        H[:2, 2] = -R @ body.along
        K = self._P @ H.T @ np.linalg.inv(H @ self._P @ H.T + self._R)
        self._x = self._x + K @ error
        self._P = (np.eye(3) - K @ H) @ self._P


# Estimate of an object that is pushed, by late frames and by the fingertips that it goes with.
#
# Model: between late and noisy camera frames the object goes with the fingertips; how it lies to
# them and how it is turned are filtered. What it is to meet stands where it was seen, until it is
# seen to go along.

_SHARE = 0.12  # weight of a new frame in the filtered place: 0.25 of a frame's noise is left
_FASTER = 0.25  # the same for angles, which change faster: 0.4 is left
LEFT, LEFT_OF_ANGLES = noise_left(_SHARE), noise_left(_FASTER)
"""Shares of a frame's noise that are left in a filtered place and in a filtered angle."""

MOVED = 0.001
"""Travel of the fingertips that shows that the object moves [m]."""

NEAR = 0.015
"""Seen gap below which two objects may touch [m]."""

_SLIDING = 0.5  # time constant of the force while it slides freely [s]
_SPEED_SHARE = 0.2  # weight of a new control step in the speed


class ObjectEstimate:
    """A pushed object now, and what it is to meet.

    Args:
        push: that moves it.
        state: what was seen and believed before.
        vision: rate of the camera.
        tip: midpoint of the fingertips' centres in W when they touch, shape (3,) [m].
        period: of a control step [s].

    Attributes:
        slipped: how far the object has come beyond the fingertips since, in W, shape (2,) [m].
        turned: how far it has turned since it was seen first [rad].
        tilt: of its axis B_z, along W's x and y, shape (2,) [rad].
        footprint: corners of what it covers of the table in W, shape (k, 2) [m].
        force: along the push, that it was felt to take last [N].
        sliding_force: the same while it slid freely, filtered [N].
        shoved: how far what it is to meet was seen to go along the push, filtered [m].
        looks: how many frames have told where that stood.
    """

    def __init__(
        self, push: Push, state: WorldState, vision: Vision, tip: Array, period: float
    ) -> None:
        self._seen = seen = state.objects[push.object]
        self._u = np.array(push.direction_W[:2])
        self._name = push.object
        self._first = self._tip = tip[:2]
        self._tips: deque[tuple[float, Array]] = deque()
        self.slipped = np.zeros(2)
        self.turned = 0.0
        self.tilt = np.zeros(2)
        self._outline = footprint(seen)
        self.footprint = self._outline
        self.force = self.sliding_force = 0.0
        self._sliding_share = min(1.0, period / _SLIDING)
        self._meets = push.meets
        self._met = None if push.meets is None else footprint(state.objects[push.meets])
        self._stood = np.zeros(2) if push.meets is None else state.objects[push.meets].pose.p_WB[:2]
        self.shoved = 0.0
        # Where that stands is the mean of a look of a second and of the frames since.
        self.looks = max(1.0, vision.rate_hz)

    def update(self, time: float, tip: Array, force: float, frames: Iterable[Frame]) -> None:
        """Takes in a control step.

        Args:
            time: now [s].
            tip: midpoint of the fingertips' centres in W, shape (3,) [m].
            force: along the push, filtered [N].
            frames: that arrived in it, in the order of their times.
        """
        self._tip = tip[:2]
        self._tips.append((time, self._tip))
        for frame in frames:
            self._update_from_camera(frame.time, frame.poses[self._name])
            if self._meets is not None:
                self._watch_met(frame.poses[self._meets])
        self.footprint = self._covered()
        self.force = force
        slides = self.travel @ self._u > MOVED
        share = self._sliding_share if slides else 1.0
        self.sliding_force += share * (force - self.sliding_force)

    def _update_from_camera(self, time: float, pose: SeenPose) -> None:
        """Takes what a frame showed at a time [s]; those from before the touch tell nothing."""
        while len(self._tips) > 1 and self._tips[1][0] <= time + 1e-9:
            self._tips.popleft()
        at, tip = self._tips[0]
        if at > time + 1e-9:
            return
        slipped = pose.p_WB[:2] - self._seen.pose.p_WB[:2] - (tip - self._first)
        self.slipped = self.slipped + _SHARE * (slipped - self.slipped)
        turned = wrap(yaw_of(pose.R_WB) - self._seen.pose.yaw)
        self.turned += _FASTER * (float(turned) - self.turned)
        x, y, z = pose.R_WB[:, 2]
        self.tilt = self.tilt + _FASTER * (np.arctan2([x, y], z) - self.tilt)

    def _watch_met(self, pose: SeenPose) -> None:
        """Takes in how far what is to be met was seen to go along the push.

        As long as it is not near it stands, and is seen the better.
        """
        assert self._met is not None, "it meets something"
        gone = pose.p_WB[:2] - self._stood
        if gap(self._covered(), self._met) >= NEAR:
            self.looks += 1.0
            self._stood = self._stood + gone / self.looks
        self.shoved += _SHARE * (float(gone @ self._u) - self.shoved)

    def _covered(self) -> Array:
        middle = self._seen.pose.p_WB[:2]
        turned = (self._outline - middle) @ rot_z(-self.turned)[:2, :2]
        return np.asarray(turned + middle + self.displacement)

    @property
    def travel(self) -> Array:
        """Way of the fingertips in W since the touch, shape (2,) [m]."""
        return np.asarray(self._tip - self._first)

    @property
    def displacement(self) -> Array:
        """Way of the object in W since it was seen first, shape (2,) [m]."""
        return self.travel + self.slipped

    @property
    def lean(self) -> float:
        """Tilt to whichever side [rad]."""
        return float(np.linalg.norm(self.tilt))

    @property
    def gap_to_met(self) -> float:
        """Seen gap between it and what it is to meet [m]; nan if that is nothing."""
        return math.nan if self._met is None else gap(self.footprint, self._met)


class TravelSpeed:
    """Speed of a travel, filtered over some control steps.

    Attributes:
        speed: now [m/s].

    Args:
        period: of a control step [s].
    """

    def __init__(self, period: float) -> None:
        self.speed = 0.0
        self._period = period
        self._before = 0.0

    def update(self, travel: float) -> float:
        """Takes the travel after a control step [m]; returns the speed [m/s]."""
        self.speed += _SPEED_SHARE * ((travel - self._before) / self._period - self.speed)
        self._before = travel
        return self.speed


_LEAST_WEIGHT = 0.1  # of a new frame: a third of a second at 30 Hz counts
_TRUSTED = 4.0  # frames that the fingertip's own tilt is worth at the touch


class TiltEstimator:
    """The tilt of an object that a fingertip leans on.

    Model: the fingertip on the face tells the tilt at once and without noise, but for what the base
    has slid and for what is not known of the object's size; both change slowly. The camera tells it
    late and noisily, but wherever the object is. So the mean of what the camera showed lately, less
    what the fingertip told at the times of those frames, is added to what the fingertip tells now.

    Args:
        noise: standard deviation of the tilt that a frame shows [rad].

    Attributes:
        own: what the fingertip tells now [rad].
        correction: what the camera adds to it [rad].
    """

    def __init__(self, noise: float) -> None:
        self.own = 0.0
        self.correction = 0.0
        self._noise = noise
        self._frames = 0.0
        self._past: deque[tuple[float, float]] = deque()

    @property
    def tilt(self) -> float:
        """The tilt now [rad]."""
        return self.own + self.correction

    @property
    def unsure(self) -> float:
        """Standard deviation of the correction [rad]."""
        weight = max(1.0 / (_TRUSTED + self._frames), _LEAST_WEIGHT)
        return self._noise * float(np.sqrt(weight / (2.0 - weight)))

    def update_from_tip(self, time: float, own: float) -> None:
        """The fingertip tells a tilt [rad] at a time [s]."""
        self.own = own
        self._past.append((time, own))

    def update_from_camera(self, time: float, tilt: float) -> None:
        """A frame of a time [s], later than those before it, shows a tilt [rad]."""
        while len(self._past) > 1 and self._past[1][0] <= time:
            self._past.popleft()
        _, own = min(self._past, key=lambda past: abs(past[0] - time))
        self._frames += 1.0
        weight = max(1.0 / (_TRUSTED + self._frames), _LEAST_WEIGHT)
        self.correction += weight * (tilt - own - self.correction)


@dataclass(frozen=True)
class Touch:
    """Fingertips at one time.

    Attributes:
        tips: centres p_WT, shape (k, 3) [m].
        forces: on the object in W, shape (k, 3) [N].
    """

    tips: Array
    forces: Array

    @functools.cached_property
    def midpoint(self) -> Array:
        """Midpoint of the tips' centres in W, shape (3,) [m]."""
        return np.asarray(self.tips.mean(axis=0))


def sense_touch(
    port: RobotPort, mount: Mount, fingers: tuple[str, ...], inward_W: Array, torques: Array
) -> Touch:
    """Places of the pushing fingertips and what they press, by their joints' sensors.

    Model: a fingertip touches with the point of its sphere that faces the object, and its
    joints' torques balance the force there: τ = Jᵀ f, J at that point and not at the sphere's
    centre.

    Frames: P is the palm, T a fingertip's centre; forces are those on the object, in W.

    Args:
        port: of the robot.
        mount: of the arm.
        fingers: names of the pushing fingers.
        inward_W: unit normal into the touched face in W, shape (3,), or of each finger, (k, 3).
        torques: of the fingers' joints, their sensors' zero taken off, shape (k, 3) [N·m].
    """
    hand = mount.hand
    R_WP, p_WP = mount.palm_poses(port.arm_angles())
    tips, forces = [], []
    inwards = np.broadcast_to(inward_W, (len(fingers), 3))
    for finger, inward, tau in zip(fingers, inwards, torques, strict=True):
        angles = port.finger_angles(finger)
        p_PT = hand.tip_centre(finger, angles)
        f_P = hand.tip_force(finger, angles, p_PT + hand.tip_radius * R_WP.T @ inward, tau)
        tips.append(R_WP @ p_PT + p_WP)
        forces.append(R_WP @ f_P)
    return Touch(np.array(tips), np.array(forces))


class Camera(Protocol):
    """A robot that looks; see `nlcontrol.session.executor.Executor`."""

    @property
    def time(self) -> float:
        """The robot's time [s]."""

    def look(self, models: Mapping[str, ObjectModel], /) -> WorldState:
        """Looks at the table and returns what the robot believes then."""


class _Seen(NamedTuple):
    state: WorldState
    time: float
    models: dict[str, ObjectModel]


class LastLook:
    """Looks of a robot, of which the last one is remembered.

    It holds until something is done or learned, or the robot's time goes on; a real one's goes on
    by itself.
    """

    def __init__(self) -> None:
        self._seen: _Seen | None = None
        self._holds = False

    @property
    def state(self) -> WorldState | None:
        """The belief at the last look; None if something was done since."""
        return None if self._seen is None else self._seen.state

    def look(self, camera: Camera, models: Mapping[str, ObjectModel]) -> WorldState:
        """The belief now, or within `kept` that of the last look, where it still holds."""
        seen = self._seen
        if self._holds and seen and (seen.time, seen.models) == (camera.time, models):
            return seen.state
        state = camera.look(models)
        self._seen = _Seen(state, camera.time, dict(models))
        return state

    def forget(self) -> None:
        """Notes that something is done."""
        self._seen = None

    @contextmanager
    def kept(self) -> Iterator[None]:
        """Context in which the last look is enough."""
        before, self._holds = self._holds, True
        try:
            yield
        finally:
            self._holds = before


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


def estimate_objects(
    cell: CellDescription,
    frames: Iterable[Frame],
    models: Mapping[str, ObjectModel],
    held: Held | None = None,
) -> dict[str, SeenObject]:
    """The objects of a cell as the robot knows them from frames in which everything stands still.

    There must be a frame, and a believed model of every object; a lid that is off is one more. What
    is held stands on nothing.
    """
    seen = list(frames)
    poses, lids, colours = mean_poses(seen), mean_lids(seen), seen[-1].colours
    found = {
        item.name: SeenObject.lying(
            item.name,
            poses[item.name],
            models[item.name],
            colours.get(item.name),
            fragile=item.fragile,
            fixed=item.fixed,
            lid=lids.get(item.name),
        )
        for item in cell.objects
    }
    for name, seen_object in list(found.items()):
        lid = detached_lid(models[name], name)
        if lid is not None and lid.name in poses:
            found[name] = replace(seen_object, lid_at=_lid_at(seen, lid.name, poses[lid.name]))
            found[lid.name] = SeenObject.lying(lid.name, poses[lid.name], lid)
    upright = {item.name for item in cell.objects if poses[item.name].attitude is None}
    if held is not None:
        upright.discard(held.name)
    return with_supports(found, {name: _mean_height(seen, name) for name in upright})


def _mean_height(frames: Iterable[Frame], name: str) -> float:
    """Mean height at which an object's origin is seen over the table [m]."""
    return float(np.mean([f.poses[name].p_WB[2] for f in frames if name in f.poses]))


def frame_as_things_lie(frame: Frame, rests: Mapping[str, Resting]) -> Frame:
    """A camera frame in which some objects have the frames of the faces that they lay on."""
    shown = {
        name: SeenPose(*rests[name].lying_pose(pose.R_WB, pose.p_WB)) if name in rests else pose
        for name, pose in frame.poses.items()
    }
    return replace(frame, poses=shown)


def _lid_at(frames: list[Frame], name: str, pose: PlanarPose) -> tuple[float, float, float] | None:
    """Place of a lid that is off; None if it does not lie level."""
    if pose.attitude is not None:
        return None
    return pose.x, pose.y, max(0.0, _mean_height(frames, name))


def mean_poses(frames: Iterable[Frame]) -> dict[str, PlanarPose]:
    """Mean pose of each object over frames in which everything stands still."""
    seen = list(frames)
    return {
        name: mean_pose(f.poses[name] for f in seen if name in f.poses) for name in seen[-1].poses
    }


def mean_lids(frames: Iterable[Frame]) -> dict[str, float]:
    """Mean of how far each lid is open over frames in which everything stands still."""
    seen = list(frames)
    return {name: float(np.mean([f.lids[name] for f in seen])) for name in seen[0].lids}

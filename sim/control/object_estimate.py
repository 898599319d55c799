"""Estimates of objects: where they are, how they turn, what the fingertips tell of them.

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
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from objectmodels.containers.lids import detached_lid
from objectmodels.geometry.rotations import Array, rot_z, wrap, yaw_of
from objectmodels.models.object_model import LEVEL, ObjectModel, Resting
from planner.problem.stacks import with_supports
from planner.types.world_state import Held, PlanarPose, SeenObject
from sim.robots.cell_description import CellDescription
from sim.robots.hand import Mount
from sim.worlds.ports import Frame, RobotPort, SeenPose

if TYPE_CHECKING:
    from planner.types.world_state import WorldState


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

"""Sensing of what the robot holds, by its fingers and the camera.

The finger joints' torques tell how hard thumb and fingers press and what hangs on them; the camera
tells, late and noisily, whether the object stays where it is in the hand, and whether the others
stay where they stand. A frame is compared with where the hand was when it was taken.

Model of a weight: the fingertips' forces balance it, τ = Jᵀf at each of them. While the hand hangs
still the sensors' noise is white; what they read before the fingers touched was taken off, so its
noise adds to that of the mean. Where exactly a fingertip touches is known to a share of its lever.

Frames: P is the palm, G the middle of the grasp, W the world.
"""

from __future__ import annotations

import math
import operator
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from objectmodels.containers.lids import lid_name
from objectmodels.geometry.rotations import Array, wrap, yaw_of
from objectmodels.safety_figure import SafetyFigure
from planner.types.actions import TurnCap
from planner.types.world_state import Held, SeenObject, WorldState
from sim.control.guards import Guard
from sim.control.trace_recorder import TraceRecorder
from sim.motion.held_object_path import HeldObject
from sim.motion.motion_planner import GraspMotion
from sim.robots.cell_description import Vision
from sim.worlds.ports import Frame
from sim.worlds.sensors import noise_left

if TYPE_CHECKING:
    from sim.robots.hand import Mount
    from sim.worlds.ports import SeenPose


CONTACT = 0.4
"""Force on each side that counts as contact [N]."""

FELT = 0.04
"""Time constant of the felt squeeze [s]."""

WEIGHED, WEIGHED_SOON = 0.25, 0.10
"""Time constants of the felt weight, and of one that is noisier and not so late [s]."""

FALLS = 0.4
"""Time constant of the rate at which the weight is felt to fall [s]."""

SLIP: SafetyFigure = 0.012
"""Slip in the hand at which it is no more held as it should be [m]."""

SLIP_ANGLE: SafetyFigure = math.radians(20.0)
"""The same of its turn there [rad]."""

DROPPED = 0.040
"""Slip at which it is not in the hand any more [m]."""

NUDGED: SafetyFigure = 0.010
"""Way of another object that counts as moved [m]."""

NUDGED_ANGLE: SafetyFigure = math.radians(8.0)
"""Lean of another object that counts as moved [rad]."""

LEVER_ERROR = 0.01
"""Relative standard deviation of a weight by the levers of the fingertips' contacts."""

_LOOSE: SafetyFigure = 0.3  # share of the squeeze below which nothing is held
_SEEN_SHARE, _OTHERS_SHARE = 0.25, 0.12  # largest weights of a new camera frame
_SEEN_TO = 0.001  # standard deviation of where it is seen in the hand, along each axis [m]
_TURNED = 4.0  # standard deviations of a constant error: two, along two axes, turned by 90°
_KEPT = 1.0  # time for which the hand's poses are kept; frames are not later [s]


def seen_share(vision: Vision, lever: float) -> float:
    """Weight of a new camera frame in where something is seen in the hand.

    As small as leaves `_SEEN_TO` of the noise, by the law of
    `sim.worlds.sensors.noise_left`.

    Args:
        vision: data sheet of the camera.
        lever: from the place that it tells to the middle of the grasp [m].
    """
    noise = float(np.hypot(vision.position_noise_m, np.radians(vision.angle_noise_deg) * lever))
    left = (_SEEN_TO / max(noise, _SEEN_TO)) ** 2
    return min(_SEEN_SHARE, 2.0 * left / (1.0 + left))


def most_slip(vision: Vision) -> float:
    """Slip that is seen in a hand at most while nothing slips too far [m].

    What is seen wrong by the same in the world is elsewhere in a hand that has turned.
    """
    return SLIP + _TURNED * vision.position_bias_m


@dataclass(frozen=True, eq=False)
class Holding:
    """The part of a grasp that lasts from one execution to the next.

    Attributes:
        held: what is held, as plans know it.
        zero: what the torque sensors read before the fingers touched, shape (4, 3) [N·m].
        zero_samples: over how many control steps.
        opening: how far each fingertip is commanded to stand off its side [m].
        wound, borne: squeeze and weight for which the finger springs are wound up [N].
        R_PB, p_PG: how the object was seen in the hand, and the middle of its grasp [m].
        came: arm angles on the way from home to where it was left, each of shape (7,) [rad].
    """

    held: Held
    zero: Array
    zero_samples: int
    opening: float
    wound: float
    borne: float
    R_PB: Array
    p_PG: Array
    came: tuple[Array, ...]


class HandSense:
    """Feels and sees while something is done with the whole hand.

    Args:
        recorder: of the robot.
        mount: of the arm.
        name: of what is handled.
        p_BG: middle of the grasp in B, shape (3,) [m].
        state: where everything stood.

    Attributes:
        holding: the fingers that touch, the thumb first.
        thumb, fingers: force with which the thumb presses, and the others together [N].
        weight, weight_soon: force upwards on what is held, filtered [N].
        frames: camera frames in which it was seen in the hand.
    """

    def __init__(
        self, recorder: TraceRecorder, mount: Mount, name: str, p_BG: Array, state: WorldState
    ) -> None:
        self._recorder = recorder
        self._mount = mount
        self._name = name
        self._hand = mount.hand
        self.holding: tuple[str, ...] = self._hand.grasp_fingers
        self._p_BG = p_BG
        self._period = recorder.port.period
        vision = recorder.port.cell.vision
        self._seen_share = seen_share(vision, float(np.linalg.norm(p_BG)))
        self._most_slip = most_slip(vision)
        self._past: deque[tuple[float, Array, Array]] = deque()
        self._others = {
            other: (np.append(seen.pose.p_WB[:2], 0.0), np.array([0.0, 0.0, 1.0]))
            for other, seen in state.objects.items()
            if other != name and seen.attitude is None
        }
        self._stood = dict(self._others)
        self.zero_forces()
        self.frames = 0
        self._now: tuple[Array, Array] | None = None
        self._first: tuple[Array, Array] | None = None

    def step(self, q_arm: Array, q_hand: Array) -> None:
        """Commands joint angles, and takes in what is felt and seen then."""
        recorder, hand = self._recorder, self._hand
        R_WP = self._mount.palm_poses(recorder.port.arm_angles())[0]
        recorder.inward = np.array(
            [R_WP @ hand.closing_direction(finger) for finger in hand.grasp_fingers]
        )
        recorder.step(q_arm, q_hand)
        if recorder.touch is not None and recorder.fingers == hand.grasp_fingers:
            presses = np.sum(recorder.touch.forces * recorder.inward, axis=1)
            share = min(1.0, self._period / FELT)
            self.thumb += share * (float(presses[0]) - self.thumb)
            self.fingers += share * (float(presses[1:].sum()) - self.fingers)
            vertical = self.vertical
            self.weight += min(1.0, self._period / WEIGHED) * (vertical - self.weight)
            soon = min(1.0, self._period / WEIGHED_SOON)
            self.weight_soon += soon * (vertical - self.weight_soon)
            # Each filter lags behind a steady fall by its time constant.
            fall = (self.weight - self.weight_soon) / (WEIGHED - WEIGHED_SOON)
            self._fall += min(1.0, self._period / FALLS) * (fall - self._fall)
        self._see(recorder.frames)

    @property
    def vertical(self) -> float:
        """Force of all fingers upwards in the last step [N]."""
        touch = self._recorder.touch
        return 0.0 if touch is None else float(touch.forces[:, 2].sum())

    @property
    def squeeze(self) -> float:
        """Mean of what both sides press [N]."""
        return 0.5 * (self.thumb + self.fingers)

    def felt_text(self, done: str) -> str:
        """What is felt where the hand has done something about it, in words."""
        return (
            f"the hand {done} to {1e3 * self.width:.0f} mm and feels {self.thumb:.1f} N at the "
            f"thumb, {self.fingers:.1f} N at the fingers"
        )

    @property
    def width(self) -> float:
        """Between thumb and fingers, as the joints' angles tell [m]."""
        world = self._recorder.port
        tips = [self._hand.tip_centre(f, world.finger_angles(f))[0] for f in self.holding]
        return float(tips[0] - np.mean(tips[1:]) - 2.0 * self._hand.tip_radius)

    # -- the camera -----------------------------------------------------------------------------

    def _see(self, frames: list[Frame]) -> None:
        world = self._recorder.port
        self._past.append((world.time, *self._mount.palm_poses(world.arm_angles())))
        while self._past[0][0] < world.time - _KEPT:
            self._past.popleft()
        for frame in frames:
            if self._name in frame.poses:
                self._see_held(frame.time, frame.poses[self._name])
            for other, (p_W, up) in self._others.items():
                seen = frame.poses[other]
                place = np.append(seen.p_WB[:2], 0.0)
                self._others[other] = (
                    p_W + _OTHERS_SHARE * (place - p_W),
                    up + _OTHERS_SHARE * (seen.R_WB[:, 2] - up),
                )

    def _see_held(self, time: float, seen: SeenPose) -> None:
        """Takes in where it is in the hand, by a frame."""
        _, R_WP, p_WP = min(self._past, key=lambda past: abs(past[0] - time))
        R_PB = R_WP.T @ seen.R_WB
        p_PG = R_WP.T @ (seen.p_WB + seen.R_WB @ self._p_BG - p_WP)
        self.frames += 1
        if self._now is None:
            self._now = R_PB, p_PG
            return
        share = max(self._seen_share, 1.0 / self.frames)
        R, p = self._now
        self._now = R + share * (R_PB - R), p + share * (p_PG - p)

    def remember(self, R_PB: Array | None = None, p_PG: Array | None = None) -> None:
        """From now on it is to stay in the hand as it is, or as it was seen before."""
        self._first = self._now if R_PB is None or p_PG is None else (R_PB, p_PG)

    def zero_forces(self) -> None:
        """Nothing is felt: the sensors' zero was taken."""
        self.thumb = self.fingers = 0.0
        self.weighs(0.0)

    def weighs(self, weight: float) -> None:
        """Takes the weight that hangs on the fingers as known [N]."""
        self.weight = self.weight_soon = weight
        self._fall = 0.0

    def weight_ahead(self, seconds: float) -> float:
        """Weight after some time [s] if it goes on to fall as it does [N]."""
        return self.weight - self._fall * (WEIGHED + seconds)

    def forget(self) -> None:
        """It is looked at anew: what was seen before does not count."""
        self._now, self.frames = None, 0

    @property
    def remembered_pose(self) -> tuple[Array, Array] | None:
        """R_PB and p_PG as it was remembered; None of a lid, which the camera does not show so."""
        return self._first

    @property
    def slip(self) -> tuple[float, float]:
        """Distance by which it has slipped in the hand [m], and its turn there [rad]."""
        if self._first is None or self._now is None:
            return 0.0, 0.0
        (R_0, p_0), (R, p) = self._first, self._now
        cosine = 0.5 * (float(np.trace(R_0.T @ R)) - 1.0)
        return float(np.linalg.norm(p - p_0)), float(np.arccos(np.clip(cosine, -1.0, 1.0)))

    # -- guards ---------------------------------------------------------------------------------

    def guards(self, squeeze: float) -> Iterator[Guard[Any]]:
        """Guards while something is held with a squeeze [N]: it stays, and so do all others."""
        yield drop_guard(self._name, squeeze)
        yield slip_guard(self._name, self._most_slip)
        yield Guard("slipped", lambda s: s.slip[1], SLIP_ANGLE, partial(_slip_text, self._name))
        yield others_guard()

    @property
    def others(self) -> Iterator[tuple[str, float, float]]:
        """Each other object, how far it was seen to be moved [m], and the sine of its lean."""
        for other, (p_W, up) in self._others.items():
            p_0, _ = self._stood[other]
            yield other, float(np.linalg.norm(p_W - p_0)), float(np.hypot(up[0], up[1]))


def contact_guard(width: float) -> Guard[HandSense]:
    """A hand that closes about a width [m] must feel something on both sides in the end."""
    return Guard(
        "no_grasp",
        lambda s: min(s.thumb, s.fingers),
        CONTACT,
        lambda s: s.felt_text("closed"),
        beyond=operator.lt,
        text=f"a side feels less than {CONTACT:g} N when the hand is closed "
        f"beyond {1e3 * width:.0f} mm",
        unit="N",
    )


def drop_guard(name: str, squeeze: float) -> Guard[HandSense]:
    """The fingers feel something that they hold with a squeeze [N]."""
    return Guard(
        "slipped",
        lambda s: s.squeeze,
        _LOOSE * squeeze,
        lambda s: f"the {name} was dropped: the fingers feel nothing of it",
        beyond=operator.lt,
    )


def slip_guard(name: str, most: float = SLIP) -> Guard[HandSense]:
    """What is held stays where it is in the hand.

    Args:
        name: of it.
        most: slip that a camera may show [m]; see `most_slip`.
    """
    return Guard(
        "slipped",
        lambda s: s.slip[0],
        SLIP,
        partial(_slip_text, name),
        trips_at=most,
        text=f"what is held has slipped by {1e3 * SLIP:.0f} mm in the hand",
        unit="m",
    )


def _slip_text(name: str, sense: HandSense) -> str:
    slip, angle = sense.slip
    what = "was dropped" if slip > DROPPED else "slipped in the hand"
    return f"the {name} {what}: {1e3 * slip:.0f} mm, {np.degrees(angle):.0f}°"


def others_guard() -> Guard[HandSense]:
    """All other objects stay where they stand, upright."""

    def most(sense: HandSense) -> tuple[float, float, str]:
        """Of the one that is moved most: a share of what counts as moved, its way, its name."""
        moved = (
            (max(way / NUDGED, lean / math.sin(NUDGED_ANGLE)), way, name)
            for name, way, lean in sense.others
        )
        return max(moved, default=(0.0, 0.0, ""))

    def says(sense: HandSense) -> str:
        _, way, name = most(sense)
        return f"the {name} was moved by {1e3 * way:.0f} mm"

    return Guard(
        "nudged",
        lambda s: most(s)[0],
        NUDGED,
        says,
        trips_at=1.0,
        text=f"another object is seen moved by {1e3 * NUDGED:.0f} mm",
        unit="m",
    )


@dataclass(frozen=True)
class Weight:
    """A weight as it was felt.

    Attributes:
        mean, sd: the weight and its standard deviation [N].
        samples: control steps over which it was felt.
    """

    mean: float
    sd: float
    samples: int


def estimate_weight(vertical: Array, zero_samples: int) -> Weight:
    """The weight of what is held still, by the fingertips' force upwards, shape (n,) [N].

    It was felt in n control steps, and the sensors' zero taken over `zero_samples`.
    """
    n = len(vertical)
    noise = float(np.std(vertical, ddof=1)) if n > 1 else float("inf")
    mean = float(np.mean(vertical))
    white = noise * np.sqrt(1.0 / n + 1.0 / max(zero_samples, 1))
    return Weight(mean, float(np.hypot(white, LEVER_ERROR * mean)), n)


LEANS: SafetyFigure = math.radians(3.0)
"""Tilt of the object at which its lid is let go [rad]."""

MOVES: SafetyFigure = 0.008
"""Displacement of the object at which its lid is let go [m]."""

TURNS: SafetyFigure = math.radians(6.0)
"""Turn of the object at which its lid is let go [rad]."""

_TURNING = 0.15  # time constant of the felt torque [s]
_LID_SHARE, _POSE_SHARE = 0.3, 0.2  # weights of a new frame
_LEFT = noise_left(_POSE_SHARE)  # of a frame's noise, once filtered
_SIGMAS = 5.0  # of that, which noise in two directions exceeds in one of 270,000 frames


class LidEstimator:
    """A lid and its object as they are seen, from how they were seen before.

    Attributes:
        name: of the object.
        lid: how far it is open.
        is_off: whether it is off its object.
        turn: of the object about the vertical [rad].
        unsure, unsure_angle: displacement [m], and tilt or turn [rad], that may be noise.

    Args:
        target: the object as it was seen before.
        lid: how far it was open.
        vision: noise of the camera.
    """

    def __init__(self, target: SeenObject, lid: float, vision: Vision) -> None:
        self.unsure = _SIGMAS * _LEFT * vision.position_noise_m
        self.unsure_angle = _SIGMAS * _LEFT * float(np.radians(vision.angle_noise_deg))
        self.lid = lid
        self.is_off = target.lid_at is not None
        self.name = target.name
        self._before = target.pose
        self._up = np.array([0.0, 0.0, 1.0])
        self._p_WB = target.pose.p_WB
        self.turn = 0.0

    def update_from_camera(self, frames: Iterable[Frame]) -> None:
        """Takes in what arrived."""
        for frame in frames:
            pose = frame.poses[self.name]
            self.is_off = lid_name(self.name) in frame.poses
            self.lid += _LID_SHARE * (frame.lids[self.name] - self.lid)
            self._up = self._up + _POSE_SHARE * (pose.R_WB[:, 2] - self._up)
            self._p_WB = self._p_WB + _POSE_SHARE * (pose.p_WB - self._p_WB)
            turned = float(wrap(yaw_of(pose.R_WB) - self._before.yaw))
            self.turn += _POSE_SHARE * (turned - self.turn)

    @property
    def tilt(self) -> float:
        """By which the object leans [rad]."""
        return float(np.arctan2(np.hypot(*self._up[:2]), self._up[2]))

    @property
    def displacement(self) -> float:
        """Distance of the object from where it stood [m]."""
        return float(np.hypot(*(self._p_WB - self._before.p_WB)[:2]))


class LidSense(HandSense):
    """Feels and sees while a lid is held.

    The camera shows how far a lid is open, and the object to which it belongs; it does not show
    where a lid is in the hand. The fingers' torques tell how hard a cap turns.

    Model: frames are noisy; each filtered value is an exponential mean of them. The object
    stands where it was seen before, upright; it should stay so.

    Frames: W is the world.

    Attributes:
        view: of the lid and its object.
        torque: with which the hand turns the lid, about the vertical [N·m].
    """

    def __init__(self, recorder: TraceRecorder, way: GraspMotion, handled: HeldObject) -> None:
        p_BG = np.array(handled.grasp.p_BG)
        super().__init__(recorder, way.mount, handled.held.name, p_BG, handled.state)
        self._lid_way = way
        self.holding = way.grip.touching_fingers
        self._owner = handled.state.objects[handled.name]
        vision = recorder.port.cell.vision
        self.view = LidEstimator(self._owner, handled.opened, vision)
        self.torque = 0.0

    def step(self, q_arm: Array, q_hand: Array) -> None:
        """Commands joint angles, and takes in what is felt and seen then."""
        super().step(q_arm, q_hand)
        self.view.update_from_camera(self._recorder.frames)
        touch = self._recorder.touch
        if touch is None:
            return
        R_WP, p_WP = self._mount.palm_poses(q_arm)
        arms = touch.tips - (p_WP + R_WP @ self._lid_way.grip.middle)
        # A fingertip touches something round on the line to its middle.
        arms *= 1.0 - self._hand.tip_radius / np.linalg.norm(arms, axis=1, keepdims=True)
        turning = arms[:, 0] * touch.forces[:, 1] - arms[:, 1] * touch.forces[:, 0]
        share = min(1.0, self._period / _TURNING)
        self.torque += share * (float(turning.sum()) - self.torque)

    def guards(self, squeeze: float) -> Iterator[Guard[Any]]:
        """Guards while the lid is held; besides, the object whose it is stays where it stands."""
        yield from super().guards(squeeze)
        view, name = self.view, self._owner.name
        yield Guard(
            "turned_off",
            lambda s: abs(view.turn),
            TURNS,
            lambda s: f"the {name} turned along by {np.degrees(view.turn):.0f}°",
            trips_at=max(TURNS, view.unsure_angle),
        )
        yield Guard(
            "tilted",
            lambda s: view.tilt,
            LEANS,
            lambda s: f"the {name} leans by {np.degrees(view.tilt):.0f}°",
            trips_at=max(LEANS, view.unsure_angle),
        )
        yield Guard(
            "nudged",
            lambda s: view.displacement,
            MOVES,
            lambda s: f"the {name} was moved by {1e3 * view.displacement:.0f} mm",
            trips_at=max(MOVES, view.unsure),
        )


def cap_guard(step: TurnCap) -> Guard[LidSense]:
    """A cap turns with no more than its torque."""
    return Guard(
        "force",
        lambda s: abs(s.torque),
        step.torque_limit,
        lambda s: f"the cap does not turn with {abs(s.torque):.3f} N·m",
        text=f"the cap takes more than {step.torque_limit:.3f} N·m",
        unit="N·m",
    )

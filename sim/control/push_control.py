"""Control of a push: its force, its line, its turn, its tilt.

A `ForceController` advances a fingertip under a force limit; pushes along a line, tilts and turns
are kinds of it. A `LateralController` steers a push of one fingertip.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from objectmodels import ObjectModel
from objectmodels.geometry.rotations import Array, rot_z, wrap, yaw_of
from objectmodels.mechanics.push_motion import touched_faces, turning_motion
from objectmodels.mechanics.push_thresholds import length_along
from objectmodels.safety_figure import SafetyFigure
from planner.types.end_reasons import Ended
from planner.types.plan import USUAL, Plan, speed_profile
from planner.types.world_state import WorldState
from sim.control.guarded_touch import TouchControl
from sim.control.guards import (
    RAMP,
    Guard,
    Sample,
    Watch,
    band,
    bystander_guards,
    hand_guard,
    planned_ends,
    push_guards,
    sentence_guards,
)
from sim.control.object_estimate import (
    MOVED,
    ObjectEstimate,
    TiltEstimator,
    TravelSpeed,
    TurnedObject,
    TurnEstimator,
)
from sim.control.trace_recorder import EarlyEndError, TraceRecorder
from sim.motion.fingertip_path import FingertipPath, TiltArc
from sim.motion.inverse_kinematics import ArmConfiguration
from sim.worlds.ports import SeenPose

_FORCE_RATE = 10.0  # of an object that stands [N/s]

FASTEST_START = 0.012
"""Speed of the command before the object moves, at most [m/s]."""

_LOOK_ANGLE, _LOOK_PLACE = 0.003, 0.0005  # doubt that averaging leaves [rad], [m]


@dataclass(frozen=True)
class ExecutionContext:
    """A planned motion: the stance of arm and hand, the fingertips' way, what is believed."""

    plan: Plan
    recorder: TraceRecorder
    stance: ArmConfiguration
    way: FingertipPath
    state: WorldState


class ForceController(TouchControl, ABC):
    """One planned motion, from before a face to its end: first `touch`, then `act`.

    Law: from the touch on, the command advances at

        ṡ = v clip((F_limit(t) − F_felt) / band, −1, 1)

    F_felt is the sum of the fingers' forces along the movement vector and F_limit rises from
    the touch to the plan's force. While the object stands, v is so low that the fingers'
    stiffness raises the force at a bounded rate; v rises at a bounded rate after. What v is
    then and where the command goes is each motion's own: its `_advance`, a control step of the
    one loop that all of them share. The loop ends when a guard trips.

    Frames: W is the world, T the midpoint of the pushing fingertips' centres.
    """

    def __init__(self, errand: ExecutionContext) -> None:
        self.plan = plan = errand.plan
        super().__init__(
            plan.push,
            plan.push.prediction.onset,
            errand.recorder,
            errand.stance,
            errand.way,
        )
        self._state = errand.state
        self._target = errand.state.objects[plan.push.object]
        self._started = 0.0
        self._felt_first = 0.0

    @abstractmethod
    def act(self) -> Ended:
        """Does what is planned from the touch on; returns how that ended and why."""

    # -- the loop ------------------------------------------------------------------------------

    def _advance_until(self, guards: Iterable[Guard[Sample]]) -> Ended:
        """Advances, from where the fingertips are now, until a guard trips."""
        watch = Watch(guards, self._period)
        self._origin, vision = self._here.midpoint, self.recorder.port.cell.vision
        self._estimate = ObjectEstimate(
            self.plan.push, self._state, vision, self._origin, self._period
        )
        speed = TravelSpeed(self._period)
        while True:
            self._take_in()
            travel = self._travel
            sample = self._seen_as(
                Sample(
                    elapsed=self._elapsed_time,
                    travel=travel,
                    speed=speed.update(travel),
                    felt=self._felt,
                    tilt=self._tilt,
                    estimate=self._estimate,
                )
            )
            ended = watch.first_tripped(sample)
            if ended is not None:
                return ended
            self._advance(sample)

    def _guards(self) -> Iterator[Guard[Sample]]:
        """Guards of what slides: planned ends, what the sentence limits, what protects."""
        push, vision = self.plan.push, self.recorder.port.cell.vision
        yield from planned_ends(push)
        yield from sentence_guards(push, self._state, vision)
        yield from bystander_guards(push, self._state, vision)
        yield from push_guards(push)

    def _take_in(self) -> None:
        """Takes in what was felt and seen in the last control step."""
        self._estimate.update(
            self.recorder.port.time, self._here.midpoint, self._felt_along, self.recorder.frames
        )

    @abstractmethod
    def _advance(self, sample: Sample) -> None:
        """One control step, after what was felt and seen."""

    @property
    def _travel(self) -> float:
        """Way along the vector since the touch, as the stroke counts it [m]."""
        return float((self._here.midpoint - self._origin) @ self._u)

    def _seen_as(self, sample: Sample) -> Sample:
        """The sample with what this motion knows better."""
        return sample

    # -- force and speed -----------------------------------------------------------------------

    def _begin(self, asked: str) -> None:
        """Reports what is asked; from now on the force limit rises."""
        self.recorder.begin("push", asked)
        self._started = self.recorder.port.time
        self._felt_first = self._felt

    @property
    def _elapsed_time(self) -> float:
        """Time since it began [s]."""
        return self.recorder.port.time - self._started

    @property
    def _felt(self) -> float:
        """Force along the movement vector, filtered [N]."""
        return float(self._forces.sum())

    @property
    def _felt_along(self) -> float:
        """Force that the object takes along the movement vector [N]."""
        return self._felt

    def _room(self) -> float:
        """Share of its speed with which the command advances now, −1 to 1."""
        push, first = self.plan.push, self._felt_first
        limit = min(1.0, self._elapsed_time / RAMP) * (push.force_limit - first) + first
        self.recorder.force_limit = max(limit, first)
        return float(np.clip((limit - self._felt) / band(push), -1.0, 1.0))

    def _loading(self) -> float:
        """Speed of the command that raises the force of an object that stands [m/s]."""
        return _FORCE_RATE / self.stance.push_stiffness(self._u)

    def _start(self) -> float:
        """Speed until the object moves [m/s]."""
        return min(FASTEST_START, self.plan.push.speed, self._loading())

    # -- what is known -------------------------------------------------------------------------

    def _inform(self, keeper: TurnEstimator | LateralController) -> None:
        keeper.update_from_tip(self.recorder.port.time, self._here.midpoint[:2])
        for frame in self.recorder.frames:
            keeper.update_from_camera(frame.time, frame.poses[self._object])

    @property
    def _camera(self) -> tuple[float, float]:
        """Standard deviations of a frame's position [m] and heading [rad]."""
        vision = self.recorder.port.cell.vision
        return vision.position_noise_m, float(np.radians(vision.angle_noise_deg))

    @property
    def _look(self) -> tuple[float, float]:
        """Standard deviations of heading [rad] and place [m] in the look before."""
        place, angle = self._camera
        frames = max(1.0, self.recorder.port.cell.vision.rate_hz)  # the look lasted a second
        return (
            float(angle / np.sqrt(frames)) + _LOOK_ANGLE,
            float(place / np.sqrt(frames)) + _LOOK_PLACE,
        )


@dataclass(frozen=True)
class Pushed:
    """The robot's beliefs about an object that it steers.

    Attributes:
        depth: distance d from the touched face to the object's middle, along the normal [m].
        friction_radius: c̄ [m].
        tip_radius: r of the fingertip [m].
        facing: heading of the touched face's inward normal in B [rad].
        curvature: κ of the face [1/m].
        centre: offset g of the centre of friction from the middle, to the left of the push [m].
    """

    depth: float
    friction_radius: float
    tip_radius: float
    facing: float = 0.0
    curvature: float = 0.0
    centre: float = 0.0

    @property
    def alpha(self) -> float:
        """α = d / (d² + c̄²) [1/m]."""
        return self.depth / (self.depth**2 + self.friction_radius**2)

    @property
    def beta(self) -> float:
        """β = 1 / (d² + c̄²) [1/m²]."""
        return 1.0 / (self.depth**2 + self.friction_radius**2)

    @property
    def flatness(self) -> float:
        """ν = 1 − κ d: lever of the contact about the middle per offset along the face."""
        return 1.0 - self.curvature * self.depth

    @property
    def rolling(self) -> float:
        """ρ = 1 / (1 + κ r): turn of the normal at the contact per turn of the object."""
        return 1.0 / (1.0 + self.curvature * self.tip_radius)

    def turning(self, ahead: float, aside: float) -> Array:
        """Turn of the object by (θ, s, g, 1) when the tip goes so far in D, m being 1; (4,)."""
        by_heading, by_lever = self.alpha * ahead, self.beta * ahead
        by_contact = -self.curvature * by_heading - self.flatness * by_lever
        return np.array([by_heading, by_contact, by_lever, -self.alpha * aside])

    def middle(self, heading: float, contact: float) -> tuple[Array, Array]:
        """The middle from the tip in D, shape (2,) [m], and its derivatives by θ and s, (2, 2)."""
        normal = heading - self.curvature * contact
        R = rot_z(normal)[:2, :2]
        ahead, aside = self.depth + self.tip_radius, -self.flatness * contact
        by_normal = R @ np.array([-aside, ahead])
        by_contact = -self.curvature * by_normal - self.flatness * R[:, 1]
        return R @ np.array([ahead, aside]), np.column_stack([by_normal, by_contact])


@dataclass
class _State:
    """The belief at one time: tip in D, and (θ, s, g, m)."""

    time: float
    tip: Array
    belief: Array


@dataclass(frozen=True)
class LateralTuning:
    """Weights of the least squares over the remaining way, and the filter's doubt."""

    steps: int = 20  # into which the remaining way is divided
    shortest_way: float = 0.01  # remaining way over which it is solved at least [m]
    lateral_weight: float = 1.0 / 0.0015  # of an error at the end [1/m], [1/rad]
    heading_weight: float = 1.0 / math.radians(1.0)
    # Heading on the way that weighs one, root mean square [rad]. With its centre of friction aside
    # of the contact an object goes straight only at an angle.
    heading_on_way: float = math.radians(4.0)
    heading_share: float = 0.15  # or this share of the largest turn allowed
    input_weight: float = 4.0  # of the path's slope
    largest_slope: float = 0.4  # relative to φ, inside the friction cone, so that the tip sticks
    # Growth of the doubt per centimetre of way, from friction that varies and tips that slip: of
    # heading [rad], contact and centre of friction [m], and m.
    doubt_growth: tuple[float, float, float, float] = (0.004, 0.0002, 0.0004, 0.02)
    least_mobility: float = 0.25
    most_mobility: float = 2.0


class LateralController:
    """Estimates how the object moves and says which way the fingertip must go.

    Model: quasi-static sliding with an ellipsoidal limit surface of friction radius c̄ about a
    centre of friction. The fingertip, a sphere of radius r that does not turn, rolls on the face
    without slipping. With κ the face's curvature (0 of a flat one, 1/R of a round one), d the
    distance from the face to the object's middle, s the contact's offset along the face and g that
    of the centre of friction, the face's inward normal at the contact has the heading φ = θ − κ s,
    and with the travelled distance as time

        θ′ = m (α (φ − u) − β (ν s − g)),    s′ = ρ r θ′,    y′ = u + d θ′
        α = d / (d² + c̄²),  β = 1 / (d² + c̄²),  ν = 1 − κ d,  ρ = 1 / (1 + κ r)

    where θ is the heading error, y the lateral error of the middle and u the slope of the
    fingertip's path; m is 1 if c̄ is as believed. On a flat face the middle is ahead of the tip by
    d + r along the normal and aside by s; on a round one it lies on the normal. This is unstable,
    so (θ, s, g, m) are estimated by a Kalman filter from late camera frames and u is chosen by
    least squares over what remains of the way.

    Frame: D has its x axis along the push and its origin at W's; θ is the heading of the face's
    inward normal in D, where the face would be touched in its middle.

    Args:
        pushed: the object.
        direction: heading of the push in W [rad].
        tip: centre of the fingertip in W when it touches, shape (2,) [m].
        seen: where the object was seen before, x, y in W [m] and heading of the face's inward
            normal in W [rad].
        turn: by which the object is to turn [rad].
        limit: largest turn on the way [rad].
        deviations: standard deviations of heading [rad], contact and centre of friction [m] and of
            c̄ [m] at the start.
        camera: standard deviations of a frame's position [m] and heading [rad].
    """

    tuning = LateralTuning()

    def __init__(
        self,
        pushed: Pushed,
        direction: float,
        tip: Array,
        seen: tuple[float, float, float],
        *,
        turn: float = 0.0,
        limit: float = np.inf,
        deviations: tuple[float, float, float, float],
        camera: tuple[float, float],
    ) -> None:
        self._R_DW = rot_z(-direction)[:2, :2]
        self._direction = direction
        self._pushed = pushed
        self._way_weight = (
            1.0
            / min(self.tuning.heading_on_way, self.tuning.heading_share * limit)
            / np.sqrt(self.tuning.steps)
        )
        *others, radius = deviations
        by_radius = 2.0 * pushed.friction_radius * pushed.beta
        self._P = np.diag(np.square([*others, by_radius * radius]))
        self._R = np.diag(np.square([*2 * (max(camera[0], 1e-6),), max(camera[1], 1e-4)]))
        x, y, normal = seen
        heading = float(wrap(normal - direction))
        tip_D, middle = self._R_DW @ tip, self._R_DW @ np.array([x, y])
        c, s = np.cos(heading), np.sin(heading)
        aside = float(np.array([-s, c]) @ (tip_D - middle))
        self._line = float(middle[1])
        self._wanted = heading + turn
        belief = np.array([heading, pushed.rolling * aside, pushed.centre, 1.0])
        self._history = [_State(0.0, tip_D, belief)]
        self._first = float(self._middle[0])

    @property
    def _now(self) -> _State:
        return self._history[-1]

    @property
    def _middle(self) -> Array:
        """The object's middle in D, shape (2,) [m]."""
        now = self._now
        return now.tip + self._pushed.middle(*now.belief[:2])[0]

    @property
    def travelled_distance(self) -> float:
        """Way of the middle along the push since the touch [m]."""
        return float(self._middle[0] - self._first)

    def update_from_tip(self, time: float, tip: Array) -> None:
        """Takes the fingertip's centre in W, shape (2,) [m], at a time [s]."""
        now = self._now
        tip_D = self._R_DW @ tip
        step = tip_D - now.tip
        *others, mobility = now.belief
        turning = self._pushed.turning(*step)
        turned = float(turning @ [*others, 1.0])
        rolled = np.array([1.0, self._pushed.rolling * self._pushed.tip_radius, 0.0, 0.0])
        F = np.eye(4) + np.outer(rolled, [*mobility * turning[:3], turned])
        drift = np.square(self.tuning.doubt_growth) * np.linalg.norm(step) / 0.01
        self._P = F @ self._P @ F.T + np.diag(drift)
        self._history.append(_State(time, tip_D, now.belief + mobility * turned * rolled))

    def update_from_camera(self, time: float, pose: SeenPose) -> None:
        """Takes a camera frame of an earlier time; it corrects everything believed since."""
        past = [state for state in self._history if state.time >= time - 1e-9]
        if not past or past[0] is self._history[0]:
            return
        then = past[0]
        middle, slope = self._pushed.middle(*then.belief[:2])
        p_D = self._R_DW @ pose.p_WB[:2] - then.tip
        heading = float(yaw_of(pose.R_WB)) + self._pushed.facing - self._direction
        error = np.array([*(p_D - middle), wrap(heading - then.belief[0])])
        H = np.zeros((3, 4))
        H[:2, :2], H[2, 0] = slope, 1.0
        K = self._P @ H.T @ np.linalg.inv(H @ self._P @ H.T + self._R)
        self._P = (np.eye(4) - K @ H) @ self._P
        for state in past:
            state.belief = state.belief + K @ error
            state.belief[3] = np.clip(
                state.belief[3], self.tuning.least_mobility, self.tuning.most_mobility
            )

    def slope(self, remaining: float) -> float:
        """Slope u = dy/dx of the fingertip's path in D, for the remaining way [m]."""
        tuning = self.tuning
        pushed, (heading, contact, centre, mobility) = self._pushed, self._now.belief
        step = max(remaining, tuning.shortest_way) / tuning.steps
        turning = mobility * pushed.turning(step, step)
        # One step of (y, θ, s, g) and what the slope adds to it.
        change = np.array([pushed.depth, 1.0, pushed.rolling * pushed.tip_radius, 0.0])
        A = np.eye(4)
        A[:, 1:] += np.outer(change, turning[:3])
        B = turning[3] * change + np.array([step, 0.0, 0.0, 0.0])
        state = np.array([self._middle[1] - self._line, heading, contact, centre])
        # Columns: what comes of the state alone and of a slope in one step, so many steps later.
        ahead = [np.column_stack([A @ state, B])]
        for _ in range(tuning.steps - 1):
            ahead.append(A @ ahead[-1])
        free, by_slope = np.moveaxis(np.array(ahead)[:, :2], -1, 0)
        # Of the steps of the remaining way, how many a later one comes after an earlier one.
        since = np.subtract.outer(np.arange(tuning.steps), np.arange(tuning.steps))
        headings = self._way_weight * np.where(since < 0, 0.0, by_slope[since, 1])
        weights = np.array([tuning.lateral_weight, tuning.heading_weight])
        wanted = np.array([0.0, self._wanted])
        rows = np.vstack([headings, weights[:, None] * by_slope[::-1].T])
        missed = np.append(
            self._way_weight * (free[:, 1] - self._wanted), weights * (free[-1] - wanted)
        )
        squares = rows.T @ rows + tuning.input_weight**2 / tuning.steps * np.eye(tuning.steps)
        u = np.linalg.solve(squares, -rows.T @ missed)[0]
        normal = heading - pushed.curvature * contact
        return float(np.clip(u, normal - tuning.largest_slope, normal + tuning.largest_slope))


@dataclass(frozen=True)
class PushTuning:
    """Speeds and corrections of a push along a line."""

    follow_share: float = 0.3  # share of the commanded speed with which a moving object follows
    least_speed: float = 0.008  # speed at the end [m/s]
    across_rate: float = 4.0  # rate at which deviations across the vector are corrected [1/s]
    largest_correction: float = 0.010  # of them [m]
    largest_slope: float = 0.2  # of the fingertips' path then, inside the friction cone
    # Deviations of the friction radius by which a larger one is believed: too large a one is
    # corrected on the way.
    radius_sigmas: float = 0.5
    # Standard deviation of the centre of friction along the face, from friction that varies [m].
    centre_sd: float = 0.002


class _Line:
    """The line of fingertips led across a push along a unit direction in W, and back onto it."""

    def __init__(self, along: Array, tuning: PushTuning) -> None:
        self._along = along
        self._tuning = tuning
        self._across = np.zeros(3)
        self._correction = np.zeros(3)

    def correction(self, step: Array, come: Array, period: float) -> Array:
        """Correction of a command that advances by a step; T has come so far, shape (3,) [m]."""
        self._across = self._across + step - (step @ self._along) * self._along
        off = come - (come @ self._along) * self._along - self._across
        wanted = self._correction - self._tuning.across_rate * period * off
        self._correction = wanted * min(
            1.0, self._tuning.largest_correction / max(float(np.linalg.norm(wanted)), 1e-9)
        )
        return self._correction


class PushControl(ForceController):
    """One push, from before the face to its end.

    Law: the fingertips' command advances along the movement vector as in `ForceController`.
    Once the object moves, the speed rises to the plan's; near the end of the stroke it falls
    with what remains (`planner.types.plan`). The stroke is that of the object's middle. Two
    fingers keep the object's heading by themselves, so that the fingertips tell it; where they
    square the object up to themselves its middle swings aside, which the camera tells. One
    finger is steered by a `LateralController`, which knows it too.

    Ends, guards, limits and events stand in `sim.control.guards`.
    """

    tuning = PushTuning()

    def act(self) -> Ended:
        """Pushes until an end or a guard; returns which and why."""
        push = self.plan.push
        self._begin(f"pushing with at most {push.force_limit:.1f} N")
        self._line, self._led = _Line(self._u, self.tuning), self.commanded
        straight = push.ends_on == "stroke"
        self._steering = self._lateral() if push.fingers == 1 and straight else None
        self._squares_up = straight and push.turn != 0.0
        self._speed = self._first_speed = self._start()
        hand = hand_guard(push, self._state, self.stance, lambda: self.recorder.port.commanded[0])
        return self._advance_until((*self._guards(), hand))

    def _take_in(self) -> None:
        super()._take_in()
        if self._steering is not None:
            self._inform(self._steering)

    @property
    def _travel(self) -> float:
        if self._steering is not None:
            return self._steering.travelled_distance
        return self._led_way()[0] if self._squares_up else super()._travel

    @property
    def _slope(self) -> float:
        """Slope of the fingertips' path, to the left of the push."""
        if self._steering is not None:
            return self._steering.slope(self.plan.push.stroke - self._steering.travelled_distance)
        return self._led_way()[1] if self._squares_up else 0.0

    def _advance(self, sample: Sample) -> None:
        self._speed = self._next_speed(sample)
        slope, advance = self._slope, self._speed * self._room()
        sideways = np.array([*self._leftwards, 0.0])
        step = advance * self._period * (self._u + slope * sideways) / np.hypot(1.0, slope)
        self._led = self._led + step
        off = self._line.correction(step, self._here.midpoint - self._origin, self._period)
        self._step(self._led + off, self._u)

    def _next_speed(self, sample: Sample) -> float:
        """Largest speed now: slow until something moves, then up to the plan's, slow at the end."""
        push, tuning, before = self.plan.push, self.tuning, self._speed
        follows = sample.speed >= tuning.follow_share * before or before <= 2.0 * tuning.least_speed
        if sample.travel < MOVED or not follows:
            return self._first_speed
        if push.ends_on != "stroke":
            return self._faster(before, push.speed, USUAL.acceleration)
        profile = speed_profile(push.speed, push.stroke)
        near = max(tuning.least_speed, profile.braking * (push.stroke - sample.travel))
        return min(self._faster(before, push.speed, profile.acceleration), near)

    # -- steering ------------------------------------------------------------------------------

    @property
    def _leftwards(self) -> Array:
        """Unit vector to the left of the push in W, shape (2,)."""
        return np.array([-self._u[1], self._u[0]])

    def _led_way(self) -> tuple[float, float]:
        """Way of an object that two fingers square up [m], and their path's slope.

        Its middle swings aside while it does.
        """
        displacement = self._estimate.displacement
        come, aside = displacement @ self._u[:2], displacement @ self._leftwards
        remaining = max(self.plan.push.stroke - float(come), LateralController.tuning.shortest_way)
        return float(come), float(
            np.clip(-aside / remaining, -self.tuning.largest_slope, self.tuning.largest_slope)
        )

    def _lateral(self) -> LateralController:
        """Steering from what is believed at the touch."""
        push, pose, model = self.plan.push, self._target.pose, self._target.model
        inward = float(np.arctan2(-push.normal_W[1], -push.normal_W[0]))
        facing = inward - pose.yaw
        into = np.array([np.cos(facing), np.sin(facing)])
        face = max(model.faces([facing]), key=lambda face: -into @ face.normal[:2])
        left = np.array([-into[1], into[0]])
        return LateralController(
            Pushed(
                depth=float(-into @ push.p_BC[:2]),
                tip_radius=self._tip_radius,
                friction_radius=model.friction_radius
                + self.tuning.radius_sigmas * model.friction_radius_sd,
                facing=facing,
                curvature=face.curvature,
                centre=float(left @ model.com[:2]),
            ),
            float(np.arctan2(self._u[1], self._u[0])),
            self._here.midpoint[:2],
            (pose.x, pose.y, inward),
            turn=push.turn,
            limit=push.limits.turn or np.inf,
            deviations=(
                *self._look,
                float(np.hypot(self.tuning.centre_sd, np.abs(left) @ model.com_sd[:2])),
                model.friction_radius_sd,
            ),
            camera=self._camera,
        )


@dataclass(frozen=True)
class TiltTuning:
    """Rates of a tilt, and what shows that the object stands again."""

    # Share of the plan's speed that is commanded; the fingertip overtakes it in jerks.
    speed_share: float = 0.8
    rate: SafetyFigure = math.radians(6.0)  # of tilting and of letting back [rad/s]
    back_rate: SafetyFigure = math.radians(5.0)
    least_rate: float = math.radians(
        1.0
    )  # where it ends and where the base meets the table [rad/s]
    braking: float = 2.0  # rate per remaining tilt [1/s]
    acceleration: SafetyFigure = math.radians(12.0)  # [rad/s²]
    # Tilt of an object that stands, as far as is seen [rad].
    standing_tilt: float = math.radians(1.0)
    # Share of the largest force that a standing object no longer exceeds.
    standing_force_share: float = 0.15
    retreat_way: float = 0.02  # most way back behind the touch [m]
    arc_steps: int = 8  # places of the arc that the arm is asked for beforehand
    hold_time: float = 0.5  # time for which the tilt is held [s]


class TiltControl(ForceController):
    """One tilt, from before the face until the object stands again.

    After the touch the fingertips go along the arc on which the contact turns about that edge,
    a `TiltArc`, sticking to the face, no faster than the force limit allows (the law of
    `ForceController`), and slower as the asked tilt comes near, so that they stop on it. They
    hold still for a moment, then go back the same way and carry the object down until its base
    stands and presses on them no more. Where they cannot go on (it slides, it leans too far,
    the force does not suffice), they let it back at once.

    Frames: W is the world, T the midpoint of the pushing fingertips' centres.
    """

    tuning = TiltTuning()

    def __init__(self, errand: ExecutionContext) -> None:
        super().__init__(errand)
        self._length = length_along(self._target.model, self._target.pose.R_WB.T @ self._u)
        self._arc = TiltArc(self.way.touch, self._u, self._length, self._tip_radius)
        self._view = TiltEstimator(self._camera[1])
        self._angle = 0.0  # of the arc, as commanded
        self._most = 0.0  # the largest tilt
        self._most_force = 0.0

    def act(self) -> Ended:
        """Tilts, holds and lets back; returns how that ended and why."""
        push = self.plan.push
        self._arc = TiltArc(self._here.midpoint, self._u, self._length, self._tip_radius)
        self._angle = float(self._arc.tilt_angles(self.commanded[None])[0])
        for angle in np.linspace(0.0, push.tilt, self.tuning.arc_steps):
            self.stance.joint_angles(self._arc.tip_at(angle))
        self._begin(f"tilting it by {np.degrees(push.tilt):.1f}°")
        tuning = self.tuning
        self._fastest = min(tuning.rate, tuning.speed_share * push.speed / self._arc.arc_radius)
        self._standing = self._loading() / self._arc.arc_radius
        self._rate = min(self._fastest, self._standing)
        try:
            ended = self._advance_until((*planned_ends(push), *push_guards(push)))
            if ended.end == "returned":
                for _ in range(round(tuning.hold_time / self._period)):
                    self._lean(0.0)
        except EarlyEndError as stopped:
            ended = stopped.ended
            self.recorder.phase = "retreat"
        self.recorder.report("push", "letting it back")
        if not self._let_back() and ended.end == "returned":
            return Ended("guard", "it did not come back onto its base")
        if ended.end != "returned":
            return ended
        told = f"it was tilted by {np.degrees(self._most):.1f}° and stands on its base again"
        return Ended("returned", told)

    def _seen_as(self, sample: Sample) -> Sample:
        view = self._view
        return replace(sample, tilt=view.tilt, tip_tilt=view.own, tilt_sd=view.unsure)

    def _advance(self, sample: Sample) -> None:
        tuning = self.tuning
        self._rate = self._faster(self._rate, self._fastest, tuning.acceleration)
        if sample.travel < MOVED:
            self._rate = min(self._rate, self._standing)
        left = self.plan.push.tilt - sample.tilt
        allowed = min(self._rate, max(tuning.least_rate, tuning.braking * left))
        self._lean(allowed * self._room())

    def _let_back(self) -> bool:
        """Carries it down; whether it stands."""
        tuning = self.tuning
        behind = -tuning.retreat_way / self._arc.arc_radius
        while self._angle > behind and not self._stands():
            near = max(tuning.least_rate, tuning.braking * self._view.own)
            self._lean(
                -min(
                    tuning.back_rate,
                    tuning.speed_share * self.plan.push.speed / self._arc.arc_radius,
                    near,
                )
            )
        return self._stands()

    def _stands(self) -> bool:
        gone = self._felt < self.tuning.standing_force_share * self._most_force
        return bool(gone and self._view.tilt < self.tuning.standing_tilt)

    def _lean(self, rate: float) -> None:
        """Goes on along the arc at a rate [rad/s] for a control step."""
        self._angle += rate * self._period
        lean = self._view.own
        # Where the fingertip touches goes round on it as the face leans.
        self.recorder.inward = np.cos(lean) * self._u - [0.0, 0.0, np.sin(lean)]
        self._step(self._arc.tip_at(self._angle), self._u)
        now = self.recorder.port.time
        self._view.update_from_tip(now, float(self._arc.tilt_angles(self._here.midpoint[None])[0]))
        for frame in self.recorder.frames:
            up = frame.poses[self._object].R_WB[:, 2]
            self._view.update_from_camera(frame.time, float(np.arctan2(up @ self._u, up[2])))
        self._most = max(self._most, self._view.tilt)
        self._most_force = max(self._most_force, self._felt)


@dataclass(frozen=True)
class TurnTuning:
    """Speeds of a push that turns an object."""

    # Speed of the contact as a share of that of the fingertip, which is farther out.
    contact_share: float = 0.8
    least_rate: float = math.radians(1.5)  # turning rate at the end [rad/s]
    braking: float = 2.0
    palm_share: float = 0.1  # share of its error that the palm's heading loses in a control step
    face_end: SafetyFigure = 0.002  # distance from the end of a face at which the push stops [m]


class TurnControl(ForceController):
    """One push that turns an object, from before the face to its end.

    Law: as in `ForceController`, the contact advances while less than the force limit is felt;
    its direction is fixed relative to the face, which turns. The turn is estimated by a
    `TurnEstimator`; the speed falls with what remains of it, and the push ends when the
    estimate reaches it.
    """

    tuning = TurnTuning()

    def __init__(self, errand: ExecutionContext) -> None:
        super().__init__(errand)
        self._direction = self._u
        # In B: where the face is touched, and where along it, half its width, its curvature.
        outward = self._target.pose.R_WB.T @ -self.way.inward
        self._point = np.array([self.plan.push.p_BC])
        self._normal = _normal(self._target.model, outward)[None]
        (self._face,) = touched_faces(self._target.model, self._point[:, :2], self._normal[:, :2])

    def act(self) -> Ended:
        """Pushes until an end or a guard; returns which and why."""
        push = self.plan.push
        asked = f"turning it by {np.degrees(push.turn):.0f}° with at most {push.force_limit:.1f} N"
        self._begin(asked)
        self._keeper, self._led = self._turn_estimator(), self.commanded
        self._speed = self._first_speed = self._start()
        return self._advance_until(self._guards())

    def _guards(self) -> Iterator[Guard[Sample]]:
        yield from super()._guards()
        at, half, curvature = self._face
        if curvature == 0.0:
            # Along ẑ × inward, which is against the face's tangent.
            yield Guard(
                "guard",
                lambda s: abs(at - self._keeper.slip),
                half - self.tuning.face_end,
                lambda s: f"the fingertip slid {1e3 * abs(self._keeper.slip):.0f} mm, off the face",
            )

    def _take_in(self) -> None:
        super()._take_in()
        self._inform(self._keeper)

    @property
    def _travel(self) -> float:
        return self._keeper.travel

    def _seen_as(self, sample: Sample) -> Sample:
        return replace(sample, turn=self._keeper.turn_angle)

    def _advance(self, sample: Sample) -> None:
        bent = self._led - self._here.midpoint
        self._speed = self._next_speed()
        advance = self._speed * self._room() * self._period
        self._follow(self._keeper, advance)
        # The finger's spring, bent in the direction of the force, turns along.
        swung = rot_z(self._keeper.rate * advance) @ bent - bent
        self._led = self._led + advance * self._u + swung
        self._step(self._led, self._u)

    def _next_speed(self) -> float:
        """Largest speed of the contact now [m/s]: slow until it moves, and as the end is near."""
        keeper = self._keeper
        if abs(keeper.travel) < MOVED:
            return self._first_speed
        remaining = abs(self.plan.push.turn - keeper.turn_angle)
        at_end = float(
            max(self.tuning.least_rate, self.tuning.braking * remaining) / abs(keeper.rate)
        )
        most = min(at_end, self.tuning.contact_share * self.plan.push.speed)
        return self._faster(self._speed, most)

    def _follow(self, keeper: TurnEstimator, advance: float) -> None:
        """Turns palm and direction with the object."""
        self.turned += keeper.rate * advance
        self.turned += self.tuning.palm_share * (keeper.turn_angle - self.turned)
        R = rot_z(self.turned)
        self._u = R @ self._direction
        self.recorder.inward = R @ self.way.inward

    # -- what is known -------------------------------------------------------------------------

    def _turn_estimator(self) -> TurnEstimator:
        """The estimate of the turn, from what is believed at the touch."""
        pose, inward = self._target.pose, self.way.inward[:2]
        here, centre = self._here.midpoint[:2], self.way.touch[:2]
        along = np.array([-inward[1], inward[0]])
        body = TurnedObject(
            yaw=pose.yaw,
            inward=inward,
            middle=pose.p_WB[:2] - centre,
            direction=self._direction[:2],
            radius=self._tip_radius,
            rate=self._rate(),
        )
        return TurnEstimator(
            body,
            here,
            float((here - centre) @ along),
            deviations=self._look,
            camera=self._camera,
        )

    def _rate(self) -> float:
        """Turn per travel of the contact, as the object's model has it [rad/m]."""
        inward, u = self.way.inward, self._direction
        slant = float(np.arctan2(inward[0] * u[1] - inward[1] * u[0], inward @ u))
        turn = self.plan.push.turn
        predicted = turning_motion(self._target.model, self._point, self._normal, slant, turn)
        travel = float(predicted.travel[0])
        return turn / (travel if np.isfinite(travel) else self.plan.push.stroke)


def _normal(model: ObjectModel, outward: Array) -> Array:
    """Level normal of the face that looks most along a direction in B, shape (3,).

    A plan is made from an earlier look at the object: its direction is that of the face but for
    the noise of two looks.
    """
    faces = model.faces(np.array([np.arctan2(-outward[1], -outward[0])]))
    level = [np.array([*face.normal[:2], 0.0]) / np.hypot(*face.normal[:2]) for face in faces]
    return max(level, key=lambda normal: float(normal @ outward))

"""Guards: what ends a motion, by what is felt and seen.

Ends of a push before its stroke: the limits of the sentence, and the event it waits for.

Model: between late and noisy camera frames the pushed object goes with the fingertips; how it lies
to them and how it is turned are filtered. Other objects stand where they were seen at first. A
limit counts as reached while the estimate's doubt still keeps the object this side of it. A
constant error of the camera cannot be known and is not in the doubt; that two objects meet is felt,
or seen as the other one goes along. Seen gaps tell it only beyond what such an error explains.

Frames: W; footprints as in `planner.problem.footprints`.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable, Iterator

import numpy as np

from objectmodels.geometry.rotations import Array, rot_z, wrap, yaw_of
from objectmodels.safety_figure import SafetyFigure
from planner.problem.footprints import footprint, gap
from planner.types.actions import FALLING, Push, PushAction
from planner.types.plan import FORCE_BAND, Plan, StopCondition
from planner.types.world_state import SeenObject, WorldState
from sim.motion.collision_scene import CollisionScene
from sim.motion.inverse_kinematics import ArmConfiguration
from sim.robots.cell_description import Vision
from sim.traces.trace import EndReason
from sim.worlds.ports import Frame, SeenPose
from sim.worlds.sensors import noise_left

NEAREST: SafetyFigure = 0.003
"""Distance from another object at which a push ends: planned ones are larger [m]."""

_BYSTANDER_EVERY = 5  # control steps from one look to the next
_ENDS = ("stroke", "turned")  # of pushes in which the object stays on its face


class BystanderGuard:
    """Ends a push in which the object comes too near to what stands by.

    Model: on its planned way an object keeps clear of everything. One finger steers a long
    object, and a turn drifts, so that it may leave that way; then it stops short of what stands
    beside it, and the next push begins there. Others stand where they were seen, and what was
    close at first is left to the plan, which keeps as much of that gap as it can.

    Frames: W; footprints as in `planner.problem.footprints`.

    Args:
        push: what is to end; what it meets or stays clear of has limits of its own.
        state: where everything was seen.
        doubt: of a gap that is seen [m]; what stands closer than that at first is not watched.
    """

    def __init__(self, push: Push, state: WorldState, doubt: float) -> None:
        here = footprint(state.objects[push.object])
        watched = set(state.objects) - {push.object, push.meets}
        watched -= {name for name, _ in push.limits.clear_of}
        others = {name: footprint(state.objects[name]) for name in watched}
        apart = 2.0 * NEAREST + doubt
        self._others = {
            name: other
            for name, other in sorted(others.items())
            if push.ends_on in _ENDS and gap(here, other) > apart
        }
        self._discs = [_disc(other) for other in self._others.values()]
        self._steps = 0

    def end(self, corners: Array) -> tuple[EndReason, str] | None:
        """Why the push ends now; None if it goes on.

        Args:
            corners: what the object covers of the table now, in W, shape (k, 2) [m].
        """
        self._steps += 1
        if self._steps % _BYSTANDER_EVERY:
            return None
        middle, radius = _disc(corners)
        for (name, other), (centre, around) in zip(self._others.items(), self._discs, strict=True):
            if np.linalg.norm(centre - middle) - radius - around >= NEAREST:
                continue
            room = gap(corners, other)
            if room < NEAREST:
                return "too_close", f"it comes near the {name}, {1e3 * room:.0f} mm are left"
        return None


def _disc(corners: Array) -> tuple[Array, float]:
    """Centre, shape (2,), and radius of a disc around a polygon [m]."""
    middle = corners.mean(axis=0)
    return middle, float(np.linalg.norm(corners - middle, axis=1).max())


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


RAMP = 2.0
"""Time in which the force limit rises to the plan's [s]."""

MOVED = 0.001
"""Travel of the fingertips that shows that the object moves [m]."""

_SMALLEST_BAND = 0.1  # [N]
# A push that must not tilt stops at this share of the angle of no return.
_TILT_SHARE: SafetyFigure = 0.35
_SLIDES_AFTER: SafetyFigure = 0.03  # travel after which a topple must show some tilt [m]
_SLIDES_SHARE: SafetyFigure = 0.35  # of the tilt that turning about the far edge would show by then
_SAFE_SHARE: SafetyFigure = 0.9  # a tilt stops at this share of the angle of no return
_SURELY = 4.0  # standard deviations by which less must be seen than the fingers show
_STUCK_SPEED = 0.001  # [m/s]
_CREEPING, _CREPT = 8.0, 0.05  # time after which no more than a share of the way is no way [s]
_STUCK_TIME: SafetyFigure = 0.8  # [s]
_LOST_TIME: SafetyFigure = 0.6  # [s]
_LOST_SHARE = 0.1  # of the onset force: less is no contact


def band(push: Push) -> float:
    """Force below the limit over which the speed falls to zero [N]."""
    return max(FORCE_BAND * push.force_limit, _SMALLEST_BAND)


def fastest(push: Push) -> float:
    """Speed of the fingertips beyond which a push ends [m/s]."""
    return 2.0 * push.speed + 0.03


def longest(push: Push) -> float:
    """Time after which a push ends, whatever became of it [s]."""
    least = 10.0 + 3.0 * push.stroke / push.speed
    return min(least, push.limits.duration or np.inf) if push.ends_on == "tilted" else least


def largest_tilt(push: PushAction) -> float:
    """Tilt at which a push ends, wanted or not [rad]."""
    no_return = push.prediction.stay_on_base_angle
    if push.ends_on == "toppled":
        return no_return + FALLING
    if push.ends_on == "tilted":
        return min(_SAFE_SHARE * no_return, push.limits.tilt or np.inf)
    return _TILT_SHARE * no_return


def guard_conditions(push: PushAction) -> tuple[StopCondition, ...]:
    """Conditions of the guards of a push, as numbers."""
    toppled, tilt = push.ends_on == "toppled", largest_tilt(push)
    told = "falls by itself" if toppled else "leans more than it may"
    bound, lost = push.force_limit - band(push), _LOST_SHARE * push.prediction.onset
    conditions = [
        StopCondition(
            when="toppled" if toppled else "tilted",
            limit=tilt,
            unit="rad",
            text=f"the object is seen tilted by {np.degrees(tilt):.1f}° along the push: it {told}",
        ),
        StopCondition(
            when="force",
            limit=bound,
            unit="N",
            text=f"the force stays above {bound:.1f} N, and the fingertips below "
            f"{1e3 * _STUCK_SPEED:.0f} mm/s, for {_STUCK_TIME:g} s",
        ),
        StopCondition(
            when="speed",
            limit=fastest(push),
            unit="m/s",
            text=f"the fingertips are faster than {1e3 * fastest(push):.0f} mm/s",
        ),
        StopCondition(
            when="duration",
            limit=longest(push),
            unit="s",
            text=f"it takes longer than {longest(push):.0f} s",
        ),
    ]
    if toppled:
        conditions.append(
            StopCondition(
                when="slid",
                limit=_SLIDES_AFTER,
                unit="m",
                text=f"after {1e3 * _SLIDES_AFTER:.0f} mm it is tilted by less than "
                f"{_SLIDES_SHARE:.0%} of what turning about its far edge would show",
            )
        )
    if push.ends_on == "tilted":
        conditions.append(
            StopCondition(
                when="slid",
                text=f"it is seen tilted by less than {_SLIDES_SHARE:.0%} of what the fingertip's "
                "place on the face tells",
            )
        )
    if not toppled:
        conditions.append(
            StopCondition(
                when="lost",
                limit=lost,
                unit="N",
                text=f"less than {lost:.2f} N is felt for {_LOST_TIME:g} s, "
                "once the object has moved",
            )
        )
    return tuple(conditions)


class Guards:
    """Ends and guards of a push.

    Guards: a tilt that was not asked for, sliding where a tilt was asked for, a lost contact, a
    speed beyond the plan's, a push that lasts too long. They know what the robot sees and
    feels; of an object that is tilted, an estimate of how far it leans.

    Args:
        plan: what was to happen.
        period: of a control step [s].

    Attributes:
        speed: of the fingertips along the vector, filtered [m/s].
    """

    def __init__(self, plan: Plan, period: float) -> None:
        self._push = plan.push
        self._prediction = plan.push.prediction
        self._period = period
        self._before = 0.0
        self.speed = 0.0
        self._stuck = 0.0
        self._lost = 0.0
        self._longest = longest(plan.push)

    def end(
        self, elapsed: float, travel: float, felt: float, tilt: float
    ) -> tuple[EndReason, str] | None:
        """Why the push ends now; None if it goes on.

        Args:
            elapsed: since its start [s].
            travel: of the fingertips along the vector [m].
            felt: force along the vector, filtered [N].
            tilt: seen tilt along the vector, filtered [rad].
        """
        self._measure(travel)
        topple = self._push.ends_on == "toppled"
        return (
            (self._topple_end(travel, tilt) if topple else self._stroke(travel, tilt))
            or self._force(elapsed, travel, felt)
            or self._too_fast()
            or (None if topple else self._contact_lost(travel, felt))
            or self._too_long(elapsed)
        )

    def _measure(self, travel: float) -> None:
        self.speed += 0.2 * ((travel - self._before) / self._period - self.speed)
        self._before = travel

    def _stroke(self, travel: float, tilt: float) -> tuple[EndReason, str] | None:
        if travel >= self._push.stroke:
            return "stroke", f"the fingertips travelled {1e3 * travel:.0f} mm"
        if tilt > largest_tilt(self._push):
            return "tilted", f"the object was seen to tilt by {np.degrees(tilt):.0f}°"
        return None

    def _topple_end(self, travel: float, tilt: float) -> tuple[EndReason, str] | None:
        if tilt > largest_tilt(self._push):
            return "toppled", f"it was seen tilted by {np.degrees(tilt):.0f}° and falls by itself"
        if travel >= self._push.stroke:
            return "stroke", f"it does not fall after {1e3 * travel:.0f} mm"
        expected = np.arctan2(travel, self._push.p_BC[2])
        if travel > _SLIDES_AFTER and tilt < _SLIDES_SHARE * expected:
            return "slid", f"it slides instead of tilting, {1e3 * travel:.0f} mm so far"
        return None

    def _force(self, elapsed: float, travel: float, felt: float) -> tuple[EndReason, str] | None:
        all_of_it = elapsed > RAMP and felt > self._push.force_limit - band(self._push)
        still = all_of_it and abs(self.speed) < _STUCK_SPEED
        self._stuck = self._stuck + self._period if still else 0.0
        # It may also creep along in jerks, which gets it nowhere either.
        creeps = elapsed > _CREEPING and travel < _CREPT * min(
            self._push.stroke, self._push.speed * elapsed
        )
        if self._stuck > _STUCK_TIME or creeps:
            return "force", f"it does not move with {felt:.1f} N"
        return None

    def _too_fast(self) -> tuple[EndReason, str] | None:
        if self.speed > fastest(self._push):
            return "speed", f"the fingertips became {1e3 * self.speed:.0f} mm/s fast"
        return None

    def _contact_lost(self, travel: float, felt: float) -> tuple[EndReason, str] | None:
        lost = travel > MOVED and felt < _LOST_SHARE * self._prediction.onset
        self._lost = self._lost + self._period if lost else 0.0
        if self._lost > _LOST_TIME:
            return "guard", "the fingertips lost the object"
        return None

    def _too_long(self, elapsed: float) -> tuple[EndReason, str] | None:
        if elapsed > self._longest:
            return "guard", f"the push took longer than {self._longest:.0f} s"
        return None


class TiltGuards(Guards):
    """Guards of an object that is tilted and let back: any end of theirs lets it back at once.

    Args:
        plan: what was to happen.
        period: of a control step [s].
        view: of the tilt.
    """

    def __init__(self, plan: Plan, period: float, view: TiltEstimator) -> None:
        super().__init__(plan, period)
        self._view = view

    def _stroke(self, travel: float, tilt: float) -> tuple[EndReason, str] | None:
        view = self._view
        if tilt > largest_tilt(self._push):
            return "tilted", f"it leans by {np.degrees(tilt):.1f}°, more than it may"
        short = max((1.0 - _SLIDES_SHARE) * view.own, _SURELY * view.unsure)
        if -view.correction > short or travel > self._push.stroke:
            return "slid", f"it slides instead of tilting, {1e3 * travel:.0f} mm so far"
        return None


End = tuple[EndReason, str]

_SHARE = 0.12  # weight of a new frame in the filtered place: 0.25 of a frame's noise is left
_FASTER = 0.25  # the same for angles, which change faster: 0.4 is left
_LEFT, _LEFT_FASTER = noise_left(_SHARE), noise_left(_FASTER)
_SIGMAS: SafetyFigure = 2.0  # standard deviations of the estimate that are kept from a limit
_OF_SMALL: SafetyFigure = 0.3  # but at most this share of a limit that is an angle
_STOPPING: SafetyFigure = 0.001  # way until the object stands [m]

# Turn by which two fingers show that they do not hold the heading.
_HELD: SafetyFigure = math.radians(10.0)

_MET, _DEEPEST = 0.001, 0.007  # seen overlap at which two objects surely touch, and at most [m]
_NEAR = 0.015  # seen gap below which a rising force tells that they do [m]
_GONE = 4.0  # standard deviations that noise of tens of frames does not show in a standing object
_STEP, _STEP_SHARE = 0.15, 0.05  # rise of the force that does [N], and as a share of it
_SLIDING = 0.5  # time constant of the force while it slides freely [s]
_CLEARLY_MOVED = 3.0 * MOVED  # checks ask for 2 mm; the fingers give way by less than the rest [m]
_SURELY_MOVED = 5.0 * MOVED  # travel of the fingertips that no deflection explains [m]


class Follower:
    """Place of a pushed object now, by late frames and by the fingertips that it goes with.

    Args:
        seen: the object in the look before.
        tip: midpoint of the fingertips' centres in W when they touch, shape (3,) [m].

    Attributes:
        slipped: how far the object has come beyond the fingertips since, in W, shape (2,) [m].
        turned: how far it has turned since it was seen first [rad].
        tilt: of its axis B_z, along W's x and y, shape (2,) [rad].
    """

    def __init__(self, seen: SeenObject, tip: Array) -> None:
        self._seen = seen
        self._first = tip[:2]
        self._tips: deque[tuple[float, Array]] = deque()
        self.slipped = np.zeros(2)
        self.turned = 0.0
        self.tilt = np.zeros(2)

    def update_from_tip(self, time: float, tip: Array) -> None:
        """Takes the midpoint of the fingertips in W, shape (3,) [m], at a time [s]."""
        self._tips.append((time, tip[:2]))

    def update_from_camera(self, time: float, pose: SeenPose) -> None:
        """Takes what a frame showed at a time [s]; those from before the touch tell nothing.

        Frames come in the order of their times.
        """
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

    @property
    def travel(self) -> Array:
        """Way of the fingertips in W since the touch, shape (2,) [m]."""
        return np.asarray(self._tips[-1][1] - self._first)

    @property
    def displacement(self) -> Array:
        """Way of the object in W since it was seen first, shape (2,) [m]."""
        return self.travel + self.slipped

    @property
    def footprint(self) -> Array:
        """Corners of what it covers of the table in W, shape (k, 2) [m]."""
        middle = self._seen.pose.p_WB[:2]
        turned = (footprint(self._seen) - middle) @ rot_z(-self.turned)[:2, :2]
        return np.asarray(turned + middle + self.displacement)


class LimitGuards:
    """Ends a push at its limits and at its event.

    Args:
        push: what is to end.
        state: what was seen and believed before it.
        vision: noise and rate of the camera.
        tip: midpoint of the fingertips' centres in W at the touch, shape (3,) [m].
        period: of a control step [s].

    Attributes:
        follower: of the pushed object.
    """

    def __init__(
        self, push: Push, state: WorldState, vision: Vision, tip: Array, period: float
    ) -> None:
        self._push = push
        self._u = np.array(push.direction_W[:2])
        self.follower = Follower(state.objects[push.object], tip)
        self._share = min(1.0, period / _SLIDING)
        self._sliding = 0.0
        self._doubt = _SIGMAS * _LEFT * vision.position_noise_m
        self._angle_doubt = _SIGMAS * _LEFT_FASTER * float(np.radians(vision.angle_noise_deg))
        others = {name for name, _ in push.limits.clear_of} | (
            {push.meets} if push.meets else set()
        )
        # The errors of two objects differ by their diagonal.
        unknown = _SIGMAS * float(np.sqrt(2.0)) * vision.position_bias_m
        self._met = -min(_MET + unknown, _DEEPEST)
        self._shoved = 0.0
        # Where it stands is the mean of a look of a second and of the frames since.
        self._looks = max(1.0, vision.rate_hz)
        self._noise = vision.position_noise_m
        self._turn = _turn_limit(push, state.objects[push.object])
        self._others = {name: footprint(state.objects[name]) for name in others}
        self._stood = {name: state.objects[name].pose.p_WB[:2] for name in others}
        here = footprint(state.objects[push.object])
        first = {name: gap(here, other) for name, other in self._others.items()}
        self._bystanders = BystanderGuard(push, state, self._doubt)
        # What is too close from the start may be pushed away, but not closer.
        self._closest = {
            name: min(clearance + self._doubt + _STOPPING, first[name] - 2.0 * self._doubt)
            for name, clearance in push.limits.clear_of
        }

    def end(
        self, elapsed: float, time: float, tip: Array, felt: float, frames: Iterable[Frame]
    ) -> End | None:
        """Why the push ends now; None if it goes on.

        Args:
            elapsed: since its start [s].
            time: now [s].
            tip: midpoint of the fingertips' centres in W, shape (3,) [m].
            felt: force along the vector, filtered [N].
            frames: that arrived since the last call.
        """
        self.follower.update_from_tip(time, tip)
        for frame in frames:
            self.follower.update_from_camera(frame.time, frame.poses[self._push.object])
            self._watch_other(frame)
        return (
            self._event(felt)
            or self._too_close()
            or self._bystanders.end(self.follower.footprint)
            or self._turned_off()
            or self._tilt_end()
            or self._too_long(elapsed)
        )

    # -- limits --------------------------------------------------------------------------------

    def _too_close(self) -> End | None:
        for name, closest in self._closest.items():
            room = gap(self.follower.footprint, self._others[name])
            if room < closest:
                return "too_close", f"it is {1e3 * room:.0f} mm from the {name}"
        return None

    def _turned_off(self) -> End | None:
        limit, turned = self._turn, self.follower.turned
        if limit is not None and abs(turned) > self._below(limit):
            return "turned_off", f"the object was seen to turn by {np.degrees(turned):.0f}°"
        return None

    def _tilt_end(self) -> End | None:
        limit, tilt = self._push.limits.tilt, np.linalg.norm(self.follower.tilt)
        if limit is not None and tilt > self._below(limit):
            return "tilted", f"the object was seen to tilt by {np.degrees(tilt):.0f}°"
        return None

    def _too_long(self, elapsed: float) -> End | None:
        duration = self._push.limits.duration
        if duration is not None and elapsed >= duration:
            return "guard", f"the push may take {duration:.1f} s, and it took them"
        return None

    def _below(self, limit: float) -> float:
        """An angle that is surely below a limit [rad]."""
        return limit - min(self._angle_doubt, _OF_SMALL * limit)

    # -- events --------------------------------------------------------------------------------

    def _event(self, felt: float) -> End | None:
        match self._push.until:
            case "moves":
                return self._moves()
            case "touching":
                return self._meets(felt)
            case None:
                return None

    def _watch_other(self, frame: Frame) -> None:
        """Takes in how far what is to be met was seen to go along the push.

        As long as it is not near it stands, and is seen the better.
        """
        other = self._push.meets
        if other is None:
            return
        gone = frame.poses[other].p_WB[:2] - self._stood[other]
        if gap(self.follower.footprint, self._others[other]) >= _NEAR:
            self._looks += 1.0
            self._stood[other] = self._stood[other] + gone / self._looks
        self._shoved += _SHARE * (float(gone @ self._u) - self._shoved)

    def _moves(self) -> End | None:
        travel = self.follower.travel @ self._u
        come = travel + self.follower.slipped @ self._u
        clearly = come > _CLEARLY_MOVED + self._doubt or travel > _SURELY_MOVED
        if travel > _CLEARLY_MOVED and clearly:
            return "event", f"the object moves: {1e3 * travel:.0f} mm so far"
        return None

    def _meets(self, felt: float) -> End | None:
        other = self._push.meets
        assert other is not None, "the event is to touch something"
        room = gap(self.follower.footprint, self._others[other])
        if room < self._met:
            return "event", f"the object was seen to meet the {other}"
        doubt = _GONE * self._noise * float(np.hypot(_LEFT, 1.0 / np.sqrt(self._looks)))
        if room < _NEAR and self._shoved > MOVED + doubt:
            return "event", f"the {other} was seen to go along"
        slides = self.follower.travel @ self._u > MOVED
        self._sliding += (self._share if slides else 1.0) * (felt - self._sliding)
        if room < _NEAR and felt > (1.0 + _STEP_SHARE) * self._sliding + _STEP:
            return "event", f"the object was felt to meet the {other}, {1e3 * room:.0f} mm seen"
        return None


def _turn_limit(push: Push, seen: SeenObject) -> float | None:
    """Turn at which a push ends [rad]; None if any will do.

    Where two fingers give way more to the one side than to the other, what they push turns ever
    faster: it is pushed otherwise before it is far off. What is to be quick has no second push.
    """
    limit = push.limits.turn
    round_ = seen.model.base.is_round
    if push.fingers == 1 or push.ends_on != "stroke" or round_ or push.limits.duration is not None:
        return limit
    return _HELD if limit is None else min(limit, _HELD)


def limit_conditions(push: Push, seen: SeenObject) -> Iterator[StopCondition]:
    """Conditions of a sentence's limits and of its event, as numbers without a camera's doubt."""
    turn, tilt, duration = _turn_limit(push, seen), push.limits.tilt, push.limits.duration
    if push.until == "moves":
        yield StopCondition(
            when="event", limit=_CLEARLY_MOVED, unit="m", text="the object has begun to move"
        )
    if push.until == "touching":
        yield StopCondition(
            when="event", other=push.meets, text=f"the object has met the {push.meets}"
        )
    if turn is not None:
        told = f"the object has turned by {np.degrees(turn):.0f}° from where it stood"
        yield StopCondition(when="turned_off", limit=turn, unit="rad", text=told)
    if tilt is not None:
        told = f"the object leans by {np.degrees(tilt):.1f}° to any side"
        yield StopCondition(when="tilted", limit=tilt, unit="rad", text=told)
    if duration is not None:
        told = f"{duration:.1f} s have passed since the touch"
        yield StopCondition(when="duration", limit=duration, unit="s", text=told)
    for name, clear in push.limits.clear_of:
        told = f"the object is closer than {1e3 * clear:.0f} mm to the {name}"
        yield StopCondition(when="too_close", limit=clear, unit="m", other=name, text=told)


ASIDE: SafetyFigure = 0.004
"""Distance from the planned way within which nothing else is near [m]."""

_HAND_EVERY = 3  # control steps from one look to the next


class HandGuard:
    """Ends a push in which the hand comes too near to what it does not push.

    Model: on its way the hand keeps clear of everything, as was planned. Once it is aside of
    that way, hand and arm are spheres again, and other objects stand where they were seen.

    Frames: W is the world.

    Args:
        stance: of arm and hand.
        state: where everything was seen.
        pushed: name of what is pushed.
    """

    def __init__(self, stance: ArmConfiguration, state: WorldState, pushed: str) -> None:
        self._stance = stance
        self._scene = CollisionScene.from_state(state, pushed, clearance=NEAREST)
        self._steps = 0

    def end(self, q_arm: Array, aside: float) -> tuple[EndReason, str] | None:
        """Why the push ends now; None if it goes on.

        Args:
            q_arm: commanded angles of the arm, shape (7,) [rad].
            aside: distance of the fingertips from the planned way [m].
        """
        self._steps += 1
        if abs(aside) < ASIDE or self._steps % _HAND_EVERY:
            return None
        spheres = self._stance.robot_spheres(q_arm[None])[0]
        for other in self._scene.others_near(spheres):
            if not other.is_clear(spheres, NEAREST):
                return "too_close", f"the hand, steering it, comes near the {other.name}"
        return None

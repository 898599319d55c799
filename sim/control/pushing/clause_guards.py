"""Ends of a push before its stroke: the limits of the sentence, and the event it waits for.

Model: between late and noisy camera frames the pushed object goes with the fingertips; how it lies
to them and how it is turned are filtered. Other objects stand where they were seen at first. A
limit counts as reached while the estimate's doubt still keeps the object this side of it. A
constant error of the camera cannot be known and is not in the doubt; that two objects meet is felt,
or seen as the other one goes along. Seen gaps tell it only beyond what such an error explains.

Frames: W; footprints as in `planner.problem.footprints`.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator

import numpy as np

from objectmodels.geometry.base_shapes import Disc
from planner.problem.footprints import footprint, gap
from planner.types.actions import Push
from planner.types.plan import StopCondition
from planner.types.world_state import SeenObject, WorldState
from sim.cell.cell_description import Vision
from sim.control.camera_noise import noise_left
from sim.control.pushing.bystander_guard import BystanderGuard
from sim.control.pushing.push_guards import MOVED
from sim.rotations import Array, rot_z, wrap, yaw_of
from sim.traces.trace import EndReason
from sim.worlds.ports import Frame, SeenPose

End = tuple[EndReason, str]

_SHARE = 0.12  # weight of a new frame in the filtered place: 0.25 of a frame's noise is left
_FASTER = 0.25  # the same for angles, which change faster: 0.4 is left
_LEFT, _LEFT_FASTER = noise_left(_SHARE), noise_left(_FASTER)
_SIGMAS = 2.0  # standard deviations of the estimate that are kept from a limit
_OF_SMALL = 0.3  # but at most this share of a limit that is an angle
_STOPPING = 0.001  # way until the object stands [m]

_HELD = float(np.radians(10.0))  # turn by which two fingers show that they do not hold the heading

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
    round_ = isinstance(seen.model.base, Disc)
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

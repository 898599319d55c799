"""Guards: what ends a motion, by what is felt and seen.

A `Guard` is a measure and its limit, with the words for both. The same guards are watched by a
controller, step by step (`Watch`), and told to the controllers of other arms (`stop_conditions`),
so that each limit stands once. Those of pushes stand here, those of a hand that holds something in
`sim.control.held_object_sensing`, those of a lid that is flipped in `sim.control.grasp_control`.

Model: a limit of the sentence counts as reached while the estimate's doubt still keeps the object
this side of it. A constant error of the camera cannot be known and is not in the doubt; that two
objects meet is felt, or seen as the other one goes along. Seen gaps tell it only beyond what such
an error explains. Other objects stand where they were seen at first.

Frames: W; footprints as in `planner.problem.footprints`.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Iterator
from dataclasses import KW_ONLY, dataclass, replace
from typing import Any, Generic, TypeVar

import numpy as np

from objectmodels.geometry.rotations import Array
from objectmodels.safety_figure import SafetyFigure
from planner.problem.footprints import footprint, gap
from planner.types.actions import FALLING, Push, PushAction
from planner.types.end_reasons import Ended, EndReason
from planner.types.plan import FORCE_BAND, StopCondition, StopUnit
from planner.types.world_state import SeenObject, WorldState
from sim.control.object_estimate import LEFT, LEFT_OF_ANGLES, MOVED, NEAR, ObjectEstimate
from sim.motion.collision_scene import CollisionScene
from sim.motion.inverse_kinematics import ArmConfiguration
from sim.robots.cell_description import Vision

S_contra = TypeVar("S_contra", contravariant=True)


@dataclass(frozen=True)
class Guard(Generic[S_contra]):
    """One limit of a motion: what is measured, at which number it ends, and why in words.

    Attributes:
        end: the reason why it ends.
        measure: the number that is held against the limit, from what is felt and seen now.
        limit: of it, in its unit.
        says: why it ended, from what was felt and seen then.
        beyond: whether a measure is beyond a limit.
        trips_at: what the measure is held against, where that is not the limit itself: an
            estimate's doubt is kept off it, or the measure is a share of it.
        applies: whether it is in force now; always, if that is not given.
        lasts: time for which the measure must be beyond without a break [s].
        every: control steps from one look to the next, of a measure that takes long.
        text: the condition in words, for another arm's controller; "" if it is not told.
        unit: of the limit; None if the limit is no number that is told.
        other: name of the object that it is about, if it is another one.
    """

    end: EndReason
    measure: Callable[[S_contra], float]
    limit: float
    says: Callable[[S_contra], str]
    _: KW_ONLY
    beyond: Callable[[float, float], bool] = operator.gt
    trips_at: float | None = None
    applies: Callable[[S_contra], bool] | None = None
    lasts: float = 0.0
    every: int = 1
    text: str = ""
    unit: StopUnit | None = None
    other: str | None = None

    def is_tripped(self, sample: S_contra) -> bool:
        """Whether the measure is beyond the limit now, for however long."""
        if self.applies is not None and not self.applies(sample):
            return False
        limit = self.limit if self.trips_at is None else self.trips_at
        return bool(self.beyond(self.measure(sample), limit))

    def end_of(self, sample: S_contra) -> Ended:
        """The end that it makes of a motion."""
        return Ended(self.end, self.says(sample))


class Watch(Generic[S_contra]):
    """Guards of one motion, and for how long each has been beyond its limit.

    Args:
        guards: in the order in which they are asked.
        period: of a control step [s].
    """

    def __init__(self, guards: Iterable[Guard[S_contra]], period: float) -> None:
        self._guards = tuple(guards)
        self._beyond = [0.0] * len(self._guards)
        self._period = period
        self._steps = 0

    def first_tripped(self, sample: S_contra) -> Ended | None:
        """The end that the first guard makes now; None if it goes on.

        It is asked once in each control step.
        """
        self._steps += 1
        for k, guard in enumerate(self._guards):
            if self._steps % guard.every:
                continue
            tripped = guard.is_tripped(sample)
            self._beyond[k] = self._beyond[k] + self._period if tripped else 0.0
            if self._beyond[k] > guard.lasts:
                return guard.end_of(sample)
        return None


def stop_conditions(guards: Iterable[Guard[Any]]) -> tuple[StopCondition, ...]:
    """Guards as another arm's controller is told of them, without a camera's doubt."""
    return tuple(
        StopCondition(
            when=guard.end,
            limit=None if guard.unit is None else guard.limit,
            unit=guard.unit,
            other=guard.other,
            text=guard.text,
        )
        for guard in guards
        if guard.text
    )


@dataclass(frozen=True)
class Sample:
    """What is felt and seen of a pushed object at one time.

    Attributes:
        elapsed: time since it is pushed [s].
        travel: along the vector, as the stroke counts it [m].
        speed: of that, filtered [m/s].
        felt: force that the fingertips exert, filtered [N].
        tilt: along the vector [rad].
        estimate: of the object by the fingertips that it goes with.
        turn: about the vertical, of what is turned; nan of anything else [rad].
        tip_tilt, tilt_sd: tilt by the fingertip alone, and what of it the camera may take off or
            add by its noise, of what is tilted; nan of anything else [rad].
    """

    elapsed: float
    travel: float
    speed: float
    felt: float
    tilt: float
    estimate: ObjectEstimate
    turn: float = math.nan
    tip_tilt: float = math.nan
    tilt_sd: float = math.nan


RAMP = 2.0
"""Time in which the force limit rises to the plan's [s]."""

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

SLIPS: SafetyFigure = 0.008
"""Way by which an object stays behind a fingertip that slips over it [m]."""

LET_OFF: SafetyFigure = 0.1
"""Share of the pressing force below which the fingertip has left the face."""

_LET_OFF_TIME: SafetyFigure = 0.3  # [s]


def band(push: Push) -> float:
    """Force below the limit over which the speed falls to zero [N]."""
    return max(FORCE_BAND * push.force_limit, _SMALLEST_BAND)


def largest_tilt(push: PushAction) -> float:
    """Tilt at which a push ends, wanted or not [rad]."""
    no_return = push.prediction.stay_on_base_angle
    if push.ends_on == "toppled":
        return no_return + FALLING
    if push.ends_on == "tilted":
        return min(_SAFE_SHARE * no_return, push.limits.tilt or np.inf)
    return _TILT_SHARE * no_return


def planned_ends(push: Push) -> Iterator[Guard[Sample]]:
    """Ends of a push as planned, and its stroke in any case."""
    if push.ends_on == "turned":
        yield Guard(
            "turned",
            lambda s: s.turn,
            push.turn,
            lambda s: f"it was seen to turn by {np.degrees(s.turn):.1f}°",
            beyond=operator.ge if push.turn >= 0.0 else operator.le,
            text=f"the object is seen turned by {np.degrees(push.turn):.1f}°",
            unit="rad",
        )
    if push.ends_on == "tilted":
        yield Guard(
            "returned",
            lambda s: s.tilt,
            push.tilt,
            lambda s: f"it was tilted by {np.degrees(s.tilt):.1f}°",
            beyond=operator.ge,
            text=f"it was tilted by {np.degrees(push.tilt):.1f}°, held and let back onto its base",
            unit="rad",
        )
    told = "it was drawn along by {:.0f} mm" if push.press else "the fingertips travelled {:.0f} mm"
    told = _WRONG_STROKES.get(push.ends_on, told)
    yield Guard(
        "slid" if push.ends_on == "tilted" else "stroke",
        lambda s: s.travel,
        push.stroke,
        lambda s: told.format(1e3 * s.travel),
        beyond=operator.ge,
        text=f"the fingertips have travelled {1e3 * push.stroke:.0f} mm since the touch",
        unit="m",
    )


_SLIDES = "it slides instead of tilting, {:.0f} mm so far"
_WRONG_STROKES = {"toppled": "it does not fall after {:.0f} mm", "tilted": _SLIDES}


def push_guards(push: PushAction) -> Iterator[Guard[Sample]]:
    """Guards of a push: a tilt or a slide that was not asked for, no way, no contact, no end."""
    if push.press:
        yield from _drag_guards(push)
    elif push.ends_on == "toppled":
        falls = "it was seen tilted by {:.0f}° and falls by itself"
        yield _tilt_guard(push, "toppled", falls, "along the push: it falls by itself")
        yield from _way_guards(push)
        yield Guard(
            "slid",
            lambda s: s.travel,
            _SLIDES_AFTER,
            lambda s: _SLIDES.format(1e3 * s.travel),
            applies=lambda s: s.tilt < _SLIDES_SHARE * np.arctan2(s.travel, push.p_BC[2]),
            text=f"after {1e3 * _SLIDES_AFTER:.0f} mm it is tilted by less than "
            f"{_SLIDES_SHARE:.0%} of what turning about its far edge would show",
            unit="m",
        )
    else:
        tilts = push.ends_on == "tilted"
        leans = "it leans by {:.1f}°, more than it may" if tilts else _SEEN_TO_TILT
        yield _tilt_guard(push, "tilted", leans, "along the push: it leans more than it may")
        yield from _way_guards(push)
        if tilts:
            yield _unseen_tilt_guard()
        lost = _LOST_SHARE * push.prediction.onset
        yield Guard(
            "lost",
            lambda s: s.felt,
            lost,
            lambda s: "the fingertips lost the object",
            beyond=operator.lt,
            applies=lambda s: s.travel > MOVED,
            lasts=_LOST_TIME,
            text=f"less than {lost:.2f} N is felt for {_LOST_TIME:g} s, once the object has moved",
            unit="N",
        )


_SEEN_TO_TILT = "the object was seen to tilt by {:.0f}°"


def _tilt_guard(push: PushAction, end: EndReason, says: str, told: str) -> Guard[Sample]:
    tilt = largest_tilt(push)
    return Guard(
        end,
        lambda s: s.tilt,
        tilt,
        lambda s: says.format(np.degrees(s.tilt)),
        text=f"the object is seen tilted by {np.degrees(tilt):.1f}° {told}",
        unit="rad",
    )


def _unseen_tilt_guard() -> Guard[Sample]:
    """The camera surely shows much less of a tilt than the fingertip's place on the face."""

    def missing(s: Sample) -> float:
        short = max((1.0 - _SLIDES_SHARE) * s.tip_tilt, _SURELY * s.tilt_sd)
        return s.tip_tilt - s.tilt - short

    return Guard(
        "slid",
        missing,
        0.0,
        lambda s: _SLIDES.format(1e3 * s.travel),
        text=f"it is seen tilted by less than {_SLIDES_SHARE:.0%} of what the fingertip's "
        "place on the face tells",
    )


def _way_guards(push: Push) -> Iterator[Guard[Sample]]:
    """Guards of the way that a push makes: none with the whole force, too fast, too long."""
    bound = push.force_limit - band(push)

    def says(s: Sample) -> str:
        return f"it does not move with {s.felt:.1f} N"

    yield Guard(
        "force",
        lambda s: s.felt,
        bound,
        says,
        applies=lambda s: s.elapsed > RAMP and abs(s.speed) < _STUCK_SPEED,
        lasts=_STUCK_TIME,
        text=f"the force stays above {bound:.1f} N, and the fingertips below "
        f"{1e3 * _STUCK_SPEED:.0f} mm/s, for {_STUCK_TIME:g} s",
        unit="N",
    )
    # It may also creep along in jerks, which gets it nowhere either.
    yield Guard(
        "force",
        lambda s: s.travel / min(push.stroke, push.speed * s.elapsed),
        _CREPT,
        says,
        beyond=operator.lt,
        applies=lambda s: s.elapsed > _CREEPING,
    )
    fastest = 2.0 * push.speed + 0.03
    yield Guard(
        "speed",
        lambda s: s.speed,
        fastest,
        lambda s: f"the fingertips became {1e3 * s.speed:.0f} mm/s fast",
        text=f"the fingertips are faster than {1e3 * fastest:.0f} mm/s",
        unit="m/s",
    )
    yield _time_guard(push, "push")


def _time_guard(push: Push, motion: str) -> Guard[Sample]:
    most = 10.0 + 3.0 * push.stroke / push.speed
    if push.ends_on == "tilted":
        most = min(most, push.limits.duration or np.inf)
    return Guard(
        "duration",
        lambda s: s.elapsed,
        most,
        lambda s: f"the {motion} took longer than {most:.0f} s",
        text=f"it takes longer than {most:.0f} s",
        unit="s",
    )


def _drag_guards(push: PushAction) -> Iterator[Guard[Sample]]:
    """Guards of a fingertip that presses on an object from above and draws it along."""
    u, least = np.array(push.direction_W[:2]), LET_OFF * push.press

    def behind(s: Sample) -> float:
        return -float(s.estimate.slipped @ u)

    yield Guard(
        "slipped",
        behind,
        SLIPS,
        lambda s: (
            f"the fingertip slips over it: it went {1e3 * (s.travel + behind(s)):.0f} mm, and the "
            f"{push.object} stayed behind"
        ),
        text=f"the object stays behind by more than {1e3 * SLIPS:.0f} mm: the fingertip slips "
        "over it",
        unit="m",
    )
    yield _tilt_guard(push, "tilted", _SEEN_TO_TILT, "along the way")
    yield Guard(
        "lost",
        lambda s: s.felt,
        least,
        lambda s: "the fingertip lost the object",
        beyond=operator.lt,
        lasts=_LET_OFF_TIME,
        text=f"it presses with less than {least:.1f} N for {_LET_OFF_TIME:g} s",
        unit="N",
    )
    yield _time_guard(push, "drag")


_SIGMAS: SafetyFigure = 2.0  # standard deviations of the estimate that are kept from a limit
_OF_SMALL: SafetyFigure = 0.3  # but at most this share of a limit that is an angle
_STOPPING: SafetyFigure = 0.001  # way until the object stands [m]

# Turn by which two fingers show that they do not hold the heading.
_HELD: SafetyFigure = math.radians(10.0)

_MET, _DEEPEST = 0.001, 0.007  # seen overlap at which two objects surely touch, and at most [m]
_GONE = 4.0  # standard deviations that noise of tens of frames does not show in a standing object
_STEP, _STEP_SHARE = 0.15, 0.05  # rise of the force that does [N], and as a share of it
_CLEARLY_MOVED = 3.0 * MOVED  # checks ask for 2 mm; the fingers give way by less than the rest [m]
_SURELY_MOVED = 5.0 * MOVED  # travel of the fingertips that no deflection explains [m]


def sentence_guards(push: Push, state: WorldState, vision: Vision) -> Iterator[Guard[Sample]]:
    """The event that a sentence waits for, and its limits.

    Args:
        push: what is to end.
        state: what was seen and believed before it.
        vision: noise of the camera, whose doubt is kept off each limit.
    """
    seen, limits = state.objects[push.object], push.limits
    doubt = _SIGMAS * LEFT * vision.position_noise_m
    angle_doubt = _SIGMAS * LEFT_OF_ANGLES * float(np.radians(vision.angle_noise_deg))

    def surely_below(angle: float) -> float:
        return angle - min(angle_doubt, _OF_SMALL * angle)

    if push.until == "moves":
        yield _motion_guard(push, doubt)
    if push.until == "touching":
        yield from _meeting_guards(push, vision)
    turn = _turn_limit(push, seen)
    if turn is not None:
        yield Guard(
            "turned_off",
            lambda s: abs(s.estimate.turned),
            turn,
            lambda s: f"the object was seen to turn by {np.degrees(s.estimate.turned):.0f}°",
            trips_at=surely_below(turn),
            text=f"the object has turned by {np.degrees(turn):.0f}° from where it stood",
            unit="rad",
        )
    if limits.tilt is not None:
        yield Guard(
            "tilted",
            lambda s: s.estimate.lean,
            limits.tilt,
            lambda s: _SEEN_TO_TILT.format(np.degrees(s.estimate.lean)),
            trips_at=surely_below(limits.tilt),
            text=f"the object leans by {np.degrees(limits.tilt):.1f}° to any side",
            unit="rad",
        )
    duration = limits.duration
    if duration is not None:
        yield Guard(
            "duration",
            lambda s: s.elapsed,
            duration,
            lambda s: f"the push may take {duration:.1f} s, and it took them",
            beyond=operator.ge,
            text=f"{duration:.1f} s have passed since the touch",
            unit="s",
        )
    for name, clear in limits.clear_of:
        yield _clearance_guard(seen, state.objects[name], clear, doubt)


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


def _clearance_guard(
    seen: SeenObject, other: SeenObject, clear: float, doubt: float
) -> Guard[Sample]:
    """What is too close from the start may be pushed away, but not closer."""
    first = gap(footprint(seen), footprint(other))
    return replace(
        _gap_guard(other, clear, "it is {:.0f} mm from the {}"),
        trips_at=min(clear + doubt + _STOPPING, first - 2.0 * doubt),
        text=f"the object is closer than {1e3 * clear:.0f} mm to the {other.name}",
        unit="m",
        other=other.name,
    )


def _gap_guard(other: SeenObject, least: float, says: str) -> Guard[Sample]:
    """Another object stays so far off [m]; the words take the gap [mm] and its name."""
    stands = footprint(other)

    def distance(s: Sample) -> float:
        return gap(s.estimate.footprint, stands)

    return Guard(
        "too_close",
        distance,
        least,
        lambda s: says.format(1e3 * distance(s), other.name),
        beyond=operator.lt,
    )


def _motion_guard(push: Push, doubt: float) -> Guard[Sample]:
    """The object moves: the fingertips do, and the camera shows it or no deflection explains it."""
    u = np.array(push.direction_W[:2])

    def travel(s: Sample) -> float:
        return float(s.estimate.travel @ u)

    def clearly(s: Sample) -> bool:
        come = travel(s) + s.estimate.slipped @ u
        return bool(come > _CLEARLY_MOVED + doubt or travel(s) > _SURELY_MOVED)

    return Guard(
        "event",
        travel,
        _CLEARLY_MOVED,
        lambda s: f"the object moves: {1e3 * travel(s):.0f} mm so far",
        applies=clearly,
        text="the object has begun to move",
        unit="m",
    )


def _meeting_guards(push: Push, vision: Vision) -> Iterator[Guard[Sample]]:
    """The object meets another: seen to overlap, seen to go along, or felt."""
    other = push.meets
    assert other is not None, "the event is to touch something"
    # The errors of two objects differ by their diagonal.
    unknown = _SIGMAS * float(np.sqrt(2.0)) * vision.position_bias_m

    def is_near(s: Sample) -> bool:
        return s.estimate.gap_to_met < NEAR

    def beyond_noise(s: Sample) -> float:
        looks = s.estimate.looks
        return s.estimate.shoved - _GONE * vision.position_noise_m * float(
            np.hypot(LEFT, 1.0 / np.sqrt(looks))
        )

    yield Guard(
        "event",
        lambda s: s.estimate.gap_to_met,
        -min(_MET + unknown, _DEEPEST),
        lambda s: f"the object was seen to meet the {other}",
        beyond=operator.lt,
        text=f"the object has met the {other}",
        other=other,
    )
    yield Guard(
        "event",
        beyond_noise,
        MOVED,
        lambda s: f"the {other} was seen to go along",
        applies=is_near,
    )
    yield Guard(
        "event",
        lambda s: s.estimate.force - (1.0 + _STEP_SHARE) * s.estimate.sliding_force,
        _STEP,
        lambda s: (
            f"the object was felt to meet the {other}, {1e3 * s.estimate.gap_to_met:.0f} mm seen"
        ),
        applies=is_near,
    )


NEAREST: SafetyFigure = 0.003
"""Distance from another object at which a push ends: planned ones are larger [m]."""

ASIDE: SafetyFigure = 0.004
"""Distance from the planned way within which nothing else is near [m]."""

_BYSTANDER_EVERY, _HAND_EVERY = 5, 3  # control steps from one look to the next
_ENDS = ("stroke", "turned")  # of pushes in which the object stays on its face


def bystander_guards(push: Push, state: WorldState, vision: Vision) -> Iterator[Guard[Sample]]:
    """End a push in which the object comes too near to what stands by.

    Model: on its planned way an object keeps clear of everything. One finger steers a long
    object, and a turn drifts, so that it may leave that way; then it stops short of what stands
    beside it, and the next push begins there. Others stand where they were seen, and what was
    close at first is left to the plan, which keeps as much of that gap as it can.

    Args:
        push: what is to end; what it meets or stays clear of has limits of its own.
        state: where everything was seen.
        vision: noise of the camera; what stands closer than its doubt at first is not watched.
    """
    if push.ends_on not in _ENDS:
        return
    here = footprint(state.objects[push.object])
    watched = set(state.objects) - {push.object, push.meets}
    watched -= {name for name, _ in push.limits.clear_of}
    doubt = _SIGMAS * LEFT * vision.position_noise_m
    for name in sorted(watched):
        if gap(here, footprint(state.objects[name])) > 2.0 * NEAREST + doubt:
            comes_near = "it comes near the {1}, {0:.0f} mm are left"
            guard = _gap_guard(state.objects[name], NEAREST, comes_near)
            yield replace(guard, every=_BYSTANDER_EVERY)


def hand_guard(
    push: Push, state: WorldState, stance: ArmConfiguration, q_arm: Callable[[], Array]
) -> Guard[Sample]:
    """Ends a push in which the hand comes too near to what it does not push.

    Model: on its way the hand keeps clear of everything, as was planned. Once it is aside of
    that way, hand and arm are spheres again, and other objects stand where they were seen.

    Args:
        push: what is to end.
        state: where everything was seen.
        stance: of arm and hand.
        q_arm: tells the commanded angles of the arm, shape (7,) [rad].
    """
    scene = CollisionScene.from_state(state, push.object, clearance=NEAREST)
    left = np.array([-push.direction_W[1], push.direction_W[0]])

    def nearest() -> tuple[float, str]:
        spheres = stance.robot_spheres(q_arm()[None])[0]
        near = ((float(o.distance_to(spheres).min()), o.name) for o in scene.others_near(spheres))
        return min(near, default=(math.inf, ""))

    return Guard(
        "too_close",
        lambda s: nearest()[0],
        NEAREST,
        lambda s: f"the hand, steering it, comes near the {nearest()[1]}",
        beyond=operator.le,
        applies=lambda s: abs(float(s.estimate.travel @ left)) >= ASIDE,
        every=_HAND_EVERY,
    )

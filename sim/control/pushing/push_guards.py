"""When a push ends: its stroke, its force, its speed, or a guard.

Guards: a tilt that was not asked for, sliding where a tilt was asked for, a lost contact, a speed
beyond the plan's, a push that lasts too long. They know what the robot sees and feels; of an object
that is tilted, an estimate of how far it leans.
"""

from __future__ import annotations

from collections import deque

import numpy as np

from planner.types.actions import FALLING, Push, PushAction
from planner.types.plan import FORCE_BAND, Plan, StopCondition
from sim.traces.trace import EndReason

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
_TILT_SHARE = 0.35  # a push that must not tilt stops at this share of the angle of no return
_SLIDES_AFTER = 0.03  # travel after which a topple must show some tilt [m]
_SLIDES_SHARE = 0.35  # of the tilt that turning about the far edge would show by then
_SAFE_SHARE = 0.9  # a tilt stops at this share of the angle of no return
_SURELY = 4.0  # standard deviations by which less must be seen than the fingers show
_STUCK_SPEED = 0.001  # [m/s]
_CREEPING, _CREPT = 8.0, 0.05  # time after which no more than a share of the way is no way [s]
_STUCK_TIME = 0.8  # [s]
_LOST_TIME = 0.6  # [s]
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

"""What ends a push before its stroke: limits and events, from what is seen and felt."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from objectmodels import Registry
from objectmodels.geometry.rotations import Array, rot_y, rot_z
from planner.problem.footprints import footprint
from planner.types.actions import Limits, Push
from planner.types.end_reasons import Ended
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim.control.guards import Sample, Watch, bystander_guards, sentence_guards
from sim.control.object_estimate import ObjectEstimate
from sim.robots.cell_description import Vision
from sim.worlds.ports import Frame, SeenPose

PERIOD = 0.01
SPEED = 0.03
TIP = np.array([0.395, 0.0, 0.03])
AWAY = 1.0  # of what nothing comes near [m]


def _state(x: float = 0.60) -> WorldState:
    """Two ice tea boxes of 90 mm, one 60 mm behind the other."""
    model = Registry.default().get("ice tea box")
    near = SeenObject("near", PlanarPose(0.45, 0.0), model)
    return WorldState({"near": near, "far": SeenObject("far", PlanarPose(x, 0.0), model)})


def _push(**changes: Any) -> Push:
    return Push.model_validate(
        {
            "object": "near",
            "face": "front",
            "p_BC": (-0.045, 0.0, 0.03),
            "normal_W": (-1.0, 0.0, 0.0),
            "direction_W": (1.0, 0.0, 0.0),
            "force_limit": 6.0,
            "speed": SPEED,
            "stroke": 0.2,
            "fingers": 2,
            "spread": 0.04,
            "ends_on": "stroke",
            **changes,
        }
    )


class _Limits:
    """What a sentence and what stands by limit, watched with an estimate of the object.

    Attributes:
        estimate: of the object.
    """

    def __init__(self, push: Push, state: WorldState, vision: Vision) -> None:
        self.estimate = ObjectEstimate(push, state, vision, TIP, PERIOD)
        guards = *sentence_guards(push, state, vision), *bystander_guards(push, state, vision)
        self._watch = Watch(guards, PERIOD)

    def end(self, time: float, tip: Array, felt: float, frames: list[Frame]) -> Ended | None:
        """How it ends at a time since the touch."""
        self.estimate.update(time, tip, felt, frames)
        return self.end_now(time, felt)

    def end_now(self, time: float = 0.0, felt: float = 0.0) -> Ended | None:
        """How it ends with the estimate as it is."""
        return self._watch.first_tripped(
            Sample(time, travel=0.0, speed=0.0, felt=felt, tilt=0.0, estimate=self.estimate)
        )


class _Scripted:
    """An object that is pushed along x, and what camera and fingers tell of it.

    Args:
        push: the push.
        vision: of the camera.
        turning, tilting: rates [rad/s].
        standing: the object stays where it is.
        meets_at: displacement from which on another is pushed too [m].
        felt: rise of the force then [N].
        goes_along: the other is seen to be pushed.
        far: where the other one stands [m].
        seed: of the noise.
    """

    def __init__(
        self,
        push: Push,
        vision: Vision,
        *,
        turning: float = 0.0,
        tilting: float = 0.0,
        standing: bool = False,
        meets_at: float = np.inf,
        felt: float = 0.6,
        goes_along: bool = False,
        far: float = 0.60,
        seed: int = 0,
    ) -> None:
        self.far = far
        self.vision, self.meets_at = vision, meets_at
        self.felt, self.goes_along = felt, goes_along
        self.turning, self.tilting, self.standing = turning, tilting, standing
        self.rng = np.random.default_rng(seed)
        self.guards = _Limits(push, _state(far), vision)
        self.waiting: list[Frame] = []
        self.come = self.turn = self.tilt = self.time = 0.0

    def run(self, seconds: float) -> Ended | None:
        """How it ends within a time."""
        for step in range(round(seconds / PERIOD)):
            self.time = step * PERIOD
            # The tip deflects a little against an object that stands.
            tip = 0.0008 * min(1.0, self.time) if self.standing else SPEED * self.time
            self.come = 0.0 if self.standing else tip
            self.turn, self.tilt = self.turning * self.time, self.tilting * self.time
            if step % 3 == 0:
                self.waiting.append(self._frame())
            ready = [f for f in self.waiting if f.arrival <= self.time]
            self.waiting = [f for f in self.waiting if f.arrival > self.time]
            rise = self.felt if self.come > self.meets_at else 0.0
            felt = 3.6 + rise + self.rng.normal(0.0, 0.04)
            at = TIP + np.array([tip, 0.0, 0.0])
            end = self.guards.end(self.time, at, felt, ready)
            if end is not None:
                return end
        return None

    def _frame(self) -> Frame:
        angle = np.radians(self.vision.angle_noise_deg)
        x, y, z = self.rng.normal(0.0, angle, 3)
        R: Array = rot_z(self.turn + z) @ rot_y(self.tilt + y) @ rot_y(x)
        p = np.array([0.45 + self.come, 0.0, 0.0])
        p += self.rng.normal(0.0, self.vision.position_noise_m, 3)
        shoved = max(0.0, self.come - self.meets_at) if self.goes_along else 0.0
        far = np.array([self.far + shoved, 0.0, 0.0])
        far += self.rng.normal(0.0, self.vision.position_noise_m, 3)
        seen = {"near": SeenPose(R, p), "far": SeenPose(np.eye(3), far)}
        return Frame(self.time, self.time + self.vision.delay_s, seen)


NOISY = Vision()
CLEAN = Vision(position_noise_m=0.0, angle_noise_deg=0.0)


@pytest.mark.parametrize("seed", range(5))
def test_without_limits_nothing_ends(seed: int) -> None:
    assert _Scripted(_push(), NOISY, far=AWAY, seed=seed).run(3.0) is None


def test_what_stands_by_is_not_touched() -> None:
    scripted = _Scripted(_push(), CLEAN)
    end = scripted.run(3.0)
    assert end is not None
    assert end[0] == "too_close"
    # It ends 3 mm short, and goes 1.5 mm from one look to the next.
    assert 0.0015 < 0.06 - scripted.come <= 0.003


def test_what_turns_into_another_ends() -> None:
    push = _push(ends_on="turned", turn=0.5, fingers=1)
    state = _state(0.55)  # its side 10 mm away; a corner that turns reaches 17 mm farther
    guard = _Limits(push, state, CLEAN)
    free = [_ends(guard, state, degrees) for degrees in (0.0, 3.0, 30.0)]
    assert free == [False, False, True]
    # What it is to meet, and what was nearly touched at first, are none of its concern.
    meeting = _Limits(push.model_copy(update={"meets": "far"}), state, CLEAN)
    # Two standard deviations of a quarter of a frame's noise: 5 mm.
    doubtful = _Limits(push, state, CLEAN.model_copy(update={"position_noise_m": 0.01}))
    assert not _ends(meeting, state, 30.0)
    assert not _ends(doubtful, state, 30.0)


def _ends(guard: _Limits, state: WorldState, degrees: float) -> bool:
    """Whether the guard ends a push that has turned the near one on the spot."""
    near = state.objects["near"]
    turned = replace(near, pose=replace(near.pose, yaw=math.radians(degrees)))
    guard.estimate.footprint = footprint(turned)
    return any(guard.end_now() is not None for _ in range(10))


@pytest.mark.parametrize("seed", range(5))
def test_it_stays_clear_of_another(seed: int) -> None:
    push = _push(limits=Limits(clear_of=(("far", 0.02),)))
    scripted = _Scripted(push, NOISY, seed=seed)
    end = scripted.run(3.0)
    assert end is not None
    assert end[0] == "too_close"
    assert "far" in end[1]
    left = 0.06 - scripted.come
    # 20 mm are kept; the guard's margin is 2 mm, the estimate is a millimetre off at most.
    assert 0.020 < left < 0.0245


def test_what_is_too_close_from_the_start_may_be_left_alone() -> None:
    push = _push(limits=Limits(clear_of=(("far", 0.08),)), direction_W=(-1.0, 0.0, 0.0))
    assert _Scripted(push, NOISY, standing=True).run(3.0) is None
    closer = _push(limits=Limits(clear_of=(("far", 0.08),)))
    scripted = _Scripted(closer, NOISY)
    end = scripted.run(1.0)
    assert end is not None
    assert end[0] == "too_close"
    assert scripted.come < 0.005


@pytest.mark.parametrize(("rates", "limits", "reason"), [
    ({"turning": 0.05}, Limits(turn=np.radians(10.0)), "turned_off"),
    ({"turning": -0.05}, Limits(turn=np.radians(10.0)), "turned_off"),
    ({"tilting": 0.05}, Limits(tilt=np.radians(5.0)), "tilted"),
])  # fmt: skip
@pytest.mark.parametrize("seed", range(3))
def test_angles_stop_before_their_limit(
    rates: dict[str, Any], limits: Limits, reason: str, seed: int
) -> None:
    scripted = _Scripted(_push(limits=limits), NOISY, far=AWAY, seed=seed, **rates)
    end = scripted.run(6.0)
    assert end is not None
    assert end[0] == reason
    limit = limits.turn or limits.tilt or 0.0
    reached = max(abs(scripted.turn), abs(scripted.tilt))
    # The filter is 0.15 s late at 3°/s, against a margin of 0.8°; its noise is 0.4°.
    assert limit - np.radians(2.5) < reached < limit + np.radians(0.3)


@pytest.mark.parametrize(
    ("limit", "degrees", "ends"),
    [
        # The camera's doubt is 0.76°, which would leave a quarter of one degree.
        (1.0, 0.65, False),
        (1.0, 0.75, True),
        # It is kept from larger ones, and from the 10° by which two fingers hold a heading.
        (5.0, 4.1, False),
        (5.0, 4.4, True),
        (None, 9.1, False),
        (None, 9.5, True),
    ],
)
def test_an_angle_is_used_but_for_the_doubt(
    limit: float | None, degrees: float, ends: bool
) -> None:
    push = _push(limits=Limits(turn=None if limit is None else np.radians(limit)))
    guards, end = _Limits(push, _state(), NOISY), None
    for step in range(60):
        seen = SeenPose(rot_z(np.radians(degrees)), np.array([0.45, 0.0, 0.0]))
        frame = Frame(step * PERIOD, step * PERIOD, {"near": seen})
        end = guards.end(step * PERIOD, TIP, 3.6, [frame])
    assert (end is not None) == ends


def test_two_deviations_and_a_millimetre_are_kept_from_what_stands_by() -> None:
    push = _push(limits=Limits(clear_of=(("far", 0.02),)))
    guards = _Limits(push, _state(), NOISY)
    for way in np.arange(0.0, 0.06, 0.00005):
        tip = TIP + np.array([way, 0.0, 0.0])
        end = guards.end(way / SPEED, tip, 3.6, [])
        if end is not None:
            break
    # A filter of weight 0.12 leaves a quarter of a frame's 2 mm.
    assert 0.06 - way == pytest.approx(0.02 + 2.0 * 0.2526 * 0.002 + 0.001, abs=0.0001)


def test_a_millimetre_is_left_to_stop_in() -> None:
    scripted = _Scripted(_push(limits=Limits(clear_of=(("far", 0.02),))), CLEAN)
    assert scripted.run(3.0) is not None
    # It goes 0.3 mm in a control step.
    assert 0.0206 < 0.06 - scripted.come < 0.0211


def test_frames_may_be_most_of_a_second_late() -> None:
    limits = Limits(turn=np.radians(10.0))
    scripted = _Scripted(_push(limits=limits), CLEAN.model_copy(update={"delay_s": 0.8}),
                         turning=0.1, far=AWAY)  # fmt: skip
    end = scripted.run(4.0)
    assert end is not None
    assert end[0] == "turned_off"
    # 10° are reached after 1.7 s and seen 0.8 s later.
    assert scripted.time == pytest.approx(2.6, abs=0.15)
    assert np.linalg.norm(scripted.guards.estimate.slipped) < 1e-9


def test_two_fingers_that_do_not_hold_the_heading_end() -> None:
    end = _Scripted(_push(), NOISY, turning=0.06, far=AWAY).run(4.0)  # 14° in all
    assert end is not None
    assert end[0] == "turned_off"
    # One finger is steered, and what is to be quick is not corrected.
    for free in (_push(fingers=1), _push(limits=Limits(duration=9.0))):
        assert _Scripted(free, NOISY, turning=0.06, far=AWAY).run(4.0) is None


def test_a_push_without_turn_or_tilt_is_left_alone() -> None:
    limits = Limits(turn=np.radians(10.0), tilt=np.radians(5.0))
    for seed in range(5):
        assert _Scripted(_push(limits=limits), NOISY, far=AWAY, seed=seed).run(4.0) is None


def test_it_ends_when_its_time_is_over() -> None:
    scripted = _Scripted(_push(limits=Limits(duration=1.5)), CLEAN)
    end = scripted.run(3.0)
    assert end is not None
    assert end[0] == "duration"
    assert "1.5 s" in end[1]
    assert scripted.time == pytest.approx(1.5, abs=PERIOD)


@pytest.mark.parametrize("seed", range(5))
def test_it_ends_when_the_object_moves(seed: int) -> None:
    scripted = _Scripted(_push(until="moves"), NOISY, seed=seed)
    end = scripted.run(1.0)
    assert end is not None
    assert end[0] == "event"
    # Checks ask for 2 mm; it stands a camera's delay and noise later.
    assert 0.002 < scripted.come < 0.007
    assert _Scripted(_push(until="moves"), NOISY, standing=True, seed=seed).run(3.0) is None


@pytest.mark.parametrize("seed", range(5))
def test_it_ends_when_another_is_felt(seed: int) -> None:
    # It is met 4 mm before the camera says so.
    push = _push(until="touching", meets="far")
    scripted = _Scripted(push, NOISY, meets_at=0.056, seed=seed)
    end = scripted.run(3.0)
    assert end is not None
    assert end[0] == "event"
    assert "felt" in end[1]
    assert scripted.come == pytest.approx(0.056, abs=0.001)


@pytest.mark.parametrize("seed", range(5))
def test_it_ends_when_another_is_seen_to_be_met(seed: int) -> None:
    scripted = _Scripted(_push(until="touching", meets="far"), NOISY, seed=seed)
    end = scripted.run(3.0)
    assert end is not None
    assert end[0] == "event"
    assert "seen" in end[1]
    # A millimetre beyond what is believed; the estimate is as much off.
    assert scripted.come == pytest.approx(0.061, abs=0.0015)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(("felt", "goes_along"), [(0.6, False), (0.0, True)])
def test_a_camera_with_a_constant_error_does_not_end_it_short(
    felt: float, goes_along: bool, seed: int
) -> None:
    # The gap is 3 mm wider than it looks: by sight it would end 2 mm before they touch.
    biased = NOISY.model_copy(update={"position_bias_m": 0.002})
    push = _push(until="touching", meets="far")
    scripted = _Scripted(push, biased, meets_at=0.063, felt=felt, goes_along=goes_along, seed=seed)
    end = scripted.run(3.0)
    assert end is not None
    assert end[0] == "event"
    # Felt at once; seen once it has gone 1 mm and the noise's 1 mm, some frames late.
    assert 0.0625 < scripted.come < 0.064 + (0.0 if felt else 0.006)


@pytest.mark.parametrize("seed", range(20))
def test_what_stands_does_not_seem_to_go_along(seed: int) -> None:
    # Noise of 5 mm in a frame; once it is near, it is looked at for half a second.
    coarse = NOISY.model_copy(update={"position_noise_m": 0.005})
    scripted = _Scripted(_push(until="touching", meets="far"), coarse, seed=seed)
    assert scripted.run(0.056 / SPEED) is None


@pytest.mark.parametrize(
    ("rise", "gaps", "ends"),
    [
        (0.40, (0.011, 0.009), True),
        (0.28, (0.011, 0.009), False),  # the noise of a force
        (0.40, (0.020, 0.018), False),  # too far off to be the other
        (0.55, (0.030, 0.0), False),  # it has slid so for a while
        (0.60, (0.021, 0.0), True),
    ],
)
def test_a_force_that_rises_near_another_has_met_it(
    rise: float, gaps: tuple[float, float], ends: bool
) -> None:
    guards = _Limits(_push(until="touching", meets="far"), _state(), CLEAN)
    found = []
    for time in np.arange(0.0, 0.058 / SPEED, PERIOD).tolist():
        more = rise if gaps[1] < 0.06 - SPEED * time < gaps[0] else 0.0
        tip = TIP + np.array([SPEED * time, 0.0, 0.0])
        found.append(guards.end(time, tip, 3.6 + more, []))
    assert any(found) == ends

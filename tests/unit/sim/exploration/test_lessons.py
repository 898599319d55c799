"""What a push shows: the figures of a trace made by hand come back as a trial."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from objectmodels import BoxModel
from planner.types.actions import Push
from planner.types.end_reasons import EndReason
from planner.types.world_state import PlanarPose, SeenObject
from sim.exploration.trial_extraction import EVEN, FORCE_SD, trial_from_push
from sim.traces.trace import Trace

BOX = BoxModel(
    name="box", size=(0.09, 0.09, 0.23), mass=1.0, friction=0.4, com=(0.002, 0.004, 0.08)
)
YAW = 0.3
SEEN = SeenObject("box", PlanarPose(0.5, 0.1, YAW), BOX)
RATE = 100.0
AT = (-0.045, 0.015, 0.03)
"""Where the fingers touch, in B."""


def push(fingers: int = 2, stroke: float = 0.06) -> Push:
    u = SEEN.pose.R_WB[:, 0]
    x, y, _ = u.tolist()
    return Push(
        object="box", face="front", p_BC=AT, normal_W=(-x, -y, 0.0), direction_W=(x, y, 0.0),
        force_limit=6.0, speed=0.05, stroke=stroke, fingers=2 if fingers == 2 else 1,
        spread=0.04 if fingers == 2 else 0.0, ends_on="stroke",
    )  # fmt: skip


def trace(
    force: NDArray[np.float64],
    travel: NDArray[np.float64],
    *,
    end: EndReason = "stroke",
    fingers: int = 2,
    up: float = 0.0,
) -> Trace:
    """A push with this force and travel along it, and a force upwards; noiseless."""
    lead = 30  # samples before the push, with another force
    n = lead + len(force)
    u, start = SEEN.pose.R_WB[:, 0], SEEN.pose.p_WB + SEEN.pose.R_WB @ np.array(AT)
    along = np.concatenate([np.full(lead, 9.0), force])
    felt = np.outer(along, u) + np.array([0.0, 0.0, up])
    tips = start + np.outer(np.concatenate([np.zeros(lead), travel]), u)
    names = [f"finger_{i}" for i in range(fingers)]
    shares = (0.7, 0.3) if fingers == 2 else (1.0,)
    return Trace(
        time=np.arange(n) / RATE,
        phase=np.array(["touch"] * lead + ["push"] * len(force)),
        poses={},
        seen={},
        joints=np.zeros((n, 0)),
        joint_names=(),
        tips={name: tips + (0.02 - 0.04 * i) * np.cross([0, 0, 1], u) for i, name in
              enumerate(names)},
        felt={name: share * felt for name, share in zip(names, shares, strict=True)},
        force_limit=np.full(n, 6.0),
        contacts=(),
        pushed="box",
        direction=u,
        end=end,
        detail="",
        seed=0,
    )  # fmt: skip


def sliding(level: float = 3.5, stroke: float = 0.06) -> tuple[NDArray[np.float64], ...]:
    """The force rises, peaks, is even under way, and falls where the hand brakes."""
    rise = np.linspace(0.0, 1.3 * level, 40)
    travel = np.concatenate([np.zeros(40), np.linspace(0.0, stroke, 200)])
    even = np.full(200, level)
    even[travel[40:] < 0.8 * EVEN[0]] = 1.2 * level
    even[travel[40:] > 1.02 * EVEN[1] * stroke] = 0.3 * level
    return np.concatenate([rise, even]), travel


def tilting(level: float = 2.0) -> tuple[NDArray[np.float64], ...]:
    """The force rises while nothing moves, then falls slowly while the face recedes."""
    force = np.concatenate([np.linspace(0.0, level, 60), np.linspace(level, 0.7 * level, 120)])
    travel = np.concatenate([np.linspace(0.0, 3e-4, 60), 3e-4 + np.linspace(0.0, 0.03, 120)])
    return force, travel


@pytest.mark.parametrize("fingers", [1, 2])
def test_a_slide_tells_the_force_of_its_even_part(fingers: int) -> None:
    found = trial_from_push(push(fingers), SEEN, trace(*sliding(), fingers=fingers, up=0.2))
    assert found is not None
    assert (found.moved, found.tilt, found.turn_rate) == ("slide", 0.0, None)
    # In the object's own axes; only samples of the even part, so no peak and no braking.
    assert found.force == pytest.approx((3.5, 0.0, 0.2), abs=1e-9)
    assert found.force_sd == pytest.approx(FORCE_SD * np.hypot(3.5, 0.2))
    assert found.force_sd == pytest.approx(0.1, rel=0.2)  # speeds change, joints flex: 3 %


def test_two_fingers_press_level_with_the_centre_of_mass() -> None:
    one = trial_from_push(push(1), SEEN, trace(*sliding(), fingers=1))
    two = trial_from_push(push(2), SEEN, trace(*sliding()))
    assert one is not None
    assert two is not None
    assert one.point == AT
    assert two.point == pytest.approx((AT[0], BOX.com[1], AT[2]), abs=1e-9)


@pytest.mark.parametrize("fingers", [1, 2])
def test_a_tilt_tells_the_force_at_its_onset(fingers: int) -> None:
    found = trial_from_push(push(fingers), SEEN, trace(*tilting(), end="tilted", fingers=fingers))
    assert found is not None
    assert (found.moved, found.tilt) == ("topple", 0.0)
    # Five samples to each side of the onset, at 1/30 N a sample before the peak: a little low.
    assert found.force[0] == pytest.approx(1.97, abs=0.015)
    assert found.point == AT


def test_a_topple_as_meant_tells_its_onset_too() -> None:
    found = trial_from_push(push(), SEEN, trace(*tilting(), end="toppled"))
    assert found is not None
    assert found.moved == "topple"


def test_what_slid_where_it_was_to_tilt_tells_a_slide() -> None:
    found = trial_from_push(push(), SEEN, trace(*sliding(), end="slid"))
    assert found is not None
    assert found.moved == "slide"
    assert found.force[0] == pytest.approx(3.5)


def test_the_force_limit_tells_the_force_at_the_end() -> None:
    force = np.concatenate([np.linspace(0.0, 6.0, 100), np.full(60, 6.0)])
    found = trial_from_push(push(), SEEN, trace(force, np.linspace(0.0, 5e-4, 160), end="force"))
    assert found is not None
    assert found.moved == "none"
    assert found.force[0] == pytest.approx(6.0)


def test_the_force_limit_is_felt_over_half_a_second() -> None:
    force = np.linspace(0.0, 1.99, 200)
    found = trial_from_push(push(), SEEN, trace(force, np.linspace(0.0, 5e-4, 200), end="force"))
    assert found is not None
    assert found.force[0] == pytest.approx(force[-1] - 0.25, abs=0.05)


@pytest.mark.parametrize(("samples", "enough"), [(20, False), (40, True)])
def test_an_even_part_of_a_few_samples_tells_nothing(samples: int, enough: bool) -> None:
    force = np.concatenate([np.linspace(0.0, 3.5, 40), np.full(samples, 3.5)])
    travel = np.concatenate([np.zeros(40), np.linspace(0.0, 0.06, samples)])
    assert (trial_from_push(push(), SEEN, trace(force, travel)) is not None) == enough


@pytest.mark.parametrize("end", ["guard", "speed", "no_touch", "unreachable"])
def test_an_end_that_says_nothing_of_the_object_teaches_nothing(end: EndReason) -> None:
    assert trial_from_push(push(), SEEN, trace(*sliding(), end=end)) is None


def test_what_did_not_fall_after_its_stroke_did_not_slide() -> None:
    falling = push().model_copy(update={"ends_on": "toppled"})
    assert trial_from_push(falling, SEEN, trace(*sliding())) is None


def test_what_is_not_clear_teaches_nothing() -> None:
    force, travel = sliding()
    # Too short a push; one that ended before it went evenly; a tilt without an onset; no push.
    assert trial_from_push(push(), SEEN, trace(force[:8], travel[:8])) is None
    assert trial_from_push(push(), SEEN, trace(force[:50], travel[:50])) is None
    flat = np.full(200, 1.0)
    assert trial_from_push(push(), SEEN, trace(flat, np.zeros(200), end="tilted")) is None
    nothing = replace(trace(force, travel), phase=np.full(30 + len(force), "transit"))
    assert trial_from_push(push(), SEEN, nothing) is None

"""A trace made by hand: what an execution would have recorded, as plain data."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from objectmodels import BoxModel
from planner.types.end_reasons import EndReason
from planner.types.plan import Plan
from sim.traces.trace import ContactEvent, Trace
from tests.unit.nlcontrol.pushes import Happens, TraceMaker, stuck

RATE = 100.0
TIP_RADIUS = 0.01


def _pose(
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    yaw: NDArray[np.float64],
    tilt: NDArray[np.float64],
    tilt_heading: float,
) -> NDArray[np.float64]:
    """Poses, shape (n, 7): a turn about the vertical, then a tilt towards a heading."""
    half = tilt / 2
    # The tilt's axis is horizontal, a quarter turn to the left of the heading.
    ax, ay = -math.sin(tilt_heading), math.cos(tilt_heading)
    w1, x1, y1, z1 = np.cos(half), ax * np.sin(half), ay * np.sin(half), 0.0 * half
    w2, z2 = np.cos(yaw / 2), np.sin(yaw / 2)
    quaternion = [w1 * w2 - z1 * z2, x1 * w2 + y1 * z2, y1 * w2 - x1 * z2, w1 * z2 + z1 * w2]
    return np.column_stack([*quaternion, x, y, np.zeros_like(x)])


@pytest.fixture
def box() -> BoxModel:
    return BoxModel(name="ice tea box", size=(0.09, 0.09, 0.23), mass=1.0, friction=0.378)


@pytest.fixture
def make_trace() -> TraceMaker:
    """A trace of an ice tea box that was pushed; everything about it can be set."""

    def make(
        *,
        travel: tuple[float, float] = (0.10, 0.0),
        turned: float = 0.0,
        tilt: float = 0.0,
        tilt_at_end: float | None = None,
        tilt_heading: float = 0.0,
        force: float = 4.0,
        noise: float = 0.0,
        speed: float = 0.05,
        height: float = 0.03,
        side: tuple[float, float] = (-1.0, 0.0),
        fingers: int = 2,
        touches: tuple[str, ...] = (),
        end: EndReason = "stroke",
        seed: int = 0,
    ) -> Trace:
        length = float(np.hypot(*travel)) or 0.10
        n_push = max(2, round(length / speed * RATE))
        phases = ["look"] * 20 + ["touch"] * 20 + ["push"] * n_push + ["settle"] * 60
        n = len(phases)
        phase = np.array(phases)
        push = phase == "push"
        share = np.concatenate([np.zeros(40), np.linspace(0, 1, n_push), np.ones(60)])
        direction = np.array([*travel, 0.0]) / length
        peak = np.sin(np.pi * share)
        final = tilt if tilt_at_end is None else tilt_at_end
        tilts = tilt * peak + final * share**4 if tilt_at_end is not None else tilt * share
        x, y = 0.5 + travel[0] * share, travel[1] * share
        start = np.array([0.5, 0.0]) + np.array(side) * (0.045 + TIP_RADIUS)
        p_WT = start + share[:, None] * np.array(travel)
        aside = 0.04 * np.array([-direction[1], direction[0]])
        off = [(i - 0.5 * (fingers - 1)) * aside for i in range(fingers)]
        tips = {
            f"finger_{i}": np.column_stack([p_WT + off[i], np.full(n, height)])
            for i in range(fingers)
        }
        rng = np.random.default_rng(seed)
        felt = {
            name: np.where(push, force / fingers, 0.0)[:, None] * direction
            + noise * rng.standard_normal((n, 3))
            for name in tips
        }
        return Trace(
            time=np.arange(n) / RATE,
            phase=phase,
            poses={
                "ice tea box": _pose(x, y, turned * share, tilts, tilt_heading),
                "mug": np.tile([1.0, 0, 0, 0, 0.5, 0.2, 0], (n, 1)),
            },
            seen={},
            joints=np.zeros((n, 0)),
            joint_names=(),
            tips=tips,
            felt=felt,
            force_limit=np.full(n, 6.0),
            contacts=tuple(ContactEvent(1.0, "ice tea box", other) for other in touches),
            pushed="ice tea box",
            direction=direction,
            end=end,
            detail="",
            seed=seed,
        )

    return make


@pytest.fixture
def goes(make_trace: TraceMaker) -> Callable[..., Happens]:
    """What comes of a push that goes as predicted, or only by a share of that."""

    def make(share: float = 1.0, end: EndReason | None = None, **values: Any) -> Happens:
        def happens(plan: Plan) -> Trace:
            x, y, _ = plan.push.displacement or (0.0, 0.0, 0.0)
            push = plan.push
            turned = share * push.turn
            ended: EndReason = "turned" if push.ends_on == "turned" else "stroke"
            return make_trace(
                travel=(share * x, share * y),
                turned=turned,
                fingers=push.fingers,
                end=end or ended,
                **{"force": 3.7, **values},
            )

        return happens

    return make


@pytest.fixture
def stands(make_trace: TraceMaker) -> Callable[..., Happens]:
    """Nothing moves, whatever is pushed."""

    def make(end: EndReason = "force", force: float = 4.0) -> Happens:
        return lambda plan: replace(
            stuck(make_trace(force=force, fingers=plan.push.fingers)), end=end, detail="as it came"
        )

    return make

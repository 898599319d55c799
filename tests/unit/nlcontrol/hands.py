"""Traces of a whole hand, made by hand: an object goes up, leans, comes back, or does not."""

from __future__ import annotations

from typing import Any

import numpy as np

from planner.types.end_reasons import EndReason
from sim.traces.trace import Trace

RATE = 100  # samples in a second


def hand_trace(
    name: str,
    *,
    up: float = 0.0,
    at_end: float | None = None,
    moved: tuple[float, float] = (0.0, 0.0),
    tilt_at_end: float = 0.0,
    others: dict[str, tuple[float, float]] | None = None,
    weighs: float = 0.0,
    end: EndReason = "handled",
    **more: Any,
) -> Trace:
    """What happened to one object in the hand.

    Args:
        name: of the object.
        up: how high it was lifted [m].
        at_end: how high it was in the end; as it was lifted if not given [m].
        moved: how far along x and y [m].
        tilt_at_end: how it leans in the end [rad].
        others: other objects and how far each was moved [m].
        weighs: force on the fingers while it is held [N].
        end: why it ended.
        more: of the trace.
    """
    phases = ["look"] * 20 + ["grasp"] * 20 + ["lift"] * 200 + ["carry"] * 50 + ["settle"] * 60
    n, phase = len(phases), np.array(phases)
    share = np.concatenate([np.zeros(40), np.linspace(0.0, 1.0, 50), np.ones(n - 90)])
    z = up * share
    if at_end is not None:
        z[-60:] = at_end
    half = 0.5 * tilt_at_end * (phase == "settle")
    zeros = np.zeros(n)
    pose = np.column_stack(
        [np.cos(half), zeros, np.sin(half), zeros, 0.5 + moved[0] * share, moved[1] * share, z]
    )
    poses = {name: pose}
    for other, (x, y) in (others or {}).items():
        beside = np.column_stack([x * share, 0.3 + y * share, zeros])
        poses[other] = np.column_stack([np.tile([1.0, 0, 0, 0], (n, 1)), beside])
    held = np.isin(phase, ["lift", "carry"])
    quarter = np.column_stack([zeros, zeros, 0.25 * weighs * held])
    fingers = ("thumb", "index", "middle", "ring")
    return Trace(
        time=np.arange(n) / RATE, phase=phase, poses=poses, seen=poses,
        joints=np.zeros((n, 0)), joint_names=(),
        tips=dict.fromkeys(fingers, pose[:, 4:]), felt=dict.fromkeys(fingers, quarter),
        force_limit=np.zeros(n), contacts=(), pushed=name, direction=np.array([0.0, 0.0, -1.0]),
        end=end, detail="", seed=0, **more,
    )  # fmt: skip


def over_time(start: float, end: float) -> Any:
    """A quantity that goes from one value to another one during a trace."""
    return np.concatenate([np.full(40, start), np.linspace(start, end, 250), np.full(60, end)])

"""Traces of a box and frames about it, made by hand."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from grammar.frames import command as g
from grammar.parser import parser_for
from sim.traces.trace import Trace

BOX = "ice tea box"


def trace(*, x: float = 0.0, y: float = 0.0, yaw: float = 0.0, tilts: float = 0.0) -> Trace:
    """From (0.5, 0) by x, y and a turn; on the way, or for good if it fell, tilted to the left."""
    n, fell = 50, tilts > 1.0
    share: NDArray[np.float64] = np.linspace(0.0, 1.0, n)
    half = 0.5 * tilts * (share if fell else np.sin(np.pi * share))
    turn = 0.5 * yaw * share
    poses = np.zeros((n, 7))
    # About −x, so that the top goes to +y; then about the vertical.
    poses[:, 0], poses[:, 1] = np.cos(half) * np.cos(turn), -np.sin(half) * np.cos(turn)
    poses[:, 2], poses[:, 3] = -np.sin(half) * np.sin(turn), np.cos(half) * np.sin(turn)
    poses[:, 4], poses[:, 5] = 0.5 + x * share, y * share
    # It is at rest for the last part, as checks want it.
    poses = np.vstack([poses, np.tile(poses[-1], (40, 1))])
    k = len(poses)
    return Trace(
        time=np.linspace(0.0, 0.01 * (k - 1), k), phase=np.full(k, "push"),
        poses={BOX: poses}, seen={BOX: poses},
        joints=np.zeros((k, 0)), joint_names=(), tips={}, felt={}, force_limit=np.zeros(k),
        contacts=(), pushed=BOX, direction=np.array([1.0, 0.0, 0.0]), end="stroke", detail="",
        seed=0,
    )  # fmt: skip


def frame(words: str) -> g.Frame:
    (parsed,) = parser_for({BOX}).parse(words.format(f"the {BOX}")).frames
    return parsed

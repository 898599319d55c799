"""Free motion: the hand takes its posture near home, where nothing stands in its way."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from objectmodels.geometry.rotations import Array
from sim.control.free_motion import move_joints
from sim.control.trace_recorder import TraceRecorder

CLOSED, OPEN = np.zeros(12), np.full(12, 0.8)


class _Recorder:
    """What is commanded, from rest at zero."""

    def __init__(self) -> None:
        self.port = SimpleNamespace(commanded=(np.zeros(7), CLOSED), period=0.01)
        self.steps: list[tuple[Array, Array]] = []

    def step(self, q_arm: Array, q_hand: Array) -> None:
        self.steps.append((q_arm, q_hand))


@pytest.mark.parametrize("homeward", [False, True])
def test_the_hand_changes_near_home_alone(homeward: bool) -> None:
    recorder = _Recorder()
    move_joints(cast(TraceRecorder, recorder), np.full(7, 0.6), OPEN, homeward=homeward)
    arm = np.array([q[0] for q, _ in recorder.steps]) / 0.6
    hand = np.array([q[0] for _, q in recorder.steps]) / 0.8
    far = arm < 0.6 if homeward else arm > 0.4
    np.testing.assert_allclose(hand[far], 0.0 if homeward else 1.0, atol=1e-9)  # rounding
    np.testing.assert_array_equal(recorder.steps[-1][1], OPEN)
    # Its joints do not jump: 1.5 of the mean rate over 0.4 of a way that is at most 1 cm a step.
    assert np.abs(np.diff(hand)).max() <= 1.5 / 0.4 * np.diff(arm).max() + 1e-9

"""Actions in words."""

from __future__ import annotations

import math

import pytest

from planner.types.actions import Grasp


@pytest.mark.parametrize(
    ("down", "words"),
    [
        (0.0, "from its side"),
        (2.0, "from its side"),
        (4.0, "askew from above"),
        (70.0, "askew from above"),
        (74.0, "from above"),
        (90.0, "from above"),
    ],
)
def test_a_hand_comes_from_the_side_or_from_above(down: float, words: str) -> None:
    pitch = math.radians(down)
    grasp = Grasp(
        p_BG=(0.0, 0.0, 0.1), closing_W=(0.0, 1.0, 0.0), width=0.06,
        approach_W=(math.cos(pitch), 0.0, -math.sin(pitch)),
        squeeze=5.0, needed=3.0, strongest=20.0,
    )  # fmt: skip
    assert grasp.approach_text == words

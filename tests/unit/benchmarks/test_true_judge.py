"""The judge of true poses, on traces made by hand: just inside and just outside its tolerances."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.goals.judge import judged
from nlcontrol import Registry
from sim.traces.trace import ContactEvent
from tests.unit.benchmarks.box_traces import BOX, frame, trace

MODELS = {BOX: Registry.built_in().get(BOX)}
DEG = np.pi / 180.0


@pytest.mark.parametrize(
    ("words", "moved", "met"),
    [
        ("push {} 10 cm away", {"x": 0.111}, True),
        ("push {} 10 cm away", {"x": 0.115}, False),
        ("push {} 10 cm away", {"x": -0.10}, False),
        ("push {} 10 cm away", {"x": 0.10, "y": 0.03}, False),
        ("push {} 10 cm away", {"x": 0.10, "tilts": 80.0 * DEG}, False),
        ("push {} at least 10 cm to the left", {"y": 0.2}, True),
        ("push {} at least 10 cm to the left", {"y": 0.09}, False),
        ("push {} to x 0.6 y 0.1", {"x": 0.1, "y": 0.1}, True),
        ("push {} to x 0.6 y 0.1", {"x": 0.1, "y": 0.12}, False),
        ("turn {} 40 degrees to the left", {"yaw": 43.0 * DEG}, True),
        ("turn {} 40 degrees to the left", {"yaw": 45.0 * DEG}, False),
        ("turn {} 40 degrees to the left", {"yaw": -40.0 * DEG}, False),
        ("tilt {} by 10 degrees to the left", {"tilts": 11.0 * DEG}, True),
        ("tilt {} by 10 degrees to the left", {"tilts": 14.0 * DEG}, False),
        ("tilt {} by 10 degrees to the right", {"tilts": 11.0 * DEG}, False),
        ("topple {} to the left", {"tilts": 90.0 * DEG}, True),
        ("topple {} away", {"tilts": 90.0 * DEG}, False),
        ("topple {}", {"tilts": 30.0 * DEG}, False),
    ],
)
def test_goals(words: str, moved: dict[str, float], met: bool) -> None:
    assert judged(frame(words), trace(**moved), MODELS).met is met


@pytest.mark.parametrize(
    ("words", "moved", "broken"),
    [
        ("without toppling it", {"tilts": 80.0 * DEG}, ("no_topple",)),
        ("without toppling it", {}, ()),
        ("without turning it", {"yaw": 20.0 * DEG}, ("no_turn",)),
        ("without tilting it more than 5 degrees", {"tilts": 9.0 * DEG}, ("max_tilt",)),
    ],
)
def test_clauses(words: str, moved: dict[str, float], broken: tuple[str, ...]) -> None:
    asked = frame(f"push {{}} 10 cm away {words}")
    assert judged(asked, trace(x=0.1, **moved), MODELS).broken == broken


def test_what_is_stirred_or_touched_breaks_a_clause() -> None:
    moved = trace(x=0.1)
    pushed = moved.poses[BOX]
    still = np.tile(pushed[0] + [0, 0, 0, 0, 0.3, 0.0, 0.0], (len(pushed), 1))
    shoved = still.copy()
    shoved[-1, 5] += 0.02
    models = {**MODELS, "mug": Registry.built_in().get("mug")}
    asked = frame("push {} 10 cm away")
    for poses, broken in ((still, ()), (shoved, ("others",))):
        seen = replace(moved, poses={BOX: pushed, "mug": poses})
        assert judged(asked, seen, models).broken == broken
    touched = replace(moved, poses={BOX: pushed, "mug": still})
    touched = replace(touched, contacts=(ContactEvent(0.1, "mug", BOX),))
    alone = frame("push {} 10 cm away without touching anything")
    assert judged(alone, touched, models).broken == ("no_touch",)


@pytest.mark.parametrize(("height", "broken"), [(0.1, ("max_tilt",)), (0.0, ())])
def test_what_hangs_askew_counts_as_tilted_and_what_lies_does_not(
    height: float, broken: tuple[str, ...]
) -> None:
    seen = trace(x=0.1)
    poses = seen.poses[BOX].copy()
    poses[:, :4] = (np.cos(8.5 * DEG), np.sin(8.5 * DEG), 0.0, 0.0)
    poses[:, 6] = height + 0.01
    askew = replace(seen, poses={BOX: poses})
    asked = frame("push {} 10 cm away without tilting it more than 10 degrees")
    assert judged(asked, askew, MODELS).broken == broken


def test_what_poses_do_not_tell_is_left_open() -> None:
    assert judged(frame("push {} halfway to the left edge"), trace(x=0.1), MODELS).met is None

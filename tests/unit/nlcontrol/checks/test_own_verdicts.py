"""The robot's own verdicts: right by what it perceived, and unknown where that does not tell."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.verdicts.judged_cases import with_frames
from grammar.frames import command as g
from nlcontrol.checks import own_verdicts
from nlcontrol.checks.own_accounts import Knowledge, Place, felt_end
from nlcontrol.checks.verdicts import Check, compare
from objectmodels import BoxModel
from planner.types.defaults import DEFAULTS
from sim.robots.cell_description import Vision
from sim.traces.trace import Trace
from tests.unit.nlcontrol.checks.conftest import (
    AWAY,
    MUG,
    ROUND,
    TABLE,
    TraceMaker,
    frame_of,
    one,
)

STANDARD = Vision()
ROUGH = Vision(
    position_noise_m=0.008, angle_noise_deg=3.0, position_bias_m=0.002, angle_bias_deg=0.5
)
BOX = "ice tea box"


def _seen(trace: Trace, vision: Vision = STANDARD, seed: int = 0) -> Trace:
    """What a camera showed of it, with a look of a second before."""
    n = 100
    before = {name: np.tile(p[0], (n, 1)) for name, p in trace.poses.items()}
    longer = replace(
        trace,
        time=np.concatenate([trace.time[0] - 0.01 * np.arange(n, 0, -1), trace.time]),
        phase=np.concatenate([np.full(n, "look"), trace.phase]),
        poses={name: np.concatenate([before[name], p]) for name, p in trace.poses.items()},
        joints=np.zeros((n + len(trace.time), 0)),
        tips={name: np.concatenate([np.tile(p[0], (n, 1)), p]) for name, p in trace.tips.items()},
        felt={name: np.concatenate([np.zeros((n, 3)), f]) for name, f in trace.felt.items()},
        force_limit=np.concatenate([np.zeros(n), trace.force_limit]),
    )
    return with_frames(longer, vision, np.random.default_rng(seed))


def _verdicts(
    frame: g.Frame, trace: Trace, box: BoxModel, vision: Vision = STANDARD
) -> tuple[Check, ...]:
    models = {BOX: box, "mug": ROUND}
    return own_verdicts.verdicts(frame, trace, Knowledge(models, TABLE, vision, DEFAULTS))


@pytest.mark.parametrize("vision", [STANDARD, ROUGH])
@pytest.mark.parametrize("seed", range(3))
def test_a_good_push_is_held_by_what_was_seen(
    make_trace: TraceMaker, box: BoxModel, vision: Vision, seed: int
) -> None:
    # Single frames of the standard camera show a tilt of 2° and more at the end, where 2° are
    # allowed: judged by its newest frame, most pushes have failed.
    frame = frame_of(AWAY, g.NoTopple(), g.NoTurn())
    checks = _verdicts(frame, _seen(make_trace(), vision, seed), box, vision)
    assert [c.verdict for c in checks] == ["held"] * len(checks)
    moved = one(checks, "moved in")
    assert isinstance(moved.low, float)
    assert isinstance(moved.high, float)
    assert moved.low <= 0.1 <= moved.high
    assert all(c.observed is not None and c.observed.ok for c in checks)


@pytest.mark.parametrize(("travelled", "verdict"), [(0.08, "not_held"), (0.0905, "unknown")])
def test_what_is_nearer_to_the_limit_than_is_known_is_unknown(
    make_trace: TraceMaker, box: BoxModel, travelled: float, verdict: str
) -> None:
    trace = _seen(make_trace(travel=(travelled, 0.0)))
    moved = one(_verdicts(frame_of(), trace, box), "moved in")
    assert (moved.verdict, moved.ok) == (verdict, False)
    assert moved.why == ("too_near" if verdict == "unknown" else None)


def test_the_truth_plays_no_part(make_trace: TraceMaker, box: BoxModel) -> None:
    trace, frame = _seen(make_trace()), frame_of(AWAY, g.NoTopple())
    own = [c.model_copy(update={"observed": None}) for c in _verdicts(frame, trace, box)]
    assert list(_verdicts(frame, trace.perceived, box)) == own
    wrong = make_trace(travel=(0.0, 0.1), tilt=1.0, touches=("mug",))
    false = replace(trace, poses=_seen(wrong).poses, contacts=wrong.contacts)
    told = _verdicts(frame, false, box)
    assert [c.model_copy(update={"observed": None}) for c in told] == own
    assert not all(c.observed is not None and c.observed.ok for c in told)


def test_with_a_perfect_camera_both_say_the_same(make_trace: TraceMaker, box: BoxModel) -> None:
    perfect = Vision(position_noise_m=0.0, angle_noise_deg=0.0)
    trace = _seen(make_trace(tilt=0.05, tilt_at_end=0.0), perfect)
    for check in _verdicts(frame_of(AWAY, g.NoTilt()), trace, box, perfect):
        assert check.observed is not None
        if isinstance(check.measured, float):
            # Between frames, 33 ms apart, a lean goes on by a few thousandths.
            assert check.measured == pytest.approx(check.observed.measured, abs=3e-3)
        assert check.ok == check.observed.ok


def _hidden(trace: Trace, *, ever_since: bool) -> Trace:
    """The trace without frames of the box while it is pushed, or of all that comes after, too."""
    pushing = trace.time[np.flatnonzero(trace.phase == "push")[[0, -1]]]
    seen = trace.sightings[BOX]
    shown = seen[(seen[:, 0] < pushing[0]) | ((seen[:, 0] > pushing[1]) & (not ever_since))]
    return replace(trace, sightings=trace.sightings | {BOX: shown})


@pytest.mark.parametrize("ever_since", [False, True])
def test_what_was_hidden_is_neither_held_nor_failed(
    make_trace: TraceMaker, box: BoxModel, ever_since: bool
) -> None:
    trace = replace(_seen(make_trace(tilt=0.05, tilt_at_end=0.0)), felt={})
    checks = _verdicts(frame_of(AWAY, g.NoTilt()), _hidden(trace, ever_since=ever_since), box)
    tilt = one(checks, "largest tilt")
    assert (tilt.verdict, tilt.why, tilt.measured) == (
        "unknown", "not_perceived", "not perceived",
    )  # fmt: skip
    assert one(checks, "moved in").verdict == ("unknown" if ever_since else "held")


@pytest.mark.parametrize(("dip", "verdict"), [(0.02, "held"), (0.5, "unknown")])
def test_a_lean_that_nobody_saw_shows_in_the_force(
    make_trace: TraceMaker, box: BoxModel, dip: float, verdict: str
) -> None:
    """The box falls by itself at 21°: of half of its force less it may have leant by 10°."""
    trace = _seen(make_trace())
    n = int((trace.phase == "push").sum())
    share = np.ones(len(trace.time))
    share[trace.phase == "push"] -= dip * np.sin(np.linspace(0.0, np.pi, n)) ** 2
    trace = replace(trace, felt={k: share[:, None] * force for k, force in trace.felt.items()})
    clause = g.MaxTilt(value=math.radians(8.0))
    hidden = _hidden(trace, ever_since=True)
    checks = _verdicts(frame_of(AWAY, clause), hidden, box)
    assert one(checks, "largest tilt").verdict == verdict
    assert one(checks, "moved in").verdict == "held"


@pytest.mark.parametrize("askew", [0.0, 5.0, -10.0])
def test_the_force_of_one_fingertip_points_where_the_object_goes(
    make_trace: TraceMaker, box: BoxModel, askew: float
) -> None:
    """It goes 30 mm, pushed 45 mm behind its middle: that goes aside by 30 mm · tan θ."""
    trace = make_trace(travel=(0.03, 0.0), fingers=1)
    angle = math.radians(askew)
    turned = np.array([[math.cos(angle), -math.sin(angle), 0.0],
                       [math.sin(angle), math.cos(angle), 0.0], [0.0, 0.0, 1.0]])  # fmt: skip
    felt = {name: force @ turned.T for name, force in trace.felt.items()}
    trace = _seen(replace(trace, felt=felt))
    samples = np.flatnonzero(np.isin(trace.phase, ("touch", "push")))
    place = Place.seen(trace.sightings[BOX][:20])
    end = felt_end(trace, samples, box, place)
    assert end is not None
    # The box is 90 mm deep; what 20 frames of 2 mm and 1° leave open is 0.5 mm and 0.2°.
    aside = 0.03 * math.tan(angle)
    assert math.degrees(end.turn) == pytest.approx(math.degrees(aside / 0.045), abs=0.5)
    moved = place.after(end).p - place.p
    assert moved[:2] == pytest.approx([0.03, aside], abs=6e-4)


@pytest.mark.parametrize(
    "clause", [g.MaxForce(value=5.0), g.MinForce(value=1.0), g.Force(value=4.0)]
)
def test_a_force_that_nobody_felt_is_unknown(
    make_trace: TraceMaker, box: BoxModel, clause: Any
) -> None:
    trace = _seen(make_trace())
    felt = one(_verdicts(frame_of(AWAY, clause), trace, box), "force felt")
    assert felt.verdict == "held"
    numb = one(_verdicts(frame_of(AWAY, clause), replace(trace, felt={}), box), "force felt")
    assert (numb.verdict, numb.why) == ("unknown", "not_perceived")


def test_a_robot_that_saw_nothing_knows_nothing(make_trace: TraceMaker, box: BoxModel) -> None:
    blind = replace(_seen(make_trace()), sightings={})
    checks = _verdicts(frame_of(AWAY, g.NoTopple()), blind, box)
    assert {c.verdict for c in checks} == {"unknown"}
    assert all(c.observed is not None and c.observed.ok for c in checks)


def _nudged(trace: Trace, by: float) -> Trace:
    mug = trace.poses["mug"].copy()
    mug[len(mug) // 2 :, 4] += by
    return replace(trace, poses=trace.poses | {"mug": mug})


@pytest.mark.parametrize("vision", [STANDARD, ROUGH])
def test_a_neighbour_that_was_nudged_was_touched(
    make_trace: TraceMaker, box: BoxModel, vision: Vision
) -> None:
    nudged = _seen(_nudged(make_trace(), 0.015), vision)
    others = one(_verdicts(frame_of(), nudged, box, vision), "touched on the way")
    assert (others.verdict, others.measured) == ("not_held", "mug")
    stands = one(_verdicts(frame_of(), _seen(make_trace(), vision), box, vision), "touched on")
    assert stands.verdict == "held"


@pytest.mark.parametrize(("way", "verdict"), [((0.1, 0.0), "held"), ((0.0, 0.115), "unknown")])
def test_whether_it_was_touched_and_stayed_nobody_knows(
    make_trace: TraceMaker, box: BoxModel, way: tuple[float, float], verdict: str
) -> None:
    goal = g.Displace(direction="away" if way[0] else "left", distance=max(way))
    # The mug's side is 115 mm to the left of the box's.
    trace = _seen(make_trace(travel=way, side=(-1.0, 0.0) if way[0] else (0.0, -1.0)))
    frame = frame_of(goal, g.NoTouch(object=MUG))
    assert one(_verdicts(frame, trace, box), "contact with").verdict == verdict


@pytest.mark.parametrize("fades", [False, True])
def test_touch_tells_a_slide_from_a_fall_where_nobody_sees_it(
    make_trace: TraceMaker, box: BoxModel, fades: bool
) -> None:
    trace = _seen(make_trace(noise=0.05, tilt=math.pi / 2 if fades else 0.0, height=0.2))
    pushing = trace.phase == "push"
    if fades:
        # The force that holds an object on its edge falls with the tilt, to nothing.
        left = np.clip(1.0 - 1.2 * np.cumsum(pushing) / pushing.sum(), 0.0, 1.0)[:, None]
        trace = replace(trace, felt={name: left * force for name, force in trace.felt.items()})
    begun = trace.time[np.argmax(trace.phase == "touch")]
    seen = trace.sightings[BOX]
    dark = replace(trace, sightings=trace.sightings | {BOX: seen[seen[:, 0] < begun]})
    slid = one(_verdicts(frame_of(), dark, box), "moved in")
    fell = one(_verdicts(frame_of(g.Topple()), dark, box), "tilt at the end")
    assert fell.verdict == ("held" if fades else "not_held")
    assert slid.verdict == ("unknown" if fades else "held")


@pytest.mark.parametrize("lies", [[0.0, np.pi / 2, 0.0], [np.pi / 2, 0.0, 0.0], [np.pi, 0.0, 0.0]])
def test_a_push_of_what_lies_on_its_side_is_felt_too(
    make_trace: TraceMaker, box: BoxModel, lies: list[float]
) -> None:
    trace = make_trace(travel=(0.03, 0.0))
    samples = np.flatnonzero(np.isin(trace.phase, ("touch", "push")))
    place = Place(Rotation.from_rotvec(lies), trace.poses[BOX][0, 4:])
    end = felt_end(trace, samples, box, place)
    assert end is not None
    assert end.way == pytest.approx([0.03, 0.0, 0.0])


@pytest.mark.parametrize("shown", [1, 2, 3, 4])
def test_a_push_of_few_samples_breaks_nothing(
    make_trace: TraceMaker, box: BoxModel, shown: int
) -> None:
    trace = make_trace(travel=(0.03, 0.0))
    pushing = np.flatnonzero(trace.phase == "push")
    samples = pushing[np.linspace(0, len(pushing) - 1, shown).astype(int)]
    end = felt_end(trace, samples, box, Place.seen(_seen(trace).sightings[BOX][:5]))
    assert end is None or shown >= 3


@pytest.mark.parametrize(("spread", "verdict"), [(1.0, "unknown"), (0.01, "not_held")])
def test_a_narrow_band_in_a_wide_range_is_not_denied(spread: float, verdict: str) -> None:
    """Of draws that are spread by a radian, hardly one turns by 8° ± 3°."""
    clause = g.Rotate(angle=0.14)
    mean = compare(clause, "about", "turned", 0.14, 0.0, 0.05, "rad")
    values = spread * np.linspace(-2.0, 2.0, 40)
    drawn = [compare(clause, "about", "turned", 0.14, float(v), 0.05, "rad") for v in values]
    assert own_verdicts.ToldClause(mean, drawn, hidden=False).verdict().verdict == verdict

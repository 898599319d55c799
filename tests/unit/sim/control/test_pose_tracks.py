"""Tracks of objects from camera frames: how far off they are, and what nobody saw."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sim.control.pose_tracks import (
    CALM,
    WILD,
    Array,
    Bridge,
    CameraSheet,
    PoseTrack,
    Stretch,
    pose_track,
    swing_and_turn,
)

SHEET = CameraSheet(position=0.002, angle=float(np.radians(1.0)))
TIME = np.arange(0.0, 10.0, 0.02)
STRETCH = Stretch(3.0, 7.0)
WAY, MEMBERS = 0.1, 40


def _frames(lean: float = 0.0, *, sheet: CameraSheet = SHEET, seed: int = 0) -> Array:
    """Frames of an object that goes 10 cm along x, and leans on its way by so much [rad]."""
    rng, at = np.random.default_rng(seed), np.arange(0.0, 10.0, 1.0 / 30.0)
    share = np.clip((at - 4.0) / 2.0, 0.0, 1.0)
    tilt = lean * np.sin(np.pi * share) ** 2
    R_WB = Rotation.from_rotvec(np.column_stack([0.0 * at, tilt, 0.0 * at]))
    R_WB = Rotation.from_rotvec(sheet.angle * rng.standard_normal((len(at), 3))) * R_WB
    p = np.column_stack([WAY * share, 0.0 * at, 0.0 * at])
    p = p + sheet.position * rng.standard_normal(p.shape)
    return np.column_stack([at, R_WB.as_quat()[:, [3, 0, 1, 2]], p])


def _track(frames: Array, *, sheet: CameraSheet = SHEET, moves: bool = True) -> PoseTrack:
    rng = np.random.default_rng(1)
    found = pose_track(frames, TIME, [STRETCH], sheet, MEMBERS, rng, moves=moves)
    assert found is not None
    return found


def _tilts(poses: Array) -> Array:
    """Tilts, shape (…, n) [rad]."""
    return np.asarray(
        np.arccos(np.clip(1.0 - 2.0 * (poses[..., 1] ** 2 + poses[..., 2] ** 2), -1, 1))
    )


@pytest.mark.parametrize("seed", range(4))
def test_a_way_between_two_rests(seed: int) -> None:
    track = _track(_frames(seed=seed))
    moved = track.members[:, -1, 4] - track.members[:, 0, 4]
    # 90 frames at each end: 2 mm · √(2 / 90) is 0.3 mm; three of that.
    assert moved.std() == pytest.approx(0.0003, rel=0.3)
    assert track.mean[-1, 4] - track.mean[0, 4] == pytest.approx(WAY, abs=0.0009)
    assert (track.moved, track.hidden) == (True, False)


@pytest.mark.parametrize("lean", [0.0, 2.0, 8.0])
@pytest.mark.parametrize("seed", range(3))
def test_the_largest_tilt_on_the_way(lean: float, seed: int) -> None:
    track = _track(_frames(np.radians(lean), seed=seed))
    most = _tilts(track.mean).max()
    # A single frame is off by 1°, the largest of 120 frames by more than 2°.
    assert np.degrees(most) == pytest.approx(lean, abs=0.7)
    spread = np.degrees(_tilts(track.members).max(axis=1).std())
    assert spread < 0.5


def test_what_stands_is_level_in_the_end() -> None:
    track = _track(_frames())
    assert np.degrees(_tilts(track.members[:, -1])).max() < 0.7


def test_what_is_not_worked_on_stays_unless_it_is_seen_elsewhere() -> None:
    still = _frames()
    still[:, 5] -= WAY * np.clip((still[:, 0] - 4.0) / 2.0, 0.0, 1.0)
    track = _track(still, moves=False)
    assert track.moved is False
    assert np.ptp(track.mean[:, 4]) == 0.0
    # 15 mm, as far as a nudge of a neighbour.
    nudged = still.copy()
    nudged[nudged[:, 0] > 5.0, 6] += 0.015
    assert _track(nudged, moves=False).moved is True


def test_a_constant_error_cancels_in_a_way_and_stays_in_a_place() -> None:
    sheet = CameraSheet(SHEET.position, SHEET.angle, position_bias=0.005)
    track = _track(_frames(), sheet=sheet)
    place = track.members[:, -1, 4]
    assert place.std() == pytest.approx(0.005, rel=0.4)  # of 40 draws
    assert (place - track.members[:, 0, 4]).std() < 0.0005


def test_more_noise_than_the_sheet_has_is_noticed() -> None:
    half = CameraSheet(SHEET.position / 2.0, SHEET.angle / 2.0)
    told, true = _track(_frames(), sheet=half), _track(_frames())
    spread = [t.members[:, -1, 4].std() for t in (told, true)]
    assert spread[0] == pytest.approx(spread[1], rel=0.1)


@pytest.mark.parametrize("shown", [lambda t: (t < 3.5) | (t > 6.5), lambda t: t < 3.5])
def test_nothing_is_told_of_what_no_frame_shows(shown: object) -> None:
    frames = _frames(np.radians(8.0))
    track = _track(frames[shown(frames[:, 0])])  # type: ignore[operator]
    assert track.hidden
    most = np.degrees(_tilts(track.members).max(axis=1))
    assert np.median(most[CALM]) < 2.0
    assert np.median(most[WILD]) > 20.0


def test_what_was_never_seen_has_no_track() -> None:
    frames = _frames()
    rng = np.random.default_rng(0)
    late = frames[frames[:, 0] > 5.0]
    assert pose_track(late, TIME, [STRETCH], SHEET, MEMBERS, rng, moves=True) is None


@pytest.mark.parametrize("edges", [(0.0, 2.0), (0.0, 0.7, 1.5, 2.0)])
def test_a_bridge_is_at_rest_at_both_ends(edges: tuple[float, ...]) -> None:
    at = np.linspace(0.0, 2.0, 41)
    covariance, mean = Bridge(at, np.array(edges)).given(np.ones(len(edges) - 1))
    assert covariance[[0, -1]] == pytest.approx(np.zeros((2, 41)), abs=1e-12)
    assert (mean[0], mean[-1]) == (0.0, pytest.approx(1.0))
    # Its rates at the ends are 0: what begins is of second order.
    assert mean[1] < 0.01
    assert np.linalg.eigvalsh(covariance).min() > -1e-12
    # Parts of one density are one part, whose variance half-way is L³ / 192.
    assert covariance[20, 20] == pytest.approx(2.0**3 / 192.0)


def test_a_bridge_against_walks_that_are_drawn() -> None:
    """Accelerations drawn step by step, and of these walks what a linear fit leaves at the end."""
    edges, q, step = np.array([0.0, 0.6, 2.0]), np.array([4.0, 0.25]), 0.005
    rng, u = np.random.default_rng(0), np.arange(0.0, 2.0, 0.005) + 0.0025
    sd = np.sqrt(np.where(u < 0.6, q[0], q[1]) / step)
    rates = np.cumsum(sd * rng.standard_normal((10000, len(u))), axis=1) * step
    ways = np.cumsum(rates, axis=1) * step
    ends = np.column_stack([ways[:, -1], rates[:, -1]])
    fit, *_ = np.linalg.lstsq(ends, ways, rcond=None)
    covariance, mean = Bridge(u + 0.0025, edges).given(q)
    # 10,000 walks tell a variance to 1.4 %, steps of 1/400 of the way are as much off.
    assert np.var(ways - ends @ fit, axis=0)[40:330:40] == pytest.approx(
        covariance.diagonal()[40:330:40], rel=0.06
    )
    assert fit[0] == pytest.approx(mean, abs=0.02)


def test_a_jerk_in_the_midst_of_a_long_stretch_is_not_blurred() -> None:
    """4° for half a second in a stretch of nine, by six seeds; one of them may lie outside 2σ."""
    at, within = np.arange(0.0, 12.0, 1.0 / 30.0), []
    turn = np.radians(4.0) * np.exp(-(((at - 6.0) / 0.3) ** 2))
    for seed in range(6):
        rng = np.random.default_rng(seed)
        off = SHEET.angle * rng.standard_normal((len(at), 3))
        R_WB = Rotation.from_rotvec(off + turn[:, None] * [0.0, 0.0, 1.0])
        p = SHEET.position * rng.standard_normal((len(at), 3))
        frames = np.column_stack([at, R_WB.as_quat()[:, [3, 0, 1, 2]], p])
        ways = [Stretch(1.5, 10.5)]
        track = pose_track(frames, TIME, ways, SHEET, MEMBERS, rng, moves=True)
        assert track is not None
        turns = np.degrees(2.0 * np.arctan2(track.members[..., 3], track.members[..., 0]))
        low, high = np.quantile(np.abs(turns).max(axis=1), [0.023, 0.977])
        within.append(low < 4.0 < high)
    assert sum(within) >= 5


@pytest.mark.parametrize("turn", [0.3, -2.0, 3.0])
def test_a_swing_after_a_turn(turn: float) -> None:
    swing = np.array([0.2, -0.4])
    whole = Rotation.from_rotvec([*swing, 0.0]) * Rotation.from_rotvec([0.0, 0.0, turn])
    swings, turns = swing_and_turn(Rotation.concatenate([whole]))
    assert swings[0] == pytest.approx(swing)
    assert turns[0] == pytest.approx(turn)

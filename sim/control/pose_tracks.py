"""Where objects were over time, as far as a camera's frames tell it: a mean and an ensemble.

Model: an object stands still but for the stretches in which it is worked on. While it stands, each
of its coordinates is constant, and n frames tell it to σ/√n. On its way a coordinate is an
integrated Wiener process, tied at both ends to where it stood, at rest, with an acceleration
density for each part of the way: those that make the frames of the stretch most likely
[rasmussen-2006]. One density for all would blur a jerk in the midst of a long stretch. Members of
the ensemble are joint draws, so that any function of a track, its largest tilt as well, has its own
spread; they come from the mean by Matheron's rule: a draw from the prior, corrected by what the
frames say of it.

A constant error of the camera is drawn once for each member and object, so that it cancels in what
moved and stays in a gap. Noise is the larger of the data sheet's and of what the rests show. What
stands within two standard deviations of level is taken to stand level.

Nothing is concluded from frames that are not there. Where none shows the object for `HIDDEN` on
its way, or none in the end, and touch does not tell (`FeltEnd`), every other member (`CALM`) does
as little as it may, and the others (`WILD`) as much as is thought of, so that what depends on it
shows.

Frames: W is the world, B an object. A rotation is R_WB = S(s) R_z(ψ) R₀: R₀ as it stood at first,
a turn ψ about the vertical, then a swing s about a horizontal axis of W, shape (2,) [rad].
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve, eigh
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

POSITION_DENSITIES = np.logspace(-5.0, -1.0, 9)
"""Acceleration densities of a position that are tried [m²/s³]."""

ANGLE_DENSITIES = np.logspace(-5.0, 1.5, 14)
"""The same of an angle [rad²/s³]; the largest is that of a fall."""

HIDDEN = 0.2
"""An object that no frame shows for so long on its way was hidden on it [s]."""

CALM, WILD = slice(0, None, 2), slice(1, None, 2)
"""Members of a track of what was hidden: that did as little as they may, and as much."""

FELT_WAY_SD = (0.003, np.radians(1.0))
"""By which the place and the heading of what is felt may be off it half-way [m], [rad]."""

MOST_FRAMES = 150
"""Frames of a stretch that are taken as they are; of more, neighbours are averaged."""

PART = 1.0
"""Longest time over which an object is taken to move with one acceleration density [s]."""

LEVEL_SD = np.radians(0.2)
"""Standard deviation from level of what stands level, table and faces together [rad]."""

_GROUPS = (([0, 1, 2], POSITION_DENSITIES), ([3, 4], ANGLE_DENSITIES), ([5], ANGLE_DENSITIES))

_LEVEL_CHI2 = 5.99  # of two angles: 95 % of what stands level seem nearer to it
_MOVED_CHI2 = 30.0  # of six coordinates: seen of one in 25,000 that did not move
_EXACTLY = 1e-9  # sine of a tilt that has no direction
_FEW = 10  # rests of fewer frames tell nothing of the noise
_ANYWHERE = (0.5, 1.0)  # standard deviations of what is not seen again [m], [rad]
_SWEEPS = 2  # over the parts of a way, one density after the other
_TINY = 1e-5  # least noise: exact frames differ by rounding [m], [rad]


@dataclass(frozen=True)
class CameraSheet:
    """Standard deviations of a camera: noise in each frame, and constant errors.

    Attributes:
        position, angle: of a frame, along and about each axis of W [m], [rad].
        position_bias, heading_bias: constant for each object [m], [rad].
    """

    position: float
    angle: float
    position_bias: float = 0.0
    heading_bias: float = 0.0


@dataclass(frozen=True, eq=False)
class FeltEnd:
    """How far a stretch moved its object, as touch alone tells it.

    Attributes:
        way: of the fingertips in W, shape (3,) [m].
        lever: from where they began to where the object's origin was, shape (2,) [m].
        turn: by which it turned about them [rad].
        swing: by which it was tilted, shape (2,) [rad].
        way_sd: standard deviations, shape (3,) [m].
        turn_sd, swing_sd: standard deviations [rad].
        lean_sd: the same of a lean half-way [rad].
    """

    way: Array
    lever: Array
    turn: float
    swing: Array
    way_sd: Array
    turn_sd: float
    swing_sd: float
    lean_sd: float

    def after(self, starts: Array, rng: np.random.Generator) -> Array:
        """Draws of where it ends from where it began, their mean last, shape (k + 1, 6) each."""
        mean = np.array([*self.way, *self.swing, self.turn])
        sd = np.array([*self.way_sd, self.swing_sd, self.swing_sd, self.turn_sd])
        off = mean + sd * _white(rng, (len(starts) - 1, 6))
        c, s = np.cos(off[:, 5]) - 1.0, np.sin(off[:, 5])
        off[:, 0] += c * self.lever[0] - s * self.lever[1]
        off[:, 1] += s * self.lever[0] + c * self.lever[1]
        return np.asarray(starts + off)


@dataclass(frozen=True)
class Stretch:
    """A stretch of time in which an object is worked on.

    Attributes:
        begin, end: on the robot's clock [s].
        held: it is in the hand afterwards, so that it need not be level.
        felt: where the object went by touch alone; None if that does not tell.
    """

    begin: float
    end: float
    held: bool = False
    felt: FeltEnd | None = None

    @property
    def edges(self) -> Array:
        """Of its parts, from 0 to its length, shape (p + 1,) [s]."""
        length = self.end - self.begin
        return np.linspace(0.0, length, int(np.ceil(length / PART)) + 1)


@dataclass(frozen=True, eq=False)
class PoseTrack:
    """An object over time.

    Attributes:
        mean: poses X_WB, quaternions (w, x, y, z) and positions, shape (n, 7).
        members: draws of the same, shape (k, n, 7).
        moved: its pose changed from the first rest to the last; None if one of them shows nothing.
        hidden: neither frames nor touch tell its way or its end; see `CALM`.
    """

    mean: Array
    members: Array
    moved: bool | None
    hidden: bool

    def over(self, n: int) -> PoseTrack:
        """The track of what stands still, over n samples."""
        mean, members = self.mean[-1:], self.members[:, -1:]
        return replace(
            self,
            mean=np.broadcast_to(mean, (n, 7)),
            members=np.broadcast_to(members, (len(members), n, 7)),
        )


def pose_track(
    sightings: Array,
    time: Array,
    stretches: Sequence[Stretch],
    sheet: CameraSheet,
    members: int,
    rng: np.random.Generator,
    *,
    moves: bool,
) -> PoseTrack | None:
    """The track of one object; None if it was not seen before it was worked on.

    Args:
        sightings: time of exposure, quaternion (w, x, y, z) and position, shape (m, 8).
        time: of the samples of the track, increasing, shape (n,) [s].
        stretches: in which it is worked on, in order of time.
        sheet: of the camera.
        members: how many draws.
        rng: of what is drawn.
        moves: it is worked on itself; else it is still, unless it is seen to have moved.
    """
    at = sightings[:, 0]
    rests = _rests(at, stretches)
    if not len(rests[0]):
        return None
    frames = _Coordinates.of(sightings, rests[0], sheet).with_noise_of(rests)
    moved = frames.moved(rests[0], rests[-1]) if stretches else False
    if not moves and not moved:
        level = frames.level(np.arange(len(at)), held=False)
        track = frames.track(level.draws(members, rng)[:, None], rng, moved, moved is None)
        return track.over(len(time))
    held = [False, *(stretch.held for stretch in stretches)]
    levels = [frames.level(rest, held=h) for rest, h in zip(rests, held, strict=True)]
    ends = [level.draws(members, rng) for level in levels]
    for i, stretch in enumerate(stretches):
        if len(rests[i + 1]):
            continue
        if stretch.felt is not None:
            ends[i + 1] = stretch.felt.after(ends[i], rng)
        else:
            ends[i + 1][CALM] = ends[i][CALM]
    values = np.repeat(ends[0][:, None], len(time), axis=1)
    hidden = any(
        not len(rest) and stretch.felt is None
        for rest, stretch in zip(rests[1:], stretches, strict=True)
    )
    for i, stretch in enumerate(stretches):
        within = np.flatnonzero((at > stretch.begin) & (at < stretch.end))
        way = _Way(stretch, at[within], frames.values[within], frames.noise)
        hidden |= way.is_hidden
        on, after = (time > stretch.begin) & (time < stretch.end), time >= stretch.end
        values[:, on] = way.tracks(time[on], ends[i], ends[i + 1], rng)
        values[:, after] = ends[i + 1][:, None]
    return frames.track(values, rng, moved, hidden)


def _rests(at: Array, stretches: Sequence[Stretch]) -> list[NDArray[np.intp]]:
    """Frames before, between and after the stretches."""
    begins = [-np.inf, *(s.end for s in stretches)]
    ends = [*(s.begin for s in stretches), np.inf]
    return [np.flatnonzero((at >= a) & (at <= b)) for a, b in zip(begins, ends, strict=True)]


@dataclass(frozen=True, eq=False)
class _Level:
    """Where an object stands: position, swing and turn, mean and standard deviation, (6,) each."""

    mean: Array
    sd: Array

    def draws(self, members: int, rng: np.random.Generator) -> Array:
        """Draws of where it stands, and the mean as one more, shape (members + 1, 6)."""
        return np.asarray(self.mean + self.sd * _white(rng, (members, 6)))


@dataclass(frozen=True, eq=False)
class _Coordinates:
    """Frames as positions, swings and turns, (m, 6), with the attitude that these start from."""

    values: Array
    start: Rotation
    noise: Array
    sheet: CameraSheet

    @classmethod
    def of(cls, sightings: Array, first: NDArray[np.intp], sheet: CameraSheet) -> _Coordinates:
        R_WB = Rotation.from_quat(sightings[:, [2, 3, 4, 1]])
        start = _level(R_WB[first].mean(), len(first), sheet)
        swings, turns = swing_and_turn(R_WB * start.inv())
        values = np.column_stack([sightings[:, 5:8], swings, turns])
        noise = np.repeat([max(sheet.position, _TINY), max(sheet.angle, _TINY)], 3)
        return cls(values, start, noise, sheet)

    def with_noise_of(self, rests: Sequence[NDArray[np.intp]]) -> _Coordinates:
        """The same with the noise that the rests show, where it is the larger one."""
        rests = [rest for rest in rests if len(rest) >= _FEW]
        if not rests:
            return self
        off = [self.values[rest] - self.values[rest].mean(axis=0) for rest in rests]
        free = sum(len(rest) - 1 for rest in rests)
        squares = np.sum([np.sum(each**2, axis=0) for each in off], axis=0)
        seen = np.sqrt(squares.reshape(2, 3).sum(axis=1) / (3 * free))
        noise = np.maximum(self.noise, np.repeat(seen, 3))
        return _Coordinates(self.values, self.start, noise, self.sheet)

    def level(self, rest: NDArray[np.intp], *, held: bool) -> _Level:
        """Where it stands during some frames; anywhere if there are none."""
        if not len(rest):
            return _Level(self.values.mean(axis=0), np.repeat(_ANYWHERE, 3))
        mean, sd = self.values[rest].mean(axis=0), self.noise / np.sqrt(len(rest))
        swing = mean[3:5]
        if not held and swing @ swing < _LEVEL_CHI2 * sd[3] ** 2:
            share = LEVEL_SD**2 / (LEVEL_SD**2 + sd[3] ** 2)
            mean[3:5], sd[3:5] = share * swing, np.sqrt(share) * sd[3]
        return _Level(mean, sd)

    def moved(self, first: NDArray[np.intp], last: NDArray[np.intp]) -> bool | None:
        """Whether it stands elsewhere in the end; None if it is not seen then."""
        if not len(last):
            return None
        apart = self.values[last].mean(axis=0) - self.values[first].mean(axis=0)
        sd = self.noise * np.sqrt(1.0 / len(first) + 1.0 / len(last))
        return bool(np.sum((apart / sd) ** 2) > _MOVED_CHI2)

    def track(
        self, values: Array, rng: np.random.Generator, moved: bool | None, hidden: bool
    ) -> PoseTrack:
        """The track of coordinates, (k + 1, n, 6), the mean last, with the constant errors."""
        shift = self.sheet.position_bias * _white(rng, (len(values) - 1, 3))
        turn = self.sheet.heading_bias * _white(rng, (len(values) - 1,))
        poses = np.array([self._poses(one, by) for one, by in zip(values, turn, strict=True)])
        poses[:, :, 4:] += shift[:, None]
        return PoseTrack(poses[-1], poses[:-1], moved, hidden)

    def _poses(self, values: Array, heading: float) -> Array:
        swing = np.column_stack([values[:, 3:5], np.zeros(len(values))])
        turn = np.column_stack([np.zeros((len(values), 2)), values[:, 5] + heading])
        R_WB = Rotation.from_rotvec(swing) * Rotation.from_rotvec(turn) * self.start
        return np.column_stack([R_WB.as_quat()[:, [3, 0, 1, 2]], values[:, :3]])


def _level(R_WB: Rotation, frames: int, sheet: CameraSheet) -> Rotation:
    """The attitude with its axis nearest to the vertical made vertical, if it may be that."""
    matrix = R_WB.as_matrix()
    axis = int(np.argmax(np.abs(matrix[2])))
    up = matrix[:, axis] * np.sign(matrix[2, axis])
    tilt = float(np.arccos(np.clip(up[2], -1.0, 1.0)))
    about = np.cross(up, [0.0, 0.0, 1.0])
    if (
        np.linalg.norm(about) < _EXACTLY
        or frames * tilt**2 > _LEVEL_CHI2 * max(sheet.angle, _TINY) ** 2
    ):
        return R_WB
    return Rotation.from_rotvec(tilt * about / np.linalg.norm(about)) * R_WB


def swing_and_turn(rotations: Rotation) -> tuple[Array, Array]:
    """Rotations as a swing about a horizontal axis after a turn about the vertical.

    Returns:
        Swings s, shape (m, 2), and turns ψ, unwrapped, shape (m,) [rad].
    """
    _x, _y, z, w = rotations.as_quat().T
    turns = np.unwrap(2.0 * np.arctan2(z, w))
    back = Rotation.from_rotvec(np.column_stack([np.zeros((len(turns), 2)), -turns]))
    return np.asarray((rotations * back).as_rotvec()[:, :2]), np.asarray(turns)


def _white(rng: np.random.Generator, shape: tuple[int, ...]) -> Array:
    """Standard normal numbers of members, and zeros for their mean as one more."""
    return np.concatenate([rng.standard_normal(shape), np.zeros((1, *shape[1:]))])


class _Way:
    """The frames of a stretch: what they say of an object between two rests.

    Args:
        stretch: of time.
        at: times of its frames [s].
        values: coordinates in them, shape (m, 6).
        noise: standard deviation of each, shape (6,).
    """

    def __init__(self, stretch: Stretch, at: Array, values: Array, noise: Array) -> None:
        edges = np.concatenate([[stretch.begin], at, [stretch.end]])
        unseen = bool(np.diff(edges).max() > HIDDEN)
        self._felt = stretch.felt if unseen else None
        self.is_hidden = unseen and self._felt is None
        self._begin, self._edges = stretch.begin, stretch.edges
        self._length = float(self._edges[-1])
        stride = max(1, -(-len(at) // MOST_FRAMES))
        whole = len(at) // stride * stride
        self._at = at[:whole].reshape(-1, stride).mean(axis=1) - stretch.begin
        self._values = values[:whole].reshape(-1, stride, 6).mean(axis=1)
        self._noise = noise / np.sqrt(stride)

    def tracks(self, time: Array, start: Array, end: Array, rng: np.random.Generator) -> Array:
        """Draws of the track between ends, and its mean as the last.

        Args:
            time: at which they are wanted, shape (n,) [s].
            start: of each, shape (k + 1, 6).
            end: of each, of the same shape.
            rng: of what is drawn.

        Returns:
            Shape (k + 1, n, 6).
        """
        knots, k = self._knots(), len(start)
        bridge, seen = Bridge(knots, self._edges), np.searchsorted(knots, self._at)
        found = np.empty((k, len(knots), 6))
        # A position, a swing and a turn each move alike in all their coordinates.
        for group, densities in _GROUPS:
            sd = float(self._noise[group[0]])
            white = _white(rng, (k - 1, len(knots), len(group)))
            noise = sd * _white(rng, (k - 1, len(seen), len(group)))
            ends = start[:, None, group], end[:, None, group]
            for rows, q in self._densities(bridge.at(seen), group, densities, ends):
                prior, ramp = bridge.given(q)
                free = ends[0][rows] + ramp[:, None] * (ends[1] - ends[0])[rows]
                free = free + _root(prior) @ white[rows]
                said = self._values[:, group] - free[:, seen] - noise[rows]
                gain = _gain(prior[:, seen], prior[np.ix_(seen, seen)], sd)
                found[rows, :, group[0] : group[-1] + 1] = free + gain @ said
        return _interpolated(time - self._begin, knots, found)

    def _densities(
        self, bridge: Bridge, group: list[int], densities: Array, ends: tuple[Array, Array]
    ) -> list[tuple[slice, Array]]:
        """Acceleration densities of the parts, and the draws for which they are."""
        alike = np.ones(bridge.parts)
        if self.is_hidden:
            return [(CALM, densities[0] * alike), (WILD, densities[-1] * alike)]
        if self._felt is not None:
            place_sd, turn_sd = FELT_WAY_SD
            most = {0: place_sd, 3: self._felt.lean_sd, 5: turn_sd}[group[0]]
            half_way = float(Bridge(0.5 * self._edges[-1:], self._edges).given(alike)[0][0, 0])
            return [(slice(None), most**2 / half_way * alike)]
        values, sd = self._values[:, group], float(self._noise[group[0]])
        between = ends[0][-1], ends[1][-1]
        return [(slice(None), _likeliest(densities, bridge, values, between, sd))]

    def _knots(self) -> Array:
        """Times of a track from its begin on: its ends, its frames, and what no frame shows."""
        between = np.arange(0.0, self._length, 0.5 * HIDDEN)
        apart = np.abs(between[:, None] - self._at[None]).min(axis=1, initial=np.inf)
        unseen = between[apart > 0.25 * HIDDEN]
        return np.unique(np.concatenate([[0.0, self._length], self._at, unseen]))


def _gain(across: Array, inner: Array, sd: float) -> Array:
    """What a way makes of frames off it, shape (n, m): C (C + σ²)⁻¹."""
    if not len(inner):
        return np.zeros((len(across), 0))
    known = cho_factor(inner + sd**2 * np.eye(len(inner)))
    return np.asarray(cho_solve(known, across.T).T)


def _interpolated(at: Array, knots: Array, values: Array) -> Array:
    """Values at some times, straight between the knots, shapes (n,), (m,), (k, m, c)."""
    right = np.clip(np.searchsorted(knots, at), 1, len(knots) - 1)
    share = (at - knots[right - 1]) / (knots[right] - knots[right - 1])
    low, high = values[:, right - 1], values[:, right]
    return np.asarray(low + share[:, None] * (high - low))


class Bridge:
    """A way between two rests whose acceleration is white, of one density in each of its parts.

    The integrated Wiener process x from rest, cov(x(s), x(t)) = Σ q_i ∫ (s − u) (t − u) du over
    part i up to the earlier one of s and t, given that it comes to rest at the end.

    Args:
        at: times from the begin, shape (n,) [s].
        edges: of the parts, from 0 to the length of the way, shape (p + 1,) [s].
    """

    def __init__(self, at: Array, edges: Array) -> None:
        a, b = edges[:-1, None, None], edges[1:, None, None]
        length, s, t = edges[-1], at[:, None], at[None, :]
        self.parts = len(edges) - 1
        self._free = _positions(s, t, a, b)
        ends = np.broadcast_arrays(_positions(s, length, a, b), _rates(s, a, b))
        self._to_end = np.concatenate(ends, axis=2)
        both, rate = _positions(length, length, a, b), _rates(length, a, b)
        self._end = np.concatenate(
            [np.concatenate([both, rate], axis=2), np.concatenate([rate, b - a], axis=2)], axis=1
        )

    def at(self, chosen: NDArray[np.intp]) -> Bridge:
        """The same at some of its times."""
        some = copy(self)
        some._free = self._free[:, chosen[:, None], chosen]
        some._to_end = self._to_end[:, chosen]
        return some

    def given(self, densities: Array) -> tuple[Array, Array]:
        """Covariance of the way, shape (n, n), and its mean from 0 to 1, shape (n,).

        Args:
            densities: q of each part, shape (p,).
        """
        free, to_end, end = (
            np.tensordot(densities, each, 1) for each in (self._free, self._to_end, self._end)
        )
        gain = np.linalg.solve(end, to_end.T).T
        return free - gain @ to_end.T, np.asarray(gain[:, 0])


def _positions(s: Array | float, t: Array | float, a: Array, b: Array) -> Array:
    """∫ (s − u) (t − u) du from a to b, but no further than s and t."""
    v = np.clip(np.minimum(s, t), a, b)
    return s * t * (v - a) - (s + t) * (v**2 - a**2) / 2.0 + (v**3 - a**3) / 3.0


def _rates(s: Array | float, a: Array, b: Array) -> Array:
    """∫ (s − u) du from a to b, but no further than s."""
    v = np.clip(s, a, b)
    return np.asarray(s * (v - a) - (v**2 - a**2) / 2.0)


def _root(covariance: Array) -> Array:
    """A matrix A with A Aᵀ = covariance, which may be singular."""
    values, vectors = eigh(covariance)
    return np.asarray(vectors * np.sqrt(np.clip(values, 0.0, None)))


def _likeliest(
    densities: Array, bridge: Bridge, values: Array, ends: tuple[Array, Array], sd: float
) -> Array:
    """The densities of the parts under which what is seen is most likely, shape (p,).

    They are sought one after the other, from the same one for all parts.

    Args:
        densities: that are tried, shape (g,).
        bridge: at the times of the frames.
        values: what is seen, shape (m, c).
        ends: where it begins and where it ends, shape (1, c) each.
        sd: of the noise.
    """

    def unlikely(q: Array) -> float:
        prior, ramp = bridge.given(q)
        known = cho_factor(prior + sd**2 * np.eye(len(values)), lower=True)
        off = values - (ends[0] + ramp[:, None] * (ends[1] - ends[0]))
        log_det = 2.0 * float(np.log(known[0].diagonal()).sum())
        return float(values.shape[1] * log_det + np.sum(off * cho_solve(known, off)))

    def best(of: list[Array]) -> Array:
        return min(of, key=unlikely)

    found = best([np.full(bridge.parts, q) for q in densities])
    for _sweep in range(_SWEEPS if bridge.parts > 1 else 0):
        for i in range(bridge.parts):
            found = best([np.where(np.arange(bridge.parts) == i, q, found) for q in densities])
    return found

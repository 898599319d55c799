"""Where objects were over time, as far as a camera's frames tell it: a mean and an ensemble.

Model: an object stands still but for the stretches in which it is worked on. While it stands, each
of its coordinates is constant, and n frames tell it to σ/√n. On its way a coordinate is an
integrated Wiener process with acceleration density q, tied at both ends to where it stood, at rest;
q is the one that makes the frames of that stretch most likely [rasmussen-2006]. Members of the
ensemble are joint draws, so that any function of a track, its largest tilt as well, has its own
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
"""By which what is felt all the way may be off it half-way [m], [rad]."""

MOST_FRAMES = 300
"""Frames of a stretch that are taken as they are; of more, neighbours are averaged."""

LEVEL_SD = np.radians(0.2)
"""Standard deviation from level of what stands level, table and faces together [rad]."""

_GROUPS = (([0, 1, 2], POSITION_DENSITIES), ([3, 4], ANGLE_DENSITIES), ([5], ANGLE_DENSITIES))

_LEVEL_CHI2 = 5.99  # of two angles: 95 % of what stands level seem nearer to it
_MOVED_CHI2 = 30.0  # of six coordinates: seen of one in 25,000 that did not move
_EXACTLY = 1e-9  # sine of a tilt that has no direction
_FEW = 10  # rests of fewer frames tell nothing of the noise
_ANYWHERE = (0.5, 1.0)  # standard deviations of what is not seen again [m], [rad]
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
        shift: of its place in W, shape (3,) [m].
        swing: by which it was tilted, shape (2,) [rad].
        shift_sd: standard deviations, shape (3,) [m].
        swing_sd, turn_sd: standard deviations [rad].
    """

    shift: Array
    swing: Array
    shift_sd: Array
    swing_sd: float
    turn_sd: float

    def after(self, starts: Array, rng: np.random.Generator) -> Array:
        """Draws of where it ends from where it began, their mean last, shape (k + 1, 6) each."""
        mean = np.array([*self.shift, *self.swing, 0.0])
        sd = np.array([*self.shift_sd, self.swing_sd, self.swing_sd, self.turn_sd])
        return np.asarray(starts + mean + sd * _white(rng, (len(starts) - 1, 6)))


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
        self._is_felt = unseen and stretch.felt is not None
        self.is_hidden = unseen and not self._is_felt
        self._begin, self._length = stretch.begin, stretch.end - stretch.begin
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
        prior, ramp = bridge(knots, self._length)
        seen = np.searchsorted(knots, self._at)
        inner = prior[np.ix_(seen, seen)]
        spread, vectors = eigh(inner) if len(seen) else (np.zeros(0), np.zeros((0, 0)))
        root = _root(prior)
        found = np.empty((k, len(knots), 6))
        # A position, a swing and a turn each move alike in all their coordinates.
        for group, densities in _GROUPS:
            sd = float(self._noise[group[0]])
            straight = start[:, None, group] + ramp[:, None] * (end - start)[:, None, group]
            white = _white(rng, (k - 1, len(knots), len(group)))
            noise = sd * _white(rng, (k - 1, len(seen), len(group)))
            if self.is_hidden:
                ways = [(CALM, densities[0]), (WILD, densities[-1])]
            elif self._is_felt:
                most = FELT_WAY_SD[group != [0, 1, 2]]
                ways = [(slice(None), most**2 / max(float(prior.diagonal().max()), _EXACTLY))]
            else:
                off = self._values[:, group] - straight[-1, seen]
                ways = [(slice(None), _likeliest(densities, spread, vectors, off, sd))]
            for rows, q in ways:
                free = straight[rows] + np.sqrt(q) * (root @ white[rows])
                said = self._values[:, group] - free[:, seen] - noise[rows]
                gain = _gain(float(q), prior[:, seen], inner, sd)
                found[rows, :, group[0] : group[-1] + 1] = free + gain @ said
        return _interpolated(time - self._begin, knots, found)

    def _knots(self) -> Array:
        """Times of a track from its begin on: its ends, its frames, and what no frame shows."""
        between = np.arange(0.0, self._length, 0.5 * HIDDEN)
        apart = np.abs(between[:, None] - self._at[None]).min(axis=1, initial=np.inf)
        unseen = between[apart > 0.25 * HIDDEN]
        return np.unique(np.concatenate([[0.0, self._length], self._at, unseen]))


def _gain(q: float, across: Array, inner: Array, sd: float) -> Array:
    """What a way makes of frames off it, shape (n, m): q C (q C + σ²)⁻¹."""
    if not len(inner):
        return np.zeros((len(across), 0))
    known = cho_factor(q * inner + sd**2 * np.eye(len(inner)))
    return np.asarray(cho_solve(known, q * across.T).T)


def _interpolated(at: Array, knots: Array, values: Array) -> Array:
    """Values at some times, straight between the knots, shapes (n,), (m,), (k, m, c)."""
    right = np.clip(np.searchsorted(knots, at), 1, len(knots) - 1)
    share = (at - knots[right - 1]) / (knots[right] - knots[right - 1])
    low, high = values[:, right - 1], values[:, right]
    return np.asarray(low + share[:, None] * (high - low))


def bridge(at: Array, length: float) -> tuple[Array, Array]:
    """Covariance of a way between two rests with q = 1, and its mean from 0 to 1.

    The integrated Wiener process x from rest, cov(x(s), x(t)) = s² (3 t − s) / 6 for s ≤ t, given
    that x and its rate are 0 at the end.

    Args:
        at: times from the begin, shape (n,) [s].
        length: of the way [s].

    Returns:
        Shapes (n, n) and (n,).
    """
    s, t = np.minimum.outer(at, at), np.maximum.outer(at, at)
    free = s**2 * (3.0 * t - s) / 6.0
    to_end = np.column_stack([at**2 * (3.0 * length - at) / 6.0, at**2 / 2.0])
    end = np.array([[length**3 / 3.0, length**2 / 2.0], [length**2 / 2.0, length]])
    gain = np.linalg.solve(end, to_end.T).T
    return free - gain @ to_end.T, np.asarray(gain[:, 0])


def _root(covariance: Array) -> Array:
    """A matrix A with A Aᵀ = covariance, which may be singular."""
    values, vectors = eigh(covariance)
    return np.asarray(vectors * np.sqrt(np.clip(values, 0.0, None)))


def _likeliest(densities: Array, spread: Array, vectors: Array, off: Array, sd: float) -> float:
    """The density under which what is seen off the straight way is most likely.

    Args:
        densities: that are tried, shape (g,).
        spread: eigenvalues of the way with q = 1, shape (m,).
        vectors: its eigenvectors, shape (m, m).
        off: what is seen, shape (m, c).
        sd: of the noise.
    """
    energy = np.sum((vectors.T @ off) ** 2, axis=1)
    variance = densities[:, None] * np.clip(spread, 0.0, None) + sd**2
    likelihood = -0.5 * np.sum(off.shape[1] * np.log(variance) + energy / variance, axis=1)
    return float(densities[int(np.argmax(likelihood))])

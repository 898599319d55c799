"""Onset of motion of a pressed object, from force and travel over time, and trials from that.

Model: while the object stands, the pressing finger hardly moves and the force rises as the finger's
stiffness is loaded; once it moves, the finger travels and the force stays (a slide) or falls slowly
(a tilt). So the travel over time is two straight lines that meet at the onset. The force there is
read off the line of the force over the travel afterwards; if the object stuck harder than it slides
(static friction above kinetic), off the rise before it. A finger of a stiff arm travels evenly all
the time: then the onset is where the force, as two straight lines over time, stops rising.

In recordings places and forces are in the level axes that B had at their start. What moved is
stated, or read off the object's tilt: force and place of the finger alone do not tell it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import radians
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.rotations import rotate, vector_tuple
from objectmodels.identification.trial import ContactPath, Moved, Trial, Vector

if TYPE_CHECKING:
    from objectmodels.geometry.pushed_body import PushedBody

LEAST_TRAVEL = 0.001
"""Travel after the onset that shows that the object moved [m]."""

LEAST_SAMPLES = 12

_KINK = 3.0  # the finger is so many times as fast after the onset as before
_EVEN = 1.5  # a finger that does not yield is slowed by less than this
_LOADED = 0.5  # share of the largest force that belongs to the rise, and to its end
_AFTER = 0.010  # travel after the onset over which the force is fitted [m]
_RISE = 0.4  # last share of the rise that is fitted before the onset
_STICKS, _STICKS_SURELY = 0.03, 4.0  # a drop counts from this share and so many sd on

_WAY = 0.010  # travel after the onset over which direction and turn are taken [m]
_LAST = 0.1  # share of a recording, at its end, over which a held tilt is averaged
_FORCE_SHARE_SD = 0.01  # least standard deviation of a force as a share of it: tables are uneven
_ANGLE_SD = radians(0.5)  # of a tilt at an instant


@dataclass(frozen=True)
class Onset:
    """The onset of motion in a recording.

    Attributes:
        index: of the first sample at which the object moves.
        time: when [s].
        force: that moved it [N].
        force_sd: its standard deviation from the samples' scatter [N].
        moved: whether an onset is seen; if not, `force` is the largest one.
        travel: of the finger along the push, from its touch to the end [m].
    """

    index: int
    time: float
    force: float
    force_sd: float
    moved: bool
    travel: float


def detect_onset(time: ArrayLike, force: ArrayLike, travel: ArrayLike) -> Onset:
    """The onset of motion in a recording of one touch.

    Args:
        time: of the samples, increasing, shape (n,) [s].
        force: along the push, shape (n,) [N].
        travel: of the fingertip along the push, shape (n,) [m].

    Raises:
        ModelError: `bad_array` if they do not fit together or are fewer than `LEAST_SAMPLES`.
    """
    t, f, x = (np.asarray(a, dtype=np.float64) for a in (time, force, travel))
    if not (t.ndim == 1 and t.shape == f.shape == x.shape and len(t) >= LEAST_SAMPLES):
        raise ModelError(
            "bad_array",
            f"a recording needs time, force and travel of {LEAST_SAMPLES} samples or more",
            suggestions=("give three arrays of one length",),
        )
    if not (np.isfinite([t, f, x]).all() and (np.diff(t) > 0.0).all()):
        raise ModelError(
            "bad_array",
            "a recording must be finite, its times increasing",
            suggestions=("sort it by time, and leave out samples with nan and repeated times",),
        )
    # Running mean; the ends repeat their outermost value.
    width = max(len(f) // 50, 3)
    padded = np.pad(f, (width // 2, width - 1 - width // 2), mode="edge")
    smooth = np.convolve(padded, np.full(width, 1.0 / width), mode="valid")
    # Share of the largest force from which on the finger touches.
    first = int(np.argmax(smooth > 0.05 * smooth.max()))
    first = min(first, len(t) - LEAST_SAMPLES)
    kink, before, after = _two_lines(t[first:], x[first:])
    yields = after > _KINK * max(before, 0.0)
    if not yields:
        end = first + 2 * _rising_samples(smooth[first:])
        if end > first:
            kink, *_ = _two_lines(t[first:end], f[first:end])
            back = max(2 * first - end, 0)  # as much of the approach as of the rise
            yields = _goes_on(t[back:], x[back:], kink)
    begin, gone = first + int(np.searchsorted(t[first:], kink)), float(x[-1] - x[first])
    if not (yields and x[-1] - x[begin] > LEAST_TRAVEL):
        top = int(np.argmax(smooth))
        spread = float(np.std(f - smooth)) / np.sqrt(max(len(f) // 50, 3))
        return Onset(top, float(t[top]), float(smooth[top]), spread, False, gone)
    way = slice(begin, max(int(np.searchsorted(x, x[begin] + _AFTER)), begin + 4))
    sliding, sliding_sd = _line_value(x[way], f[way], x[begin])
    rising = slice(begin - max(int(_RISE * (begin - first)), 4), begin)
    if rising.start >= first:
        sticking, sticking_sd = _line_value(t[rising], f[rising], kink)
        # The averaged force shows a drop without relying on where exactly the kink is.
        drop = min(sticking, float(smooth[first : way.stop].max())) - sliding
        sd = float(np.hypot(sticking_sd, sliding_sd))
        if drop > max(_STICKS * sliding, _STICKS_SURELY * sd):
            return Onset(begin, kink, sticking, sticking_sd, True, gone)
    return Onset(begin, kink, sliding, sliding_sd, True, gone)


def _two_lines(t: Array, x: Array) -> tuple[float, float, float]:
    """Time at which two lines through x(t) meet best, and their slopes before and after."""
    kinks = np.linspace(t[2], t[-3], 200)
    bent = np.maximum(t[:, None] - kinks, 0.0)
    # Least squares of 1, t and the bend, for all candidates at once.
    straight = np.column_stack([np.ones_like(t), t - t[0]])
    q, _ = np.linalg.qr(straight)
    rest = bent - q @ (q.T @ bent)
    left = x - q @ (q.T @ x)
    size = np.sum(rest * rest, axis=0)
    explained = (left @ rest) ** 2 / np.maximum(size, 1e-300)
    best = int(np.argmax(explained))
    bend = float(left @ rest[:, best] / size[best])
    (_, slope), *_ = np.linalg.lstsq(straight, x - bend * bent[:, best], rcond=None)
    return float(kinks[best]), float(slope), float(slope + bend)


def _rising_samples(force: Array) -> int:
    """Samples in which a force rises before it stays for as long; 0 if it never stays or rises."""
    size, i = float(force.max()), np.arange(3, len(force) // 2)
    if force[0] > _LOADED * size:
        return 0
    stays = _KINK * (force[2 * i] - force[i]) < force[i] - force[0]
    (found,) = np.nonzero(stays & (force[i] > _LOADED * size))
    return int(i[found[0]]) if found.size else 0


def _goes_on(t: Array, x: Array, kink: float) -> bool:
    """Return True if the travel goes on after a time no slower than before, nearly."""
    middle = int(np.searchsorted(t, kink))
    before = (x[middle] - x[0]) / max(t[middle] - t[0], 1e-9)
    after = (x[-1] - x[middle]) / max(t[-1] - t[middle], 1e-9)
    return bool(0.0 < before < _EVEN * after)


def _line_value(x: Array, y: Array, place: float) -> tuple[float, float]:
    """Value at a place of the straight line through y(x), and its standard deviation."""
    A = np.column_stack([np.ones_like(x), x - place])
    solution, *_ = np.linalg.lstsq(A, y, rcond=None)
    rest = y - A @ solution
    variance = float(rest @ rest) / max(len(y) - 2, 1)
    inverse = np.linalg.pinv(A.T @ A)
    return float(solution[0]), float(np.sqrt(max(variance * inverse[0, 0], 0.0)))


@dataclass(frozen=True)
class Recording:
    """One touch over time.

    Attributes:
        time: of the n samples, shape (n,) [s].
        force: f_BC on the object, shape (n, 3) [N].
        tip: place of the fingertip's contact, shape (n, 3) [m].
        yaw: turn of the object, counter-clockwise, shape (n,) [rad]; None if not recorded.
        tilt: of the object, shape (n,) [rad]; None if not recorded.
        moved: what moved, if it was stated.
        end: x, y [m], θ [rad] of B at the end, in B at the start; None if not recorded.
        repetition: as of `Trial`.
        source: what to call it in messages.
    """

    time: Array
    force: Array
    tip: Array
    yaw: Array | None = None
    tilt: Array | None = None
    moved: Moved | None = None
    end: Vector | None = None
    repetition: int = 0
    source: str = "a recording"


def trial_from_series(recording: Recording) -> tuple[Trial | None, Onset]:
    """The trial at the onset of motion in a recording, None if none is seen, and the onset.

    Raises:
        ModelError: `bad_array` if it is too short, or its times do not increase.
    """
    force, tip = recording.force, recording.tip
    d = _push_direction(recording)
    travel = (tip - tip[0]) @ d
    onset = detect_onset(recording.time, force @ d, travel)
    if not onset.moved:
        return None, onset
    whole = slice(onset.index, None)
    way = _samples_after_onset(travel, onset.index) if recording.end is None else whole
    mean = _forces_in_body(recording, travel, onset.index)[way].mean(axis=0)
    if mean @ d <= 0.0 or onset.force <= 0.0:
        raise ModelError(
            "bad_array",
            "the force is against the travel of the finger",
            suggestions=("give the force on the object; a sensor in the finger feels −force",),
        )
    # The size is the onset's; what acts across the push is the mean on the way.
    found = onset.force * mean / (mean @ d)
    size = float(np.linalg.norm(found))
    moved = recording.moved or ("topple" if _held_tilt(recording) else "slide")
    point = vector_tuple(tip[onset.index])
    rate, rate_sd, drift = None, None, None
    if moved == "slide":
        rate, rate_sd, drift = _slide_motion(recording, travel, way, point, vector_tuple(found))
    trial = Trial(
        moved=moved,
        point=point,
        force=vector_tuple(found),
        force_sd=float(np.hypot(onset.force_sd * size / onset.force, _FORCE_SHARE_SD * size)),
        turn_rate=rate,
        turn_rate_sd=rate_sd,
        drift=drift,
        repetition=recording.repetition,
        source=recording.source,
    )
    return trial, onset


def tilted_trial(recording: Recording, onset: Trial, model: PushedBody) -> Trial | None:
    """The balance at the end of a recording in which the object is held tilted, if it is one.

    The trial at the onset is a topple; the model's base has the edge about which it tilts.
    """
    if recording.tilt is None or onset.moved != "topple" or not _held_tilt(recording):
        return None
    last = slice(-max(int(_LAST * len(recording.time)), 3), None)
    tilt = float(recording.tilt[last].mean())
    force = recording.force[last].mean(axis=0)
    u = np.array(onset.force[:2])
    n = np.append(model.base.facing_normal(u / np.linalg.norm(u)), 0.0)
    d = float(model.base.extent(n[:2]))
    # The point of the object where the finger now is: turned back about the edge.
    tip = recording.tip[last].mean(axis=0)
    along, up = float(n @ tip) - d, float(tip[2])
    back = along * np.cos(tilt) - up * np.sin(tilt)
    height = along * np.sin(tilt) + up * np.cos(tilt)
    point = tip + (back - along) * n + [0.0, 0.0, height - up]
    scatter = float(recording.force[last].std(axis=0).max())
    return replace(
        onset,
        point=vector_tuple(point),
        force=vector_tuple(force),
        force_sd=float(np.hypot(scatter, _FORCE_SHARE_SD * np.linalg.norm(force))),
        tilt=tilt,
        tilt_sd=_ANGLE_SD,
        source=f"{onset.source}, held at {np.degrees(tilt):.0f}°",
    )


def _push_direction(recording: Recording) -> Array:
    """Unit direction of the finger's travel, or of the mean force if it hardly travels."""
    way = recording.tip[-1] - recording.tip[0]
    if np.linalg.norm(way) < LEAST_TRAVEL:
        way = recording.force.mean(axis=0)
    length = float(np.linalg.norm(way))
    if length == 0.0:
        raise ModelError(
            "bad_array",
            "there is neither force nor travel in it",
            suggestions=("leave this recording out",),
        )
    return np.asarray(way / length)


def _samples_after_onset(travel: Array, begin: int) -> slice:
    """Samples from the onset on, over the way that is looked at."""
    beyond = np.flatnonzero(travel[begin:] > travel[begin] + _WAY)
    return slice(begin, max(begin + int(beyond[0]) if beyond.size else len(travel), begin + 3))


def _forces_in_body(recording: Recording, travel: Array, begin: int) -> Array:
    """Forces in the axes of B, which turn with it from the onset on, shape (n, 3) [N]."""
    yaw = recording.yaw
    if recording.end is not None:
        # Seen before and after alone, it is taken to turn evenly with the finger's travel.
        gone = (travel - travel[begin]) / max(float(travel[-1] - travel[begin]), LEAST_TRAVEL)
        yaw = recording.end[2] * np.clip(gone, 0.0, 1.0)
    if yaw is None:
        return recording.force
    level = rotate(recording.force[:, :2], -yaw)
    return np.column_stack((level, recording.force[:, 2]))


def _slide_motion(
    recording: Recording, travel: Array, way: slice, point: Vector, force: Vector
) -> tuple[float | None, float | None, float | None]:
    """Turn over the travel after the onset, its standard deviation [rad/m], and the drift."""
    if recording.end is not None:
        path = ContactPath.between_poses(point, force, recording.end)
        if path.travel < LEAST_TRAVEL:
            raise ModelError(
                "bad_array",
                f"the contact went {path.travel:g} m along the force, by the pose at the end",
                suggestions=("poses are in the axes of the object at the start",),
            )
        return path.turn / path.travel, _ANGLE_SD / path.travel, path.drift
    if recording.yaw is None:
        return None, None, None
    x, y = travel[way] - travel[way].mean(), recording.yaw[way] - recording.yaw[way].mean()
    size = float(x @ x)
    if size <= 0.0:
        return None, None, None
    rate = float(x @ y) / size
    rest = y - rate * x
    scatter = float(np.sqrt(rest @ rest / max(len(x) - 2, 1) / size))
    # A small share of the whole angle's own error: cameras drift.
    doubt = 0.2 * _ANGLE_SD / max(float(np.ptp(travel[way])), 1e-3)
    return rate, float(np.hypot(scatter, doubt)), None


def _held_tilt(recording: Recording) -> bool:
    # A recording in which the object tilts by this is of a topple, else of a slide [rad].
    return recording.tilt is not None and float(recording.tilt[-1]) > radians(2.0)

"""Onset of motion of a pressed object, from force and travel over time.

Model: while the object stands, the pressing finger hardly moves and the force rises as the finger's
stiffness is loaded; once it moves, the finger travels and the force stays (a slide) or falls slowly
(a tilt). So the travel over time is two straight lines that meet at the onset. The force there is
read off the line of the force over the travel afterwards; if the object stuck harder than it slides
(static friction above kinetic), off the rise before it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array

LEAST_TRAVEL = 0.001
"""Travel after the onset that shows that the object moved [m]."""

LEAST_SAMPLES = 12

_TOUCHED = 0.05  # share of the largest force from which on the finger touches
_CANDIDATES = 200
_KINK = 3.0  # the finger is so many times as fast after the onset as before
_AFTER = 0.010  # travel after the onset over which the force is fitted [m]
_RISE = 0.4  # last share of the rise that is fitted before the onset
_STICKS, _STICKS_SURELY = 0.03, 4.0  # a drop counts from this share and so many sd on


@dataclass(frozen=True)
class Onset:
    """The onset of motion in a recording.

    Attributes:
        index: of the first sample at which the object moves.
        time: when [s].
        force: that moved it [N].
        force_sd: its standard deviation from the samples' scatter [N].
        moved: whether it moved at all; if not, `force` is the largest that it withstood.
    """

    index: int
    time: float
    force: float
    force_sd: float
    moved: bool


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
        )
    if not (np.isfinite([t, f, x]).all() and (np.diff(t) > 0.0).all()):
        raise ModelError("bad_array", "a recording must be finite, its times increasing")
    smooth = _running_mean(f, max(len(f) // 50, 3))
    first = int(np.argmax(smooth > _TOUCHED * smooth.max()))
    first = min(first, len(t) - LEAST_SAMPLES)
    kink, before, after = _two_lines(t[first:], x[first:])
    begin = first + int(np.searchsorted(t[first:], kink))
    moved = x[-1] - x[begin] > LEAST_TRAVEL and after > _KINK * max(before, 0.0)
    if not moved:
        top = int(np.argmax(smooth))
        spread = float(np.std(f - smooth)) / np.sqrt(max(len(f) // 50, 3))
        return Onset(top, float(t[top]), float(smooth[top]), spread, moved=False)
    later = slice(begin, max(int(np.searchsorted(x, x[begin] + _AFTER)), begin + 4))
    sliding, sliding_sd = _line_value(x[later], f[later], x[begin])
    rising = slice(begin - max(int(_RISE * (begin - first)), 4), begin)
    if rising.start >= first:
        sticking, sticking_sd = _line_value(t[rising], f[rising], kink)
        # The averaged force shows a drop without relying on where exactly the kink is.
        drop = min(sticking, float(smooth[first : later.stop].max())) - sliding
        sd = float(np.hypot(sticking_sd, sliding_sd))
        if drop > max(_STICKS * sliding, _STICKS_SURELY * sd):
            return Onset(begin, kink, sticking, sticking_sd, moved=True)
    return Onset(begin, kink, sliding, sliding_sd, moved=True)


def _running_mean(f: Array, width: int) -> Array:
    """Running mean; the ends repeat their outermost value."""
    padded = np.pad(f, (width // 2, width - 1 - width // 2), mode="edge")
    return np.convolve(padded, np.full(width, 1.0 / width), mode="valid")


def _two_lines(t: Array, x: Array) -> tuple[float, float, float]:
    """Time at which two lines through x(t) meet best, and their slopes before and after."""
    kinks = np.linspace(t[2], t[-3], _CANDIDATES)
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


def _line_value(x: Array, y: Array, place: float) -> tuple[float, float]:
    """Value at a place of the straight line through y(x), and its standard deviation."""
    A = np.column_stack([np.ones_like(x), x - place])
    solution, *_ = np.linalg.lstsq(A, y, rcond=None)
    rest = y - A @ solution
    variance = float(rest @ rest) / max(len(y) - 2, 1)
    inverse = np.linalg.pinv(A.T @ A)
    return float(solution[0]), float(np.sqrt(max(variance * inverse[0, 0], 0.0)))

"""What the object models answer with: thresholds, predictions and faces, over whole arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from objectmodels.thresholds import Array

UNDECIDED = 1e-9
"""Relative band in which two thresholds count as equal: the outcome is then `slide+topple`."""


@dataclass(frozen=True)
class Thresholds:
    """Forces at which slow pushes start to move an object; arrays over n pushes.

    Attributes:
        slide: force at which it slides, shape (n,) [N]; inf if the push jams.
        topple: force at which it topples, shape (n,) [N]; inf if it never does.
        onset: the smaller of the two [N].
        outcome: class at the onset: `slide`, `topple`, `slide+topple` (undecided: the two lie
            within the band `UNDECIDED`) or `none` (neither ever happens).
        edge: base edge about which it would topple first, index into `EDGE_NORMALS`; −1 if never.
        twist: incipient twist V_WB in B at the onset, shape (n, 6): angular velocity [rad/s] and
            velocity of B's origin [m/s], for a contact that moves at 1 m/s along its direction;
            nan where the outcome is not decided.
    """

    slide: Array
    topple: Array
    onset: Array
    outcome: NDArray[np.str_]
    edge: NDArray[np.int64]
    twist: Array


@dataclass(frozen=True)
class Prediction:
    """Outcomes of pushes with given forces, applied slowly; arrays over n pushes.

    Attributes:
        outcome: `none` (the force is below the onset) or the class at the onset.
        margin: change of the force or of a threshold at which another class begins, shape (n,)
            [N]: |force − onset|, and for a moving object also |slide − topple|, whichever is less.
        thresholds: what the classes were decided by.
    """

    outcome: NDArray[np.str_]
    margin: Array
    thresholds: Thresholds


@dataclass(frozen=True)
class Face:
    """A side face of a box in B.

    Attributes:
        normal: outward unit normal.
        centre: its middle [m].
        tangent: horizontal unit vector along the face, ẑ × normal.
        width: horizontal extent [m].
        height: vertical extent [m].
    """

    normal: tuple[float, float, float]
    centre: tuple[float, float, float]
    tangent: tuple[float, float, float]
    width: float
    height: float


def outcome_at_onset(slide: Array, topple: Array) -> NDArray[np.str_]:
    """Class of what moves first; see `Thresholds.outcome`."""
    onset = np.minimum(slide, topple)
    with np.errstate(invalid="ignore"):
        undecided = np.abs(slide - topple) <= UNDECIDED * onset
    names = np.where(slide < topple, "slide", "topple")
    return np.select([~np.isfinite(onset), undecided], ["none", "slide+topple"], names)


def gap(first: Array, other: Array) -> Array:
    """How much later `other` comes than `first` [N]; −inf where `first` never comes."""
    with np.errstate(invalid="ignore"):
        return np.where(np.isinf(first), -np.inf, other - first)

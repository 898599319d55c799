"""Statistics of a parameter over repetitions of the experiments that find it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Statistics:
    """A line of the paper's Table I.

    Attributes:
        mean: over the repetitions.
        sd: standard deviation of one repetition; None of a single one.
        percent: the same in per cent of the mean.
        least: smallest value.
        most: largest value.
        n: number of repetitions with a value.
    """

    mean: float
    sd: float | None
    percent: float | None
    least: float
    most: float
    n: int

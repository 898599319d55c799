"""What something weighs that the hand holds: the finger joints' torques tell.

Model: the fingertips' forces balance the weight, τ = Jᵀf at each of them. While the hand hangs
still the sensors' noise is white; what they read before the fingers touched was taken off, so its
noise adds to that of the mean. Where exactly a fingertip touches is known to a share of its lever.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.rotations import Array

LEVER_ERROR = 0.01
"""Relative standard deviation of a weight by the levers of the fingertips' contacts."""


@dataclass(frozen=True)
class Weight:
    """A weight as it was felt.

    Attributes:
        mean, sd: the weight and its standard deviation [N].
        samples: control steps over which it was felt.
    """

    mean: float
    sd: float
    samples: int


def weight(vertical: Array, zero_samples: int) -> Weight:
    """The weight of what is held still.

    Args:
        vertical: force of all fingertips upwards in each control step, shape (n,) [N].
        zero_samples: over how many steps the sensors' zero was taken.
    """
    n = len(vertical)
    noise = float(np.std(vertical, ddof=1)) if n > 1 else float("inf")
    mean = float(np.mean(vertical))
    white = noise * np.sqrt(1.0 / n + 1.0 / max(zero_samples, 1))
    return Weight(mean, float(np.hypot(white, LEVER_ERROR * mean)), n)

"""Made-up recordings of touches."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def made_up(
    onset: float, seconds: float, noise: float, fall: float, *, sticks: float = 1.0, seed: int = 0
) -> tuple[Array, Array, Array]:
    """Time, force and travel of a touch sampled at 100 Hz.

    Args:
        onset: force at which it moves [N].
        seconds: time of the rise [s]; three more follow at 5 mm/s.
        noise: standard deviation of the force [N].
        fall: share of the onset's force lost over those.
        sticks: by how much more the force rises before it moves.
        seed: of the noise.
    """
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, seconds + 3.0, 0.01)
    after = np.maximum(time - seconds, 0.0)
    rise = sticks * onset * np.minimum(time / seconds, 1.0)
    force = np.where(after > 0.0, onset * (1.0 - fall * after / 3.0), rise)
    travel = 1e-5 * np.minimum(time, seconds) + 0.005 * after
    force = force + noise * rng.standard_normal(len(time))
    return time, force, travel + 2e-5 * rng.standard_normal(len(time))

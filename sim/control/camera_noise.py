"""Noise of the camera in what an even filter makes of its frames."""

from __future__ import annotations

import math


def noise_left(share: float) -> float:
    """Share of a frame's standard deviation that is left where each new frame has a weight."""
    return math.sqrt(share / (2.0 - share))

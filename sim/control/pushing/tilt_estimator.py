"""How far an object leans: from where the fingertip is, corrected by what the camera shows.

Model: the fingertip on the face tells the tilt at once and without noise, but for what the base has
slid and for what is not known of the object's size; both change slowly. The camera tells it late
and noisily, but wherever the object is. So the mean of what the camera showed lately, less what the
fingertip told at the times of those frames, is added to what the fingertip tells now.
"""

from __future__ import annotations

from collections import deque

import numpy as np

_LEAST_WEIGHT = 0.1  # of a new frame: a third of a second at 30 Hz counts
_TRUSTED = 4.0  # frames that the fingertip's own tilt is worth at the touch


class TiltEstimator:
    """The tilt of an object that a fingertip leans on.

    Args:
        noise: standard deviation of the tilt that a frame shows [rad].

    Attributes:
        own: what the fingertip tells now [rad].
        correction: what the camera adds to it [rad].
    """

    def __init__(self, noise: float) -> None:
        self.own = 0.0
        self.correction = 0.0
        self._noise = noise
        self._frames = 0.0
        self._past: deque[tuple[float, float]] = deque()

    @property
    def tilt(self) -> float:
        """The tilt now [rad]."""
        return self.own + self.correction

    @property
    def unsure(self) -> float:
        """Standard deviation of the correction [rad]."""
        weight = max(1.0 / (_TRUSTED + self._frames), _LEAST_WEIGHT)
        return self._noise * float(np.sqrt(weight / (2.0 - weight)))

    def update_from_tip(self, time: float, own: float) -> None:
        """The fingertip tells a tilt [rad] at a time [s]."""
        self.own = own
        self._past.append((time, own))

    def update_from_camera(self, time: float, tilt: float) -> None:
        """A frame of a time [s], later than those before it, shows a tilt [rad]."""
        while len(self._past) > 1 and self._past[1][0] <= time:
            self._past.popleft()
        _, own = min(self._past, key=lambda past: abs(past[0] - time))
        self._frames += 1.0
        weight = max(1.0 / (_TRUSTED + self._frames), _LEAST_WEIGHT)
        self.correction += weight * (tilt - own - self.correction)

"""The clock on the wall, to which a simulated world is held back while somebody looks."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

_CATCH_UP = 0.1  # of a delay that is made up for; what came before that is let go [s]


class WallClock:
    """A clock that lets steps take no less than real time, or does nothing.

    What happens in a world does not depend on it, but when it happens does.

    Args:
        now: the time [s].
        sleep: waits for so long [s].

    Attributes:
        runs: steps are held back.
    """

    def __init__(
        self,
        now: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], object] = time.sleep,
    ) -> None:
        self._now, self._sleep = now, sleep
        self.runs = False
        self._due = -math.inf

    def wait(self, period: float) -> None:
        """Waits until a step of a period [s] is over by the clock on the wall."""
        if not self.runs:
            return
        now = self._now()
        self._due = max(self._due + period, now - _CATCH_UP)
        if self._due > now:
            self._sleep(self._due - now)

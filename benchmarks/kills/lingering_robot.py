"""A robot that counts its motions, each of which takes a while, so that faults fall into them."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

from objectmodels import ObjectModel
from sim.supervision import Monitor
from sim.traces.trace import Trace
from tests.fakes.counted_executor import CountedExecutor

MOTION_TIME, STEP = 0.3, 0.02
"""Of each motion, and between two questions whether to go on [s]."""


class LingeringRobot(CountedExecutor):
    """It goes on for a while before it has moved; a stop ends that."""

    def execute(self, plan: Any, models: Mapping[str, ObjectModel], progress: Any = None) -> Trace:
        """Carries a plan out; see `Executor`."""
        stop = Monitor.of(progress).stop
        ends = time.monotonic() + MOTION_TIME
        while time.monotonic() < ends:
            stop.check()
            time.sleep(STEP)
        return super().execute(plan, models, progress)

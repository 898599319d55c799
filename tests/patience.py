"""How long tests wait: until something comes, however busy the machine is.

No test measures how long anything takes. The limit here is no judgement; it ends what hangs.
"""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

PATIENCE = 600.0
"""Longest time to wait for anything [s]."""


def wait_until(holds: Callable[[], object], what: str = "it") -> None:
    """Waits until something holds."""
    ends = time.monotonic() + PATIENCE
    while not holds():
        assert time.monotonic() < ends, f"{what} did not come to hold in {PATIENCE:g} s"
        time.sleep(0.02)


@contextmanager
def hang_ended() -> Iterator[None]:
    """Context that fails where it would go on for ever, by the processor's own clock."""

    def fail(number: int, frame: FrameType | None) -> None:
        raise AssertionError(f"it did not end in {PATIENCE:g} s of the processor")

    before = signal.signal(signal.SIGPROF, fail)
    signal.setitimer(signal.ITIMER_PROF, PATIENCE)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)

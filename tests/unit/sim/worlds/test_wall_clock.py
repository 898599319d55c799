"""The clock to which a world is held back while somebody looks."""

from __future__ import annotations

import time

from sim.worlds.wall_clock import WallClock


def seconds_of(clock: WallClock, steps: int) -> float:
    """Time that steps of 10 ms take by the clock on the wall [s]."""
    began = time.monotonic()
    for _ in range(steps):
        clock.wait(0.01)
    return time.monotonic() - began


def test_steps_take_real_time_while_it_runs() -> None:
    clock = WallClock()
    assert seconds_of(clock, 1000) < 0.5  # where 10 s pass: it does not wait at all
    clock.runs = True
    seconds_of(clock, 1)
    # The first steps make up for the 0.1 s before, as after every delay.
    assert seconds_of(clock, 30) >= 0.3 - 0.1 - 0.02
    time.sleep(0.5)
    assert seconds_of(clock, 30) >= 0.3 - 0.1 - 0.02

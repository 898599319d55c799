"""The clock to which a world is held back while somebody looks."""

from __future__ import annotations

import pytest

from sim.worlds.ports import WallClock


class HandSetTime:
    """A time that passes while somebody sleeps, or is moved on by hand."""

    now = 100.0

    def __call__(self) -> float:
        return self.now

    def sleep(self, duration: float) -> None:
        self.now += duration


def seconds_of(clock: WallClock, time: HandSetTime, steps: int) -> float:
    """Time that steps of 10 ms take [s]."""
    began = time.now
    for _ in range(steps):
        clock.wait(0.01)
    return time.now - began


def test_steps_take_real_time_while_it_runs() -> None:
    time = HandSetTime()
    clock = WallClock(time, time.sleep)
    assert seconds_of(clock, time, 1000) == 0.0  # it does not wait at all
    clock.runs = True
    # The first steps make up for the 0.1 s before, as after every delay.
    assert seconds_of(clock, time, 31) == pytest.approx(0.3 - 0.1)
    assert seconds_of(clock, time, 30) == pytest.approx(0.3)
    time.now += 0.5
    assert seconds_of(clock, time, 31) == pytest.approx(0.3 - 0.1)

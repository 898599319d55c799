"""Places in which a command that went no further leaves things, as far as the robot saw them.

What was moved for a goal that was not reached does not stand where it did; a person who thinks so
would say the wrong thing next. Frames: W.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from nlcontrol.text_format import place_text, quantity

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from planner.types.world_state import Held
    from sim.traces.trace import Trace

_MOVED = 0.005  # less is not told: it is within what goals leave [m]
_LAST = 0.5  # time at the end over which it is seen [s]


def whereabouts(result: Result, held: Held | None) -> Iterator[str]:
    """Sentences on what the hand holds and what was moved, if the last step ended halfway."""
    trace, last = result.trace, result.steps[-1] if result.steps else None
    if trace is None or last is None or last.error is None:
        return
    if last.execution is not None and last.stuck is None:
        return  # it was done, though not well
    if held is not None:
        up = quantity(held.height, "m")
        yield f"the hand holds the {held.name}, {up} up; say “put it down”"
    yield from _moved_things(trace, held)


def _moved_things(trace: Trace, held: Held | None) -> Iterator[str]:
    """Sentences on what stands elsewhere than before."""
    last = trace.time > trace.time[-1] - _LAST
    for name, poses in trace.seen.items():
        if held is not None and name == held.name:
            continue
        moved = float(np.linalg.norm(trace.seen_displacement(name)))
        if moved > _MOVED:
            x, y = poses[last, 4:6].mean(axis=0).tolist()
            yield (
                f"the {name} is at {place_text(x, y)} now, {quantity(moved, 'm')} from where it "
                "was; “undo that” brings it back"
            )

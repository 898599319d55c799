"""A guard of what stands by: a pushed object that swings or drifts comes near to what was clear.

Model: on its planned way an object keeps clear of everything. One finger steers a long object, and
a turn drifts, so that it may leave that way; then it stops short of what stands beside it, and the
next push begins there. Others stand where they were seen, and what was close at first is left to
the plan, which keeps as much of that gap as it can.

Frames: W; footprints as in `planner.problem.footprints`.
"""

from __future__ import annotations

import numpy as np

from planner.problem.footprints import footprint, gap
from planner.types.actions import Push
from planner.types.world_state import WorldState
from sim.rotations import Array
from sim.traces.trace import EndReason

NEAREST = 0.003
"""Distance from another object at which a push ends: planned ones are larger [m]."""

_EVERY = 5  # control steps from one look to the next
_ENDS = ("stroke", "turned")  # of pushes in which the object stays on its face


class BystanderGuard:
    """Ends a push in which the object comes too near to what stands by.

    Args:
        push: what is to end; what it meets or stays clear of has limits of its own.
        state: where everything was seen.
        doubt: of a gap that is seen [m]; what stands closer than that at first is not watched.
    """

    def __init__(self, push: Push, state: WorldState, doubt: float) -> None:
        here = footprint(state.objects[push.object])
        watched = set(state.objects) - {push.object, push.meets}
        watched -= {name for name, _ in push.limits.clear_of}
        others = {name: footprint(state.objects[name]) for name in watched}
        apart = 2.0 * NEAREST + doubt
        self._others = {
            name: other
            for name, other in sorted(others.items())
            if push.ends_on in _ENDS and gap(here, other) > apart
        }
        self._discs = [_disc(other) for other in self._others.values()]
        self._steps = 0

    def end(self, corners: Array) -> tuple[EndReason, str] | None:
        """Why the push ends now; None if it goes on.

        Args:
            corners: what the object covers of the table now, in W, shape (k, 2) [m].
        """
        self._steps += 1
        if self._steps % _EVERY:
            return None
        middle, radius = _disc(corners)
        for (name, other), (centre, around) in zip(self._others.items(), self._discs, strict=True):
            if np.linalg.norm(centre - middle) - radius - around >= NEAREST:
                continue
            room = gap(corners, other)
            if room < NEAREST:
                return "too_close", f"it comes near the {name}, {1e3 * room:.0f} mm are left"
        return None


def _disc(corners: Array) -> tuple[Array, float]:
    """Centre, shape (2,), and radius of a disc around a polygon [m]."""
    middle = corners.mean(axis=0)
    return middle, float(np.linalg.norm(corners - middle, axis=1).max())

"""What an ordinary push shows of the object, from what the pushing fingers felt.

A push that slides the object tells the force that it takes, once it goes at an even speed; one that
tilts it tells the force at the onset of the tilt; one that stops at its force limit tells that more
is needed. One that lost the object, became too fast or did not fall tells nothing. Two fingers keep
the object from turning, so that their midpoint counts as level with the centre of mass.

Frames: W is the world, B the object's as it was seen before.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from objectmodels.identification import Moved, Trial, detect_onset
from objectmodels.identification.onset_detection import LEAST_SAMPLES

if TYPE_CHECKING:
    from planner.types.actions import Push
    from planner.types.world_state import SeenObject
    from sim.rotations import Array
    from sim.traces.trace import Trace

EVEN = (0.005, 0.9)
"""Way after which, and share of the stroke until which, a push goes at an even speed [m]."""

FEWEST = 20
"""Samples that a mean needs."""

FORCE_SD = 0.03
"""Standard deviation of a pushing force as a share of it: speeds that change, joints that flex."""

_AT_LIMIT = 0.5  # time at the end over which a force that moved nothing is averaged [s]
_ONSET = 5  # samples before and after an onset over which its force is averaged

_SHOWS: dict[str, Moved] = {
    "tilted": "topple",
    "toppled": "topple",
    "slid": "slide",
    "stroke": "slide",
    "force": "none",
}


def trial_from_push(push: Push, target: SeenObject, trace: Trace) -> Trial | None:
    """What a push showed; None if that is not clear.

    Args:
        push: what was carried out.
        target: the object as it was seen before.
        trace: of the push.
    """
    pushing = trace.phase == "push"
    moved = _SHOWS.get(trace.end)
    unfallen = trace.end == "stroke" and push.ends_on == "toppled"
    if moved is None or unfallen or pushing.sum() < LEAST_SAMPLES:
        return None
    time = trace.time[pushing]
    tips = np.mean([tip[pushing] for tip in trace.tips.values()], axis=0)
    forces = np.sum([felt[pushing] for felt in trace.felt.values()], axis=0)
    travel = (tips - tips[0]) @ trace.direction
    chosen = _chosen(moved, push, time, forces @ trace.direction, travel)
    if chosen is None:
        return None
    force = forces[chosen].mean(axis=0) @ target.pose.R_WB
    point = np.array(push.p_BC)
    if push.fingers == 2 and moved != "topple":
        # The part of its place along the face that lies off the centre of mass turns nothing.
        along = np.array([-force[1], force[0], 0.0]) / np.hypot(*force[:2])
        point = point - ((point - np.array(target.model.com)) @ along) * along
    (x, y, z), (f_x, f_y, f_z) = point.tolist(), force.tolist()
    return Trial(
        moved,
        point=(x, y, z),
        force=(f_x, f_y, f_z),
        force_sd=FORCE_SD * float(np.linalg.norm(force)),
        source="a push",
    )


def _chosen(
    moved: Moved, push: Push, time: Array, force: Array, travel: Array
) -> NDArray[np.bool_] | None:
    """The samples whose force counts."""
    if moved == "none":
        return np.asarray(time > time[-1] - _AT_LIMIT)
    if moved == "topple":
        onset = detect_onset(time, force, travel)
        if not onset.moved:
            return None
        return np.asarray(np.abs(np.arange(len(time)) - onset.index) <= _ONSET)
    even = (travel > EVEN[0]) & (travel < EVEN[1] * push.stroke)
    return np.asarray(even) if even.sum() >= FEWEST else None

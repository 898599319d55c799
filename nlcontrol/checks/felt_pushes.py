"""What became of a pushed object as the fingertips felt it, for where no camera sees it.

Model: a push with two fingers, straight on. What slides goes as far as the fingertips, under a
force that stays as it is. What tips over an edge gives way: the force on it falls in proportion to
the tilt that is left until it falls by itself, and is gone when it does (moments about the edge, as
in `objectmodels.mechanics`); then it lies on the side to which it was pushed. Anything else, a push
with one finger or around a corner as well, is not told by touch.

Frames: W is the world, T a fingertip.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nlcontrol.checks import trace_measures as measures
from sim.perception.pose_tracks import FeltEnd

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sim.traces.trace import Trace

FELT = 0.15
"""Least force that is told from nothing by sensors of such hands, averaged [N]."""

STAYS, GONE = 0.7, 0.35
"""Shares of the first force on the way: more at its end, and it slid; less, and it tipped over."""

LEAST_WAY = 0.008
"""A way of the fingertips on which a force has time to change [m]."""

STRAIGHT = 0.003
"""By which a straight way may be off its line [m]."""

ALONG_SD, ASIDE_SHARE = 0.0005, 0.04
"""Standard deviations of a slide: along the push [m], and aside, as a share of the way."""

TURN_SD, FALL_SD = np.radians(3.0), np.radians(5.0)
"""The same of the heading, and of the tilt of what fell [rad]."""

_PART = 0.15  # of the way, at its begin and at its end, over which a force is averaged


def felt_end(trace: Trace, samples: NDArray[np.intp]) -> FeltEnd | None:
    """How a push has left its object by touch alone; None if that does not tell.

    Args:
        trace: of the robot's own senses.
        samples: those of one push, from its touch on.
    """
    pushing = samples[trace.phase[samples] == "push"]
    if len(trace.tips) != 2 or not trace.felt or len(pushing) < 3:
        return None
    tips = measures.midpoint(trace)[pushing] - measures.midpoint(trace)[pushing[0]]
    way = np.array([*tips[-1, :2], 0.0])
    length = float(np.linalg.norm(way))
    if length < LEAST_WAY:
        return None
    along = way / length
    travel = tips @ along
    if np.linalg.norm((tips - travel[:, None] * along)[:, :2], axis=1).max() > STRAIGHT:
        return None
    total = np.sum(list(trace.felt.values()), axis=0) @ along
    force = measures.windowed_mean(trace.time, total, measures.FORCE_WINDOW)[pushing]
    begun = int(np.argmax(travel > 0.02 * length))
    first = float(force[begun : int(np.argmax(travel > _PART * length)) + 1].max())
    last = float(force[travel > (1.0 - _PART) * length].mean())
    if first < FELT:
        return None
    if last > STAYS * first:
        aside = ASIDE_SHARE * length
        across = np.array([-along[1], along[0], 0.0])
        sd = np.hypot(ALONG_SD * np.abs(along), aside * np.abs(across))
        sd[2] = ALONG_SD
        return FeltEnd(way, np.zeros(2), sd, 0.0, TURN_SD)
    if last < GONE * first:
        # It turns about the edge, to the left of the way; where its middle lies is not felt.
        fallen = 0.5 * np.pi * np.array([-along[1], along[0]])
        return FeltEnd(way, fallen, np.full(3, 0.5 * length), FALL_SD, TURN_SD)
    return None

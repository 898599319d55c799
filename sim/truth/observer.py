"""The observer of the simulated world, who alone may ask the truth.

In the paper a person watched what an object did; here it is this. It judges from true poses what
moved first. Nothing that plans, controls, senses or fits
may ask it, and a contract of the project's checks sees to that.

Model: an object slides when a corner of its base has moved sideways by more than a bound, and
topples when one has risen by more than it, as happens when it tilts about an edge: the bound
over the base's length is the tilt that counts, 0.6° for 1 mm and 90 mm. What came first is the
class. Any simulator creeps a little below the threshold, so that less than the bound is no motion;
an object that is pressed down sinks, which is no tilt.

Frames: W is the world, z up; B an object's frame at the centre of its base.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from objectmodels.geometry.rotations import Array, from_quaternion
from sim.truth.object_truth import Truth

Moved = Literal["none", "slide", "topple"]
"""What moved first."""

BOUND = 1e-3
"""Displacement of a corner of the base that counts as motion [m]."""


@dataclass(frozen=True)
class Verdict:
    """The motion of an object, sampled n times.

    Attributes:
        outcome: what moved first, or `none`.
        sample: the first one beyond the bound; the last one if nothing moved.
        slip: largest sideways displacement of a corner of the base so far, shape (n,) [m].
        lift: how far the highest corner has risen, shape (n,) [m].
    """

    outcome: Moved
    sample: int
    slip: Array
    lift: Array


def first_motion(truth: Truth, poses: Array, *, bound: float = BOUND) -> Verdict:
    """The first motion of an object, compared with where it was at the first sample.

    Args:
        truth: of the object.
        poses: quaternions (w, x, y, z) and positions p_WB [m], shape (n, 7), as worlds and traces
            keep them.
        bound: displacement that counts as motion [m].
    """
    p_BC = np.pad(np.array(truth.shape.silhouette), ((0, 0), (0, 1)))
    R_WB = from_quaternion(poses[:, :4])
    corners = poses[:, None, 4:] + p_BC @ np.swapaxes(R_WB, -1, -2)
    moved = corners - corners[0]
    slip = np.hypot(moved[..., 0], moved[..., 1]).max(axis=1)
    lift = moved[..., 2].max(axis=1)
    (beyond,) = np.nonzero(np.maximum(slip, lift) > bound)
    if not beyond.size:
        return Verdict("none", len(slip) - 1, slip, lift)
    first = int(beyond[0])
    return Verdict("slide" if slip[first] > lift[first] else "topple", first, slip, lift)

"""What the robot knew during one touch."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from planner.touch_experiments import Experiment
from planner.types.world_state import PlanarPose
from sim.rotations import Array
from sim.traces.trace import EndReason, Trace

if TYPE_CHECKING:
    from objectmodels.identification import Moved


@dataclass(frozen=True)
class Recording:
    """What the robot knew during one touch, sampled n times from the touch on.

    Attributes:
        experiment: what was tried.
        end: how it ended; `detail` says it in words.
        moved: what the touch showed: that the object slid or tilted, that the finger slipped; None
            if nothing did, or if that is not clear.
        time: shape (n,) [s].
        tips: the fingertip's centre p_WT, shape (n, 3) [m].
        forces: on the object in W, shape (n, 3) [N].
        before: where the object was seen before.
        after: where it was seen at the end, the finger still there; None if it was not looked at.
        seen_tilt: the same for its tilt along the push [rad].
        tip_radius: of the finger [m].
        force_sd: standard deviation of one sample of the force along the push [N].
        zero_sd: of the sensors' zero, as a force along the push [N].
        pose_sd: of the seen position [m] and heading [rad].
        trace: of the whole trip, for judging and replay.
    """

    experiment: Experiment
    end: EndReason
    detail: str
    moved: Moved | None
    time: Array
    tips: Array
    forces: Array
    before: PlanarPose
    after: PlanarPose | None
    seen_tilt: float | None
    tip_radius: float
    force_sd: float
    zero_sd: float
    pose_sd: tuple[float, float]
    trace: Trace | None = field(default=None, repr=False)

    @classmethod
    def nothing(
        cls, experiment: Experiment, end: EndReason, detail: str, before: PlanarPose
    ) -> Recording:
        """Of a touch that did not come about."""
        empty = np.empty((0, 3))
        return cls(
            experiment, end, detail, None, np.empty(0), empty, empty, before, None, None,
            tip_radius=0.0, force_sd=0.0, zero_sd=0.0, pose_sd=(0.0, 0.0),
        )  # fmt: skip

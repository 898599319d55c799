"""How far something leans that a hand holds.

Model: the fingertips stick, and their springs give way. About the closing direction they resist a
turn with a stiffness K; the others they hardly allow. The weight m g acts at the centre of mass, e
beside the line across, to its left, and h above it, so that it leans by −φ: K φ = m g (e + h φ).
What is not known of mass and centre of mass counts to first order; all else is `HAND_LEAN`.

Frame: B of the object, which stood upright.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from objectmodels.mechanics.push_outcomes import normal_cdf
from objectmodels.models.object_model import ObjectModel
from planner.grasping.grasp_sampling import Candidate

HAND_LEAN = math.radians(1.2)
"""Standard deviation of a lean by what is not in the model, as simulated lifts have it [rad]."""


@dataclass(frozen=True)
class Lean:
    """Lean about the closing direction, and its standard deviation [rad]; infinite if it tips."""

    angle: float
    sd: float

    @classmethod
    def of_grasp(cls, model: ObjectModel, candidate: Candidate) -> Lean:
        """The lean of an object that hangs in a hand."""
        off = np.array(model.com) - candidate.middle
        closing = candidate.closing
        beside = np.array([-closing[1], closing[0], 0.0])
        weight = model.weight
        holds = candidate.grip.stiffness - weight * float(off[2])
        if holds <= 0.0:
            return cls(math.inf, math.inf)
        angle = 0.0 - weight * float(off @ beside) / holds
        by_place = weight * math.hypot(*(beside * model.com_sd)) / holds
        by_mass = angle * model.mass_sd / model.mass
        return cls(angle, math.hypot(by_place, by_mass, HAND_LEAN))

    def probability_within(self, most: float) -> float:
        """Probability that it leans by no more than an angle [rad]."""
        if math.isinf(self.sd):
            return 0.0
        ends = (np.array([most, -most]) - self.angle) / self.sd
        within, below = normal_cdf(ends).tolist()
        return float(within - below)

"""A hand that holds what is 8 to 100 mm wide, and gets where a rule says."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from planner import plan
from planner.types.plan import Plan
from planner.types.refusal import Refusal
from planner.types.robot import Grip, ReachAnswer, RobotLimits
from planner.types.world_state import PlanarPose, WorldState
from tests.unit.planner.conftest import LIMITS, RuledReach, frame_of, world

CONTACTS = np.array([[0.0, 0.0], [0.0, 0.027], [0.0, 0.0], [0.0, -0.027]])
"""Three fingers side by side, the thumb opposite the middle one [m]."""


HAND = replace(LIMITS, grasp_widths=(0.008, 0.100))


@dataclass
class RuledHand(RuledReach):
    """A robot that pushes where it wants, and whose hand gets where a rule says."""

    holds: Callable[[Plan], bool] = lambda _: True
    limits: RobotLimits = HAND
    strongest: float = 11.0
    blocker: str | None = None
    plans: list[Plan] = field(default_factory=list)

    def grasp(self, width: float, *, pinch: bool = False, depth: float = 0.0) -> Grip | None:
        if pinch:
            return Grip(np.zeros((2, 2)), np.ones(2), self.strongest, (0.09, 0.06), 0.014)
        shares = np.array([1.0, 1 / 3, 1 / 3, 1 / 3])
        return Grip(CONTACTS, shares, self.strongest, (0.09, 0.04))

    def reach_plan(self, plan: Plan, state: WorldState) -> ReachAnswer:
        self.plans.append(plan)
        if self.holds(plan):
            return ReachAnswer(ok=True, margin=0.5)
        reason = "kinematics" if self.blocker is None else "obstacle"
        return ReachAnswer(
            ok=False, reason=reason, code="told", words={"text": "too far"}, blocker=self.blocker
        )


def planned(text: str, state: WorldState, hand: RuledHand) -> Plan:
    """The plan of a sentence that takes a hand."""
    made = plan(frame_of(text), state, hand)
    assert isinstance(made, Plan), made
    return made


def refused(text: str, state: WorldState, hand: RuledHand) -> Refusal:
    """The refusal of a sentence that takes a hand."""
    made = plan(frame_of(text), state, hand)
    assert isinstance(made, Refusal), made
    assert made.message
    return made


@pytest.fixture
def hand() -> RuledHand:
    """A hand that gets everywhere."""
    return RuledHand()


@pytest.fixture
def table() -> WorldState:
    """A carton, a mug and a cup, and a box that is too heavy to be lifted."""
    return world(
        ice_tea=PlanarPose(0.24, -0.13, np.radians(-91.0)),
        mug=PlanarPose(0.24, -0.33),
        ice_tea_cup=PlanarPose(0.24, 0.20),
        ice_tea_box=PlanarPose(0.60, 0.0),
    )

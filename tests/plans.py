"""Plans for tests of what carries plans out, judges them or says them in words."""

from __future__ import annotations

from typing import Any

from planner.types.actions import (
    Action,
    FlipPrediction,
    Grasp,
    GraspAction,
    GraspPrediction,
    Margins,
    PourPrediction,
    Prediction,
    Push,
    PushAction,
    TurnPrediction,
)
from planner.types.plan import Plan

SURE = Prediction(
    outcome="slide", onset=3.0, slide_force=3.0, topple_force=None, critical_height=None,
    critical_height_worst=None, probability=1.0, stay_on_base_angle=0.4, tier="closed form",
    friction="static",
)  # fmt: skip
SAFE = Margins(force=1.0, height=0.0, lateral=0.0, sigmas=0.0, force_limit=1.0)
NOTHING_POURED = PourPrediction(poured=0.0, received=0.0, spilled=0.0, left=0.0, level_after=0.0)
EASY_FLIP = FlipPrediction(
    lid_force=0.1, nearest_angle=0.0, nearest_force=0.1, slide_force=None, topple_force=None,
    lid_angle=0.0,
)  # fmt: skip
EASY_TURN = TurnPrediction(lid_torque=0.01, turning_torque=None)


def push_action(push: Push, prediction: Prediction = SURE, margins: Margins = SAFE) -> PushAction:
    """A push with what is predicted of it."""
    fields = {**dict(push), "prediction": prediction, "margins": margins}
    return PushAction.model_validate(fields)


def push_plan(
    push: Push, prediction: Prediction = SURE, margins: Margins = SAFE, **changes: Any
) -> Plan:
    """A plan of one push."""
    action = push_action(push, prediction, margins)
    return Plan(object=push.object, task="push", actions=(action,), committed=1, **changes)


def changed_push(plan: Plan, **changes: Any) -> Plan:
    """A plan whose first push is changed."""
    first = plan.push.model_copy(update=changes)
    return plan.model_copy(update={"actions": (first, *plan.actions[1:])})


def hand_plan(
    name: str, grasp: Grasp | None, *steps: Action, held: bool = False, speed: float = 0.1,
    task: Any = "lift",
) -> Plan:  # fmt: skip
    """A plan of a hand that takes hold of something and makes some steps."""
    actions = steps
    if grasp is not None:
        more = {"held": held, "prediction": GraspPrediction(holds=0.99)}
        actions = (GraspAction.model_validate({**dict(grasp), **more}), *steps)
    return Plan(object=name, task=task, actions=actions, committed=len(actions), speed=speed)

"""What the hand does not get to midway goes to another aim, if the sentence allows one."""

from __future__ import annotations

import pytest

from nlcontrol.session.foresight import onward_plan
from planner.planning import plan
from planner.types.plan import Plan, PlanningResult
from planner.types.refusal import Refusal
from planner.types.world_state import PlanarPose
from tests.unit.planner.conftest import RuledReach, frame_of, world

STATE = world(ice_tea_box=PlanarPose(0.5, 0.0, 0.0), mug=PlanarPose(0.6, 0.3, 0.0))
BESIDE = "push the ice tea box next to the mug"


@pytest.mark.parametrize(
    ("said", "code", "looked"),
    [
        (BESIDE, "pushes_blocked", True),
        (BESIDE, "no_push_reached", True),
        # Another aim would change nothing.
        (BESIDE, "topples_first", False),
        # Where it stood tells where it ends, so that the aim is the only one.
        ("push the ice tea box 5 cm away", "pushes_blocked", False),
        ("turn the ice tea box by 20 degrees", "pushes_blocked", False),
    ],
)
def test_another_aim_is_looked_for_where_the_hand_does_not_get_to_the_first(
    said: str, code: str, looked: bool
) -> None:
    frame = frame_of(said)
    begun = plan(frame, STATE, RuledReach())
    assert isinstance(begun, Plan)
    denied = Refusal(code=code, reason="out_of_reach", message="the hand does not get there")
    asked: list[Plan | None] = []

    def planning(*, previous: Plan | None = None) -> PlanningResult:
        asked.append(previous)
        return begun if previous is None else denied

    found = onward_plan(planning, frame, STATE, begun)
    if looked:
        told = begun.model_copy(update={"notes": (f"another aim, since {denied.message}",)})
        assert (found, asked) == (told, [begun, None])
    else:
        assert (found, asked) == (denied, [begun])


def test_the_aim_is_kept_as_long_as_the_hand_gets_there() -> None:
    frame = frame_of(BESIDE)
    begun = plan(frame, STATE, RuledReach())
    assert isinstance(begun, Plan)
    asked: list[Plan | None] = []

    def planning(*, previous: Plan | None = None) -> PlanningResult:
        asked.append(previous)
        return begun

    assert (onward_plan(planning, frame, STATE, begun), asked) == (begun, [begun])


def test_without_another_aim_the_reason_is_that_of_the_first() -> None:
    frame = frame_of(BESIDE)
    begun = plan(frame, STATE, RuledReach())
    assert isinstance(begun, Plan)
    first, other = (
        Refusal(code="pushes_blocked", reason="blocked", message=message) for message in "ab"
    )
    assert (
        onward_plan(lambda *, previous=None: first if previous else other, frame, STATE, begun)
        == first
    )

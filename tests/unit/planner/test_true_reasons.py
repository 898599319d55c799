"""An obstacle is named only if there is a plan without it."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from planner.clearing import obstacles
from planner.problem.stacks import put_on
from planner.types.plan import Plan
from planner.types.robot import ReachAnswer
from planner.types.world_state import PlanarPose, WorldState
from tests.unit.planner.conftest import world
from tests.unit.planner.grasping.conftest import RuledHand, refused

SAID = "lift the ice tea"


@dataclass
class Hindered(RuledHand):
    """A hand that meets objects in an order, and gets there once one of some sets is gone."""

    meets: tuple[str, ...] = ()
    enough: tuple[set[str], ...] = ()
    otherwise: str = "too far"

    def reach_plan(self, plan: Plan, state: WorldState) -> ReachAnswer:
        if any(not each & set(state.objects) for each in self.enough):
            return ReachAnswer(ok=True, margin=0.5)
        met = next((each for each in self.meets if each in state.objects), None)
        reason = "kinematics" if met is None else "obstacle"
        return ReachAnswer(
            ok=False, reason=reason, code="told", words={"text": self.otherwise}, blocker=met
        )


@pytest.fixture
def crowd() -> WorldState:
    return world(
        ice_tea=PlanarPose(0.3, 0.0),
        mug=PlanarPose(0.3, 0.2),
        tea_tin=PlanarPose(0.3, -0.2),
        cereal_box=PlanarPose(0.5, 0.0),
        coffee_box=PlanarPose(0.5, 0.3),
    )


ALL = ("mug", "tea tin", "cereal box", "coffee box")


@pytest.mark.parametrize(
    ("enough", "named"),
    [
        (({"mug"},), ("mug",)),
        (({"tea tin"},), ("tea tin",)),  # the mug is met first, and beside the point
        (({"mug", "tea tin"},), ("mug", "tea tin")),
        (({"mug", "cereal box"},), ("mug", "cereal box")),
        # One of the first two with the third does, the third alone does not.
        (({"mug", "cereal box"}, {"tea tin", "cereal box"}), ("tea tin", "cereal box")),
    ],
)
def test_what_is_named_is_what_frees_the_way(
    enough: tuple[set[str], ...], named: tuple[str, ...], crowd: WorldState
) -> None:
    made = refused(SAID, crowd, Hindered(meets=ALL, enough=enough))
    assert (made.code, made.reason) == ("grasps_blocked", "blocked")
    assert obstacles(made) == named
    assert made.suggestions[0] == f"move {' and '.join(f'the {each}' for each in named)} first"


def test_where_nothing_frees_the_way_nothing_is_named(crowd: WorldState) -> None:
    made = refused(SAID, crowd, Hindered(meets=("mug", "tea tin")))
    assert (made.code, made.reason) == ("no_grasp_reached", "out_of_reach")
    assert obstacles(made) == ()


def test_where_many_are_in_the_way_none_is_told_to_be_moved(crowd: WorldState) -> None:
    made = refused(SAID, crowd, Hindered(meets=ALL, enough=(set(ALL),)))
    assert (made.code, made.reason) == ("hemmed_in", "blocked")
    assert not any(each.startswith("move the") for each in made.suggestions)


def test_what_carries_the_object_is_not_taken_from_under_it(crowd: WorldState) -> None:
    """There would be nothing to lift."""
    hand = Hindered(meets=("cereal box",), enough=({"cereal box"},))
    on = world(ice_tea=PlanarPose(0.5, 0.0), cereal_box=PlanarPose(0.5, 0.0))
    box, tea = on.objects["cereal box"], on.objects["ice tea"]
    stack = {box.name: box, tea.name: put_on(tea, box)}
    made = refused(SAID, WorldState(stack, on.table), hand)
    assert not any(each.startswith("move the cereal box") for each in made.suggestions)


def test_what_tells_the_place_is_past_and_not_in_the_way(crowd: WorldState) -> None:
    """Nobody is told to move it."""
    made = refused("put the ice tea on the cereal box", crowd, Hindered(meets=("cereal box",)))
    assert (made.code, obstacles(made)) == ("no_way_past", ())
    assert not any("move" in each for each in made.suggestions)

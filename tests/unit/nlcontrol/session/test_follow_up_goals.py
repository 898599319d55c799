"""Clauses and bare words put onto the goal of the last command."""

from __future__ import annotations

from typing import Any

import pytest

from grammar.frames import command as g
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.remarks.follow_up_frames import (
    continue_frame,
    correct_frame,
    repeat_frames,
)
from nlcontrol.session.remarks.follow_up_targets import merge_frames
from tests.fakes.played_executor import PlayedExecutor

IT = g.ObjectRef(text="it", pronoun=True)
COFFEE = g.ObjectRef(text="coffee box")
CEREAL = g.ObjectRef(text="cereal box")
ICE_TEA = g.ObjectRef(text="ice tea box", id="ice tea box")


def said(dialogue: Any = None, **fields: Any) -> g.Frame:
    return g.Frame(dialogue=dialogue, **fields)


def frame(**fields: Any) -> g.Frame:
    return g.Frame(**{"action": "push", "object": ICE_TEA, "goal": g.Displace(), **fields})


@pytest.mark.parametrize(
    ("before", "clause", "after"),
    [
        ((g.Gentle(), g.Slow()), g.Hard(), (g.Slow(), g.Hard())),
        ((g.MaxForce(value=3.0),), g.Force(value=5.0), (g.Force(value=5.0),)),
        ((g.NoTopple(),), g.NoTurn(), (g.NoTopple(), g.NoTurn())),
        ((g.NoTouch(object=COFFEE),), g.NoTouch(object=CEREAL),
         (g.NoTouch(object=COFFEE), g.NoTouch(object=CEREAL))),
    ],
)  # fmt: skip
def test_a_clause_takes_the_place_of_one_of_its_matter(
    before: tuple[g.Constraint, ...], clause: g.Constraint, after: tuple[g.Constraint, ...]
) -> None:
    assert merge_frames(frame(constraints=before), said(constraints=(clause,))).constraints == after


def test_a_face_goes_with_its_direction_and_a_limit_with_its_distance() -> None:
    before = frame(
        goal=g.Displace(direction="right", distance=0.05, bound="at_least"),
        constraints=(g.ContactRegion(face="left", region="top"), g.MaxDistance(value=0.1)),
    )
    turned = merge_frames(before, said(goal=g.Displace(direction="away")))
    assert turned.constraints == (g.ContactRegion(region="top"), g.MaxDistance(value=0.1))
    nearer = merge_frames(before, said(goal=g.Displace(distance=0.03)))
    assert nearer.goal == g.Displace(direction="right", distance=0.03)
    assert nearer.constraints == (before.constraints[0],)


@pytest.mark.parametrize(
    ("last", "bare", "meant"),
    [
        (g.Topple(), g.Displace(direction="left"), g.Topple(direction="left")),
        (g.Rotate(angle=1.0), g.Displace(direction="left"), g.Rotate(angle=1.0, sense="ccw")),
        (g.Rotate(sense="cw"), g.Displace(amount="little"), g.Rotate(sense="cw", amount="little")),
        (g.Tilt(), g.Rotate(angle=0.5), g.Tilt(angle=0.5)),
        (g.Lift(), g.Displace(distance=0.1), g.Lift(height=0.1)),
        (
            g.Place(relation="next_to", reference=(COFFEE,)),
            g.Displace(distance=0.1),
            g.Place(relation="next_to", reference=(COFFEE,), distance=0.1),
        ),
        (g.Topple(), g.Displace(distance=0.1), g.Displace(distance=0.1)),
    ],
)
def test_bare_words_are_meant_for_the_last_goal(last: Any, bare: Any, meant: g.Goal) -> None:
    assert merge_frames(frame(goal=last), said(goal=bare)).goal == meant


def test_a_new_goal_drops_what_it_cannot_keep() -> None:
    before = frame(constraints=(g.NoTopple(), g.NoTurn()))
    after = merge_frames(before, said(action="topple", goal=g.Topple()))
    assert (after.action, after.constraints) == ("topple", (g.NoTurn(),))


def test_more_after_a_place_goes_on_in_the_same_direction() -> None:
    placed = frame(
        goal=g.Place(relation="next_to", reference=(COFFEE,)),
        constraints=(g.Until(event="touching", object=COFFEE), g.Gentle()),
    )
    for more in (g.Displace(amount="little"), g.Displace()):
        after = continue_frame(placed, said("more", goal=more), 1.5)
        assert after.goal == g.Displace(heading=1.5, amount=more.amount)
        assert after.constraints == (g.Gentle(),)


def test_more_gently_keeps_the_distance() -> None:
    before = frame(goal=g.Displace(distance=0.2))
    after = continue_frame(before, said("more", constraints=(g.Gentle(),)), None)
    assert after.goal == before.goal


def test_its_width_is_that_of_the_object_that_is_meant() -> None:
    its = g.ObjectRef(text="its", pronoun=True, id="ice tea box")
    before = frame(goal=g.Displace(distance=g.RelativeLength(value=2, of=its, side="width")))
    for (after,) in (
        correct_frame((before,), said("correct", object=CEREAL), None),
        repeat_frames((before,), said("repeat", object=CEREAL)),
    ):
        assert isinstance(after.goal, g.Displace)
        assert isinstance(after.goal.distance, g.RelativeLength)
        assert after.object == after.goal.distance.of == CEREAL


def test_again_takes_the_frame_with_the_same_action() -> None:
    both = (frame(goal=g.Displace(direction="left")), frame(action="topple", goal=g.Topple()))
    (again,) = repeat_frames(both, said("repeat", action="push", object=IT))
    assert again.goal == g.Displace(direction="left")
    assert [f.action for f in repeat_frames(both, said("repeat"))] == ["push", "topple"]


def test_a_swap_said_again_swaps_back(conversation: Conversation, stage: PlayedExecutor) -> None:
    def places(text: str) -> dict[str, tuple[float, float]]:
        frames = conversation.say(text, plan_only=True).frames
        goals = {f.object.id: f.goal for f in frames if f.object is not None}
        points = {
            name: goal.reference
            for name, goal in goals.items()
            if isinstance(goal, g.Place) and isinstance(goal.reference, g.Point)
        }
        return {name or "": (point.x, point.y) for name, point in points.items()}

    tea, tin = "ice tea box", "coffee box"
    here = {name: (stage.poses[name].x, stage.poses[name].y) for name in (tea, tin)}
    moved = places(f"swap the {tea} and the {tin}")
    # To a tenth of a millimetre, as places are said.
    other = {tea: tin, tin: tea}
    assert moved == {name: pytest.approx(here[other[name]], abs=1e-4) for name in here}
    stage.poses[tea], stage.poses[tin] = stage.poses[tin], stage.poses[tea]
    for _ in range(2):
        back = places("again")
        assert back == {name: pytest.approx(here[name], abs=1e-4) for name in here}
    # What is asked in between counts instead.
    conversation.say(f"push the {tea} 3 cm away", plan_only=True)
    assert places("again") == {}

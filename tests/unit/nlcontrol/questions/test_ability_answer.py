"""What the robot says that it can do is what it finds plans for."""

from __future__ import annotations

import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation


def abilities(scene: str) -> tuple[str, str]:
    """What it can do in a scene, and what it found no way to."""
    answer = Conversation(Controller(scene)).say("what can you do?").answer
    assert answer is not None
    can, _, cannot = answer.text.partition("; with what stands here")
    assert 0.0 < answer.numbers["can"] < answer.numbers["asked"]
    return can, cannot


@pytest.mark.parametrize(
    ("scene", "ability", "said"),
    [
        ("counter", "on others", "put the mug on the tea tin"),
        ("kitchen", "lift", "lift the coffee box"),
        ("kitchen", "topple", "topple the coffee box"),
    ],
)
def test_it_can_do_what_it_plans(scene: str, ability: str, said: str) -> None:
    can, cannot = abilities(scene)
    assert Conversation(Controller(scene)).say(said, plan_only=True).status == "planned"
    assert ability in can
    assert ability not in cannot


@pytest.mark.parametrize(("scene", "ability"), [("counter", "lids"), ("kitchen", "hand them over")])
def test_it_cannot_do_what_it_finds_no_plan_for(scene: str, ability: str) -> None:
    can, cannot = abilities(scene)
    assert ability in cannot
    assert ability not in can

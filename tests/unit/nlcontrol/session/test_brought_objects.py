"""What the hand does not get to is brought to where it does, before it is worked on."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from grammar import parse
from grammar.frames import command as g
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from planner.clearing import bringing_frames, may_be_brought
from planner.types.defaults import DEFAULTS
from sim.truth.scene_file import Scene, load_scene

BENEATH_THE_ARM = {"x_m": 0.55, "y_m": -0.05}


def pantry(**changes: Any) -> Scene:
    """The jar, and nothing else, where the arm does not get over its lid."""
    scene = load_scene("pantry")
    jar = scene.objects[0]
    pose = jar.pose.model_copy(update=BENEATH_THE_ARM)
    jar = jar.model_copy(update={"pose": pose, **changes})
    return scene.model_copy(update={"objects": (jar,)})


def test_a_jar_beneath_the_arm_is_pushed_to_where_its_lid_is_reached() -> None:
    result = Conversation(Controller(pantry())).say("open the jar gently", plan_only=True)
    assert result.status == "planned"
    first, second = (frame.goal.kind for frame in result.frames)
    assert (first, second) == ("displace", "open")
    assert [frame.object and frame.object.id for frame in result.aside] == ["jar"]
    assert [each.kind for each in result.aside[0].constraints] == ["gentle"]


@pytest.mark.parametrize("clear", [0, 1])
def test_it_stays_unless_things_may_be_moved(clear: int) -> None:
    controller = Controller(pantry(), defaults=replace(DEFAULTS, clear=clear))
    result = Conversation(controller).say("open the jar", plan_only=True)
    assert result.error is not None
    assert (result.status, result.error.code) == ("refused", "out_of_reach")
    # Asked, it says which push would do.
    suggested = [said for said in result.error.suggestions if said.endswith(" first")]
    assert [("jar" in said) for said in suggested] == [True] * clear


def test_what_is_fixed_stays() -> None:
    result = Conversation(Controller(pantry(fixed=True))).say("open the jar", plan_only=True)
    assert result.status == "refused"


@pytest.mark.parametrize(
    ("said", "brought"),
    [
        ("lift the mug by 5 cm", True),
        ("put the mug behind the jar gently", True),
        ("open the jar", True),
        # Where it stands tells where it ends.
        ("push the mug 5 cm to the left", False),
        ("turn the mug by 20 degrees", False),
        ("put the mug back", False),
        # It says how it is moved, and by how much.
        ("put the mug behind the jar within 10 s", False),
        ("put the mug behind the jar by touching it near the top", False),
    ],
)
def test_only_what_may_stand_anywhere_is_brought_elsewhere(said: str, brought: bool) -> None:
    controller = Controller("pantry")
    (frame,) = parse(said).frames
    name = said.split("the ", 1)[1].split(maxsplit=1)[0]
    frame = frame.model_copy(update={"object": g.ObjectRef(text=name, noun=name, id=name)})
    assert may_be_brought(frame, controller.look()) == brought


def test_places_with_most_room_come_first_and_the_near_ones_of_these() -> None:
    controller = Controller(pantry())
    (frame,) = parse("open the jar").frames
    frame = frame.model_copy(update={"object": g.ObjectRef(text="jar", noun="jar", id="jar")})
    goals = [f.goal for f in bringing_frames(frame, controller.look(), controller.defaults)]
    said = [goal.distance for goal in goals if isinstance(goal, g.Displace)]
    ways = [way for way in said if isinstance(way, float)]
    # Alone on the table it has room on all eight sides, but not 0.3 m away at the near edge.
    assert ways[:8] == [0.10] * 8
    assert ways == sorted(ways)
    assert set(ways) == {0.10, 0.20, 0.30}

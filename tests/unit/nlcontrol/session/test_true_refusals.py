"""Refusals are true: finite numbers, a reason that is one, and never anything but an error."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nlcontrol.errors import ControlError
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from planner.clearing import obstacles
from planner.problem.places import object_at
from planner.types.plan import Plan
from planner.types.refusal import Refusal

CAN = """format: cylinder/1
name: slick can
radius_m: 0.04
height_m: 0.1
mass_kg: 0.2
mass_kg_sd: 0.02
friction_table: 0.3
friction_table_sd: 0.03
friction_finger: {}
friction_finger_sd: 0.01
provenance: {{source: example, method: guess}}
"""
TABLE = """version: 1
name: slick
models: [slick.yaml]
objects: [{name: slick can, model: slick can, pose: {x_m: 0.45, y_m: 0.0}}]
"""


@pytest.mark.parametrize("friction", [0.02, 0.05, 0.2])
def test_what_slips_from_every_squeeze_is_refused_by_its_friction(
    friction: float, tmp_path: Path
) -> None:
    (tmp_path / "slick.yaml").write_text(CAN.format(friction))
    (tmp_path / "scene.yaml").write_text(TABLE)
    controller = Controller(tmp_path / "scene.yaml")
    refused = Conversation(controller).say("lift the slick can", plan_only=True)
    assert refused.status == "refused"
    assert refused.error is not None
    numbers = refused.error.numbers
    assert numbers["friction"] == friction
    # The outer fingertips touch the round side where it looks some 13° aside.
    assert numbers["needed_friction"] == pytest.approx(math.tan(math.radians(13.4)), abs=0.01)
    for question in ("can you lift the slick can?", "what can you do with the slick can?"):
        assert Conversation(controller).say(question).status == "answered"


def test_a_defect_is_an_error_with_a_code() -> None:
    def broken(*_: object, **__: Any) -> Any:
        raise ZeroDivisionError("somewhere")

    controller = Controller("kitchen", planner=broken)
    with pytest.raises(ControlError) as raised:
        Conversation(controller).say("push the mug away")
    assert raised.value.code == "internal"
    assert isinstance(raised.value.__cause__, ZeroDivisionError)


HEAD = """version: 1
name: few
robot: {home_deg: [41.0, -95.0, 75.0, -87.0, 110.0, -90.0, 42.0]}
objects:
"""
Places = dict[str, tuple[float, float]]


def refused_plan(said: str, places: Places, tmp_path: Path) -> tuple[Controller, Refusal]:
    """The refusal of a sentence about known objects at some places."""
    objects = (
        f"- {{name: {n}, model: {n}, pose: {{x_m: {x}, y_m: {y}}}}}\n"
        for n, (x, y) in places.items()
    )
    (tmp_path / "few.yaml").write_text(HEAD + "".join(objects))
    controller = Controller(tmp_path / "few.yaml")
    (frame,) = controller.resolve(controller.parse(said)).frames
    made = controller.plan(frame)
    assert isinstance(made, Refusal)
    return controller, made


BOX_ON_CAN: Places = {"cereal box": (0.5, -0.1), "soup can": (0.6, 0.15)}


@pytest.mark.parametrize(
    ("said", "places", "target"),
    [
        ("put the cereal box on the soup can", BOX_ON_CAN, "soup can"),
        ("put the cereal box on the soup can", BOX_ON_CAN | {"mug": (0.5, 0.4)}, "soup can"),
        ("put the tea tin into the bin", {"tea tin": (0.45, -0.05), "storage bin": (0.55, 0.3)},
         "storage bin"),
    ],
)  # fmt: skip
def test_a_target_is_never_in_the_way(
    said: str, places: Places, target: str, tmp_path: Path
) -> None:
    _, made = refused_plan(said, places, tmp_path)
    assert (made.code, made.reason) == ("no_way_past", "impossible")
    assert obstacles(made) == ()
    assert not any(target in each for each in made.suggestions)


def test_out_of_reach_says_by_how_much(tmp_path: Path) -> None:
    controller, made = refused_plan("lift the mug", {"mug": (1.1, 0.6)}, tmp_path)
    assert made.code == "no_grasp_reached"
    x, y = made.numbers["nearest_x"], made.numbers["nearest_y"]
    assert math.dist((x, y), (1.1, 0.6)) == pytest.approx(made.numbers["nearer"], abs=2e-3)
    assert 0.0 < made.numbers["nearer"] < 0.3
    state = controller.look()
    there = object_at(state.objects["mug"], np.array([x, y]))
    (frame,) = controller.resolve(controller.parse("lift the mug")).frames
    moved = replace(state, objects={"mug": there})
    assert isinstance(controller.plan(frame, moved), Plan)

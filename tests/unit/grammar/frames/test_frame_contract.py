"""The frame contract: kinds, keys and values that other programs read."""

from __future__ import annotations

import json
from typing import Any, get_args

import pytest
from pydantic import ValidationError

from grammar.frames.command import (
    Constraint,
    ContactHeight,
    ContactRegion,
    Displace,
    Effector,
    Frame,
    Goal,
    MaxForce,
    NoTouch,
    ObjectRef,
    Open,
    Parameters,
    Pour,
    RelativeLength,
    Until,
)
from grammar.paraphrasing.command_wording import paraphrase

GOALS = [
    "displace",
    "place",
    "rotate",
    "tilt",
    "topple",
    "upright",
    "lift",
    "set_down",
    "open",
    "close",
    "pour",
    "hand_over",
    "parameters",
    "none",
]
CONSTRAINTS = [
    "no_topple",
    "no_tilt",
    "no_turn",
    "no_slide",
    "no_lift",
    "no_spill",
    "no_touch",
    "max_tilt",
    "max_turn",
    "max_force",
    "min_force",
    "force",
    "max_speed",
    "min_speed",
    "speed",
    "max_duration",
    "duration",
    "max_distance",
    "gentle",
    "hard",
    "slow",
    "fast",
    "contact",
    "effector",
    "until",
]


def kinds(union: Any) -> list[str]:
    members = get_args(get_args(union)[0])
    return [member.model_fields["kind"].default for member in members]


def test_kinds_are_those_of_the_contract() -> None:
    assert kinds(Goal) == GOALS
    assert kinds(Constraint) == CONSTRAINTS


def test_keys_of_a_frame() -> None:
    assert list(Frame.model_fields)[:6] == [
        "action", "query", "dialogue", "object", "goal", "constraints",
    ]  # fmt: skip
    assert list(Displace.model_fields) == [
        "kind", "direction", "heading", "toward", "away_from", "distance", "bound", "fraction",
        "amount", "spans",
    ]  # fmt: skip


@pytest.mark.parametrize("union", [Goal, Constraint])
def test_every_part_carries_spans_last(union: Any) -> None:
    for member in get_args(get_args(union)[0]):
        assert next(reversed(member.model_fields)) == "spans"


def test_json_gives_the_frame_back() -> None:
    mug = ObjectRef(text="mug", spans=((0, 3),))
    frame = Frame(
        action="push",
        object=ObjectRef(text="box", id="box_1"),
        goal=Displace(
            direction=("away", "left"), distance=RelativeLength(value=2, of=mug, side="width")
        ),
        constraints=(
            ContactRegion(height=ContactHeight(value=0.03, origin="top")),
            MaxForce(value=5.0),
        ),
    )
    text = frame.model_dump_json()
    assert Frame.model_validate_json(text) == frame
    assert Frame.model_validate(json.loads(text)) == frame
    assert json.loads(text)["constraints"][0]["height"] == {
        "value": 0.03,
        "from": "top",
        "bound": "exact",
    }


@pytest.mark.parametrize(
    "data",
    [
        {"goal": {"kind": "fly"}},
        {"goal": {"kind": "displace", "speed": 1.0}},
        {"goal": {"kind": "displace", "distance": float("nan")}},
        {"goal": {"kind": "displace", "distance": float("inf")}},
        {"goal": {"kind": "displace", "distance": 0.0}},
        {"goal": {"kind": "displace", "direction": ["left", "away"]}},
        {"goal": {"kind": "displace", "direction": ["away", "toward"]}},
        {"goal": {"kind": "displace", "direction": "up"}},
        {"constraints": [{"kind": "max_force", "value": -1.0}]},
        {"constraints": [{"kind": "effector", "tool": "finger", "count": 0}]},
        {"action": "dance"},
        {"object": {"text": ""}},
    ],
)
def test_frame_refuses(data: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        Frame.model_validate(data)


def test_frame_is_frozen() -> None:
    frame = Frame(action="push")
    with pytest.raises(ValidationError):
        frame.action = "pull"  # type: ignore[misc]


BOX = ObjectRef(text="box")


def pushed(*constraints: Constraint, **goal: Any) -> Frame:
    return Frame(action="push", object=BOX, goal=Displace(**goal), constraints=constraints)


@pytest.mark.parametrize(
    "frame",
    [
        Frame(object=BOX),
        Frame(action="push", goal=Displace()),
        Frame(action="topple", object=BOX, goal=Displace()),
        Frame(action="open", object=ObjectRef(text="it", pronoun=True), goal=Open(part="drawer")),
        Frame(action="pour", object=BOX, goal=Pour(fraction=0.3)),
        Frame(query="value", object=BOX),
        Frame(query="value", object=BOX, goal=Parameters(which=("colour",))),
        Frame(query="possible", object=BOX),
        pushed(toward=BOX, fraction=0.4),
        pushed(distance=RelativeLength(value=1.0, of=BOX)),
        pushed(NoTouch(object=BOX, clearance=0.0)),
        pushed(Until(event="touching")),
        pushed(Effector(tool="finger", count=11)),
    ],
)
def test_paraphrase_says_when_it_has_no_words(frame: Frame) -> None:
    with pytest.raises(ValueError, match="there are no words"):
        paraphrase(frame)

"""Sentences that a person would say at a table made by hand, and those that nobody would."""

from __future__ import annotations

import pytest

from benchmarks.goals.drawn_worlds import standing
from benchmarks.goals.sense import sensible, tips
from nlcontrol import Registry
from nlcontrol.batches.drawn_scenes import scene_of
from nlcontrol.session.controller import Controller
from planner.types.world_state import WorldState
from sim.robots.cell_description import Vision
from sim.simulated_executor import simulation
from sim.truth.object_truth import truth_as_believed
from sim.truth.scene_file import Pose, SceneObject

REGISTRY = Registry.built_in()

# The ice tea box (9 cm square, 23 cm high) at 0.5, 0; gaps are 10 cm to the can on its left, 9 cm
# to the mug behind it, which is fragile.
STANDING = {"ice tea box": (0.5, 0.0), "soup can": (0.5, 0.178), "mug": (0.675, 0.0)}


def makes_sense(text: str, table: dict[str, tuple[float, float]] = STANDING) -> bool:
    objects = [
        SceneObject(
            name=name,
            model=name,
            pose=Pose(x_m=x, y_m=y),
            truth=truth_as_believed(REGISTRY.get(name)),
            fragile=name == "mug",
        )
        for name, (x, y) in table.items()
    ]
    robot = Controller(scene_of("by hand", objects, Vision()), registry=REGISTRY)
    state = WorldState(standing(simulation(robot.executor).scene), robot.table)
    return sensible(robot.resolve(robot.parse(text)).frames, state)


@pytest.mark.parametrize(
    "text",
    [
        "push the ice tea box 6 cm to the left",
        "push the ice tea box 20 cm to the right",
        "push the ice tea box to x 0.5 y -0.3",
        "push the ice tea box to the left until it touches the soup can",
        "push the ice tea box against the soup can",
        "push the ice tea box right of the mug",
        "push the ice tea box 10 cm to the right with at most 6 N",
        "push the ice tea box 10 cm to the right within 6 s",
        "turn the ice tea box a quarter turn to the left",
        "topple the ice tea box to the right",
        "topple the ice tea box to the right at the top with at most 4 N",
        "tilt the ice tea box by 10 degrees to the left",
        "push the ice tea box to the right until it is about to tip",
        "push the ice tea box 15 cm to the right, then push it 20 cm away",
    ],
)
def test_what_a_person_would_say(text: str) -> None:
    assert makes_sense(text)


@pytest.mark.parametrize(
    ("text", "because"),
    [
        ("push the ice tea box 8 cm to the left", "2 cm from the can"),
        ("push the ice tea box 40 cm to the left", "through the can"),
        ("push the ice tea box 15 cm toward me", "too near to the robot"),
        ("push the ice tea box to x 0.66 y 0.05", "on the mug"),
        ("push the ice tea box away until it touches the mug", "the mug is fragile"),
        ("push the ice tea box 6 cm to the left without touching the soup can", None),
        ("push the ice tea box 6 cm to the left and stay 5 cm away from the soup can", "4 cm"),
        ("push the ice tea box against the soup can without touching anything", "both"),
        ("push the ice tea box 10 cm to the right with at most 4.5 N", "it takes 3.7 N"),
        ("push the ice tea box 10 cm to the right within 5 s", "it takes 5.3 s"),
        ("push the ice tea box 10 cm to the right near the top", "it topples there"),
        ("topple the ice tea box at the bottom", "it slides there"),
        ("topple the soup can to the left", "it slides everywhere"),
        ("topple the ice tea box away", "onto the mug"),
        ("topple the ice tea box to the right with at most 2 N", "it takes 2 N"),
        ("tilt the ice tea box by 13 degrees to the left", "it falls beyond 21.4 degrees"),
        ("push the ice tea box 15 cm to the right, then push it 20 cm to the left", None),
        ("push the ice tea box 10 cm to the right, then push it 25 cm to the left", "into the can"),
    ],
)
def test_what_nobody_would_say(text: str, because: str | None) -> None:
    assert makes_sense(text) == (because is None)


def test_a_turn_needs_room_all_the_way() -> None:
    # 19 cm wide and 5 cm deep, it sweeps the can 8 cm behind it and ends as it began.
    table = {"cereal box": (0.5, 0.0), "soup can": (0.64, 0.0)}
    assert not makes_sense("turn the cereal box half a turn", table)
    assert makes_sense("turn the cereal box half a turn", {"cereal box": (0.5, 0.0)})


def test_what_topples() -> None:
    assert {model.name for model in REGISTRY if tips(model)} == {
        "cereal box", "coffee box", "ice tea", "ice tea box", "ice tea cup", "sugar box",
        "water bottle",
    }  # fmt: skip

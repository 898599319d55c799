"""Turns after which an object looks as asked: by its broad sides, and by its symmetry."""

from __future__ import annotations

import math

import pytest

from grammar.frames import command as g
from objectmodels import Registry
from planner.problem.goal_poses import turns_to_orientation
from planner.types.world_state import PlanarPose, SeenObject, WorldState

MODELS = Registry.default()
MUG = g.ObjectRef(text="mug", id="mug")


def turn(goal: g.Rotate, name: str, degrees: float) -> float:
    """The smallest turn of an object at the origin, the mug ahead of it, in degrees."""
    own = SeenObject(name, PlanarPose(0.0, 0.0, math.radians(degrees)), MODELS.find_one(name))
    mug = SeenObject("mug", PlanarPose(0.5, 0.0), MODELS.find_one("mug"))
    return math.degrees(turns_to_orientation(goal, own, WorldState({name: own, "mug": mug}))[0])


@pytest.mark.parametrize(
    ("goal", "name", "stands", "least"),
    [
        (g.Rotate(parallel_to="edge"), "cereal box", 30.0, -30.0),
        (g.Rotate(parallel_to="edge"), "cereal box", 50.0, 40.0),
        (g.Rotate(parallel_to="left_edge"), "cereal box", 30.0, 60.0),
        (g.Rotate(parallel_to="front_edge"), "cereal box", 170.0, 10.0),
        (g.Rotate(facing=MUG), "cereal box", 30.0, -30.0),
        (g.Rotate(facing="left"), "cereal box", 30.0, 60.0),
        (g.Rotate(facing=MUG), "ice tea box", 50.0, 40.0),
        (g.Rotate(facing=MUG), "soup can", 50.0, 0.0),
    ],
)
def test_the_smallest_turn(goal: g.Rotate, name: str, stands: float, least: float) -> None:
    # A millionth of a degree: turns are rounded to a nanoradian.
    assert turn(goal, name, stands) == pytest.approx(least, abs=1e-6)

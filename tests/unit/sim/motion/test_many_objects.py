"""A table full of objects: pushes among them are planned in seconds, and nothing is left out."""

from __future__ import annotations

import dataclasses
import itertools
import math

import numpy as np
import pytest

from objectmodels import Registry
from planner import plan
from planner.types.actions import Push
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim import load_scene
from sim.motion.collision_scene import CollisionScene
from sim.motion.robot_reach import ArmHandReach
from sim.robots.robots import ARM, HAND
from tests.unit.planner.conftest import TABLE, frame_of

STEP, ROOM = 0.09, 0.19  # between the mugs, and around the box in their midst [m]


def crowded(most: int) -> WorldState:
    """A box on the table with mugs all around it."""
    registry = Registry.built_in()
    box = SeenObject("ice tea box", PlanarPose(0.45, 0.0), registry.get("ice tea box"))
    objects, mug = {box.name: box}, registry.get("mug")
    for i, j in itertools.product(range(15), range(17)):
        x, y = -0.13 + STEP * i, -0.72 + STEP * j
        if math.dist((x, y), (0.45, 0.0)) > ROOM and len(objects) < most:
            name = f"mug {len(objects)}"
            objects[name] = SeenObject(name, PlanarPose(x, y), mug)
    assert len(objects) == most
    return WorldState(objects, TABLE)


def test_what_is_far_off_is_left_out_and_nothing_else() -> None:
    scenery = CollisionScene.from_state(crowded(60), "ice tea box")
    random = np.random.default_rng(3)
    found = []
    for _ in range(200):
        middle = random.uniform((-0.2, -0.8, 0.0), (1.2, 0.8, 0.3))
        centres = middle + random.normal(0.0, 0.05, (5, 4, 3))
        robot = np.concatenate([centres, random.uniform(0.005, 0.03, (5, 4, 1))], axis=-1)
        near = scenery.others_near(robot)
        hit = {each.name for each in scenery.others if not each.is_clear(robot).all()}
        assert hit <= {each.name for each in near}
        found.append((len(hit), len(near)))
    hits, looked_at = np.sum(found, axis=0)
    assert hits > 0
    assert looked_at < 0.2 * 200 * len(scenery.others)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sentence", "status"),
    [
        ("turn the ice tea box 90 degrees", "planned"),
        ("push the ice tea box 40 cm away", "refused"),
    ],
)
def test_a_push_among_two_hundred_objects(sentence: str, status: str) -> None:
    robot = ArmHandReach(load_scene("kitchen").cell, ARM, HAND)
    assert plan(frame_of(sentence), crowded(200), robot).status == status


def test_a_no_stays_one_wherever_what_had_no_part_in_it_is() -> None:
    robot, objects = ArmHandReach(load_scene("kitchen").cell, ARM, HAND), dict(crowded(40).objects)
    box, mug = objects["ice tea box"], objects["mug 1"]
    for x, y in ((0.33, 0.0), (0.57, 0.0), (0.45, -0.12), (0.45, 0.12)):
        objects[f"at {x}, {y}"] = dataclasses.replace(
            mug, name=f"at {x}, {y}", pose=PlanarPose(x, y)
        )
    state = WorldState(objects, TABLE)
    apart = 0
    for face, height in itertools.product(box.model.faces(), (0.03, 0.15)):
        point = tuple(face.points_at(0.0, height)[0].tolist())
        inward = tuple((-box.pose.R_WB @ np.array(face.normal)).tolist())
        push = Push(
            object=box.name, face="front", p_BC=point, normal_W=face.normal,
            direction_W=inward, force_limit=1.0, speed=0.05, stroke=0.1, fingers=1, spread=0.0,
            ends_on="stroke",
        )  # fmt: skip
        answer = robot.reach(push, state)
        if answer.ok:
            continue
        assert answer.stopped_by is not None
        left = {n: s for n, s in state.objects.items() if n in {box.name, *answer.stopped_by}}
        apart += len(state.objects) - len(left)
        assert not robot.reach(push, WorldState(left, TABLE)).ok
    assert apart > 0, "some had no part in it"

"""Obstacles of a hand on its way: the circles leave out none that its spheres come too near to."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from objectmodels.geometry.rotations import rot_z
from sim.motion.clearance import Sweep, first_obstacles
from sim.motion.collision_scene import OBJECT_CLEARANCE, Obstacle
from sim.robots.collision_spheres import place_spheres
from sim.robots.robots import HAND

BOX = np.array([[-0.04, -0.03], [0.04, -0.03], [0.04, 0.03], [-0.04, 0.03]])
TURN = np.radians(40.0)


def _obstacles(seed: int) -> tuple[Obstacle, ...]:
    """Boxes about the way, some beside it and some far off."""
    rng = np.random.default_rng(seed)
    made = []
    for _ in range(8):
        box = replace(Obstacle.at_origin(BOX, rng.uniform(0.05, 0.3)), clearance=OBJECT_CLEARANCE)
        at = np.append(rng.uniform(-0.35, 0.35, 2), 0.0)
        made.append(box.after_motion(np.zeros(3), at, rng.uniform(-3.0, 3.0)))
    return tuple(made)


@pytest.mark.parametrize("turned", [False, True])
def test_the_first_obstacle_is_the_one_that_the_spheres_hit(turned: bool) -> None:
    points = np.array([[-0.03, 0.0, 0.05], [0.0, 0.0, 0.05], [0.06, 0.0, 0.05], [0.12, 0.0, 0.05]])
    R_WD = rot_z(np.linspace(0.0, TURN, 4)) if turned else np.broadcast_to(np.eye(3), (4, 3, 3))
    every = HAND.pushing_postures(1, 0.0)
    hands = every[np.linspace(0, len(every) - 1, 150).astype(int)]
    sweep = Sweep.along(points, R_WD)
    at_T = hands.spheres_along(np.eye(3)[None], np.zeros((1, 3)))[:, 0]
    found = set()
    for seed in range(6):
        others = _obstacles(seed)
        expected = np.full(len(hands), -1)
        for number, each in reversed(list(enumerate(others))):
            for R, point in zip(*sweep, strict=True):
                robot = place_spheres(at_T, R, point)
                near = (each.distance_to(robot) <= each.clearance).any(axis=1)
                expected[near] = number
        np.testing.assert_array_equal(first_obstacles(hands, others, sweep), expected)
        found |= set(expected.tolist())
    assert found >= {-1, 0, 1}, "some hands are free, and not all are stopped by the same"

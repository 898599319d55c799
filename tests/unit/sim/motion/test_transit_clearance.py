"""Arm poses that are clear of everything: as if every sphere of arm and hand were looked at."""

from __future__ import annotations

import numpy as np

from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim import load_scene
from sim.motion.clearance import TransitClearance
from sim.motion.collision_scene import CollisionScene
from sim.robots.hand import Mount
from sim.robots.robots import ARM, HAND
from tests.unit.sim.motion.test_collision_scene import TEA

MOUNT = Mount.from_cell(load_scene("kitchen").cell.robot, ARM, HAND)
AT = {"pushed": (0.5, 0.1), "near": (0.6, -0.2), "far": (0.3, 0.5)}
STATE = WorldState({k: SeenObject(k, PlanarPose(*xy, 0.3), TEA) for k, xy in AT.items()})


def test_poses_are_free_if_all_spheres_are() -> None:
    scenery = CollisionScene.from_state(STATE, "pushed")
    hand = HAND.whole_spheres(HAND.resting)
    # From high above to far below the table.
    q = MOUNT.home + np.random.default_rng(0).uniform(-2.0, 2.0, (400, 7))
    directly = scenery.is_free(MOUNT.robot_spheres(hand, q))
    assert 0.2 < directly.mean() < 0.9
    clearance = TransitClearance(MOUNT, hand, scenery, (scenery.pushed,))
    np.testing.assert_array_equal(clearance.are_free(q), directly)


def test_an_empty_table_and_the_pushed_object_alone_are_met() -> None:
    scenery = CollisionScene.from_state(STATE, "pushed")
    bare = CollisionScene(scenery.pushed, ())
    hand = HAND.whole_spheres(HAND.resting)
    q = MOUNT.home + np.random.default_rng(1).uniform(-2.0, 2.0, (400, 7))
    above_table = bare.is_clear_of_others(MOUNT.robot_spheres(hand, q))
    alone = TransitClearance(MOUNT, hand, bare, ()).are_free(q)
    np.testing.assert_array_equal(alone, above_table)
    met = TransitClearance(MOUNT, hand, bare, (bare.pushed,)).are_free(q)
    assert met.sum() < alone.sum()

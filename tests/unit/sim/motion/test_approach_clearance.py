"""Which hands hit the object that they are to push before they push it."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from objectmodels.geometry.rotations import Array, rot_z
from planner.types.world_state import PlanarPose, SeenObject
from sim.motion.clearance import Approach
from sim.motion.collision_scene import Obstacle
from sim.robots.four_finger_hand import FourFingerHand
from sim.robots.hand import PostureSet
from sim.robots.lwr_arm import LwrKinematics
from tests.unit.sim.motion.test_collision_scene import TEA

HAND = FourFingerHand(wrist=float(np.linalg.norm(LwrKinematics.p_FW)))
HANDS = HAND.pushing_postures(1, 0.0)
CONTACT = np.array([[-0.11, 0.0, 0.06], [-0.08, 0.0, 0.06]])
"""T before the face of a box and at it, seen from the box, in m."""


def _approach(
    x: float, yaw: float, height: float = 0.0, nearer: float = 0.0
) -> tuple[Approach, Obstacle, Array]:
    pushed = Obstacle.from_seen(SeenObject("tea", PlanarPose(x, 0.1, yaw), TEA), 0.012)
    points = pushed.p_WB + (CONTACT + np.array([nearer, 0.0, height])) @ pushed.R_WB.T
    made = Approach.to_object(pushed, points, pushed.R_WB, HAND, 1, 0.0, fine=False)
    return made, pushed, points


def test_hands_are_clear_that_keep_off_at_both_places() -> None:
    near, clear = [], []
    for nearer in np.linspace(0.0, 0.004, 21).tolist():
        approach, pushed, points = _approach(0.6, 0.5, nearer=nearer)
        robot = HANDS.spheres_along(np.broadcast_to(rot_z(0.5), (2, 3, 3)), points)[..., :-1, :]
        near.append(pushed.distance_to(robot).min(axis=(1, 2)))
        clear.append(approach.clear_hands(HANDS))
        assert 0.05 < clear[-1].mean() < 0.95
    # All but the fingertip keeps half a millimetre, and no hand is left out that does.
    apart = np.concatenate(near)
    np.testing.assert_array_equal(np.concatenate(clear), apart > 0.0005)
    assert ((apart > 0.0004) & (apart < 0.0005)).any()
    assert ((apart > 0.0005) & (apart < 0.0006)).any()


def test_it_is_one_approach_wherever_the_object_stands() -> None:
    here, there, higher = _approach(0.6, 0.5)[0], _approach(0.4, -2.0)[0], _approach(0.6, 0.5, 0.02)
    assert here == there
    assert here != higher[0]


def test_hands_are_looked_at_once_in_whatever_order(monkeypatch: pytest.MonkeyPatch) -> None:
    approach = _approach(0.6, 0.5, height=0.013)[0]
    clear = approach.clear_hands(HANDS[np.arange(0, 60, 2)])
    looked = []
    along: Any = Obstacle.is_clear_along

    def counted(self: Obstacle, robot: Array, *rest: Any) -> Array:
        looked.append(len(robot))
        found: Array = along(self, robot, *rest)
        return found

    monkeypatch.setattr(Obstacle, "is_clear_along", counted)
    again = dataclasses.replace(approach).clear_hands(HANDS[np.arange(59, -1, -1)])
    np.testing.assert_array_equal(again[1::2][::-1], clear)
    assert 0 < max(looked) <= 30  # of 60, less those that stay behind the face's plane


def test_hands_know_their_place_among_all() -> None:
    some: PostureSet = HANDS[np.array([7, 3])][np.array([True, False])]
    assert some.number.tolist() == [7]

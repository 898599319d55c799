"""Free ways in joint space: the shortest that is free, around what is in the way, or none."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from sim.motion.roadmap import free_path, interpolate_joints, sample_configurations
from sim.robots.lwr_arm import LIMITS
from sim.robots.robots import ARM

Array = NDArray[np.float64]

START, GOAL = np.full(7, -0.5), np.full(7, 0.5)
BESIDE = np.array([1.2, -1.2, 0.0, 0.0, 0.0, 0.0, 0.0])
NOWHERE = np.zeros((0, 7))


def _everywhere(q: Array) -> NDArray[np.bool_]:
    return np.ones(len(q), dtype=bool)


def _around_the_middle(q: Array) -> NDArray[np.bool_]:
    return np.asarray(np.linalg.norm(q, axis=1) > 0.6)


def test_the_straight_way_is_taken_if_it_is_free() -> None:
    assert free_path(ARM, START, GOAL, BESIDE[None], _everywhere) == ()


def test_a_place_beside_leads_around() -> None:
    way = free_path(ARM, START, GOAL, BESIDE[None], _around_the_middle)
    assert way is not None
    np.testing.assert_array_equal(way, BESIDE[None])
    for leg in itertools.pairwise([START, *way, GOAL]):
        assert _around_the_middle(interpolate_joints(*leg)).all()


def test_of_two_places_the_nearer() -> None:
    farther = np.vstack([1.5 * BESIDE, BESIDE])
    way = free_path(ARM, START, GOAL, farther, _around_the_middle)
    assert way is not None
    np.testing.assert_array_equal(way, BESIDE[None])


def test_drawn_places_find_a_way_and_always_the_same() -> None:
    ways = [
        free_path(ARM, START, GOAL, sample_configurations(START, GOAL), _around_the_middle)
        for _ in range(2)
    ]
    assert ways[0]
    np.testing.assert_array_equal(ways[0], ways[1])


def test_there_is_no_way_out_of_a_cage() -> None:
    def caged(q: Array) -> NDArray[np.bool_]:
        far = np.linalg.norm(q - START, axis=1)
        return np.asarray((far < 0.2) | (far > 0.4))

    assert free_path(ARM, START, GOAL, sample_configurations(START, GOAL), caged) is None
    assert free_path(ARM, START, GOAL, NOWHERE, lambda q: ~_everywhere(q)) is None


def test_places_nearer_than_80_mrad_to_a_joint_limit_are_not_taken() -> None:
    for room, taken in ((0.079, False), (0.081, True)):
        place = np.where(np.arange(7) == 0, LIMITS - room, BESIDE)
        way = free_path(ARM, START, GOAL, place[None], _around_the_middle)
        assert (way is not None) == taken, room


def test_poses_along_a_leg_are_close_to_each_other() -> None:
    poses = interpolate_joints(START, GOAL)
    np.testing.assert_array_equal(poses[[0, -1]], [START, GOAL])
    # The finest motion that matters is that of 50 mrad at a metre's length: 5 cm, half a link.
    assert np.abs(np.diff(poses, axis=0)).max() <= 0.05 + 1e-12  # rounding

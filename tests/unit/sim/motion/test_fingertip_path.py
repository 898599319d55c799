"""The way of the fingertips: straight, or along the arc of a push that turns the object."""

from __future__ import annotations

import numpy as np
import pytest

from objectmodels import Registry
from objectmodels.geometry.rotations import rot_z
from planner.types.actions import Push
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim import load_scene
from sim.motion.fingertip_path import FingertipPath
from sim.motion.inverse_kinematics import ArmConfiguration
from sim.motion.robot_reach import ArmHandReach
from sim.robots.finger_kinematics import TIP_RADIUS
from sim.robots.hand import Mount
from sim.robots.robots import ARM, HAND

SLANT = np.radians(30.0)


def _push(ends_on: str, *, turn: float = 0.0) -> Push:
    return Push.model_validate(
        {
            "object": "ice tea box",
            "face": "front",
            "p_BC": (-0.045, 0.033, 0.03),
            "normal_W": (-1.0, 0.0, 0.0),
            "direction_W": (np.cos(SLANT), np.sin(SLANT), 0.0),
            "force_limit": 5.0,
            "speed": 0.03,
            "stroke": 0.06,
            "fingers": 1,
            "spread": 0.0,
            "ends_on": ends_on,
            "turn": turn,
        }
    )


@pytest.fixture(scope="module")
def target() -> SeenObject:
    return SeenObject("ice tea box", PlanarPose(0.5, 0.1), Registry.default().get("ice tea box"))


def test_a_turning_push_moves_its_contact_as_far_as_its_stroke(target: SeenObject) -> None:
    push = _push("turned", turn=-0.6)
    way = FingertipPath.from_push(push, target, HAND.tip_radius)
    shares = np.linspace(0.0, 1.0, 2001)
    points, turns = way.points_at(shares)[1:], way.turns_at(shares)[1:]
    # The fingertip is fixed to the object: what it touches lies a radius ahead of its centre.
    contact = points + TIP_RADIUS * rot_z(turns) @ way.inward
    steps = np.diff(contact, axis=0)
    length = np.linalg.norm(steps, axis=1)
    # Chords of 2000 pieces of an arc are shorter than it by a few parts in 10^9.
    assert length.sum() == pytest.approx(push.stroke, rel=1e-7)
    heading = np.arctan2(steps[:, 1], steps[:, 0])
    middles = 0.5 * (turns[1:] + turns[:-1])
    np.testing.assert_allclose(heading, SLANT + middles, atol=1e-9)


def test_a_turn_by_nothing_is_a_straight_push(target: SeenObject) -> None:
    turned, straight = (
        FingertipPath.from_push(_push("turned"), target, HAND.tip_radius),
        FingertipPath.from_push(_push("stroke"), target, HAND.tip_radius),
    )
    np.testing.assert_allclose(turned.points_at(), straight.points_at(), atol=1e-12)
    assert not turned.turns_at().any()


def test_a_turned_palm_leaves_the_fingertip_where_it_should_be(target: SeenObject) -> None:
    scene = load_scene("kitchen")
    push = _push("turned", turn=-0.3)
    answer = ArmHandReach(scene.cell, ARM, HAND).push_configuration(
        push, WorldState({"ice tea box": target})
    )
    assert isinstance(answer, tuple), answer
    stance: ArmConfiguration = answer[0]
    way = FingertipPath.from_push(push, target, HAND.tip_radius)
    for point, turned in zip(way.points_at(), way.turns_at(), strict=True):
        R_WP, p_WP = Mount.from_cell(scene.robot, ARM, HAND).palm_poses(
            stance.joint_angles(point, turned)
        )
        np.testing.assert_allclose(R_WP, rot_z(turned) @ stance.R_WP, atol=1e-9)
        np.testing.assert_allclose(p_WP + R_WP @ stance.posture.tips[0], point, atol=1e-9)

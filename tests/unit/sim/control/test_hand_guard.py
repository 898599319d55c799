"""A hand that steers an object aside stops before it touches something else."""

from __future__ import annotations

import numpy as np

from objectmodels import BoxModel
from planner.types.robot import ReachAnswer
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim import load_scene
from sim.control.guards import Sample, Watch, hand_guard
from sim.control.object_estimate import ObjectEstimate
from sim.motion.robot_reach import ArmHandReach
from sim.robots.cell_description import Vision
from sim.robots.robots import ARM, HAND
from tests.unit.sim.motion.test_push_motion_search import _push, _seen

PERIOD = 0.01
HIGH = 2.0  # of a wall beside the whole arm [m]


def test_it_ends_where_something_is_near_and_the_way_was_left() -> None:
    tin = _seen("tea tin", 0.55, 0.0, 0.0)
    push = _push(tin, 0.0, 0.06, stroke=0.08, force=2.0)
    reach = ArmHandReach(load_scene("kitchen").cell, ARM, HAND)
    answer = reach.push_configuration(push, WorldState({"tea tin": tin}))
    assert not isinstance(answer, ReachAnswer)
    stance, touch = answer[0], reach.fingertip_path(push, WorldState({"tea tin": tin})).touch
    q = stance.joint_angles(touch)
    spheres = stance.robot_spheres(q[None])[0]
    left = float((spheres[:, 1] + spheres[:, 3]).max())
    wall = BoxModel(name="wall", mass=1.0, com=(0.0, 0.0, 0.1), friction=0.4, friction_radius=0.05,
                    size=(1.5, 0.02, HIGH))  # fmt: skip

    def ends(gap: float, aside: float) -> list[bool]:
        pose = PlanarPose(0.5, left + gap + 0.01, 0.0)
        state = WorldState({"tea tin": tin, "wall": SeenObject("wall", pose, wall)})
        watch = Watch([hand_guard(push, state, stance, lambda: q)], PERIOD)
        estimate = ObjectEstimate(push, state, Vision(), touch, PERIOD)
        x, y, _ = push.direction_W
        estimate.update(0.0, touch + aside * np.array([-y, x, 0.0]), 0.0, [])
        sample = Sample(0.0, travel=0.0, speed=0.0, felt=0.0, tilt=0.0, estimate=estimate)
        return [watch.first_tripped(sample) is not None for _ in range(3)]

    # The way is left at 4 mm, and 3 mm are near.
    assert any(ends(0.0027, 0.0045))
    assert not any(ends(0.0027, 0.0035))
    assert not any(ends(0.0033, 0.0045))

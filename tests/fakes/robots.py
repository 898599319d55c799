"""The simulated robot in a world that a test has built."""

from __future__ import annotations

import numpy as np

from planner.types.world_state import PlanarPose
from sim.control.free_motion import RobotSetup, watch
from sim.control.object_estimate import mean_poses
from sim.motion.robot_reach import ArmHandReach
from sim.robots.robots import ARM, HAND
from sim.worlds.drake.drake_world import DrakeWorld
from sim.worlds.ports import Frame


def robot_in(world: DrakeWorld) -> RobotSetup:
    """The robot of a world, which holds nothing."""
    return RobotSetup(world.robot, world, ArmHandReach(world.scene.cell, ARM, HAND))


def frames_in(world: DrakeWorld, duration: float) -> list[Frame]:
    """Camera frames of some seconds in which nothing is done."""
    return watch(robot_in(world).recorder(np.array([0.0, 0.0, 1.0])), duration)


def poses_in(world: DrakeWorld, duration: float) -> dict[str, PlanarPose]:
    """Mean poses in these frames."""
    return mean_poses(frames_in(world, duration))

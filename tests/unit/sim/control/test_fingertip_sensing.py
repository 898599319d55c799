"""Forces from joint torques: a force put on a fingertip comes back as it was."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sim import load_scene
from sim.control.object_estimate import sense_touch
from sim.robots.finger_kinematics import TIP_RADIUS, finger_points
from sim.robots.hand import Angles, Mount
from sim.robots.robots import ARM, HAND


@dataclass
class Sensors:
    """A hand that holds still, one fingertip pressed with a force; the robot's side of a world."""

    q: NDArray[np.float64]
    angles: Angles

    def arm_angles(self) -> NDArray[np.float64]:
        return self.q

    def finger_angles(self, _: str) -> Angles:
        return self.angles


@pytest.mark.parametrize("finger", ["index", "middle", "ring"])
@pytest.mark.parametrize("angles", [(0.0, -0.4, 0.5), (0.1, 0.3, 0.9)])
def test_the_force_at_the_contact_point(finger: str, angles: Angles) -> None:
    scene = load_scene("kitchen")
    mount, q = Mount.from_cell(scene.robot, ARM, HAND), np.radians(scene.robot.home_deg)
    R_WP, p_WP = mount.palm_poses(q)
    inward_W, force_W = np.array([0.6, 0.8, 0.0]), np.array([1.2, 1.4, -0.5])
    base, middle, distal, tip = finger_points(finger, angles)
    p_PC = tip + TIP_RADIUS * R_WP.T @ inward_W
    # Moment of the force about each joint's axis, from the cross product alone.
    c, s = np.cos(angles[0]), np.sin(angles[0])
    flexion = np.array([0.0, c, s])
    force_P = R_WP.T @ force_W
    torques = np.array(
        [
            np.array([1.0, 0.0, 0.0]) @ np.cross(p_PC - base, force_P),
            flexion @ np.cross(p_PC - base, force_P),
            # The middle joint's drive bends the distal joint too.
            flexion @ np.cross(p_PC - middle, force_P) + flexion @ np.cross(p_PC - distal, force_P),
        ]
    )
    world: Any = Sensors(q, angles)
    touch = sense_touch(world, mount, (finger,), inward_W, torques[None])
    # A 3×3 system whose condition number is below a thousand.
    np.testing.assert_allclose(touch.forces[0], force_W, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(touch.midpoint, R_WP @ tip + p_WP, rtol=0, atol=1e-12)

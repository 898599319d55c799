"""What the camera's noise looks like in the hand."""

import numpy as np
import pytest

from objectmodels.geometry.rotations import rot_y
from sim.control.held_object_sensing import DROPPED, SLIP, most_slip, seen_share
from sim.robots.cell_description import Vision
from sim.worlds.sensors import noise_left

LEVER = 0.07  # of a carton that is held in its middle [m]
FRAMES = 300  # of ten seconds


def false_slips(vision: Vision, share: float, most: float, draws: int = 200) -> float:
    """How often something that stays in a hand that turns by 105° seems to slip."""
    rng, alarms = np.random.default_rng(0), 0
    noise = np.hypot(vision.position_noise_m, np.radians(vision.angle_noise_deg) * LEVER)
    for _ in range(draws):
        bias = rng.normal(0.0, vision.position_bias_m, 3)
        first = bias + rng.normal(0.0, noise * noise_left(share), 3)
        now, largest = first, 0.0
        for angle in np.radians(np.linspace(0.0, 105.0, FRAMES)):
            seen = rot_y(float(angle)).T @ bias + rng.normal(0.0, noise, 3)
            now = now + share * (seen - now)
            largest = max(largest, float(np.linalg.norm(now - first)))
        alarms += largest > most
    return alarms / draws


@pytest.mark.parametrize(
    "vision",
    [Vision(), Vision(position_noise_m=0.005, angle_noise_deg=2.0, position_bias_m=0.002)],
)
def test_noise_is_no_slip(vision: Vision) -> None:
    share, most = seen_share(vision, LEVER), most_slip(vision)
    # A pour in a hundred may end for nothing.
    assert false_slips(vision, share, most) <= 0.01
    assert most < DROPPED / 1.5


def test_a_quiet_camera_is_believed_soon() -> None:
    assert seen_share(Vision(position_noise_m=0.0, angle_noise_deg=0.0), LEVER) == 0.25
    assert most_slip(Vision()) == SLIP

"""Everything random in a world comes from its seed, each thing from a stream of its own.

So the same seed gives the same world bit for bit, and switching one imperfection on or off leaves
the others as they were.
"""

from __future__ import annotations

from enum import IntEnum, unique

import numpy as np

from objectmodels.geometry.rotations import Array


@unique
class RandomStream(IntEnum):
    """Things that are drawn at random."""

    VISION_NOISE = 1
    TORQUE_NOISE = 2
    TORQUE_BIAS = 3
    JOINT_NOISE = 4
    JOINT_OFFSET = 5
    VISION_BIAS = 6
    TABLE_FRICTION = 7
    TRIAL_FRICTION = 8
    CONTENTS = 9
    HIDDEN = 10
    LID_NOISE = 11
    OWN_VERDICT = 12
    LEVEL_NOISE = 13


def source(seed: int, stream: RandomStream) -> np.random.Generator:
    """The stream of one thing in the world of a seed."""
    return np.random.default_rng([seed, int(stream)])


def clipped_normal(rng: np.random.Generator, shape: int | tuple[int, ...]) -> Array:
    """Standard normal numbers, clipped at two standard deviations."""
    return np.clip(rng.standard_normal(shape), -2.0, 2.0)

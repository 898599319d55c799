"""Noise of the sensors: what those of the joints show of what is true, by steps, bias and gain.

Model: a sensor shows round(((1 + gain error) x + bias + noise) / resolution) · resolution. The
noise is white and drawn for every sample, the bias is constant for each joint of a world. The true
value is held over a control period, since the simulated joints hardly move within one.

The steps of rounding stay visible in a mean of samples only where the noise is smaller than they
are; a larger noise smooths them away.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from objectmodels.geometry.rotations import Array
from sim.random_streams import RandomStream, source
from sim.robots.cell_description import JointSensor, TorqueSensor


def noise_left(share: float) -> float:
    """Share of a camera frame's deviation that is left where each new frame has a weight."""
    return math.sqrt(share / (2.0 - share))


class TorqueReadings:
    """The finger joints' torque sensors of a world.

    Args:
        sensor: how good they are.
        joints: number of joints with a sensor, per finger.
        period: of a control step [s].
        seed: of the world.
        gain_error: relative error of their scale.
    """

    def __init__(
        self,
        sensor: TorqueSensor,
        joints: Mapping[str, int],
        period: float,
        seed: int,
        *,
        gain_error: float = 0.0,
    ) -> None:
        self._sensor, self._gain = sensor, 1.0 + gain_error
        self._samples = max(1, round(sensor.rate_hz * period))
        self._noise = source(seed, RandomStream.TORQUE_NOISE)
        bias = source(seed, RandomStream.TORQUE_BIAS)
        self._bias = {
            finger: sensor.bias_nm * bias.standard_normal(count) for finger, count in joints.items()
        }

    def read(self, finger: str, torques: Array) -> Array:
        """Mean of a finger's samples of a control step for true torques, shape (n,) [N·m]."""
        noise = self._noise.standard_normal((self._samples, len(torques)))
        true = self._gain * torques + self._bias[finger]
        samples = _rounded(true + self._sensor.noise_nm * noise, self._sensor.resolution_nm)
        return np.asarray(samples.sum(axis=0) / self._samples)


class JointReadings:
    """The position sensors of the joints of a world, of which so many first are the arm's."""

    def __init__(self, sensor: JointSensor, arm_joints: int, joints: int, seed: int) -> None:
        def each(arm: float, finger: float) -> Array:
            return np.where(np.arange(joints) < arm_joints, arm, finger)

        self._rng = source(seed, RandomStream.JOINT_NOISE)
        self._noise = each(sensor.arm_noise_rad, sensor.finger_noise_rad)
        self._resolution = each(sensor.arm_resolution_rad, sensor.finger_resolution_rad)
        self._offset = each(sensor.arm_offset_rad, sensor.finger_offset_rad)
        self._offset *= source(seed, RandomStream.JOINT_OFFSET).standard_normal(joints)

    def read(self, angles: Array) -> Array:
        """The angles that are shown for true ones, shape (n,) [rad]."""
        noise = self._noise * self._rng.standard_normal(len(self._noise))
        return _rounded(angles + self._offset + noise, self._resolution)


def _rounded(values: Array, step: Array | float) -> Array:
    """Values in whole steps, as they are where the step is zero."""
    whole = np.where(np.greater(step, 0.0), step, 1.0)
    return np.where(np.greater(step, 0.0), np.rint(values / whole) * whole, values)

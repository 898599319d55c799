"""Frames of a camera drawn anew on a motion that truly happened.

One run in the simulator gives as many sets of frames as are wanted, of any camera. What the robot
did was decided by the frames that it had; only its verdicts are made of these. Frames go on for a
second after the run, as the robot looks once more.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from objectmodels.geometry.rotations import Array
from sim.robots.cell_description import Vision
from sim.traces.trace import Trace

LOOKS_ON = 1.0
"""After the run [s]."""


def with_frames(trace: Trace, vision: Vision, rng: np.random.Generator) -> Trace:
    """The trace with frames of a camera; lids and levels stay as they were seen.

    Args:
        trace: with true poses.
        vision: data sheet of the camera.
        rng: of its errors.
    """
    at = np.arange(trace.time[0], trace.time[-1] + LOOKS_ON, 1.0 / vision.rate_hz)
    within = np.clip(at, trace.time[0], trace.time[-1])
    sightings = {}
    for name, poses in trace.poses.items():
        p = np.column_stack([np.interp(within, trace.time, x) for x in poses[:, 4:].T])
        R_WB = Slerp(trace.time, Rotation.from_quat(poses[:, [1, 2, 3, 0]]))(within)
        turn = np.radians(vision.angle_bias_deg) * rng.standard_normal()
        off = np.radians(vision.angle_noise_deg) * rng.standard_normal((len(at), 3))
        seen = Rotation.from_rotvec(off) * Rotation.from_rotvec([0.0, 0.0, turn]) * R_WB
        shift = vision.position_bias_m * rng.standard_normal(3)
        shift = shift + vision.position_noise_m * rng.standard_normal((len(at), 3))
        sightings[name] = np.column_stack([at, seen.as_quat()[:, [3, 0, 1, 2]], p + shift])
    return replace(trace, sightings=sightings)


def first_look(sightings: dict[str, Array], until: float) -> dict[str, Array]:
    """The frames before a time [s]."""
    return {name: seen[seen[:, 0] < until] for name, seen in sightings.items()}

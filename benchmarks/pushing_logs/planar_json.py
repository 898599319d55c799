"""A push of MIT's planar data set, a JSON file, as a tracked push.

`tip_pose` and `object_pose` have rows time [s], x, y [m], heading; `ft_wrench` rows time, the force
on the tip [N] and a moment; all in the robot's axes. The tip is a rod.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from benchmarks.pushing_logs.triangle_logs import TrackedPush
from objectmodels.geometry.rotations import rotate

TIP_RADIUS = 0.00475
"""Of the rod [m]."""


def read_planar_push(file: Path) -> TrackedPush:
    """The push of a file, its contact one radius ahead of the rod's axis along the force."""
    told = json.loads(file.read_text("utf-8"))
    tips, bodies, wrenches = (
        np.array(told[name]) for name in ("tip_pose", "object_pose", "ft_wrench")
    )
    time = wrenches[:, 0]
    force = -(wrenches[:, 1:3] - wrenches[0, 1:3])
    axis = np.column_stack([np.interp(time, tips[:, 0], tips[:, k]) for k in (1, 2)])
    strongest = force[np.argmax(np.hypot(*force.T))]
    contact = axis + TIP_RADIUS * strongest / np.hypot(*strongest)
    (x, y, before), end = bodies[0, 1:], bodies[-1, 1:]
    back = np.full(len(time), -before)
    move = rotate((end[:2] - [x, y])[None], back[:1])[0]
    turn = (end[2] - before + np.pi) % (2.0 * np.pi) - np.pi
    return TrackedPush(
        pose=np.append(move, turn),
        time=time - time[0],
        force=rotate(force, back),
        tip=rotate(contact - [x, y], back),
    )

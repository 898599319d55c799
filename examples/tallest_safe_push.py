"""Heights up to which each known object may be pushed at any angle without toppling it.

Predictions take whole arrays: here all faces of an object are asked about at once.
"""

from __future__ import annotations

import numpy as np

from nlcontrol import Registry

print(f"{'object':16} {'height':>8} {'of':>8} {'force':>8}")
for model in Registry.built_in():
    faces = model.faces()
    places = [face.points_at(0.0, 0.0) for face in faces]  # the middle of each lower edge
    points, normals = (np.array(parts) for parts in zip(*places, strict=True))
    # What holds for every force in the fingertip's friction cone, two standard deviations off.
    cone = model.cone_thresholds(points, normals, sigmas=2.0, yaw=False)
    best = int(np.argmax(cone.height_below))
    height = min(cone.height_below[best], model.top)
    print(
        f"{model.name:16} {1e3 * height:5.0f} mm {1e3 * model.top:5.0f} mm "
        f"{cone.slide_max[best]:6.2f} N"
    )

"""Names of an object's side faces when no scene says how it is turned: B's axes are the robot's."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nlcontrol.errors import error
from planner.geometry.directions import face_name

if TYPE_CHECKING:
    from objectmodels import Face, ObjectModel

_STRAIGHT = np.radians(5.0)


def face_names(model: ObjectModel) -> dict[str, Face]:
    """The side faces by name, in the model's order.

    A face that looks aside is called after the nearest of `front`, `back`, `left` and `right` and
    its angle from that, counter-clockwise: `front+60`.
    """
    named: dict[str, Face] = {}
    for face in model.faces():
        nearest, off = face_name(np.array(face.normal))
        name = f"{nearest}{np.degrees(off):+.0f}" if abs(off) > _STRAIGHT else str(nearest)
        while name in named:
            name += "'"
        named[name] = face
    return named


def face_of(model: ObjectModel, name: str) -> Face:
    """The side face of that name.

    Raises:
        ControlError: `unknown_face`, with the names that there are.
    """
    named = face_names(model)
    if name in named:
        return named[name]
    if not named:
        raise error(
            "unknown_face", f"the {model.name} has no side that is wide enough for a fingertip"
        )
    near = [known for known in named if known.startswith(name)]
    raise error(
        "unknown_face",
        f"the {model.name} has no face {name!r}",
        suggestions=(f"its faces: {', '.join(near or named)}",),
    )

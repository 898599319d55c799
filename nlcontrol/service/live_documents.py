"""Documents for viewers, and for nobody else: shapes of bodies, and their poses over time.

Where the robot is simulated these are the poses that an observer of that world sees; they are
never told to who plans, perceives or decides.
"""

from __future__ import annotations

from typing import Any, Literal

from nlcontrol.json_document import Document, DocumentPart

PoseSource = Literal["observer", "belief"]


class DrawnBody(DocumentPart):
    """A body with its shapes.

    Attributes:
        name: of the body, as in a `PoseFrame`.
        kind: of the body.
        object: name of the object on the table that it is, or whose lid it is; null for others.
        shapes: each with `kind`, `pose` in the body, `colour` (red, green, blue and opacity, 0…1)
            and the measures of its kind [m]; see `sim.views.viewer_recording`.
    """

    name: str
    kind: Literal["world", "robot", "object", "lid"]
    object: str | None
    shapes: tuple[dict[str, Any], ...]


class SceneGeometry(Document):
    """All that a viewer draws of a session.

    Attributes:
        source: of the shapes: what an observer sees, or boxes as they are believed to be.
        format: of the shapes, and its version.
        name: of the scene.
        floor: height of the ground below the table top [m].
        liquid: colour of liquid.
        bodies: with their shapes.
    """

    source: PoseSource
    format: str
    name: str
    floor: float
    liquid: tuple[float, float, float, float]
    bodies: tuple[DrawnBody, ...]


class PoseFrame(DocumentPart):
    """Places of all bodies at one time.

    Attributes:
        time: of the robot [s].
        source: what an observer of the simulated world sees, or what is believed.
        poses: by the names of the bodies: quaternion (w, x, y, z) and position in W [m].
    """

    time: float
    source: PoseSource
    poses: dict[str, tuple[float, float, float, float, float, float, float]]

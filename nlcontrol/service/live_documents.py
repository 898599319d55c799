"""What a viewer is told, and nobody else: shapes of bodies, and where they are while things happen.

Where the robot is simulated these are the poses that an observer of that world sees; they are
never told to who plans, perceives or decides.
"""

from __future__ import annotations

from typing import Literal

from nlcontrol.json_document import Document, DocumentPart

PoseSource = Literal["observer", "belief"]


class DrawnShape(DocumentPart):
    """A shape of a body.

    Attributes:
        body: name of the body, as in a `PoseFrame`.
        object: name of the object on the table that the body is, or whose lid it is; null for
            robot and table.
        kind: of the shape; one with an axis stands along z.
        size: edges of a box; radius and length of a cylinder, of a capsule without its round ends;
            radius of a sphere [m].
        vertices, triangles: of a mesh, places [m], and three of their numbers for each triangle.
        pose: of the shape in the body: quaternion (w, x, y, z) and position [m].
        colour: red, green, blue and opacity, 0…1.
    """

    body: str
    object: str | None
    kind: Literal["box", "cylinder", "capsule", "sphere", "mesh"]
    size: tuple[float, ...]
    vertices: tuple[tuple[float, float, float], ...] = ()
    triangles: tuple[tuple[int, int, int], ...] = ()
    pose: tuple[float, float, float, float, float, float, float]
    colour: tuple[float, float, float, float]


class SceneGeometry(Document):
    """All that a viewer draws of a session.

    Attributes:
        source: of the shapes: what an observer sees, or boxes as they are believed to be.
        shapes: of all bodies.
    """

    source: PoseSource
    shapes: tuple[DrawnShape, ...]


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

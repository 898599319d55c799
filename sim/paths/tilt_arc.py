"""The arc on which a fingertip goes while it tilts an object about the far edge of its base.

Model: the edge does not slide. Seen along it, the fingertip's centre T keeps the distance
`length` + r from the plane through the edge that is parallel to the touched face, wherever on the
face it slips to; so where T is tells the tilt.

Frames: W is the world, B the object's, T the fingertip's centre.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.rotations import Array


@dataclass(frozen=True, eq=False)
class TiltArc:
    """Places of the fingertip during a tilt.

    Attributes:
        origin: p_WT at the touch, the object upright, shape (3,) [m].
        u: horizontal unit direction of the push in W, shape (3,).
        length: from the touched face to the far edge [m].
        tip_radius: of the fingertip [m].
    """

    origin: Array
    u: Array
    length: float
    tip_radius: float

    @property
    def edge_distance(self) -> float:
        """Distance of T behind the edge at the touch [m]."""
        return self.length + self.tip_radius

    @property
    def arc_radius(self) -> float:
        """Distance of T from the edge [m]."""
        return float(np.hypot(self.edge_distance, self.origin[2]))

    def tip_at(self, angle: float) -> Array:
        """p_WT at a tilt [rad], if it sticks to the face, shape (3,) [m]."""
        up = float(self.origin[2])
        c, s = np.cos(angle), np.sin(angle)
        point = self.origin + (self.edge_distance - (self.edge_distance * c - up * s)) * self.u
        return np.array([point[0], point[1], self.edge_distance * s + up * c])

    def contact_heights(self, tips: Array) -> Array:
        """Heights in B at which fingertips p_WT, shape (n, 3), touch the face, shape (n,) [m]."""
        x, h = self._seen_from_edge(tips)
        return np.sqrt(np.maximum(x * x + h * h - self.edge_distance**2, 0.0))

    def tilt_angles(self, tips: Array) -> Array:
        """Tilts at which fingertips p_WT, shape (n, 3) [m], touch the face, shape (n,) [rad]."""
        x, h = self._seen_from_edge(tips)
        return np.asarray(
            np.arctan2(h, x) - np.arctan2(self.contact_heights(tips), self.edge_distance)
        )

    def _seen_from_edge(self, tips: Array) -> tuple[Array, Array]:
        """Distances behind the edge and above the table, shape (n,) each [m]."""
        return self.edge_distance - (tips - self.origin) @ self.u, tips[:, 2]

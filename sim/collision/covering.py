"""Something that is held as spheres: it may be carried and tilted among other objects.

Frame: B of the held object.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sim.collision.collision_scene import Obstacle
from sim.rotations import Array

_SPACING = 0.015  # [m]
_RADIUS = 0.004  # [m]


def surface(held: Obstacle) -> Array:
    """Spheres that cover an object's sides, edges and ends in B, shape (n, 4).

    Args:
        held: the object; where it stands does not count.
    """
    r = _RADIUS
    n = max(2, int(np.ceil(held.height / _SPACING)))
    heights = np.linspace(r, held.height - r, n)
    centre = held.outline.mean(axis=0)
    rim = np.vstack([*_rims(held.outline)])
    inner = centre + (1.0 - r / np.maximum(np.linalg.norm(rim - centre, axis=1), r))[:, None] * (
        rim - centre
    )
    rings = [np.column_stack([inner, np.full(len(inner), z)]) for z in heights]
    ends = [
        np.column_stack([centre + 0.5 * (inner - centre), np.full(len(inner), z)])
        for z in heights[[0, -1]]
    ]
    centres = np.vstack([*rings, *ends])
    return np.column_stack([centres, np.full(len(centres), r)])


def _rims(outline: Array) -> Iterator[Array]:
    """Points along the sides of a polygon."""
    for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        n = max(1, int(np.ceil(np.linalg.norm(b - a) / _SPACING)))
        yield a + np.linspace(0.0, 1.0, n, endpoint=False)[:, None] * (b - a)

"""Spheres that stand for robot and objects, and their distance from boxes and from the table.

Model: every link of the robot is covered by a row or a grid of spheres, a little larger than its
collision shape; an object is the prism or cylinder that the robot believes it to be. That is all
that planning a motion needs, and it takes whole arrays.
"""

from __future__ import annotations

import functools
import math

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.rotations import Array
from objectmodels.safety_figure import SafetyFigure

TABLE_CLEARANCE: SafetyFigure = 0.005
"""Least distance of hand and arm from the table [m]."""


def sphere_row(start: Array, end: Array, radius: float, spacing: float) -> Array:
    """Spheres along a segment, shape (n, 4): centre and radius [m]."""
    along = end - start
    n = max(2, math.ceil(math.sqrt(along @ along) / spacing) + 1)
    row = np.empty((n, 4))
    row[:, :3] = start + along * _shares(n)
    row[:, 3] = radius
    return row


@functools.cache
def _shares(n: int) -> Array:
    """Evenly spread shares of a segment from its start to its end, shape (n, 1)."""
    return np.linspace(0.0, 1.0, n)[:, None]


def surface_spheres(outline: Array, height: float) -> Array:
    """Spheres that cover the sides, edges and ends of an upright prism in its frame, shape (n, 4).

    Args:
        outline: convex, its corners counter-clockwise, shape (k, 2) [m].
        height: of the prism [m].
    """
    r, spacing = 0.004, 0.015
    heights = np.linspace(r, height - r, max(2, int(np.ceil(height / spacing))))
    centre = outline.mean(axis=0)
    sides = []
    for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        n = max(1, int(np.ceil(np.linalg.norm(b - a) / spacing)))
        sides.append(a + np.linspace(0.0, 1.0, n, endpoint=False)[:, None] * (b - a))
    rim = np.vstack(sides)
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


def place_spheres(spheres: Array, R: Array, p: Array) -> Array:
    """Spheres brought into another frame: R shape (..., 3, 3), p shape (..., 3)."""
    turned = spheres[..., :3] @ np.swapaxes(R, -1, -2)
    from_p = p[..., None, :]
    placed = np.empty((*np.broadcast_shapes(turned.shape, from_p.shape)[:-1], 4))
    np.add(turned, from_p, out=placed[..., :3])
    placed[..., 3] = spheres[..., 3]
    return placed


@functools.cache
def sphere_parts(spheres: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Every fourth of so many spheres, which tells of most hands that hit, and the others."""
    every = np.arange(spheres)
    return every[::4], every[every % 4 != 0]


def distance_to_box(spheres: Array, low: Array, high: Array) -> Array:
    """Signed distance of spheres from an axis-aligned box, shape (...) [m].

    Args:
        spheres: shape (..., 4), in the box's own axes.
        low: its corner of least coordinates, shape (3,) [m].
        high: the opposite corner.
    """
    x, y, z = (np.maximum(low[i] - spheres[..., i], spheres[..., i] - high[i]) for i in range(3))
    far = np.sqrt(np.maximum(x, 0.0) ** 2 + np.maximum(y, 0.0) ** 2 + np.maximum(z, 0.0) ** 2)
    near = np.minimum(np.maximum(np.maximum(x, y), z), 0.0)
    return np.asarray(far + near - spheres[..., 3])


def distance_to_prism(spheres: Array, outline: Array, height: float) -> Array:
    """Signed distance of spheres from an upright prism on the table, shape (...) [m].

    Args:
        spheres: shape (..., 4), in the prism's frame.
        outline: convex, its corners counter-clockwise, shape (k, 2) [m].
        height: of the prism [m].
    """
    x, y = spheres[..., 0], spheres[..., 1]
    across, squared = np.full(x.shape, -np.inf), np.full(x.shape, np.inf)
    for (a_x, a_y), (b_x, b_y) in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        length = math.hypot(b_x - a_x, b_y - a_y)
        e_x, e_y = (b_x - a_x) / length, (b_y - a_y) / length
        from_x, from_y = x - a_x, y - a_y
        off, along = from_x * e_y - from_y * e_x, from_x * e_x + from_y * e_y
        # Beyond an end of the edge by so much, and so far off its line.
        beyond = along - np.minimum(np.maximum(along, 0.0), length)
        across = np.maximum(across, off)
        squared = np.minimum(squared, off * off + beyond * beyond)
    return _distance_upright(np.where(across > 0.0, np.sqrt(squared), across), spheres, height)


def distance_to_cylinder(spheres: Array, radius: float, height: float) -> Array:
    """Signed distance of spheres from an upright cylinder on the table, shape (...) [m].

    Args:
        spheres: shape (..., 4), in the cylinder's frame.
        radius: of the cylinder [m].
        height: of the cylinder [m].
    """
    level = np.sqrt(spheres[..., 0] ** 2 + spheres[..., 1] ** 2) - radius
    return _distance_upright(level, spheres, height)


def _distance_upright(level: Array, spheres: Array, height: float) -> Array:
    """Signed distance from an upright solid, from the one in its horizontal section."""
    z = spheres[..., 2]
    over = np.maximum(-z, z - height)
    far = np.sqrt(np.maximum(level, 0.0) ** 2 + np.maximum(over, 0.0) ** 2)
    return np.asarray(far + np.minimum(np.maximum(level, over), 0.0) - spheres[..., 3])


def height_above_table(spheres: Array) -> Array:
    """Distance of spheres from the plane z = 0, shape (...) [m]."""
    return np.asarray(spheres[..., 2] - spheres[..., 3])

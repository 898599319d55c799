"""A convex hull as a mesh file (Wavefront OBJ), which SDF and URDF refer to."""

from __future__ import annotations

import numpy as np

from objectmodels.geometry.base_shapes import Array


def obj_text(vertices: Array) -> str:
    """The hull of vertices, shape (n, 3) [m], as triangles that look outwards."""
    from scipy.spatial import ConvexHull  # takes a while to import

    hull = ConvexHull(vertices)
    number = {int(vertex): k for k, vertex in enumerate(hull.vertices, start=1)}
    lines = [f"v {x:.15g} {y:.15g} {z:.15g}" for x, y, z in vertices[hull.vertices]]
    for (a, b, c), equation in zip(hull.simplices, hull.equations, strict=True):
        normal = np.cross(vertices[b] - vertices[a], vertices[c] - vertices[a])
        corners = (a, b, c) if normal @ equation[:3] > 0.0 else (a, c, b)
        lines.append("f " + " ".join(str(number[int(corner)]) for corner in corners))
    return "\n".join(lines) + "\n"

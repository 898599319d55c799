"""Liquid as a replay or a picture shows it: what stands in containers, and streams that fall.

Everything is drawn as convex pieces. What stands in a container is its cavity below the level; a
stream is a chain of thin cylinders along its parabola, down to what catches it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.containers.pour_dynamics import exit_velocity, fall_time
from objectmodels.mechanics.push_thresholds import GRAVITY
from sim.rotations import Array, from_quaternion
from sim.worlds.drake.liquid_transfer import lean_of

if TYPE_CHECKING:
    from objectmodels.models.object_parts import Vessel
    from sim.traces.trace import Trace
    from sim.truth.scene_file import Scene

COLOUR = (0.62, 0.33, 0.10, 1.0)
"""Of tea: red, green, blue and opacity."""

_LEAST = 1e-7  # volumes that are not worth drawing [m³]
_PIECES, _SIDES = 8, 8
_THIN, _THICK = 0.0015, 0.006  # radii of streams [m]


@dataclass(frozen=True)
class Part:
    """A body of liquid.

    Attributes:
        name: the container that it is in or comes from.
        of: `level` or `stream`.
        pieces: corners of convex pieces, shape (k, 3) each; a level's in B, a stream's in W [m].
    """

    name: str
    of: str
    pieces: tuple[Array, ...]


def parts(trace: Trace, scene: Scene, sample: int) -> Iterator[Part]:
    """All liquid at a sample of a trace."""
    for name, volumes in trace.contents.items():
        vessel = scene.object(name).truth.vessel
        assert vessel is not None
        R_WB, p_WB = _pose(trace, name, sample)
        if volumes[sample] > _LEAST:
            yield Part(name, "level", (_standing(vessel, volumes[sample], R_WB),))
        lost = volumes[max(sample - 1, 0)] - volumes[sample]
        if lost > 0.0:
            rate = lost / float(trace.time[sample] - trace.time[sample - 1])
            below = _landing_height(trace, scene, name, sample)
            pieces = _stream(vessel, volumes[sample], rate, (R_WB, p_WB), below)
            yield Part(name, "stream", pieces)


def triangles(pieces: Sequence[Array]) -> tuple[Array, Array]:
    """Corners (n, 3) of convex pieces, and of each triangle of their surfaces the three, (m, 3).

    Seen from outside a triangle's corners go counterclockwise: others are not drawn.
    """
    from scipy.spatial import ConvexHull

    faces, first = [], 0
    for piece in pieces:
        hull = ConvexHull(piece)
        a, b, c = np.asarray(piece)[hull.simplices].transpose(1, 0, 2)
        outwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) > 0.0
        ordered = np.where(outwards[:, None], hull.simplices, hull.simplices[:, ::-1])
        faces.append(ordered + first)
        first += len(piece)
    return np.concatenate(pieces), np.concatenate(faces)


def _pose(trace: Trace, name: str, sample: int) -> tuple[Array, Array]:
    pose = trace.poses[name][sample]
    return from_quaternion(pose[:4] / np.linalg.norm(pose[:4])), pose[4:]


def _standing(vessel: Vessel, volume: float, R_WB: Array) -> Array:
    """Corners of what of a cavity is below the level, in B."""
    ring = vessel.section.corners
    low, high = (np.column_stack([ring, np.full(len(ring), z)]) for z in (vessel.floor, vessel.top))
    level = float(vessel.surface_level(min(volume, vessel.capacity), *lean_of(R_WB[2])))
    starts = np.concatenate([low, high, low])
    ends = np.concatenate([np.roll(low, -1, axis=0), np.roll(high, -1, axis=0), high])
    a, b = starts @ R_WB[2] - level, ends @ R_WB[2] - level
    cut = a * b < 0.0
    crossing = starts[cut] + (a / np.where(cut, a - b, 1.0))[cut, None] * (ends - starts)[cut]
    corners = np.concatenate([low, high])
    return np.concatenate([corners[corners @ R_WB[2] <= level], crossing])


def _landing_height(trace: Trace, scene: Scene, source: str, sample: int) -> float:
    """Height at which a stream ends: the level of what it fills, or the table [m]."""
    for name, volumes in trace.contents.items():
        if name != source and volumes[sample] > volumes[sample - 1]:
            vessel = scene.object(name).truth.vessel
            assert vessel is not None
            R_WB, p_WB = _pose(trace, name, sample)
            return float(p_WB[2] + vessel.surface_level(volumes[sample], *lean_of(R_WB[2])))
    return 0.0


def _stream(
    vessel: Vessel, volume: float, rate: float, X_WB: tuple[Array, Array], below: float
) -> tuple[Array, ...]:
    """A stream from the lip down to a height."""
    R_WB, p_WB = X_WB
    tilt, heading = lean_of(R_WB[2])
    p_WL = p_WB + R_WB @ vessel.lip_point(heading)
    head = max(float(vessel.liquid_head(volume, tilt, heading)), 1e-4)
    ahead, down = (float(v) for v in exit_velocity(head, tilt))
    t = np.linspace(0.0, float(fall_time(down, p_WL[2] - below)), _PIECES + 1)
    out = R_WB[:2, 2] / max(float(np.hypot(*R_WB[:2, 2])), 1e-9)
    middles = p_WL + np.column_stack([
        np.outer(ahead * t, out), -(down * t + 0.5 * GRAVITY * t * t)
    ])  # fmt: skip
    speeds = np.hypot(ahead, down + GRAVITY * t)
    radii = np.clip(np.sqrt(rate / (np.pi * speeds)), _THIN, _THICK)
    phi = 2.0 * np.pi * np.arange(_SIDES) / _SIDES
    # Rings across the way: one side horizontal, the other square to both.
    along = np.column_stack([np.outer(np.full_like(t, ahead), out), -(down + GRAVITY * t)])
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    side = np.array([-out[1], out[0], 0.0])
    other = np.cross(along, side)
    rings = middles[:, None] + radii[:, None, None] * (
        np.cos(phi)[:, None] * side + np.sin(phi)[:, None] * other[:, None]
    )
    if t[-1] <= 0.0:
        return ()
    return tuple(np.concatenate(pair) for pair in pairwise(rings))

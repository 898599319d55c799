"""Which obstacle a hand comes too near to first, as its fingertips go along a way.

Model: the way has parts along which the palm does not turn; between them it turns about the
vertical alone. Circles about hands and obstacles, as seen from above, sort out most pairs; spheres
are placed for the others.

Frames: W is the world, D the frame of the push, T as in `sim.hands.hand_model`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.collision.collision_scene import Obstacle
from sim.collision.collision_spheres import place_spheres
from sim.hands.hand_model import PostureSet
from sim.rotations import Array

Sweep = tuple[Array, Array]
"""A part of a way: the frame of the push R_WD, shape (3, 3), and points of T in W, (w, 3) [m]."""

_STEP = 0.025  # largest step of the hand along the stroke [m]
_AT_T, _AS_D = np.zeros((1, 3)), np.eye(3)[None]  # where T is about itself, how D stands in itself


def sweeps_along(points: Array, R_WD: Array, *, turned: bool) -> list[Sweep]:
    """The parts of a way.

    Args:
        points: of T: the start, the touch, and on to the end of the stroke, shape (w, 3) [m].
        R_WD: frame of the push at each of them, shape (w, 3, 3).
        turned: the palm turns along the stroke.
    """
    before, after = points[1:-1], points[2:]
    apart = np.linalg.norm(after - before, axis=1).max()
    n = max(1, int(np.ceil(apart / _STEP)))
    t = np.arange(n)[:, None] / n
    stroke = (before[:, None] + t * (after - before)[:, None]).reshape(-1, 3)
    along = np.vstack([points[:1], stroke, points[-1:]])
    if not turned:
        return [(R_WD[0], along)]
    which = np.array([0, *np.repeat(np.arange(1, len(before) + 1), n), -1])
    return list(zip(R_WD[which], along[:, None], strict=True))


def first_obstacles(
    hands: PostureSet, others: tuple[Obstacle, ...], sweeps: list[Sweep]
) -> NDArray[np.intp]:
    """The first of some obstacles that each hand comes too near to; −1 if none, shape (n,)."""
    stopped_by = np.full(len(hands), -1)
    if not others or not len(hands):
        return stopped_by
    near = [_obstacles_near(hands.circles, others, sweep) for sweep in sweeps]
    (beside,) = np.nonzero(np.any(near, axis=(0, 2)))
    spheres = hands[beside].spheres_along(_AS_D, _AT_T)[:, 0]
    for number, each in enumerate(others):
        for (R_WD, points), close in zip(sweeps, near, strict=True):
            (some,) = np.nonzero(close[beside, number] & (stopped_by[beside] < 0))
            if len(some):
                robot = place_spheres(spheres[some], R_WD, _AT_T)
                clear = each.is_clear_along(robot, points, each.clearance)
                stopped_by[beside[some[~clear]]] = number
    return stopped_by


def _obstacles_near(
    circles: Array, others: tuple[Obstacle, ...], sweep: Sweep
) -> NDArray[np.bool_]:
    """Which of o obstacles each hand may come too near to along a part of its way, shape (n, o).

    Args:
        circles: about the hands, shape (n, 3); see `PostureSet`.
        others: the obstacles.
        sweep: the part.
    """
    R_WD, points = sweep
    middles = np.array([each.middle for each in others])
    kept = np.array([each.around + each.clearance for each in others])
    apart = middles - (circles[:, :2] @ R_WD[:2, :2].T)[:, None]
    # As near as any point of the way brings it, or nearer.
    apart -= np.clip(apart, points[:, :2].min(axis=0), points[:, :2].max(axis=0))
    return np.asarray(np.hypot(apart[..., 0], apart[..., 1]) < circles[:, 2:] + kept)

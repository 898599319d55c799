"""Which obstacle a hand comes too near to first, as its fingertips go along a way.

Model: the way is looked at in small steps; the palm turns about the vertical alone. Circles about
hands and obstacles, as seen from above, sort out most pairs; spheres are placed for the others.

Frames: W is the world, D the frame of the push, T as in `sim.hands.hand_model`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.collision.collision_scene import Obstacle
from sim.collision.collision_spheres import sphere_parts
from sim.hands.hand_model import PostureSet
from sim.rotations import Array

_STEP = 0.025  # largest step of the hand along the stroke [m]
_TOGETHER = 384  # hands whose spheres a processor keeps at hand
_FEW = 24  # hands of which all spheres are looked at together
_AT_T, _AS_D = np.zeros((1, 3)), np.eye(3)[None]  # where T is about itself, how D stands in itself


class Sweep(NamedTuple):
    """Where the fingertips stop on their way.

    Attributes:
        R_WD: frame of the push at each place, shape (w, 3, 3).
        points: of T in W, shape (w, 3) [m].
    """

    R_WD: Array
    points: Array

    @classmethod
    def along(cls, points: Array, R_WD: Array) -> Sweep:
        """The sweep along a way: the start, the touch, and on to the end of the stroke.

        Args:
            points: of T there, shape (w, 3) [m].
            R_WD: frame of the push at each of them, shape (w, 3, 3).
        """
        before, after = points[1:-1], points[2:]
        apart = np.linalg.norm(after - before, axis=1).max()
        n = max(1, int(np.ceil(apart / _STEP)))
        t = np.arange(n)[:, None] / n
        stroke = (before[:, None] + t * (after - before)[:, None]).reshape(-1, 3)
        which = np.array([0, *np.repeat(np.arange(1, len(before) + 1), n), -1])
        return cls(R_WD[which], np.vstack([points[:1], stroke, points[-1:]]))


def first_obstacles(
    hands: PostureSet, others: tuple[Obstacle, ...], sweep: Sweep
) -> NDArray[np.intp]:
    """The first of some obstacles that each hand comes too near to; −1 if none, shape (n,)."""
    stopped_by = np.full(len(hands), -1)
    if not others or not len(hands):
        return stopped_by
    near = _obstacles_near(hands.circles, others, sweep)
    (beside,) = np.nonzero(near.any(axis=1))
    spheres = hands[beside].spheres_along(_AS_D, _AT_T)[:, 0]
    parts = [spheres[:, part] for part in sphere_parts(spheres.shape[1])]
    for number, each in enumerate(others):
        (close,) = np.nonzero(near[beside, number] & (stopped_by[beside] < 0))
        for k in range(0, len(close), _TOGETHER):
            clear = some = close[k : k + _TOGETHER]
            for part in parts if len(some) > _FEW else (spheres,):
                clear = clear[each.is_clear_along(part[clear], *sweep, each.clearance)]
            stopped_by[beside[some]] = number
            stopped_by[beside[clear]] = -1
    return stopped_by


def _obstacles_near(
    circles: Array, others: tuple[Obstacle, ...], sweep: Sweep
) -> NDArray[np.bool_]:
    """Which of o obstacles each hand may come too near to, shape (n, o).

    Args:
        circles: about the hands, shape (n, 3); see `PostureSet`.
        others: the obstacles.
        sweep: of the hands.
    """
    R_WD, points = sweep
    middles = np.array([each.middle for each in others])
    kept = np.array([each.around + each.clearance for each in others])
    # Seen from D, shape (w, o, 2).
    middles_D = (middles - points[:, None, :2]) @ R_WD[:, :2, :2]
    apart = middles_D[:, None] - circles[:, None, :2]
    near = apart[..., 0] ** 2 + apart[..., 1] ** 2 < (circles[:, 2:] + kept) ** 2
    return np.asarray(near.any(axis=0))

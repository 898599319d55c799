"""Which arm poses between home and the places of a motion are clear of table and objects.

Model: most of arm and hand is higher than everything that stands there, so only the spheres that
come below that height are placed.

Frames: W is the world, P the palm.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.collision.collision_scene import TABLE_CLEARANCE, CollisionScene, Obstacle
from sim.hands.mount import Mount
from sim.rotations import Array

_ROUNDING = 1e-9  # so that none is left out that is low [m]


@dataclass(frozen=True, eq=False)
class TransitClearance:
    """Clearance of arm and hand from all that stands on the table.

    Attributes:
        mount: of the arm.
        hand: spheres of the hand in P, shape (h, 4) [m].
        scenery: what stands there, but for what is moved.
        standing: that, in all places where it is by then.
    """

    mount: Mount
    hand: Array
    scenery: CollisionScene
    standing: Sequence[Obstacle]

    def are_free(self, q: Array) -> NDArray[np.bool_]:
        """Which arm poses, shape (n, joints), keep clear of everything, shape (n,)."""
        spheres, pose = self._low_spheres(q)
        hit = self.scenery.stops(spheres)
        for each in self.standing:
            hit |= each.hits(spheres, each.clearance)
        free = np.ones(len(q), dtype=bool)
        free[pose[hit]] = False
        return free

    @property
    def _height(self) -> float:
        """Height above which nothing is met [m]."""
        tops = [each.top + each.clearance for each in (*self.scenery.others, *self.standing)]
        return max([TABLE_CLEARANCE, *tops]) + _ROUNDING

    def _low_spheres(self, q: Array) -> tuple[Array, NDArray[np.intp]]:
        """Spheres in W that are not above everything, shape (m, 4), and the pose of each, (m,)."""
        height, (at, radius) = self._height, (self.hand[:, :3], self.hand[:, 3])
        R_WP, p_WP = self.mount.palm_poses(q)
        pose, which = np.nonzero(R_WP[:, 2] @ at.T + p_WP[:, 2:] - radius < height)
        placed = np.empty((len(pose), 4))
        placed[:, :3] = (R_WP[pose] @ at[which, :, None])[..., 0] + p_WP[pose]
        placed[:, 3] = radius[which]
        arm = self.mount.arm_spheres(q)
        low = arm[..., 2] - arm[..., 3] < height
        return np.vstack([placed, arm[low]]), np.append(pose, np.nonzero(low)[0])

"""Protocol of an arm: all that planning and control know of it.

Frames: A is the arm's base, F its flange. Another arm is a folder of its own in this room.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib.resources.abc import Traversable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.rotations import Array


class ArmKinematics(Protocol):
    """Kinematics of an arm with n joints."""

    joint_names: tuple[str, ...]
    """Names of the joints, from the base on, n of them."""

    efforts: Array
    """Largest torque of each joint, shape (n,) [N·m]."""

    branches: int
    """Number of solutions of the inverse at one redundancy angle."""

    redundancy_samples: Array
    """Redundancy angles worth trying, in even steps, shape (m,) [rad]; one if there is none."""

    p_FW: Array
    """Centre of the wrist in F, on which `range_excess` decides, shape (3,) [m]."""

    link_radius: float
    """Radius of the last links about their axis [m]."""

    model_file: Traversable
    """URDF model, for a simulator."""

    base_link: str
    """Name of the model's link whose frame is A."""

    flange_link: str
    """Name of the model's link whose frame is F."""

    def __hash__(self) -> int: ...

    def forward(self, q: Array) -> tuple[Array, Array]:
        """R_AF, shape (..., 3, 3), and p_AF, shape (..., 3) [m], of joint angles (..., n)."""

    def inverse(
        self,
        R_AF: Array,
        p_AF: Array,
        redundancy: Array,
        branches: Sequence[int] | NDArray[np.intp] | None = None,
    ) -> tuple[Array, NDArray[np.bool_]]:
        """All joint angles that bring the flange to a pose with a given redundancy angle.

        Args:
            R_AF: flange orientations, shape (k, 3, 3).
            p_AF: flange positions, shape (k, 3) [m].
            redundancy: the freedom that a flange pose leaves, shape (k,) [rad].
            branches: which of the solutions, b of them, shape (b,), or (k, b) if they differ; all
                if not given.

        Returns:
            Joint angles, shape (k, b, n) [rad], and which of them reach the pose within the joint
            limits and away from singularities, shape (k, b).
        """

    def torques(self, q: Array, p_AC: Array, f_A: Array) -> Array:
        """Torques with which the joints exert a force at a point, Jᵀf, shape (..., n) [N·m].

        Args:
            q: joint angles, shape (..., n) [rad].
            p_AC: the point in A, shape (..., 3) [m].
            f_A: the force on what is touched, in A, shape (..., 3) [N].
        """

    def joint_room(self, q: Array) -> Array:
        """Least distance of any joint from its limits; negative beyond them, shape (...) [rad]."""

    def is_regular(self, q: Array) -> NDArray[np.bool_]:
        """Joint angles (..., n) that are well away from singularities, shape (...)."""

    def range_excess(self, p_AW: Array, margin: float) -> Array:
        """How much wrist centres (..., 3) are too far from the arm, or too near to it, (...) [m].

        A quick test before the inverse: where it is not 0, there is no solution.

        Args:
            p_AW: in A [m].
            margin: room that the joints are to keep to their limits [rad].
        """

    def spheres(self, q: Array) -> Array:
        """Spheres that cover what moves of the arm, in A, shape (..., k, 4): centre, radius [m]."""

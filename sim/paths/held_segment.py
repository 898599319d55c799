"""One leg of the way of what a hand holds.

Frames: W is the world, B the held object, C a point of it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sim.rotations import Array, axis_rotation

_STEP, _TURN_STEP = 0.025, np.radians(8.0)  # between poses that are looked at


@dataclass(frozen=True, eq=False)
class HeldSegment:
    """A point C of the held object goes straight while it turns evenly about an axis.

    Attributes:
        phase: of the trace.
        R_WB: orientation at the start, shape (3, 3).
        p_BC: the point, shape (3,) [m].
        start, end: where it is in W, shape (3,) [m].
        axis: of the turn in W, shape (3,).
        turn: angle altogether [rad].
        speed, rate: largest ones of the point [m/s] and of the turn [rad/s].
        free: whether the hand is open, and the object stands where the leg begins or ends.
    """

    phase: str
    R_WB: Array
    p_BC: Array
    start: Array
    end: Array
    axis: Array
    turn: float
    speed: float
    rate: float
    free: bool = False

    def poses_at(self, shares: Array) -> tuple[Array, Array]:
        """R_WB, shape (n, 3, 3), and p_WB, shape (n, 3), after shares of the leg, shape (n,)."""
        R_WB = axis_rotation(self.axis, self.turn * shares) @ self.R_WB
        p_WC = self.start + shares[:, None] * (self.end - self.start)
        return R_WB, p_WC - R_WB @ self.p_BC

    def sample_shares(self) -> Array:
        """Shares between which nothing is missed."""
        far = np.linalg.norm(self.end - self.start)
        n = int(np.ceil(max(far / _STEP, abs(self.turn) / _TURN_STEP, 1.0)))
        return np.linspace(0.0, 1.0, n + 1)

    @property
    def share_rate(self) -> float:
        """Largest share of the leg per time [1/s]."""
        far = float(np.linalg.norm(self.end - self.start))
        return min(self.speed / max(far, 1e-9), self.rate / max(abs(self.turn), 1e-9))

    @property
    def end_pose(self) -> tuple[Array, Array]:
        """R_WB and p_WB at the end."""
        R_WB, p_WB = self.poses_at(np.ones(1))
        return R_WB[0], p_WB[0]

    def way_back(self, **changes: object) -> HeldSegment:
        """The same leg the other way."""
        R_WB, _ = self.end_pose
        there = replace(self, R_WB=R_WB, start=self.end, end=self.start, turn=-self.turn)
        return replace(there, **changes)  # type: ignore[arg-type]

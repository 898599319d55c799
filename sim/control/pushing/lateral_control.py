"""Keeping an object on its line while one fingertip pushes it.

Model: quasi-static sliding with an ellipsoidal limit surface of friction radius c̄ about a centre
of friction. The fingertip, a sphere of radius r that does not turn, rolls on the face without
slipping. With κ the face's curvature (0 of a flat one, 1/R of a round one), d the distance from the
face to the object's middle, s the contact's offset along the face and g that of the centre of
friction, the face's inward normal at the contact has the heading φ = θ − κ s, and with the
travelled distance as time

    θ′ = m (α (φ − u) − β (ν s − g)),    s′ = ρ r θ′,    y′ = u + d θ′
    α = d / (d² + c̄²),  β = 1 / (d² + c̄²),  ν = 1 − κ d,  ρ = 1 / (1 + κ r)

where θ is the heading error, y the lateral error of the middle and u the slope of the fingertip's
path; m is 1 if c̄ is as believed. On a flat face the middle is ahead of the tip by d + r along the
normal and aside by s; on a round one it lies on the normal. This is unstable, so (θ, s, g, m) are
estimated by a Kalman filter from late camera frames and u is chosen by least squares over what
remains of the way.

Frame: D has its x axis along the push and its origin at W's; θ is the heading of the face's inward
normal in D, where the face would be touched in its middle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.rotations import Array, rot_z, wrap, yaw_of
from sim.worlds.ports import SeenPose

_STEPS = 20  # of the remaining way in the least squares
_SHORTEST = 0.01  # remaining way over which it is solved at least [m]
_LATERAL_WEIGHT = 1.0 / 0.0015  # at the end [1/m]
_HEADING_WEIGHT = 1.0 / np.radians(1.0)  # at the end [1/rad]
# With its centre of friction aside of the contact an object goes straight only at an angle.
_ON_THE_WAY = np.radians(4.0)  # heading on the way that weighs one, root mean square [rad]
_OF_LIMIT = 0.15  # or this share of the largest turn allowed
_INPUT_WEIGHT = 4.0
_LARGEST_SLOPE = 0.4  # relative to φ: inside the friction cone, so that the tip sticks
# Of the steps of the remaining way, how many a later one comes after an earlier one.
_SINCE = np.subtract.outer(np.arange(_STEPS), np.arange(_STEPS))

# Growth of the filter's doubt per centimetre of way, from friction that varies and tips that slip.
# Of heading [rad], contact and centre of friction [m], and m.
_DRIFT = np.array([0.004, 0.0002, 0.0004, 0.02])
_LEAST, _MOST = 0.25, 2.0  # values that m may take


@dataclass(frozen=True)
class Pushed:
    """The robot's beliefs about an object that it steers.

    Attributes:
        depth: distance d from the touched face to the object's middle, along the normal [m].
        friction_radius: c̄ [m].
        tip_radius: r of the fingertip [m].
        facing: heading of the touched face's inward normal in B [rad].
        curvature: κ of the face [1/m].
        centre: offset g of the centre of friction from the middle, to the left of the push [m].
    """

    depth: float
    friction_radius: float
    tip_radius: float
    facing: float = 0.0
    curvature: float = 0.0
    centre: float = 0.0

    @property
    def alpha(self) -> float:
        """α = d / (d² + c̄²) [1/m]."""
        return self.depth / (self.depth**2 + self.friction_radius**2)

    @property
    def beta(self) -> float:
        """β = 1 / (d² + c̄²) [1/m²]."""
        return 1.0 / (self.depth**2 + self.friction_radius**2)

    @property
    def flatness(self) -> float:
        """ν = 1 − κ d: lever of the contact about the middle per offset along the face."""
        return 1.0 - self.curvature * self.depth

    @property
    def rolling(self) -> float:
        """ρ = 1 / (1 + κ r): turn of the normal at the contact per turn of the object."""
        return 1.0 / (1.0 + self.curvature * self.tip_radius)

    def turning(self, ahead: float, aside: float) -> Array:
        """Turn of the object by (θ, s, g, 1) when the tip goes so far in D, m being 1; (4,)."""
        by_heading, by_lever = self.alpha * ahead, self.beta * ahead
        by_contact = -self.curvature * by_heading - self.flatness * by_lever
        return np.array([by_heading, by_contact, by_lever, -self.alpha * aside])

    def middle(self, heading: float, contact: float) -> tuple[Array, Array]:
        """The middle from the tip in D, shape (2,) [m], and its derivatives by θ and s, (2, 2)."""
        normal = heading - self.curvature * contact
        R = rot_z(normal)[:2, :2]
        ahead, aside = self.depth + self.tip_radius, -self.flatness * contact
        by_normal = R @ np.array([-aside, ahead])
        by_contact = -self.curvature * by_normal - self.flatness * R[:, 1]
        return R @ np.array([ahead, aside]), np.column_stack([by_normal, by_contact])


@dataclass
class _State:
    """The belief at one time: tip in D, and (θ, s, g, m)."""

    time: float
    tip: Array
    belief: Array


class LateralController:
    """Estimates how the object moves and says which way the fingertip must go.

    Args:
        pushed: the object.
        direction: heading of the push in W [rad].
        tip: centre of the fingertip in W when it touches, shape (2,) [m].
        seen: where the object was seen before, x, y in W [m] and heading of the face's inward
            normal in W [rad].
        turn: by which the object is to turn [rad].
        limit: largest turn on the way [rad].
        deviations: standard deviations of heading [rad], contact and centre of friction [m] and of
            c̄ [m] at the start.
        camera: standard deviations of a frame's position [m] and heading [rad].
    """

    def __init__(
        self,
        pushed: Pushed,
        direction: float,
        tip: Array,
        seen: tuple[float, float, float],
        *,
        turn: float = 0.0,
        limit: float = np.inf,
        deviations: tuple[float, float, float, float],
        camera: tuple[float, float],
    ) -> None:
        self._R_DW = rot_z(-direction)[:2, :2]
        self._direction = direction
        self._pushed = pushed
        self._way_weight = 1.0 / min(_ON_THE_WAY, _OF_LIMIT * limit) / np.sqrt(_STEPS)
        *others, radius = deviations
        by_radius = 2.0 * pushed.friction_radius * pushed.beta
        self._P = np.diag(np.square([*others, by_radius * radius]))
        self._R = np.diag(np.square([*2 * (max(camera[0], 1e-6),), max(camera[1], 1e-4)]))
        x, y, normal = seen
        heading = float(wrap(normal - direction))
        tip_D, middle = self._R_DW @ tip, self._R_DW @ np.array([x, y])
        c, s = np.cos(heading), np.sin(heading)
        aside = float(np.array([-s, c]) @ (tip_D - middle))
        self._line = float(middle[1])
        self._wanted = heading + turn
        belief = np.array([heading, pushed.rolling * aside, pushed.centre, 1.0])
        self._history = [_State(0.0, tip_D, belief)]
        self._first = float(self._middle[0])

    @property
    def _now(self) -> _State:
        return self._history[-1]

    @property
    def _middle(self) -> Array:
        """The object's middle in D, shape (2,) [m]."""
        now = self._now
        return now.tip + self._pushed.middle(*now.belief[:2])[0]

    @property
    def travelled_distance(self) -> float:
        """Way of the middle along the push since the touch [m]."""
        return float(self._middle[0] - self._first)

    def update_from_tip(self, time: float, tip: Array) -> None:
        """Takes the fingertip's centre in W, shape (2,) [m], at a time [s]."""
        now = self._now
        tip_D = self._R_DW @ tip
        step = tip_D - now.tip
        *others, mobility = now.belief
        turning = self._pushed.turning(*step)
        turned = float(turning @ [*others, 1.0])
        rolled = np.array([1.0, self._pushed.rolling * self._pushed.tip_radius, 0.0, 0.0])
        F = np.eye(4) + np.outer(rolled, [*mobility * turning[:3], turned])
        drift = np.square(_DRIFT) * np.linalg.norm(step) / 0.01
        self._P = F @ self._P @ F.T + np.diag(drift)
        self._history.append(_State(time, tip_D, now.belief + mobility * turned * rolled))

    def update_from_camera(self, time: float, pose: SeenPose) -> None:
        """Takes a camera frame of an earlier time; it corrects everything believed since."""
        past = [state for state in self._history if state.time >= time - 1e-9]
        if not past or past[0] is self._history[0]:
            return
        then = past[0]
        middle, slope = self._pushed.middle(*then.belief[:2])
        p_D = self._R_DW @ pose.p_WB[:2] - then.tip
        heading = float(yaw_of(pose.R_WB)) + self._pushed.facing - self._direction
        error = np.array([*(p_D - middle), wrap(heading - then.belief[0])])
        H = np.zeros((3, 4))
        H[:2, :2], H[2, 0] = slope, 1.0
        K = self._P @ H.T @ np.linalg.inv(H @ self._P @ H.T + self._R)
        self._P = (np.eye(4) - K @ H) @ self._P
        for state in past:
            state.belief = state.belief + K @ error
            state.belief[3] = np.clip(state.belief[3], _LEAST, _MOST)

    def slope(self, remaining: float) -> float:
        """Slope u = dy/dx of the fingertip's path in D, for the remaining way [m]."""
        pushed, (heading, contact, centre, mobility) = self._pushed, self._now.belief
        step = max(remaining, _SHORTEST) / _STEPS
        turning = mobility * pushed.turning(step, step)
        # One step of (y, θ, s, g) and what the slope adds to it.
        change = np.array([pushed.depth, 1.0, pushed.rolling * pushed.tip_radius, 0.0])
        A = np.eye(4)
        A[:, 1:] += np.outer(change, turning[:3])
        B = turning[3] * change + np.array([step, 0.0, 0.0, 0.0])
        state = np.array([self._middle[1] - self._line, heading, contact, centre])
        # Columns: what comes of the state alone and of a slope in one step, so many steps later.
        ahead = [np.column_stack([A @ state, B])]
        for _ in range(_STEPS - 1):
            ahead.append(A @ ahead[-1])
        free, by_slope = np.moveaxis(np.array(ahead)[:, :2], -1, 0)
        headings = self._way_weight * np.where(_SINCE < 0, 0.0, by_slope[_SINCE, 1])
        weights = np.array([_LATERAL_WEIGHT, _HEADING_WEIGHT])
        wanted = np.array([0.0, self._wanted])
        rows = np.vstack([headings, weights[:, None] * by_slope[::-1].T])
        missed = np.append(
            self._way_weight * (free[:, 1] - self._wanted), weights * (free[-1] - wanted)
        )
        squares = rows.T @ rows + _INPUT_WEIGHT**2 / _STEPS * np.eye(_STEPS)
        u = np.linalg.solve(squares, -rows.T @ missed)[0]
        normal = heading - pushed.curvature * contact
        return float(np.clip(u, normal - _LARGEST_SLOPE, normal + _LARGEST_SLOPE))

"""Keeping a box on its line while one fingertip pushes it.

Model: quasi-static sliding with an ellipsoidal limit surface of friction radius c̄; the fingertip
sticks to the face at the lateral offset y_c from the box's middle, the distance a ahead of which
the centre of friction lies. With the travelled distance as time, the heading error θ and the
lateral error y follow

    θ′ = α (θ − u) − β y_c,    y′ = u + a θ′,    α = a / (a² + c̄²),  β = 1 / (a² + c̄²)

where u is the slope of the fingertip's path. This is unstable, so (θ, y_c) are estimated by a
Kalman filter from late camera frames and u is chosen by least squares over what remains of the
way.

Frame: D has its x axis along the push and its origin at W's; θ is the heading of the face's inward
normal in D.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.rotations import Array, wrap, yaw_of
from sim.vision import SeenPose

_STEPS = 16  # of the remaining way in the least squares
_SHORTEST = 0.03  # remaining way over which it is solved at least [m]
_LATERAL_WEIGHT = 1.0 / 0.005  # at the end [1/m]
_HEADING_WEIGHT = 1.0 / np.radians(0.7)  # at the end [1/rad]
_WAY_WEIGHT = 1.0 / np.radians(1.5)  # of the heading on the way, root mean square [1/rad]
_INPUT_WEIGHT = 2.0
_LARGEST_SLOPE = 0.4  # relative to θ: inside the friction cone, so that the tip sticks

# Growth of the filter's doubt per centimetre of way, from friction that varies.
_HEADING_DRIFT = 0.004  # [rad]
_CONTACT_DRIFT = 0.0004  # [m]


@dataclass(frozen=True)
class PushedBox:
    """What the robot believes of a box for steering.

    Attributes:
        ahead: distance a from the fingertip's centre to the box's middle, along the normal [m].
        friction_radius: c̄ [m].
        facing: heading of the pushed face's inward normal in B [rad].
    """

    ahead: float
    friction_radius: float
    facing: float = 0.0

    @property
    def alpha(self) -> float:
        """α = a / (a² + c̄²) [1/m]."""
        return self.ahead / (self.ahead**2 + self.friction_radius**2)

    @property
    def beta(self) -> float:
        """β = 1 / (a² + c̄²) [1/m²]."""
        return 1.0 / (self.ahead**2 + self.friction_radius**2)


@dataclass
class _State:
    """The belief at one time: tip in D, θ and y_c."""

    time: float
    tip: Array
    heading: float
    contact: float


class LineKeeper:
    """Estimates how the box moves and says which way the fingertip must go.

    Args:
        box: what is pushed.
        direction: heading of the push in W [rad].
        tip: centre of the fingertip in W when it touches, shape (2,) [m].
        seen: where the box was seen before, x, y in W [m] and heading of the face's inward
            normal in W [rad].
        deviations: standard deviations of heading [rad] and contact offset [m] at the start.
        camera: standard deviations of a frame's position [m] and heading [rad].
    """

    def __init__(
        self,
        box: PushedBox,
        direction: float,
        tip: Array,
        seen: tuple[float, float, float],
        *,
        deviations: tuple[float, float],
        camera: tuple[float, float],
    ) -> None:
        c, s = np.cos(direction), np.sin(direction)
        self._R_DW = np.array([[c, s], [-s, c]])
        self._direction = direction
        self._box = box
        self._P = np.diag(np.square(deviations))
        self._R = np.diag(np.square([camera[0], camera[0], max(camera[1], 1e-4)])) + 1e-12 * np.eye(
            3
        )
        x, y, normal = seen
        heading = float(wrap(normal - direction))
        tip_D = self._R_DW @ tip
        middle = self._R_DW @ np.array([x, y])
        contact = float((_rotation(heading).T @ (tip_D - middle))[1])
        self._line = float(middle[1])
        self._wanted = heading
        self._history = [_State(0.0, tip_D, heading, contact)]

    @property
    def _now(self) -> _State:
        return self._history[-1]

    def moved(self, time: float, tip: Array) -> None:
        """Takes the fingertip's centre in W, shape (2,) [m], at a time [s]."""
        now, box = self._now, self._box
        tip_D = self._R_DW @ tip
        step = tip_D - now.tip
        turned = box.alpha * (now.heading * step[0] - step[1]) - box.beta * now.contact * step[0]
        F = np.array([[1.0 + box.alpha * step[0], -box.beta * step[0]], [0.0, 1.0]])
        drift = np.square([_HEADING_DRIFT, _CONTACT_DRIFT]) * np.linalg.norm(step) / 0.01
        self._P = F @ self._P @ F.T + np.diag(drift)
        self._history.append(_State(time, tip_D, now.heading + turned, now.contact))

    def seen(self, time: float, pose: SeenPose) -> None:
        """Takes a camera frame of an earlier time; it corrects everything believed since."""
        past = [state for state in self._history if state.time >= time - 1e-9]
        if not past or past[0] is self._history[0]:
            return
        then = past[0]
        R = _rotation(then.heading)
        middle = then.tip + R @ np.array([self._box.ahead, -then.contact])
        p_D = self._R_DW @ pose.p_WB[:2]
        normal = self._normal_of(pose)
        error = np.array([*(p_D - middle), wrap(normal - self._direction - then.heading)])
        H = np.zeros((3, 2))
        H[:2, 0] = R @ np.array([then.contact, self._box.ahead])
        H[:2, 1] = R @ np.array([0.0, -1.0])
        H[2, 0] = 1.0
        K = self._P @ H.T @ np.linalg.inv(H @ self._P @ H.T + self._R)
        correction = K @ error
        self._P = (np.eye(2) - K @ H) @ self._P
        for state in past:
            state.heading += float(correction[0])
            state.contact += float(correction[1])

    def _normal_of(self, pose: SeenPose) -> float:
        """Heading of the pushed face's inward normal in W, as the box is seen to be turned."""
        return float(yaw_of(pose.R_WB)) + self._box.facing

    def slope(self, remaining: float) -> float:
        """Slope u = dy/dx of the fingertip's path in D, for the remaining way [m]."""
        now, box = self._now, self._box
        middle = now.tip + _rotation(now.heading) @ np.array([box.ahead, -now.contact])
        step = max(remaining, _SHORTEST) / _STEPS
        a, alpha, beta = box.ahead, box.alpha, box.beta
        A = np.array([[1.0, a * alpha * step], [0.0, 1.0 + alpha * step]])
        B = np.array([(1.0 - a * alpha) * step, -alpha * step])
        drift = -beta * now.contact * step * np.array([a, 1.0])
        wanted = np.array([0.0, self._wanted])
        state, G = np.array([middle[1] - self._line, now.heading]), np.zeros((2, _STEPS))
        rows, missed = [_INPUT_WEIGHT / np.sqrt(_STEPS) * np.eye(_STEPS)], [np.zeros(_STEPS)]
        for i in range(_STEPS):
            state, G = A @ state + drift, A @ G
            G[:, i] = B
            weight = _WAY_WEIGHT / np.sqrt(_STEPS)
            rows.append(weight * G[1:])
            missed.append(weight * (state - wanted)[1:])
        weights = np.array([_LATERAL_WEIGHT, _HEADING_WEIGHT])
        rows.append(weights[:, None] * G)
        missed.append(weights * (state - wanted))
        u = np.linalg.lstsq(np.vstack(rows), -np.concatenate(missed))[0][0]
        return float(np.clip(u, now.heading - _LARGEST_SLOPE, now.heading + _LARGEST_SLOPE))


def _rotation(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])

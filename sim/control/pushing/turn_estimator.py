"""Estimate of the turn of an object while one fingertip pushes it around.

Model: the fingertip sticks to the object and moves in a direction that is fixed in B, so the object
turns at a constant rate κ per travel s of the contact (see `objectmodels.mechanics.push_motion`);
the object model knows κ roughly. A Kalman filter estimates the turn θ, κ, and the slip y along the
face, from the fingertip's motion and from late camera frames:

    θ′ = κ,    κ′ = 0,    y′ = 0

A frame of an earlier time shows θ − κ (s − s_then), so that it needs no state of the past but the
travel and the fingertip's place.

Frame: W; θ is relative to the object as it was seen before the push.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.rotations import Array, rot_z, wrap, yaw_of
from sim.worlds.ports import SeenPose

# Growth of the filter's doubt per centimetre of way, from friction that varies.
_TURN_DRIFT = 0.004  # [rad]
_RATE_DRIFT = 0.05  # share of the rate
_SLIP_DRIFT = 0.0008  # [m]
_RATE_DOUBT = 0.4  # share of the rate that is not known at first


@dataclass(frozen=True)
class TurnedObject:
    """The robot's beliefs when the finger begins to push.

    Attributes:
        yaw: of the object as seen before [rad].
        inward: unit normal into the touched face, shape (2,).
        middle: from the fingertip's centre to B's origin, shape (2,) [m].
        direction: unit direction of the contact's motion, shape (2,).
        radius: of the fingertip [m].
        rate: κ, how far the object turns per travel of the contact [rad/m].
    """

    yaw: float
    inward: Array
    middle: Array
    direction: Array
    radius: float
    rate: float

    @property
    def along(self) -> Array:
        """Unit vector along the face, ẑ × inward, shape (2,)."""
        return np.array([-self.inward[1], self.inward[0]])


@dataclass(frozen=True)
class _Past:
    """A time, and the contact's travel and the fingertip's centre then."""

    time: float
    travel: float
    tip: Array


class TurnEstimator:
    """Estimates the turn of an object.

    Args:
        body: what is pushed.
        tip: centre of the fingertip in W when it touches, shape (2,) [m].
        slip: how far along the face it is from where the body has it [m].
        deviations: standard deviations of the seen heading [rad] and of the slip [m].
        camera: standard deviations of a frame's position [m] and heading [rad].

    Attributes:
        travel: of the contact [m].
    """

    def __init__(
        self,
        body: TurnedObject,
        tip: Array,
        slip: float,
        *,
        deviations: tuple[float, float],
        camera: tuple[float, float],
    ) -> None:
        self._body = body
        self._x = np.array([0.0, body.rate, slip])
        turn, along = deviations
        self._P = np.diag(np.square([turn, _RATE_DOUBT * body.rate, along]))
        self._R = np.diag(np.square([camera[0], camera[0], max(camera[1], 1e-4)])) + 1e-12 * np.eye(
            3
        )
        self._past: list[_Past] = []
        self._tip = tip
        self.travel = 0.0

    @property
    def turn_angle(self) -> float:
        """θ [rad]."""
        return float(self._x[0])

    @property
    def rate(self) -> float:
        """κ [rad/m]."""
        return float(self._x[1])

    @property
    def slip(self) -> float:
        """Offset of the contact along the face from where it was to be, along ẑ × inward [m]."""
        return float(self._x[2])

    def update_from_tip(self, time: float, tip: Array) -> None:
        """Takes the fingertip's centre in W, shape (2,) [m], at a time [s]."""
        body, step = self._body, tip - self._tip
        # The contact moves as the tip's centre does, and around it.
        around = self.rate * body.radius * float(body.along @ body.direction)
        way = float(step @ (rot_z(self.turn_angle)[:2, :2] @ body.direction)) / (1.0 - around)
        self._tip = tip
        self.travel += way
        F = np.array([[1.0, way, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        drift = np.square([_TURN_DRIFT, _RATE_DRIFT * body.rate, _SLIP_DRIFT])
        self._x = F @ self._x
        self._P = F @ self._P @ F.T + np.diag(drift) * abs(way) / 0.01
        self._past.append(_Past(time, self.travel, tip))

    def update_from_camera(self, time: float, pose: SeenPose) -> None:
        """Takes a camera frame of an earlier time."""
        body = self._body
        then = next((past for past in self._past if past.time >= time - 1e-9), None)
        if then is None or then is self._past[0]:
            return
        since = self.travel - then.travel
        turned = self.turn_angle - self.rate * since
        R = rot_z(turned)[:2, :2]
        arm = body.middle - self.slip * body.along
        error = np.array(
            [
                *(pose.p_WB[:2] - then.tip - R @ arm),
                wrap(float(yaw_of(pose.R_WB)) - body.yaw - turned),
            ]
        )
        swing = R @ np.array([-arm[1], arm[0]])
        H = np.zeros((3, 3))
        H[:2, 0], H[2, 0] = swing, 1.0
        H[:, 1] = -since * H[:, 0]
        H[:2, 2] = -R @ body.along
        K = self._P @ H.T @ np.linalg.inv(H @ self._P @ H.T + self._R)
        self._x = self._x + K @ error
        self._P = (np.eye(3) - K @ H) @ self._P

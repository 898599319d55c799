"""A push that turns an object: one finger off the middle of a face, the palm turning along.

Law: as in `sim.control.pushing.force_control`, the contact advances while less than the force limit
is felt; its direction is fixed relative to the face, which turns. The turn is estimated by
`sim.control.pushing.turn_estimator`; the speed falls with what remains of it, and the push ends
when the estimate reaches it.
"""

from __future__ import annotations

import numpy as np

from objectmodels import ObjectModel
from objectmodels.mechanics.push_motion import touched_faces, turning_motion
from sim.control.pushing.force_control import ExecutionContext, ForceController
from sim.control.pushing.push_guards import MOVED, Guards
from sim.control.pushing.turn_estimator import TurnedObject, TurnEstimator
from sim.rotations import Array, rot_z
from sim.traces.trace import EndReason

_CONTACT = 0.8  # speed of the contact as a share of that of the fingertip, which is farther out
_BRAKING = 2.0  # turning rate per remaining turn near the end [1/s]
_SLOWEST = np.radians(1.5)  # turning rate at the end [rad/s]
_FOLLOWS = 0.1  # share of its error that the palm's heading loses in a control step
_FACE_END = 0.002  # distance from the end of a face at which the push stops [m]


class TurnControl(ForceController):
    """One push that turns an object, from before the face to its end."""

    def __init__(self, errand: ExecutionContext) -> None:
        super().__init__(errand)
        self._direction = self._u
        # In B: where the face is touched, and where along it, half its width, its curvature.
        outward = self._target.pose.R_WB.T @ -self.way.inward
        self._point = np.array([self.plan.push.p_BC])
        self._normal = _normal(self._target.model, outward)[None]
        (self._face,) = touched_faces(self._target.model, self._point[:, :2], self._normal[:, :2])

    def act(self) -> tuple[EndReason, str]:
        """Pushes until an end or a guard; returns which and why."""
        push = self.plan.push
        asked = f"turning it by {np.degrees(push.turn):.0f}° with at most {push.force_limit:.1f} N"
        self._begin(asked)
        command = self.commanded
        keeper, guards = self._keeper(), Guards(self.plan, self._period)
        limits = self._limits()
        speed = start = self._start()
        while True:
            now, elapsed, felt = self.recorder.port.time, self._elapsed_time, self._felt
            here = self._here.midpoint
            self._inform(keeper)
            stopped = limits.end(elapsed, now, here, felt, self.recorder.frames)
            end = self._turn_end(keeper) or self._at_an_end_of_the_face(keeper)
            end = end or guards.end(elapsed, keeper.travel, felt, self._tilt) or stopped
            if end is not None:
                return end
            speed = self._speed(speed, start, keeper)
            advance = speed * self._room() * self._period
            self._follow(keeper, advance)
            # The finger's spring, bent in the direction of the force, turns along.
            bent = command - here
            swung = rot_z(keeper.rate * advance) @ bent - bent
            command = command + advance * self._u + swung
            self._step(command, self._u)

    def _turn_end(self, keeper: TurnEstimator) -> tuple[EndReason, str] | None:
        if (
            abs(keeper.turn_angle) < abs(self.plan.push.turn)
            or keeper.turn_angle * self.plan.push.turn < 0
        ):
            return None
        return "turned", f"it was seen to turn by {np.degrees(keeper.turn_angle):.1f}°"

    def _at_an_end_of_the_face(self, keeper: TurnEstimator) -> tuple[EndReason, str] | None:
        at, half, curvature = self._face
        # Along ẑ × inward, which is against the face's tangent.
        if curvature == 0.0 and abs(at - keeper.slip) > half - _FACE_END:
            return "guard", f"the fingertip slid {1e3 * abs(keeper.slip):.0f} mm, off the face"
        return None

    def _speed(self, before: float, start: float, keeper: TurnEstimator) -> float:
        """Largest speed of the contact now [m/s]: slow until it moves, and as the end is near."""
        if abs(keeper.travel) < MOVED:
            return start
        remaining = abs(self.plan.push.turn - keeper.turn_angle)
        at_end = float(max(_SLOWEST, _BRAKING * remaining) / abs(keeper.rate))
        return self._faster(before, min(at_end, _CONTACT * self.plan.push.speed))

    def _follow(self, keeper: TurnEstimator, advance: float) -> None:
        """Turns palm and direction with the object."""
        self.turned += keeper.rate * advance
        self.turned += _FOLLOWS * (keeper.turn_angle - self.turned)
        R = rot_z(self.turned)
        self._u = R @ self._direction
        self.recorder.inward = R @ self.way.inward

    # -- what is known -------------------------------------------------------------------------

    def _keeper(self) -> TurnEstimator:
        """The estimate of the turn, from what is believed at the touch."""
        pose, inward = self._target.pose, self.way.inward[:2]
        here, centre = self._here.midpoint[:2], self.way.touch[:2]
        along = np.array([-inward[1], inward[0]])
        body = TurnedObject(
            yaw=pose.yaw,
            inward=inward,
            middle=pose.p_WB[:2] - centre,
            direction=self._direction[:2],
            radius=self._tip_radius,
            rate=self._rate(),
        )
        return TurnEstimator(
            body,
            here,
            float((here - centre) @ along),
            deviations=self._look,
            camera=self._camera,
        )

    def _rate(self) -> float:
        """Turn per travel of the contact, as the object's model has it [rad/m]."""
        inward, u = self.way.inward, self._direction
        slant = float(np.arctan2(inward[0] * u[1] - inward[1] * u[0], inward @ u))
        turn = self.plan.push.turn
        predicted = turning_motion(self._target.model, self._point, self._normal, slant, turn)
        travel = float(predicted.travel[0])
        return turn / (travel if np.isfinite(travel) else self.plan.push.stroke)


def _normal(model: ObjectModel, outward: Array) -> Array:
    """Level normal of the face that looks most along a direction in B, shape (3,).

    A plan is made from an earlier look at the object: its direction is that of the face but for
    the noise of two looks.
    """
    faces = model.faces(np.array([np.arctan2(-outward[1], -outward[0])]))
    level = [np.array([*face.normal[:2], 0.0]) / np.hypot(*face.normal[:2]) for face in faces]
    return max(level, key=lambda normal: float(normal @ outward))

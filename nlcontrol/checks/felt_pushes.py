"""What became of a pushed object as the fingertips felt it, for where no camera sees it.

Model: what slides goes as far as the fingertips, under a force that stays as it is. What tips over
an edge gives way: the force on it falls in proportion to the tilt that is left until it falls by
itself, and is gone when it does (moments about the edge, as in `objectmodels.mechanics`); then it
lies on the side to which it was pushed. What slid in the end may have leant on its way, by no more
than the share that its force ever fell. A push by one fingertip that loses its force is not told:
what it pushed may have turned away from it.

How far it turned on its slide the line between two fingertips tells. One fingertip is a pivot, and
the direction of its force tells: the table's friction is against the way of the centre of mass, so
that this goes where the force f points, and not where the fingertip goes, v [goyal-1991]. With the
lever l from the contact to the centre of mass,

    ω = (v × f) / (f · l).

Where the force passes it far to the side, the ellipsoidal limit surface tells it from the friction
radius c̄, pushed a behind and b beside it [howe-cutkosky-1996]: dψ/ds = b / (c̄² + a² + b²).

Frames: W is the world, T a fingertip.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.transform import Rotation

from nlcontrol.checks import trace_measures as measures
from sim.control.pose_tracks import FeltEnd

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from objectmodels import ObjectModel
    from sim.control.pose_tracks import Array
    from sim.traces.trace import Trace

FELT = 0.15
"""Least force that is told from nothing by sensors of such hands, averaged [N]."""

STAYS, GONE = 0.7, 0.35
"""Shares of the first force on the way: more at its end, and it slid; less, and it tipped over."""

LEAST_WAY, SHORT = 0.001, 0.008
"""Ways of the fingertips: less is none; on a short one a force has no time to change, and what was
pushed may have leant and come back instead of sliding [m]."""

ALONG_SD, ASIDE_SHARES = 0.0005, {1: 0.02, 2: 0.04}
"""Standard deviations of a slide: along the push [m], and aside, as a share of the way, by the
number of fingertips; two of them need not stick to keep their side straight."""

DIRECTION_SD = np.radians(1.5)
"""The same of the direction of a force, averaged over a push [rad]."""

TOWARDS, SURFACE_SHARE = 0.5, 0.3
"""Share of the lever that a force points along if its direction is to tell of a turn; and by what
share of it the limit surface may be off."""

TURN_SD, FALL_SD, LEAN_SD = np.radians(1.0), np.radians(5.0), np.radians(1.0)
"""The same of the heading by the line between two fingertips, of the tilt of what fell, and of the
least lean on the way that a force would show [rad]."""

MOST_TURN = 0.6
"""A turn under one fingertip, two standard deviations on, that is told at most [rad]."""

_UPRIGHT = 0.9  # cosine of a tilt below which it stands on its base
_PART = 0.15  # of the way, at its begin and at its end, over which a force is averaged


@dataclass(frozen=True, eq=False)
class Place:
    """Where an object stands, X_WB.

    Attributes:
        R: its attitude.
        p: its origin, shape (3,) [m].
    """

    R: Rotation
    p: Array

    @classmethod
    def seen(cls, frames: Array) -> Place:
        """The mean of sightings, shape (m, 8)."""
        return cls(Rotation.from_quat(frames[:, [2, 3, 4, 1]]).mean(), frames[:, 5:].mean(axis=0))

    def after(self, felt: FeltEnd) -> Place:
        """Where it stands after a push that touch tells."""
        turn = Rotation.from_rotvec([0.0, 0.0, felt.turn])
        lever = np.array([*felt.lever, 0.0])
        swing = Rotation.from_rotvec([*felt.swing, 0.0])
        return Place(swing * turn * self.R, self.p + felt.way + turn.apply(lever) - lever)


def felt_end(
    trace: Trace, samples: NDArray[np.intp], model: ObjectModel, place: Place
) -> FeltEnd | None:
    """How a push has left its object by touch alone; None if that does not tell.

    Args:
        trace: of the robot's own senses.
        samples: those of one push, from its touch on.
        model: what is believed of the object.
        place: where it stood before the push.
    """
    pushing = samples[trace.phase[samples] == "push"]
    fingers = _fingers(trace, pushing)
    if fingers not in ASIDE_SHARES or not trace.felt or len(pushing) < 3:
        return None
    begin = measures.midpoint(trace)[pushing[0]]
    tips = measures.midpoint(trace)[pushing] - begin
    way = np.array([*tips[-1, :2], 0.0])
    length = float(np.linalg.norm(way))
    lever = (place.p - begin)[:2]
    if length < LEAST_WAY:
        sd = np.full(3, LEAST_WAY)
        return FeltEnd(way, lever, 0.0, np.zeros(2), sd, TURN_SD, 0.0, LEAN_SD)
    along = way / length
    across = np.array([-along[1], along[0], 0.0])
    first, least, last = _forces(trace, pushing, tips @ along / length, along)
    if first < FELT:
        return None
    if last > STAYS * first:
        contact = _contact(model, place, begin, along)
        turn = _turn(trace, pushing, fingers, model, place, contact, along)
        if turn is None:
            return None
        lever = (place.p - contact)[:2]  # it rolls on the fingertip
        sd = np.hypot(ALONG_SD * np.abs(along), ASIDE_SHARES[fingers] * length * np.abs(across))
        sd[2] = ALONG_SD
        if length < SHORT:
            sd = np.hypot(sd, 0.5 * np.abs(way))
        leant = _angle_of_no_return(model, place, along) * (1.0 - least / first)
        return FeltEnd(way, lever, turn[0], np.zeros(2), sd, turn[1], 0.0, max(leant, LEAN_SD))
    if last < GONE * first and fingers == 2:
        # It turns about the edge, to the left of the way; where its middle lies is not felt.
        fallen = 0.5 * np.pi * across[:2]
        sd = np.full(3, 0.5 * length)
        return FeltEnd(way, lever, 0.0, fallen, sd, FALL_SD, FALL_SD, FALL_SD)
    return None


def _fingers(trace: Trace, pushing: NDArray[np.intp]) -> int:
    """How many pushed: among pushes of two a push of one has both of its tips in the same place."""
    tips = list(trace.tips.values())
    alike = len(tips) == 2 and np.allclose(tips[0][pushing], tips[1][pushing])
    return 1 if alike else len(tips)


def _forces(
    trace: Trace, pushing: NDArray[np.intp], travel: Array, along: Array
) -> tuple[float, float, float]:
    """The force along a push: its largest at first, the least later, and at the end [N]."""
    total = np.sum(list(trace.felt.values()), axis=0) @ along
    force = measures.windowed_mean(trace.time, total, measures.FORCE_WINDOW)[pushing]
    begun, part = int(np.argmax(travel > 0.02)), int(np.argmax(travel > _PART)) + 1
    peak, late = begun + int(np.argmax(force[begun:part])), travel > 1.0 - _PART
    last = float(force[late].mean())  # the hand draws back within the window of the last samples
    return (
        float(force[peak]),
        min(float(force[peak:][~late[peak:]].min(initial=np.inf)), last),
        last,
    )


def _angle_of_no_return(model: ObjectModel, place: Place, along: Array) -> float:
    """Tilt past which it falls by itself; a cube's for what does not stand on its base [rad]."""
    up = place.R.inv().apply([0.0, 0.0, 1.0])
    if up[2] < _UPRIGHT:
        return 0.25 * np.pi
    return model.angle_of_no_return(place.R.inv().apply(along)[:2])


def _contact(model: ObjectModel, place: Place, begin: Array, along: Array) -> Array:
    """Where a fingertip that begins to push touches the believed outline, shape (3,) [m]."""
    corners = np.column_stack([model.outline, np.zeros(len(model.outline))])
    near = float(((place.R.apply(corners) + place.p - begin) @ along).min())
    return begin + max(near, 0.0) * along


def _turn(
    trace: Trace,
    pushing: NDArray[np.intp],
    fingers: int,
    model: ObjectModel,
    place: Place,
    contact: Array,
    along: Array,
) -> tuple[float, float] | None:
    """By how much it turned as it slid, and its standard deviation; None if that is not told."""
    if fingers == 2:
        one, other = trace.tips.values()
        between = (other - one)[pushing[[0, -1]], :2]
        headings = np.arctan2(between[:, 1], between[:, 0])
        turned = float(np.angle(np.exp(1j * (headings[1] - headings[0]))))
        return turned, TURN_SD
    lever = (place.R.apply(model.com) + place.p - contact)[:2]
    tips = measures.midpoint(trace)[pushing, :2]
    steps, length = np.diff(tips, axis=0), float(np.linalg.norm(tips[-1] - tips[0]))
    force = np.sum(list(trace.felt.values()), axis=0)[pushing[1:], :2]
    force = force / np.maximum(np.linalg.norm(force, axis=1, keepdims=True), FELT)
    towards = force @ lever
    if towards.mean() > TOWARDS * np.linalg.norm(lever):
        across = steps[:, 0] * force[:, 1] - steps[:, 1] * force[:, 0]
        turn = float(across.sum() / towards.mean())
        sd = float(DIRECTION_SD * length / towards.mean())
    else:
        beside = float(lever @ [-along[1], along[0]])
        turn = length * beside / (model.friction_radius**2 + float(lever @ lever))
        sd = SURFACE_SHARE * abs(turn)
    if length < SHORT:
        sd = float(np.hypot(sd, 0.5 * turn))
    return None if abs(turn) + 2.0 * sd > MOST_TURN else (turn, sd)

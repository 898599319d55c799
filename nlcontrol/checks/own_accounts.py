"""What happened as the robot itself knows it: accounts that its own senses allow, one a draw.

Each account is a trace without truth: poses are draws of the tracks that camera frames tell
(`sim.control.pose_tracks`), lids and levels of liquids are draws of the means of their frames
before and after. Forces, fingertips, phases and commands are the robot's own in each of them. The
last account is the mean of all draws.

What was touched is not seen. An object whose pose changed was touched, by the object that was
worked on if they came near each other, else by the hand; one that stands as before may have been
touched if they came near, and was not if they did not.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.transform import Rotation

from nlcontrol.checks import trace_measures as measures
from nlcontrol.checks.verdicts import Evidence
from objectmodels.models.object_parts import LiftOffLid
from planner.problem.footprints import gap
from sim.control.pose_tracks import Array, CameraSheet, FeltEnd, PoseTrack, Stretch, pose_track
from sim.random_streams import RandomStream, source
from sim.traces.trace import ContactEvent, Trace

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from grammar.frames.command import Frame
    from objectmodels import ObjectModel
    from planner.types.defaults import Defaults
    from planner.types.world_state import TableState
    from sim.robots.cell_description import Vision


MEMBERS = 40
"""Draws; a share of 2.5 % is one of them."""

WORKED_ON = ("touch", "push", "grasp", "lift", "carry", "pour", "set_down", "lid")
"""Phases in which an object is worked on."""


LEAVES = 1.5
"""Time for which it may still move when the hand leaves it; what falls takes so long [s]."""

NEAR = 0.01
"""Outlines that came nearer than this may have touched, if what was near moved [m]."""


@dataclass(frozen=True, eq=False)
class Knowledge:
    """What the robot goes by when it judges what it perceived.

    Attributes:
        models: believed models by name.
        table: extent of the table top.
        vision: data sheet of the camera.
        defaults: what a clause means when the sentence does not say more.
    """

    models: Mapping[str, ObjectModel]
    table: TableState
    vision: Vision
    defaults: Defaults


@dataclass(frozen=True, eq=False)
class OwnAccounts:
    """What the robot's own senses allow.

    Attributes:
        draws: accounts, and their mean as the last one.
        unsure: objects that may have been touched without being moved.
        unseen: objects that were not seen in the end.
        hidden: neither frames nor touch tell all of the object that was worked on; draws are then
            calm and wild in turn (`sim.control.pose_tracks.CALM`).
    """

    draws: tuple[Trace, ...]
    unsure: frozenset[str]
    unseen: frozenset[str]
    hidden: bool


def own_accounts(frame: Frame, trace: Trace, known: Knowledge) -> OwnAccounts | None:
    """The accounts of a trace; None if the object was not seen before it was worked on.

    Of the trace only what the robot perceived is read.

    Args:
        frame: what was asked, its objects resolved.
        trace: what was perceived.
        known: what the robot goes by.
    """
    models, vision = known.models, known.vision
    trace = trace.perceived
    name = frame.object.id if frame.object and frame.object.id else trace.pushed
    rng = source(trace.seed, RandomStream.OWN_VERDICT)
    sheet = CameraSheet(
        vision.position_noise_m,
        np.radians(vision.angle_noise_deg),
        vision.position_bias_m,
        np.radians(vision.angle_bias_deg),
    )
    stretches = _stretches(trace, name, models.get(name))
    tracks: dict[str, PoseTrack] = {}
    for each in models:
        if each in trace.sightings:
            seen, moves = trace.sightings[each], each == name
            found = pose_track(seen, trace.time, stretches, sheet, MEMBERS, rng, moves=moves)
            if found is not None:
                tracks[each] = found
    if name not in tracks:
        return None
    draws = [
        replace(draw, poses={each: _nth(track, k) for each, track in tracks.items()})
        for k, draw in enumerate(_with_lids_and_levels(trace, models, stretches, vision, rng))
    ]
    mean = Evidence.of(frame, draws[-1], _of(models, tracks), known.table, known.defaults)
    touched, unsure = _touches(mean, tracks, vision)
    draws = [replace(draw, contacts=touched) for draw in draws]
    unseen = frozenset(each for each in models if each not in tracks or tracks[each].moved is None)
    return OwnAccounts(tuple(draws), unsure, unseen, tracks[name].hidden)


def _nth(track: PoseTrack, k: int) -> Array:
    return track.mean if k == MEMBERS else track.members[k]


def _of(
    models: Mapping[str, ObjectModel], tracks: Mapping[str, PoseTrack]
) -> dict[str, ObjectModel]:
    return {name: model for name, model in models.items() if name in tracks}


def _stretches(trace: Trace, name: str, model: ObjectModel | None) -> list[Stretch]:
    """Stretches of time in which something is worked on, or may not have come to rest yet."""
    found: list[Stretch] = []
    place, seen = None, trace.sightings.get(name, np.empty((0, 8)))
    for samples in measures.stretches(trace, WORKED_ON):
        begin, last = float(trace.time[samples[0]]) - 0.02, int(samples[-1])
        left = float(trace.time[last])
        leaving = np.flatnonzero(trace.phase[last + 1 :] != "retreat")
        home = float(trace.time[last + 1 + leaving[0]]) if len(leaving) else left + LEAVES
        # It may still move for 0.3 s when the hand is home.
        end = min(left + LEAVES, home + 0.3)
        if trace.end == "toppled":
            end = max(end, left + LEAVES)
        since = found[-1].end if found else -np.inf
        rest = seen[(seen[:, 0] >= since) & (seen[:, 0] <= begin)]
        place = Place.seen(rest) if len(rest) else place
        felt = felt_end(trace, samples, model, place) if model and place else None
        place = place.after(felt) if place and felt else None
        if begin <= since:
            begin, felt = found.pop().begin, None
        found.append(
            Stretch(begin, end, str(trace.phase[last]) in ("grasp", "lift", "carry", "pour"), felt)
        )
    return found


def _touches(
    e: Evidence, tracks: Mapping[str, PoseTrack], vision: Vision
) -> tuple[tuple[ContactEvent, ...], frozenset[str]]:
    """Touches of objects that moved, and the names of those that may have been touched."""
    own = e.covered_outlines(e.name) if e.name in e.start.objects else []
    at_end, touched, unsure = float(e.trace.time[-1]), [], set()
    for name, track in tracks.items():
        if name == e.name or name not in e.start.objects:
            continue
        there = e.covered_outlines(name)[0]
        least = min((gap(outline, there) for outline in own), default=np.inf)
        if track.moved:
            by = e.name if least < NEAR else "hand"
            touched.append(ContactEvent(at_end, by, name))
            continue
        places = [tracks[each].members[:, -1, 4:6] for each in (e.name, name)]
        sd = float(np.sqrt(sum(place.var(axis=0).mean() for place in places)))
        if least < 2.0 * sd:
            unsure.add(name)
    return tuple(touched), frozenset(unsure)


def _with_lids_and_levels(
    trace: Trace,
    models: Mapping[str, ObjectModel],
    stretches: list[Stretch],
    vision: Vision,
    rng: np.random.Generator,
) -> Iterator[Trace]:
    """The trace with lids, contents and what was spilled, for each draw and for their mean."""
    begin = stretches[0].begin if stretches else np.inf
    end = stretches[-1].end if stretches else -np.inf
    lids = {
        name: _before_and_after(seen, begin, end, _lid_noise(models, name, vision), 0.0, rng)
        for name, seen in trace.sighted_lids.items()
    }
    volumes = {
        name: vessel.section.area
        * _before_and_after(seen, begin, end, vision.position_noise_m, vision.position_bias_m, rng)
        for name, seen in trace.sighted_levels.items()
        if name in models and (vessel := models[name].vessel) is not None
    }
    for k in range(MEMBERS + 1):
        contents = {name: values[k] for name, values in volumes.items()}
        lost = sum(values[0] - values[1] for values in contents.values())
        yield replace(
            trace,
            lids={name: _over_time(values[k], trace) for name, values in lids.items()},
            contents={name: _over_time(values, trace) for name, values in contents.items()},
            spilled=_over_time(np.array([0.0, lost]), trace) if contents else np.zeros(0),
        )


def _lid_noise(models: Mapping[str, ObjectModel], name: str, vision: Vision) -> float:
    lifts_off = name in models and isinstance(models[name].lid, LiftOffLid)
    return vision.position_noise_m if lifts_off else float(np.radians(vision.angle_noise_deg))


def _before_and_after(
    seen: Array, begin: float, end: float, noise: float, bias: float, rng: np.random.Generator
) -> Array:
    """Draws of a value before and after something was done, and their mean, shape (k + 1, 2).

    Args:
        seen: times and values in frames, shape (m, 2).
        begin: of what was done [s].
        end: of what was done [s].
        noise: standard deviation of a frame.
        bias: the same of the constant error.
        rng: of what is drawn.
    """
    rests = seen[seen[:, 0] <= begin, 1], seen[seen[:, 0] >= end, 1]
    drawn = np.full((MEMBERS + 1, 2), np.nan)
    constant = np.append(bias * rng.standard_normal(MEMBERS), 0.0)
    for i, rest in enumerate(rests):
        white = np.append(rng.standard_normal(MEMBERS), 0.0)
        if len(rest):
            spread = max(noise, float(rest.std(ddof=1)) if len(rest) > 9 else 0.0)
            drawn[:, i] = rest.mean() + spread / np.sqrt(len(rest)) * white + constant
    return drawn


def _over_time(values: Array, trace: Trace) -> Array:
    """A value before and after, as a trace has it: it becomes the other one in the end."""
    over = np.full(len(trace.time), values[0])
    over[-1] = values[1]
    return over


# What became of a pushed object as the fingertips felt it, for where no camera sees it.
#
# Model: what slides goes as far as the fingertips, under a force that stays as it is. What tips
# over an edge gives way: the force on it falls in proportion to the tilt that is left until it
# falls by itself, and is gone when it does (moments about the edge, as in
# `objectmodels.mechanics`); then it lies on the side to which it was pushed. What slid in the end
# may have leant on its way, by no more than the share that its force ever fell. A push by one
# fingertip that loses its force is not told: what it pushed may have turned away from it.
#
# How far it turned on its slide the line between two fingertips tells. One fingertip is a pivot,
# and the direction of its force tells: the table's friction is against the way of the centre of
# mass, so that this goes where the force f points, and not where the fingertip goes, v
# [goyal-1991]. With the lever l from the contact to the centre of mass,
#
# ω = (v × f) / (f · l).
#
# Where the force passes it far to the side, the ellipsoidal limit surface tells it from the
# friction radius c̄, pushed a behind and b beside it [howe-cutkosky-1996]: dψ/ds = b / (c̄² + a² +
# b²).
#
# Frames: W is the world, T a fingertip.


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

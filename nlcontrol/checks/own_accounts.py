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

from nlcontrol.checks import trace_measures as measures
from nlcontrol.checks.felt_pushes import Place, felt_end
from nlcontrol.checks.verdicts import Evidence
from objectmodels.models.object_parts import LiftOffLid, section_area
from planner.problem.footprints import gap
from sim.control.pose_tracks import CameraSheet, PoseTrack, Stretch, pose_track
from sim.random_streams import RandomStream, source
from sim.traces.trace import ContactEvent, Trace

if TYPE_CHECKING:
    from grammar.frames.command import Frame
    from nlcontrol.checks.trace_measures import Array
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


# -- lids and liquids -----------------------------------------------------------------------------


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
        name: section_area(vessel.section)
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

"""Lessons of the whole hand: of what it lifted or poured, and of what it tried and failed at.

A lid that withstood the force, the pull or the torque that was to be enough takes more than that;
what slipped through the fingers is more slippery than believed. The next try is harder,
or refused with the number.

Frames: W is the world.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from nlcontrol.checks import trace_measures as measures
from nlcontrol.learning.learning_reports import Change, Lesson
from nlcontrol.learning.lessons import beliefs_after_grasp, weight_from_grasp
from objectmodels.identification.belief_update import (
    RevisedBelief,
    belief_of_slipperier_object,
    belief_of_stiffer_lid,
)
from objectmodels.models.object_parts import LiftOffLid
from planner.types.actions import FlipOver, TurnCap
from planner.types.plan import Plan

if TYPE_CHECKING:
    from objectmodels import ObjectModel
    from sim.traces.trace import EndReason, Trace

TRIED_AGAIN: frozenset[EndReason] = frozenset(
    {
        "no_grasp",
        "slipped",
        "missed",
        "nudged",
        "no_touch",
        "guard",
        "force",
        "tilted",
        "unreachable",
    }
)
"""Ends after which the hand tries once more, if it may."""

_WITHSTOOD = 0.3  # time at the end over which a force that was withstood is felt [s]
_LEARNED = ("friction_torque", "snap_torque", "retention")


def lessons_from_hand(
    made: Plan, models: Mapping[str, ObjectModel], trace: Trace
) -> tuple[dict[str, ObjectModel], tuple[Lesson, ...]]:
    """The models believed after a plan, by name in the scene, and the lessons."""
    model, lessons = models[made.object], []
    for learn in (weight_from_grasp, lesson_from_failure):
        found = learn(made, model, trace)
        if found is not None:
            model = found[0]
            lessons.append(found[1])
    after = {**models, made.object: model}
    return {**after, **beliefs_after_grasp(made, after, trace)}, tuple(lessons)


def lesson_from_failure(
    made: Plan, model: ObjectModel, trace: Trace
) -> tuple[ObjectModel, Lesson] | None:
    """The model believed of an object after a try that failed; None if that taught nothing."""
    grasp = made.grasp
    by_lid = grasp is None or grasp.part == "lid"
    if by_lid and (trace.end == "force" or (trace.end == "missed" and _pulled(model, trace))):
        load, found = _lid_lesson(made, model, trace)
        why = "its lid withstood what was to be enough"
    elif grasp is not None and not by_lid and trace.end == "slipped" and grasp.needed > 0.0:
        load, found = (
            grasp.squeeze,
            belief_of_slipperier_object(model, grasp.squeeze / grasp.needed),
        )
        why = "it slipped through the fingers"
    else:
        return None
    return found.model, Lesson(
        object=made.object, moved="slip" if not by_lid else "none", force=load,
        surprise=found.surprise, contradicts=True, why=why,
        changes=_changes(model, found.model),
    )  # fmt: skip


def _pulled(model: ObjectModel, trace: Trace) -> bool:
    """True if a hand pulled at a lid that lifts off."""
    return isinstance(model.lid, LiftOffLid) and bool(measures.during(trace, ("lift",)).any())


def _lid_lesson(made: Plan, model: ObjectModel, trace: Trace) -> tuple[float, RevisedBelief]:
    """Load that a lid withstood, [N] or [N·m], and what is believed then."""
    step = made.steps[0]
    if isinstance(step, FlipOver):
        angle = float(trace.seen_lids[made.object][measures.during(trace, ("lid",))][-1])
        load, opens = _flip_force(step, angle, trace), step.end > step.start
        return load, belief_of_stiffer_lid(model, load, angle=max(angle, 0.0), opens=opens)
    if isinstance(step, TurnCap):
        return step.torque_limit, belief_of_stiffer_lid(model, step.torque_limit)
    lifting = measures.during(trace, ("lift",))
    load = float(np.sum([force[lifting, 2] for force in trace.felt.values()], axis=0).max())
    return load, belief_of_stiffer_lid(model, load)


def _flip_force(step: FlipOver, angle: float, trace: Trace) -> float:
    """Felt force across a lid in the end [N]."""
    out = np.array([np.cos(step.heading), np.sin(step.heading), 0.0])
    across = np.cos(angle) * np.array([0.0, 0.0, 1.0]) - np.sin(angle) * out
    pressing = np.flatnonzero(measures.during(trace, ("lid",)))
    last = pressing[trace.time[pressing] > trace.time[pressing[-1]] - _WITHSTOOD]
    felt = np.sum([force[last] for force in trace.felt.values()], axis=0)
    return abs(float(np.mean(felt @ across)))


def _changes(before: ObjectModel, after: ObjectModel) -> tuple[Change, ...]:
    """Changes of the lid's resistance, or of friction at the fingers."""
    parts: list[tuple[str, object, object, tuple[str, ...]]] = [
        ("", before, after, ("finger_friction",)),
        ("lid_", before.lid, after.lid, _LEARNED),
    ]
    return tuple(
        Change(
            parameter=f"{prefix}{name}",
            before=getattr(old, name),
            before_sd=getattr(old, f"{name}_sd"),
            after=getattr(new, name),
            after_sd=getattr(new, f"{name}_sd"),
        )
        for prefix, old, new, names in parts
        for name in names
        if getattr(old, name, None) != getattr(new, name, None)
    )

"""What a push or a touch taught about an object, and what is believed from then on."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from nlcontrol.learning.learning_reports import Change, Lesson
from objectmodels.errors import ModelError
from objectmodels.geometry.mechanical import UNCERTAIN
from objectmodels.mechanics.turning_push import learned_radius
from sim.exploration.push_observation import trial_from_push

if TYPE_CHECKING:
    from objectmodels import ObjectModel
    from objectmodels.identification import Trial
    from objectmodels.identification.belief_update import Update
    from planner.types.plan import Plan
    from planner.types.world_state import SeenObject
    from sim.traces.trace import EndReason, Trace

CONTRADICTIONS: dict[EndReason, str] = {
    "force": "it did not move with the force that was to be enough",
    "tilted": "it tilted where it was to slide",
    "slid": "it slid where it was to tilt",
}
"""Ends of a push that contradict its prediction, in words."""

SPREAD = 0.05
"""Relative standard deviation by which friction is taken to differ from push to push."""

SHOWS_RADIUS = math.radians(8.0)
"""A turn by less than this does not show where its pivot lies."""

RADIUS_SD = 0.15
"""Relative standard deviation of a friction radius that one turn shows: the finger rolls, the load
shifts."""


def lesson_from_push(
    made: Plan, target: SeenObject, trace: Trace
) -> tuple[ObjectModel, Lesson] | None:
    """What is believed after a push, and what it taught; None if it taught nothing.

    Args:
        made: what was to happen.
        target: the object as it was seen and believed before.
        trace: what happened.
    """
    if trace.end == "turned":
        return _from_turn(made, target, trace)
    why = CONTRADICTIONS.get(trace.end)
    trial = trial_from_push(made.push, target, trace) if target.lies_on == "bottom" else None
    if trial is None:
        return None
    try:
        update = apply_lesson(target.model, trial)
    except ModelError:
        return None  # no parameters of this object explain it
    return update.model, Lesson(
        object=target.name,
        moved=trial.moved,
        force=sum(f * f for f in trial.force) ** 0.5,
        surprise=update.surprise,
        contradicts=why is not None,
        why=why,
        changes=parameter_changes(target.model, update.model),
    )


def _from_turn(made: Plan, target: SeenObject, trace: Trace) -> tuple[ObjectModel, Lesson] | None:
    """What a turn tells of the friction radius: the pivot lies the nearer the smaller it is."""
    push, model, R_WB = made.push, target.model, target.pose.R_WB
    moved, turned = R_WB.T @ trace.seen_displacement(push.object), trace.seen_turn(push.object)
    if abs(turned) < SHOWS_RADIUS:
        return None
    direction = R_WB.T @ np.array(push.direction_W)
    shown = learned_radius(model, push.p_BC, direction, (moved[0], moved[1], turned))
    believed, sd, shown_sd = model.friction_radius, model.friction_radius_sd, RADIUS_SD * shown
    weight = sd**2 / (sd**2 + shown_sd**2)
    after = model.model_copy(
        update={
            "friction_radius": believed + weight * (shown - believed),
            "friction_radius_sd": sd * math.sqrt(1.0 - weight),
        }
    )
    pushing = trace.phase == "push"
    force = float(np.mean(trace.push_force()[pushing]))
    return after, Lesson(
        object=target.name, moved="slide", force=force, surprise=abs(shown - believed) / sd,
        contradicts=False, why=None, changes=parameter_changes(model, after),
    )  # fmt: skip


def apply_lesson(model: ObjectModel, trial: Trial) -> Update:
    """What is believed after a trial; a belief that it contradicts was too sure, and is widened."""
    from objectmodels.identification.belief_update import update_belief
    from objectmodels.identification.no_motion_update import update_without_motion, widen_belief

    if trial.moved == "none":
        return update_without_motion(model, trial)
    first = update_belief(model, [trial], spread=SPREAD)
    if not first.is_contradiction:
        return first
    again = update_belief(widen_belief(model, first.surprise), [trial], spread=SPREAD)
    return replace(again, surprise=first.surprise)


def parameter_changes(before: ObjectModel, after: ObjectModel) -> tuple[Change, ...]:
    """What changed in what is believed."""
    rows = zip(
        UNCERTAIN, before.means, before.deviations, after.means, after.deviations, strict=True
    )
    return tuple(
        Change(parameter=name, before=b, before_sd=b_sd, after=a, after_sd=a_sd)
        for name, b, b_sd, a, a_sd in rows
        if (b, b_sd) != (a, a_sd)
    )

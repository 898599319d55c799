"""Lessons of a push, a touch or a grasp: what is believed of an object from then on.

What was lifted is weighed while it hangs still on the fingers: the believed mass becomes the mean
of belief and measurement, each weighted by how surely it is known. What was poured is believed to
have gone where it was predicted to, since nothing but its weight tells; where pouring ended early,
what is left is as uncertain as what was to be poured is much.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from nlcontrol.checks import trace_measures as measures
from nlcontrol.learning.learning_reports import Change, Lesson
from objectmodels.errors import ModelError
from objectmodels.geometry.pushed_body import UNCERTAIN
from objectmodels.identification.belief_update import (
    Update,
    belief_of_slipperier_object,
    belief_of_stiffer_lid,
    doubt_belief,
    standing_belief,
    update_belief,
    update_without_motion,
    widen_belief,
)
from objectmodels.identification.measurement_model import container_with_mass, container_with_volume
from objectmodels.mechanics.push_motion import learned_radius
from objectmodels.mechanics.push_thresholds import GRAVITY
from objectmodels.models.object_parts import LiftOffLid
from planner.types.actions import FlipOver, LiftUp, PourOut, TurnCap
from planner.types.end_reasons import END_REASONS
from planner.types.plan import Plan
from sim.control.held_object_sensing import Weight, estimate_weight
from sim.exploration.trial_extraction import trial_from_push

if TYPE_CHECKING:
    from objectmodels import ObjectModel
    from objectmodels.identification import Trial
    from planner.types.world_state import SeenObject
    from sim.traces.trace import Trace


SPREAD = 0.05
"""Relative standard deviation by which friction is taken to differ from push to push."""


RADIUS_SD = 0.15
"""Relative standard deviation of a friction radius that one turn shows: the finger rolls, the load
shifts."""


def lesson_from_push(
    made: Plan, target: SeenObject, trace: Trace
) -> tuple[ObjectModel, Lesson] | None:
    """The model believed after a push of a plan, and the lesson; None if it taught nothing.

    The target is the object as it was seen and believed before. The model is that of it on its
    bottom, on whichever face it lay.
    """
    if target.attitude is not None:
        return None  # what leans on something is pushed by that, too
    if trace.end == "turned":
        # The friction radius of another face is not that of the base.
        return _from_turn(made, target, trace) if target.rest is None else None
    why = END_REASONS[trace.end].contradicts
    trial = trial_from_push(made.push, target, trace)
    if trial is None:
        return None
    try:
        update = apply_lesson(target.model, trial)
        after = update.model if target.rest is None else standing_belief(target.rest, update.model)
    except ModelError:
        return None  # no parameters of this object explain it
    return after, Lesson(
        object=target.name,
        moved=trial.moved,
        # What is drawn from above is pressed besides.
        force=math.hypot(*trial.force[: 2 if made.push.press else 3]),
        surprise=update.surprise,
        contradicts=why is not None,
        why=why,
        changes=parameter_changes(target.standing_model, after),
    )


def _from_turn(made: Plan, target: SeenObject, trace: Trace) -> tuple[ObjectModel, Lesson] | None:
    """The friction radius that a turn shows: the pivot lies the nearer the smaller it is."""
    push, model, R_WB = made.push, target.model, target.pose.R_WB
    moved, turned = R_WB.T @ trace.seen_displacement(push.object), trace.seen_turn(push.object)
    # A turn by less than this does not show where its pivot lies.
    if abs(turned) < math.radians(8.0):
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
        object=target.name,
        moved="slide",
        force=force,
        surprise=abs(shown - believed) / sd,
        contradicts=False,
        why=None,
        changes=parameter_changes(model, after),
    )


def apply_lesson(model: ObjectModel, trial: Trial) -> Update:
    """The belief after a trial; one that the trial contradicts was too sure, and is widened."""
    if trial.moved == "none":
        return update_without_motion(model, trial)
    if trial.moved == "slip":
        # What stays behind a fingertip that slips over it withstands the force of that finger.
        withstood = update_without_motion(model, replace(trial, moved="none", normal=None))
        slipped = _explained(withstood.model, trial)
        return replace(slipped, surprise=max(slipped.surprise, withstood.surprise))
    return _explained(model, trial)


def _explained(model: ObjectModel, trial: Trial) -> Update:
    """The belief after a trial in which something moved."""
    first = update_belief(model, [trial], spread=SPREAD)
    if not first.is_contradiction:
        return first
    doubted = doubt_belief(model)
    surprise = update_belief(doubted, [trial], spread=SPREAD).surprise
    again = update_belief(widen_belief(doubted, surprise), [trial], spread=SPREAD)
    return replace(again, surprise=first.surprise)


def parameter_changes(before: ObjectModel, after: ObjectModel) -> tuple[Change, ...]:
    """Changes of what is believed."""
    rows = zip(
        UNCERTAIN, before.means, before.deviations, after.means, after.deviations, strict=True
    )
    return tuple(
        Change(parameter=name, before=b, before_sd=b_sd, after=a, after_sd=a_sd)
        for name, b, b_sd, a, a_sd in rows
        if (b, b_sd) != (a, a_sd)
    )


def beliefs_after_grasp(
    made: Plan, models: Mapping[str, ObjectModel], trace: Trace
) -> dict[str, ObjectModel]:
    """Those models, by name in the scene, that are believed otherwise after a plan of the hand."""
    pours = [step for step in made.steps if isinstance(step, PourOut)]
    if not pours or not measures.during(trace, ("pour",)).any():
        return {}
    poured, received = pours[0].prediction.poured, pours[0].prediction.received
    ended = 1.0 if trace.end == "handled" else 0.5
    doubt = 0.0 if trace.end == "handled" else 0.5 * poured
    into = pours[0].into
    return {
        made.object: change_contents(models[made.object], -ended * poured, doubt),
        into: change_contents(models[into], ended * received, doubt),
    }


def felt_weight(made: Plan, trace: Trace) -> Weight | None:
    """The weight on the fingers after the first lift; None if no object was lifted."""
    if made.grasp is None or made.grasp.part == "lid":
        return None
    held = next((step.hold for step in made.steps if isinstance(step, LiftUp)), None)
    lifts = measures.stretches(trace, ("lift",))
    if held is None or not lifts or trace.end in ("no_grasp", "unreachable"):
        return None
    up = lifts[0]
    # It hangs still in the last two thirds of the time, and for 0.4 s at least; the arm still
    # swings at first.
    still = up[trace.time[up] > trace.time[up[-1]] - (2.0 / 3.0) * max(held, 0.4)]
    vertical = np.sum([force[still, 2] for force in trace.felt.values()], axis=0)
    return estimate_weight(vertical, len(still))


def weight_from_grasp(
    made: Plan, model: ObjectModel, trace: Trace
) -> tuple[ObjectModel, Lesson] | None:
    """The model believed of an object that was lifted, and the lesson; None if it was not lifted.

    What it weighs otherwise than believed is put down to its contents, as far as these are
    uncertain.
    """
    felt = felt_weight(made, trace)
    if felt is None or model.mass_sd == 0.0:
        return None
    measured, sd = felt.mean / GRAVITY, felt.sd / GRAVITY
    gain = model.mass_sd**2 / (model.mass_sd**2 + sd**2)
    more = gain * (measured - model.mass)
    rest_sd = math.sqrt(1.0 - gain) * model.mass_sd
    after, held = model, container_with_mass(model, model.mass + more, rest_sd)
    if held is not None and model.container is not None:
        after = change_contents(model, held.contents - model.container.contents)
    after = after.model_copy(
        update={"container": held, "mass": model.mass + more, "mass_sd": rest_sd}
    )
    return after, Lesson(
        object=made.object,
        moved="lift",
        force=felt.mean,
        surprise=(measured - model.mass) / math.hypot(model.mass_sd, sd),
        contradicts=False,
        why=None,
        changes=tuple(c for c in parameter_changes(model, after) if c.parameter == "mass"),
    )


def change_contents(model: ObjectModel, more: float, sd: float = 0.0) -> ObjectModel:
    """A container after a volume went in, or out, as it stands upright.

    Args:
        model: what is believed of it.
        more: volume that went in; negative what ran out [m³].
        sd: its standard deviation [m³].
    """
    container, vessel = model.container, model.vessel
    assert container is not None, "what is poured is in a container"
    assert vessel is not None
    before = container.contents
    # 2 % of the contents always stay unknown.
    spread = math.hypot(container.contents_sd, sd, 0.02 * abs(more))
    held = container_with_volume(model, before + more, min(spread, max(before + more, 0.0)))
    after = held.contents
    shell = model.mass - container.mass
    mass = shell + container.density * after
    middles = [vessel.centroid(volume, 0.0, 0.0) for volume in (before, after)]
    moment = model.mass * np.array(model.com) - container.mass * middles[0]
    com = (moment + container.density * after * middles[1]) / mass
    mass_sd = math.hypot(model.mass_sd, container.density * sd)
    return model.model_copy(
        update={"container": held, "mass": mass, "mass_sd": mass_sd, "com": tuple(com.tolist())}
    )


# Lessons of the whole hand: of what it lifted or poured, and of what it tried and failed at.
#
# A lid that withstood the force, the pull or the torque that was to be enough takes more than
# that; what slipped through the fingers is more slippery than believed. The next try is harder,
# or refused with the number.
#
# Frames: W is the world.


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
        object=made.object,
        moved="slip" if not by_lid else "none",
        force=load,
        surprise=found.surprise,
        contradicts=True,
        why=why,
        changes=_changes(model, found.model),
    )


def _pulled(model: ObjectModel, trace: Trace) -> bool:
    """True if a hand pulled at a lid that lifts off."""
    return isinstance(model.lid, LiftOffLid) and bool(measures.during(trace, ("lift",)).any())


def _lid_lesson(made: Plan, model: ObjectModel, trace: Trace) -> tuple[float, Update]:
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
    # A force that was withstood is felt over the last 0.3 s.
    last = pressing[trace.time[pressing] > trace.time[pressing[-1]] - 0.3]
    felt = np.sum([force[last] for force in trace.felt.values()], axis=0)
    return abs(float(np.mean(felt @ across)))


def _changes(before: ObjectModel, after: ObjectModel) -> tuple[Change, ...]:
    """Changes of the lid's resistance, or of friction at the fingers."""
    parts: list[tuple[str, object, object, tuple[str, ...]]] = [
        ("", before, after, ("finger_friction",)),
        ("lid_", before.lid, after.lid, ("friction_torque", "snap_torque", "retention")),
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

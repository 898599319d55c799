"""What a whole hand did, as the robot knows it: whether to try again, and what it learned.

What was lifted is weighed while it hangs still on the fingers: the believed mass becomes the mean
of belief and measurement, each weighted by how surely it is known. What was poured is believed to
have gone where it was predicted to, since nothing but its weight tells; where pouring ended early,
what is left is as uncertain as what was to be poured is much.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from nlcontrol.checks import trace_measures as measures
from nlcontrol.learning.learning_reports import Change, Lesson
from objectmodels.containers.contents_update import container_with_mass, container_with_volume
from objectmodels.mechanics.push_thresholds import GRAVITY
from planner.types.actions import LiftUp, PourOut
from planner.types.plan import Plan
from sim.control.grasping.held_object_sensing import Weight, estimate_weight

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

_SWUNG = 2.0 / 3.0  # share of the time for which it is held at the end in which it hangs still
_HELD = 0.4  # least of that time [s]
_FROM_LEVEL = 0.02  # a share of the contents that always stays unknown


def beliefs_after_grasp(
    made: Plan, models: Mapping[str, ObjectModel], trace: Trace
) -> dict[str, ObjectModel]:
    """The models that are believed otherwise after a plan of the hand.

    Args:
        made: what was to happen.
        models: what was believed, by name in the scene.
        trace: what happened.
    """
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
    """What hung on the fingers after the first lift; None if no object was lifted."""
    if made.grasp is None or made.grasp.part == "lid":
        return None
    held = next((step.hold for step in made.steps if isinstance(step, LiftUp)), None)
    lifts = measures.stretches(trace, ("lift",))
    if held is None or not lifts or trace.end in ("no_grasp", "unreachable"):
        return None
    up = lifts[0]
    # It hangs still in the end; the arm still swings at first.
    still = up[trace.time[up] > trace.time[up[-1]] - _SWUNG * max(held, _HELD)]
    vertical = np.sum([force[still, 2] for force in trace.felt.values()], axis=0)
    return estimate_weight(vertical, len(still))


def weight_from_grasp(
    made: Plan, model: ObjectModel, trace: Trace
) -> tuple[ObjectModel, Lesson] | None:
    """What is believed of an object that was lifted; None if it was not.

    What it weighs otherwise than believed is put down to its contents, as far as these are
    uncertain.

    Args:
        made: what was to happen.
        model: what was believed.
        trace: what happened.
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
        changes=(
            Change(
                parameter="mass",
                before=model.mass,
                before_sd=model.mass_sd,
                after=after.mass,
                after_sd=after.mass_sd,
            ),
        ),
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
    spread = math.hypot(container.contents_sd, sd, _FROM_LEVEL * abs(more))
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

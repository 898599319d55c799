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

from nlcontrol import measures
from planner.handling.plan import HandlingPlan, PourOut

if TYPE_CHECKING:
    from objectmodels import ObjectModel
    from sim.trace import EndReason, Trace

TRIED_AGAIN: frozenset[EndReason] = frozenset(
    {"no_grasp", "slipped", "missed", "nudged", "no_touch", "guard", "force", "tilted"}
)
"""Ends after which the hand tries once more, if it may."""

_FROM_LEVEL = 0.02  # a share of the contents that always stays unknown


def believed_after(
    made: HandlingPlan, models: Mapping[str, ObjectModel], trace: Trace
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
    poured = made.prediction.poured or 0.0
    received = made.prediction.received or 0.0
    ended = 1.0 if trace.end == "handled" else 0.5
    doubt = 0.0 if trace.end == "handled" else 0.5 * poured
    into = pours[0].into
    return {
        made.object: refilled(models[made.object], -ended * poured, doubt),
        into: refilled(models[into], ended * received, doubt),
    }


def refilled(model: ObjectModel, more: float, sd: float = 0.0) -> ObjectModel:
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
    after = float(np.clip(before + more, 0.0, vessel.capacity))
    spread = min(math.hypot(container.contents_sd, sd, _FROM_LEVEL * abs(more)), after)
    shell = model.mass - container.mass
    mass = shell + container.density * after
    middles = [vessel.centroid(volume, 0.0, 0.0) for volume in (before, after)]
    moment = model.mass * np.array(model.com) - container.mass * middles[0]
    com = (moment + container.density * after * middles[1]) / mass
    held = container.model_copy(update={"contents_l": 1e3 * after, "contents_l_sd": 1e3 * spread})
    mass_sd = math.hypot(model.mass_sd, container.density * sd)
    return model.model_copy(
        update={"container": held, "mass": mass, "mass_sd": mass_sd, "com": tuple(com.tolist())}
    )

"""Which doubt about an object leaves the outcome of a push open, and what would settle it.

Model: the probability of the outcome at a contact, once as the object is believed and once with one
of its parameters known as well as touching finds it out (`Defaults.found_to`). The parameter whose
knowledge decides most, one way or the other, is the one to be found out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from objectmodels import ObjectModel
    from planner.types.defaults import Defaults

_ASKED_FOR = {
    "friction": "find out how slippery the {name} is first",
    "com": "find out the centre of mass of the {name} first",
}
"""What to say to the robot, by the parameter."""

_CENTRE_FOUND = 0.001  # to which touching finds a centre of mass [m]


@dataclass(frozen=True)
class Touch:
    """A contact from which something is wanted.

    Attributes:
        point: p_BC, shape (3,) [m].
        normal: outward unit normal there.
        outcome: that is wanted at the onset.
        turns: whether the object may turn as it slides; two fingertips hold it straight.
    """

    point: NDArray[np.float64]
    normal: tuple[float, float, float]
    outcome: Literal["slide", "topple"]
    turns: bool = False


def outcome_probability(model: ObjectModel, touch: Touch) -> float:
    """Probability of an outcome at a contact, whatever the finger transmits.

    Args:
        model: of the object.
        touch: the contact and the outcome.
    """
    point, normal = touch.point[None], np.array([touch.normal])
    found = model.cone_thresholds(point, normal, sigmas=0.0, yaw=touch.turns)
    p = found.probability_slide if touch.outcome == "slide" else found.probability_topple
    return float(p[0])


def experiment(model: ObjectModel, touch: Touch, defaults: Defaults) -> tuple[str, float]:
    """What to find out first, as a sentence, and the probability of the outcome then.

    Args:
        model: of the object.
        touch: the contact and the outcome.
        defaults: to what properties are found out.
    """
    found_to = defaults.found_to
    known: dict[str, dict[str, object]] = {
        "friction": {"friction_sd": min(model.friction_sd, found_to * model.friction)},
        "com": {"com_sd": tuple(min(sd, _CENTRE_FOUND) for sd in model.com_sd)},
    }
    then = {
        name: outcome_probability(model.model_copy(update=better), touch)
        for name, better in known.items()
    }
    best = max(then, key=lambda name: abs(then[name] - 0.5))
    return _ASKED_FOR[best].format(name=model.name), then[best]

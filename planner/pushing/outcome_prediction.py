"""What a chosen push will do, and how far it is from what it must not do, as numbers.

Frames: contacts and directions are in B; forces along the push.
"""

from __future__ import annotations

import functools
import math
from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.geometry.base_shapes import Disc
from objectmodels.mechanics.worst_cases import circle_corners, contact_forces
from planner.types.actions import Margins, Prediction, Vector3

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from objectmodels import ObjectModel, Thresholds
    from planner.problem.push_problem import Asked
    from planner.pushing.contact_sampling import Contacts
    from planner.types.actions import Push
    from planner.types.defaults import Defaults
    from planner.types.robot import Reach
    from planner.types.world_state import SeenObject

_SPINS = 0.15  # share of the force to tip a round object over which it may turn on its rim before
_CLEARLY = 0.6  # room to toppling as a share of the force to slide it that needs no second look
_CONFIRMING = 8  # directions on the friction cone's boundary that the exact tier looks at


def needed_force(
    contacts: Contacts, i: int, asked: Asked, target: SeenObject, d: Defaults
) -> float:
    """Force along the push that the motion needs, with the probability that plans must have [N]."""
    model = target.model
    if asked.outcome == "topple":
        largest = float(contacts.cone.topple_max[i])
        return largest * (1.0 + contacts.sigmas * model.mass_sd / model.mass)
    inward = -np.array([contacts.side.face.normal])
    point = _held(contacts, i, model) if contacts.fingers == 2 else contacts.points[i]
    nominal = float(model.thresholds(point[None], inward).slide[0])
    share = math.hypot(model.friction_sd / model.friction, model.mass_sd / model.mass)
    return nominal * (1.0 + NormalDist().inv_cdf(d.probability) * share)


def prediction(
    contacts: Contacts, k: int, asked: Asked, target: SeenObject, reach: Reach
) -> Prediction:
    """What the object model says of the k-th chosen contact."""
    i, model = int(contacts.chosen[k]), target.model
    inward = -np.array(contacts.side.face.normal)
    if contacts.fingers == 1:
        nominal = _within_the_cone(contacts, i, model, reach)
    else:
        # Two fingers hold the object straight, and then the closed form is exact.
        nominal = model.thresholds(_held(contacts, i, model)[None], inward[None])
    cone = contacts.cone
    worst = cone.height_below[i] if asked.outcome == "slide" else cone.height_above[i]
    return Prediction(
        outcome=asked.outcome,
        onset=float(nominal.onset[0]),
        slide_force=_finite(nominal.slide[0]),
        topple_force=_finite(nominal.topple[0]),
        critical_height=_finite(cone.critical_height[i]),
        critical_height_worst=_finite(worst),
        probability=float(contacts.probability[k]),
        stay_on_base_angle=model.angle_of_no_return(inward),
        tier="exact",
        friction="static",
    )


def confirmed(contacts: Contacts, k: int, asked: Asked, target: SeenObject, reach: Reach) -> bool:
    """Whether the exact tier has the same outcome for the k-th chosen contact, all over the cone.

    The contacts were chosen by the closed form, whose friction limit may be off where the object
    turns as it slides; two fingers leave it no turning, and need no second look. Neither do
    contacts that are much farther from toppling than it is ever off (`benchmarks.accuracy`).
    """
    if contacts.fingers == 2:
        return True
    if asked.outcome == "slide":
        surely = contacts.cone.slide_margin > _CLEARLY * contacts.cone.slide_max
        if surely[contacts.chosen[k]]:
            return True
    i, model = int(contacts.chosen[k]), target.model
    t = _within_the_cone(contacts, i, model, reach)
    if asked.outcome == "topple" and isinstance(model.base, Disc):
        # On one point of its rim it spins before it tips, and still tips.
        return bool((t.slide >= (1.0 - _SPINS) * t.topple).all())
    return bool((t.outcome == asked.outcome).all())


def _held(contacts: Contacts, i: int, model: ObjectModel) -> NDArray[np.float64]:
    """Where one finger would have to push for the object to turn as little as under two [m]."""
    point, tangent = contacts.points[i], np.array(contacts.side.face.tangent)
    return np.asarray(point - ((point - np.array(model.com)) @ tangent) * tangent)


def _within_the_cone(contacts: Contacts, i: int, model: ObjectModel, reach: Reach) -> Thresholds:
    """Thresholds of the exact tier for a force straight in, and for forces around the cone."""
    grip = model.finger_friction
    if contacts.guarded:
        grip = min(reach.force_skew, grip)
    return _exactly(model, tuple(contacts.points[i].tolist()), contacts.side.face.normal, grip)


@functools.lru_cache(maxsize=1024)
def _exactly(model: ObjectModel, point: Vector3, normal: Vector3, grip: float) -> Thresholds:
    """Kept, since models never change and the same contacts are asked for again and again."""
    shares = np.vstack((np.zeros((1, 2)), circle_corners(_CONFIRMING)))
    forces = contact_forces(np.array([normal]), grip * shares)
    u = forces / np.linalg.norm(forces, axis=1, keepdims=True)
    return model.thresholds(np.tile(point, (len(u), 1)), u, exact=True)


def margins(
    contacts: Contacts, k: int, asked: Asked, target: SeenObject, push: Push, d: Defaults
) -> Margins:
    """How far the k-th chosen contact is from the outcome that it must not have."""
    i, cone, height = int(contacts.chosen[k]), contacts.cone, target.model.top
    z = float(contacts.points[i, 2])
    if asked.outcome == "slide":
        force, room = float(cone.slide_margin[i]), min(float(cone.height_below[i]), height) - z
    else:
        force, room = float(cone.topple_margin[i]), z - max(float(cone.height_above[i]), 0.0)
    return Margins(
        # What never happens has no threshold: the object's weight is then far enough.
        force=min(force, target.model.weight),
        height=room,
        lateral=float(contacts.lateral[i]),
        sigmas=contacts.sigmas,
        force_limit=push.force_limit - needed_force(contacts, i, asked, target, d),
    )


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def remarks(
    contacts: Contacts, push: Push, predicted: Prediction, asked: Asked, refused: int, d: Defaults
) -> tuple[str, ...]:
    """Plain sentences on how the push was chosen; `refused` contacts were out of reach."""
    notes = []
    if asked.region is not None:
        notes.append(f"the sentence asks for a contact {asked.region}")
    if push.fingers == 1 and 2 in asked.fingers:
        notes.append("one finger, since two do not fit or do not reach it")
    if contacts.sigmas < d.sigmas:
        notes.append(
            f"certain within {contacts.sigmas:g} instead of {d.sigmas:g} standard deviations of "
            f"the parameters; over all of them its probability is {predicted.probability:.3f}"
        )
    if contacts.guarded:
        notes.append(
            "held for the forces that the hand's stiffness allows, not for the whole friction cone"
        )
    if refused:
        better = "contact was" if refused == 1 else "contacts were"
        notes.append(f"{refused} better {better} out of reach")
    return tuple(notes)

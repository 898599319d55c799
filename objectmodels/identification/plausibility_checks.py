"""Plausibility of measurements: contacts on the object, forces of its order.

Wrong units are wrong by a factor of 1000 as a rule, and a belief is hardly ever; so what lies
beside the object, or is off by a factor of `FAR` from what is believed, is refused, with a guess at
the unit. A force that pulls the object towards the finger is that on the finger, not on the object.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from objectmodels.geometry.base_shapes import Array, Polygon
from objectmodels.identification.trial import Trial, Vector
from objectmodels.models.object_model import ObjectModel

SLACK = 0.010
"""A contact may lie so far beside the object [m]: fingertips are round and tables uneven."""

FAR = 50.0
"""A force is off by more than this from what is believed only if its unit is wrong."""

_PULLS = 0.05  # least part of a unit force along the outward normal that surely pulls
_NEAR_ZERO = 0.01  # contacts nearer to the origin than this share of the object are none


@dataclass(frozen=True)
class Objection:
    """Reason why a measurement cannot be right.

    Attributes:
        quantity: the one that is wrong: `x`, `y` or `z` of the contact, `force` or `force_sd`.
        message: in words, with the number found.
        hints: at what may have been meant.
    """

    quantity: str
    message: str
    hints: tuple[str, ...] = ()


def contact_objection(model: ObjectModel, point: Vector) -> Objection | None:
    """Objection to a contact that lies outside of the object by more than `SLACK`; None if it fits.

    Args:
        model: the object.
        point: contact point in B [m].
    """
    x, y, z = point
    low, high = model.outline.min(axis=0), model.outline.max(axis=0)
    if z > model.top + SLACK:
        what = f"{z:g} lies above the object, {model.top:g} m high"
        return Objection("z", what, _length_hint(z, model.top))
    if z < -SLACK:
        return Objection("z", f"{z:g} lies below the table", ("z is 0 at the base, and up",))
    for quantity, value, least, most in zip("xy", (x, y), low, high, strict=True):
        if not least - SLACK <= value <= most + SLACK:
            what = f"{value:g} lies beside the object, which reaches from {least:g} to {most:g} m"
            return Objection(quantity, what, _length_hint(abs(value), max(-least, most)))
    if _distances_beyond(model, point).max() > SLACK:
        return Objection("x", f"({x:g}, {y:g}) lies beside the object")
    if np.linalg.norm(point) < _NEAR_ZERO * max(model.extents):
        what = "the contact lies in the middle of the base, inside the object"
        return Objection("x", what, ("the coordinates are in metres, from the base's middle",))
    return None


def force_objection(model: ObjectModel, trial: Trial) -> Objection | None:
    """Objection to a force that pulls, or is off by a factor of 1000; None if it is plausible.

    Args:
        model: the object as it is believed to be.
        trial: the measurement.
    """
    f = np.array(trial.force)
    size = float(np.linalg.norm(f))
    if size == 0.0:
        return Objection("force", "a force of 0 N moves nothing")
    u = f / size
    if trial.moved != "slip" and not u[:2].any():
        return Objection("force", "a vertical force neither slides nor tilts anything")
    if trial.force_sd > size:
        what = f"{trial.force_sd:g} is larger than the force itself, {size:.3g} N"
        return Objection("force_sd", what, ("is it in millinewtons?",))
    beyond = _distances_beyond(model, trial.point)
    normals = Polygon.convex(model.outline).normals[beyond > -SLACK]
    if len(normals) and (normals @ u[:2]).min() > _PULLS:
        what = "the force pulls the object towards the finger"
        hint = "is it the force on the finger? That on the object has the other sign"
        return Objection("force", what, (hint,))
    if trial.moved == "slip":
        return None  # only the ratio of its parts counts
    believed = _believed_force(model, trial, u)
    # A force that holds a tilted object is less than that at the onset, down to nothing.
    least = believed / (1e3 if trial.tilt else FAR)
    if least <= size <= FAR * believed:
        return None
    unit = "millinewtons" if size > believed else "kilonewtons"
    what = (
        f"a force of {size:.3g} N is far from what the {model.name} is believed to need to "
        f"{trial.moved} there, {believed:.3g} N"
    )
    return Objection("force", what, (f"is it in {unit}?", "or mend the model's guess"))


def _believed_force(model: ObjectModel, trial: Trial, u: Array) -> float:
    """Force at which the object is believed to do what it did; its weight if never [N]."""
    t = model.thresholds([trial.point], [u])
    force = float((t.slide if trial.moved == "slide" else t.topple)[0])
    return force if np.isfinite(force) else model.weight


def _distances_beyond(model: ObjectModel, point: Vector) -> Array:
    """Distances of a point beyond each side of the outline seen from above [m]."""
    outline = Polygon.convex(model.outline)
    return np.asarray(outline.normals @ np.array(point[:2]) - outline.offsets)


def _length_hint(value: float, most: float) -> tuple[str, ...]:
    for factor, unit in ((100.0, "centimetres"), (1000.0, "millimetres")):
        if value / factor <= most + SLACK / 10.0:
            return (f"is it in {unit}? the column is in metres",)
    return ()

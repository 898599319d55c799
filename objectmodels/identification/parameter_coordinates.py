"""The uncertain parameters as vectors, models with other values of them, and their contents then.

Vectors are in the order of `UNCERTAIN`. Steps make sense in logarithms of the positive parameters,
and in metres of the horizontal centre of mass.

Contents and shell of a container are believed independently of each other. So what all of it weighs
otherwise than believed is put down to the contents by their share of the variance, and what is
known better of the whole is known better of them by that share.
"""

from __future__ import annotations

from math import isclose, sqrt

import numpy as np
from numpy.typing import NDArray

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.pushed_body import UNCERTAIN
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.object_parts import Container

Mask = NDArray[np.bool_]

MASS, FRICTION, FINGER, RADIUS, COM_X, COM_Y, COM_Z = range(len(UNCERTAIN))
"""Places of the parameters in vectors of values."""

LOGARITHMIC = np.array([name not in ("com_x", "com_y") for name in UNCERTAIN])
"""Which coordinates are logarithms."""

_ROUNDING = 1e-9


def coordinates_of(values: Array) -> Array:
    """Coordinates of parameters (..., 7): logarithms, or metres for com_x and com_y."""
    safe = np.where(LOGARITHMIC, values, 1.0)
    return np.where(LOGARITHMIC, np.log(safe), values)


def values_at(x: Array) -> Array:
    """Parameters at coordinates (..., 7); the inverse of `coordinates`."""
    return np.where(LOGARITHMIC, np.exp(np.where(LOGARITHMIC, x, 0.0)), x)


def coordinate_units(values: Array) -> Array:
    """By how much the parameters change for each unit of their coordinates, shape (7,)."""
    return np.where(LOGARITHMIC, values, 1.0)


def with_values(model: ObjectModel, values: Array) -> ObjectModel:
    """The model with other values of the uncertain parameters, in the order of `UNCERTAIN`.

    Kinetic coefficients keep their ratio to the static ones: no trial tells them apart. What a
    container weighs otherwise is put down to its contents.

    Raises:
        ModelError: `not_possible` if an object with them would not stand.
    """
    m, friction, finger, radius, *com = (float(value) for value in values)
    c = np.array(com)
    room = model.base.topple_force(np.zeros(2), c[:2], np.zeros(()), 1.0)
    if not (room > 1.0 and 0.0 < c[2] < model.top):
        raise ModelError(
            "not_possible",
            f"the trials put the centre of mass of the {model.name} at "
            f"({c[0]:.3f}, {c[1]:.3f}, {c[2]:.3f}) m, where it would not stand",
            suggestions=("check where the contacts were, and the object's size",),
        )
    return model.model_copy(
        update={
            "mass": m,
            "friction": friction,
            "finger_friction": finger,
            "friction_radius": radius,
            "com": tuple(com),
            "container": container_with_mass(model, m, model.mass_sd),
            "friction_kinetic": _in_ratio(model.friction_kinetic, friction, model.friction),
            "finger_friction_kinetic": _in_ratio(
                model.finger_friction_kinetic, finger, model.finger_friction
            ),
        }
    )


def _in_ratio(kinetic: float | None, static: float, before: float) -> float | None:
    return None if kinetic is None else kinetic * (static / before)


def with_belief(model: ObjectModel, covariance: Array) -> ObjectModel:
    """The model with another covariance of its parameters, in the order of `UNCERTAIN`, (7, 7)."""
    mass, friction, finger, radius, *com = np.sqrt(np.maximum(np.diag(covariance), 0.0)).tolist()
    rho = correlation_of(covariance)
    pairs = [
        (a, b, float(rho[i, j]))
        for i, a in enumerate(UNCERTAIN)
        for j, b in enumerate(UNCERTAIN)
        if i < j and not isclose(rho[i, j], 0.0, abs_tol=1e-12)
    ]
    return model.model_copy(
        update={
            "mass_sd": mass,
            "friction_sd": friction,
            "finger_friction_sd": finger,
            "friction_radius_sd": radius,
            "com_sd": tuple(com),
            "container": container_with_mass(model, model.mass, mass),
            "correlations": tuple(pairs),
        }
    )


def correlation_of(covariance: Array) -> Array:
    """Correlations of a covariance (7, 7); a hair inside of what is possible, for rounding."""
    sd = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    safe = np.where(sd > 0.0, sd, 1.0)
    rho = covariance / np.outer(safe, safe) * (1.0 - 1e-9)
    np.fill_diagonal(rho, 1.0)
    return np.asarray(np.clip(rho, -1.0, 1.0))


def container_with_volume(model: ObjectModel, volume: float, sd: float) -> Container:
    """The container of a hollow model with a volume in it, or with as much of that as it holds.

    The volume and its standard deviation are in [m³].
    """
    container, vessel = model.container, model.vessel
    assert container is not None, "what holds something is a container"
    assert vessel is not None
    most = (1.0 - _ROUNDING) * vessel.capacity  # litres and cubic metres differ in the last digit
    volume = min(max(volume, 0.0), most)
    return container.model_copy(update={"contents_l": 1e3 * volume, "contents_l_sd": 1e3 * sd})


def container_with_mass(model: ObjectModel, mass: float, mass_sd: float) -> Container | None:
    """The container of a model of which all is known to weigh otherwise; None if it has none.

    Mass and standard deviation are those of container and contents together [kg].
    """
    container = model.container
    if container is None:
        return None
    uncertain = container.density * container.contents_sd
    share = min((uncertain / model.mass_sd) ** 2, 1.0) if model.mass_sd > 0.0 else 0.0
    liquid = container.mass + share * (mass - model.mass)
    if mass < model.mass:  # the shell keeps at least its part
        liquid = min(liquid, mass * container.mass / model.mass)
    known = 1.0 - share * (1.0 - (mass_sd / model.mass_sd) ** 2) if share > 0.0 else 1.0
    return container_with_volume(
        model, liquid / container.density, sqrt(known) * container.contents_sd
    )

"""Measurement model of identification: values that touches of an object should show.

Model, with F = s u the force on the object in the level axes of B, G its weight:

- *slide*: s is the model's own threshold, and the object turns by the ω of its sliding motion for
  each metre that the contact goes along u. With the load N = G − s u_z and
  a = (G/N) [(p − c) × u]_z the ellipsoid moves with ω = (a / c̄²) / (|u_xy|² + (a / c̄)²).
- *topple*, held at a tilt θ about the base edge of outward normal n and offset d: turned by θ about
  the edge, a point that was ξ = n·p − d beyond it and p_z above is x = ξ cos θ + p_z sin θ beyond
  and h = p_z cos θ − ξ sin θ above. The centre of mass was b = d − n·c_xy inside, so its weight
  acts at b cos θ − c_z sin θ. Balance of moments about the edge:

      s (u_n h − u_z x) = G (b cos θ − c_z sin θ)

  At θ = 0 that is the model's topple threshold. The edge is the one over which the model topples
  first; of a round base, the point of the rim that the load reaches.
- *slip*: the tangential share of the force at the finger |f_t| / f_n is μ_finger. Of this ratio the
  force's noise is taken to be as large across the force as along it.

All depends on the seven `UNCERTAIN` parameters; arrays of them broadcast. To fit them they are
seen in coordinates in which steps make sense: logarithms of the positive ones, metres for the
horizontal centre of mass.

The force that slides an object by the exact tier is G r / (1 + r u_z), where the load ratio r is
the root of μ S(q, c̄) − r |u_xy| = 0, S the friction limit and q(r, c) the centre of pressure; see
`objectmodels.exact.exact_thresholds`. At a root the derivatives of r follow from those of
this one equation: all of them, and those of the turn rate, come from one evaluation of the friction
limit on slightly changed copies of the pushes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isclose, sqrt

import numpy as np
from numpy.typing import NDArray

from objectmodels.errors import ModelError
from objectmodels.exact.exact_thresholds import ExactThresholds
from objectmodels.exact.support_springs import Springs
from objectmodels.geometry.base_shapes import Array, Base, hull_polygon
from objectmodels.geometry.pushed_body import UNCERTAIN
from objectmodels.geometry.rotations import dot
from objectmodels.identification.trial import Touches, Trial
from objectmodels.mechanics.friction_limit import friction_limit
from objectmodels.mechanics.push_thresholds import (
    GRAVITY,
    push_axes,
    push_moment,
    ratio_at,
    slide_threshold,
    yaw_arm,
)
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.object_parts import Container

# The uncertain parameters as vectors, models with other values of them, and their contents then.
#
# Vectors are in the order of `UNCERTAIN`. Steps make sense in logarithms of the positive
# parameters, and in metres of the horizontal centre of mass.
#
# Contents and shell of a container are believed independently of each other. So what all of it
# weighs otherwise than believed is put down to the contents by their share of the variance, and
# what is known better of the whole is known better of them by that share.

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


_STEP = 1e-6  # of a logarithm, and of the base's size, in differences

_EXACT_STEP = 1e-5  # relative, in differences; the limits are precise to 1e-10


@dataclass(frozen=True)
class Linear:
    """Predictions near some values of the parameters.

    Attributes:
        values: the parameters, in the order of `UNCERTAIN`, shape (7,).
        predicted: what the rows should show, shape (r,).
        jacobian: how that changes with the coordinates, shape (r, 7).
        sd: stated standard deviations of the rows, shape (r,).
    """

    values: Array
    predicted: Array
    jacobian: Array
    sd: Array


class Balance:
    """Predictions of a model for some trials.

    Rows are what was measured: one for what made each trial move, in their order (a force [N], or
    for a slip the ratio of forces), then one for each turn rate [rad/m].

    Attributes:
        model: whose shape and support count, and whose values for what is not given.
        touches: the trials.
        exact: whether slides are those of the exact tier.
        observed: what was measured, shape (r,).
        trial: number of the trial that each row belongs to, shape (r,).
        normals: outward normals of the edges it would topple over, shape (n, 2).
        slides, turns: which rows are forces of slides, and which are turn rates, shape (r,).
    """

    def __init__(self, model: ObjectModel, trials: Sequence[Trial], *, exact: bool = False) -> None:
        self.model, self.exact = model, exact
        self.touches = t = Touches.from_trials(trials)
        (turned,) = np.nonzero((t.kind == "slide") & np.isfinite(t.turn))
        first = np.where(t.kind == "slip", t.ratio, t.size)
        self.observed = np.concatenate((first, t.turn[turned]))
        self.trial = np.concatenate((np.arange(len(first)), turned))
        self.turns = np.arange(len(self.observed)) >= len(first)
        self.slides = (t.kind[self.trial] == "slide") & ~self.turns
        self._turned = turned
        # Outward normals of the edges that the object would topple over first, shape (n, 2).
        normals = model.thresholds(t.p, t.u).tipping_normal
        facing = [model.base.facing_normal(u[:2] / max(np.hypot(*u[:2]), 1e-300)) for u in t.u]
        self.normals = np.where(np.isfinite(normals), normals, facing)

    @property
    def groups(self) -> list[NDArray[np.intp]]:
        """Rows of one kind each: forces of slides, of tilts, ratios of slips, turn rates."""
        kinds = self.touches.kind[self.trial]
        forces = [
            np.flatnonzero((kinds == kind) & ~self.turns) for kind in ("slide", "topple", "slip")
        ]
        return [*forces, np.flatnonzero(self.turns)]

    def predict(self, values: Array) -> Array:
        """Predicted values of the rows by the closed form, shape (..., r).

        The parameters are in the order of `UNCERTAIN`, shape (..., 7).
        """
        t, values = self.touches, np.asarray(values, dtype=np.float64)
        force = np.empty((*values.shape[:-1], len(t.size)))
        turn = np.zeros_like(force)
        for kind in ("slide", "topple", "slip"):
            (i,) = np.nonzero(t.kind == kind)
            if not i.size:
                continue
            if kind == "slide":
                force[..., i], turn[..., i] = slide_force(t.p[i], t.u[i], values)
            elif kind == "topple":
                force[..., i] = topple_force(
                    self.model.base, self.normals[i], t.p[i], t.u[i], t.tilt[i], values
                )
            else:
                force[..., i] = values[..., FINGER, None]
        return np.concatenate((force, turn[..., self._turned]), axis=-1)

    def linear_predictions(self, values: Array) -> Linear:
        """Predictions near some values, of the exact tier if that is meant; shapes as in `Linear`.

        The values are in the order of `UNCERTAIN`, shape (7,).
        """
        steps = _STEP * np.where(LOGARITHMIC, 1.0, self.model.base.size)
        around = coordinates_of(values) + np.vstack((np.diag(steps), -np.diag(steps)))
        predicted = self.predict(np.vstack((values, values_at(around))))
        k = len(steps)
        with np.errstate(invalid="ignore"):  # infinite where nothing would move
            jacobian = ((predicted[1 : k + 1] - predicted[k + 1 :]) / (2.0 * steps[:, None])).T
        now = predicted[0]
        if self.exact:
            self._take_exact(values, now, jacobian)
        # Stated standard deviations; an error of the tilt counts by the force it makes.
        t = self.touches
        sd = np.where(t.kind == "slip", t.ratio_sd, t.size_sd)
        (i,) = np.nonzero(t.tilt_sd > 0.0)
        if i.size:
            place = self.model.base, self.normals[i], t.p[i], t.u[i]
            more, less = (topple_force(*place, t.tilt[i] + d, values) for d in (_STEP, -_STEP))
            sd[i] = np.hypot(sd[i], (more - less) / (2.0 * _STEP) * t.tilt_sd[i])
        return Linear(values, now, jacobian, np.concatenate((sd, t.turn_sd[self._turned])))

    def _take_exact(self, values: Array, predicted: Array, jacobian: Array) -> None:
        """Put the exact tier's slides in place of the closed form's."""
        t = self.touches
        (i,) = np.nonzero(t.kind == "slide")
        if not i.size:
            return
        found = exact_slides(with_values(self.model, values), t.p[i], t.u[i])
        rows = i[found.sure]
        predicted[rows], jacobian[rows] = found.force[found.sure], found.force_change[found.sure]
        turned = np.full(len(t.size), -1)
        turned[self._turned] = len(t.size) + np.arange(len(self._turned))
        has = found.sure & (turned[i] >= 0)
        rows = turned[i[has]]
        predicted[rows], jacobian[rows] = found.turn[has], found.turn_change[has]


def slide_force(p: Array, u: Array, values: Array) -> tuple[Array, Array]:
    """Force that slides [N] and turn rate [rad/m] of the closed form, shape (..., n) each.

    Contact points p (n, 3) [m] and directions u (n, 3) are in B, parameters (..., 7).
    """
    weight, radius = GRAVITY * values[..., MASS, None], values[..., RADIUS, None]
    arm = yaw_arm(p, u, values[..., None, COM_X:])
    share = slide_threshold(u, arm, values[..., FRICTION, None], radius, 1.0)  # s / G
    with np.errstate(divide="ignore", invalid="ignore"):
        a = arm / (1.0 - share * u[:, 2])
        turn = (a / radius**2) / (u[:, 0] ** 2 + u[:, 1] ** 2 + (a / radius) ** 2)
    return weight * share, turn


def topple_force(base: Base, n: Array, p: Array, u: Array, tilt: Array, values: Array) -> Array:
    """Force at p along u that holds the object at tilts (n,) [rad], (..., n) [N]; inf if none.

    Edges that it is tilted about have outward normals n (n, 2); a round base has its own.
    """
    weight, c = GRAVITY * values[..., MASS, None], values[..., None, COM_X:]
    if base.is_round:
        # Directions in which the load reaches the rim, n where it never does, shape (..., n, 2).
        s = base.topple_force(c[..., :2], push_moment(p, u), u[:, 2], 1.0)
        q = c[..., :2] + np.where(np.isfinite(s), s, 0.0)[..., None] * push_moment(p, u)
        found = q / np.maximum(np.hypot(q[..., 0], q[..., 1]), 1e-300)[..., None]
        n = np.where(np.isfinite(s)[..., None], found, n)
    lever, d = tilt_arms(base, n, p, u, tilt)
    holding = (d - dot(n, c)) * np.cos(tilt) - c[..., 2] * np.sin(tilt)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(lever > 0.0, weight * holding / lever, np.inf)


def tilt_arms(base: Base, n: Array, p: Array, u: Array, tilt: Array) -> tuple[Array, Array]:
    """Lever arms u_n h − u_z x about tilted edges, and the edges' offsets d, each (..., n) [m].

    The edges have outward normals n (..., n, 2), tilts are (n,) [rad]; p and u as in `slide_force`.
    """
    d = base.extent(n)
    xi, cos, sin = dot(n, p) - d, np.cos(tilt), np.sin(tilt)
    x, h = xi * cos + p[:, 2] * sin, p[:, 2] * cos - xi * sin
    return dot(n, u) * h - u[:, 2] * x, d


@dataclass(frozen=True)
class ExactSlides:
    """Slides of n pushes.

    Attributes:
        force: force that slides, shape (n,) [N].
        turn: turn rate, shape (n,) [rad/m].
        force_change: derivatives along the `coordinates`, shape (n, 7).
        turn_change: the same of the turn rate, shape (n, 7).
        sure: where the tier has an answer: the object slides before it topples, shape (n,).
    """

    force: Array
    turn: Array
    force_change: Array
    turn_change: Array
    sure: NDArray[np.bool_]


def exact_slides(model: ObjectModel, p: Array, u: Array) -> ExactSlides:
    """Slides of the exact tier for pushes at p along u as in `slide_force`, with derivatives."""
    t = model.thresholds(p, u, exact=True)
    assert isinstance(t, ExactThresholds)
    sure = (t.slide < t.topple) & np.isfinite(t.motion).all(axis=0)
    n = len(p)
    found = ExactSlides(t.slide, np.zeros(n), np.zeros((n, 7)), np.zeros((n, 7)), sure)
    (i,) = np.nonzero(sure)
    if i.size:
        _fill_derivatives(model, t, i, found)
    return found


def _fill_derivatives(
    model: ObjectModel, t: ExactThresholds, i: NDArray[np.intp], found: ExactSlides
) -> None:
    """Fills in turn rates and derivatives of the slides i."""
    (p, u), mu = (v[i] for v in t.push), model.friction
    r, h, w = ratio_at(t.slide[i], u[:, 2], model.weight), np.hypot(u[:, 0], u[:, 1]), u[:, 2]
    # Unknowns: r, c_x, c_y, log c̄.
    length = model.base.size
    steps = np.array([0.0, length, length, 1.0]) * _EXACT_STEP
    limits, turns = _limits_around(model, t, p, u, r, steps)
    step_r = _EXACT_STEP * r
    ahead, behind = limits[1:5], limits[5:]
    sizes = np.vstack((step_r, np.tile(steps[1:, None], (1, len(i)))))
    dS = (ahead - behind) / (2.0 * sizes)
    d_turn = (turns[1:5] - turns[5:]) / (2.0 * sizes)
    slope = mu * dS[0] - h
    # dr along log μ, log c̄, c_x, c_y; the root moves against the slope of the equation.
    dr = -np.stack((mu * limits[0], mu * dS[3], mu * dS[1], mu * dS[2])) / slope
    places = np.array([1, 3, 4, 5])  # of those in the order of `UNCERTAIN`
    per_r = model.weight / (1.0 + r * w) ** 2
    found.turn[i] = turns[0]
    found.force_change[np.ix_(i, places)] = (per_r * dr).T
    found.force_change[i, 0] = t.slide[i]  # all forces are proportional to the mass
    direct = np.stack((np.zeros(len(i)), d_turn[3], d_turn[1], d_turn[2]))
    found.turn_change[np.ix_(i, places)] = (direct + d_turn[0] * dr).T


def _limits_around(
    model: ObjectModel, t: ExactThresholds, p: Array, u: Array, r: Array, steps: Array
) -> tuple[Array, Array]:
    """Friction limits S and turn rates, there and one step of each unknown ahead and behind."""
    points, weights, scale = t.support
    h, along, across = push_axes(u)
    change = np.zeros((9, 4, 1)) + np.zeros((1, 1, len(p)))
    for k in range(4):
        step = _EXACT_STEP * r if k == 0 else steps[k]
        change[1 + k, k], change[5 + k, k] = step, -step
    com = np.array(model.com[:2])[:, None] + change[:, 1:3]  # (9, 2, n)
    ratio, scales = r + change[:, 0], scale * np.exp(change[:, 3])  # (9, n)
    q = (1.0 + ratio * u[:, 2])[:, None] * com + ratio[:, None] * push_moment(p, u).T
    q = q.transpose(1, 0, 2).reshape(2, -1)
    if model.base.is_round:
        inside = hull_polygon(points)
        q = q / np.maximum((inside.normals @ q / inside.offsets[:, None]).max(axis=0), 1.0)
    springs = Springs(points, weights)
    loads, _ = springs.loads(q, np.zeros_like(q), np.ones((len(points), q.shape[1]), dtype=bool))
    factor = scales.reshape(-1)
    a, b = np.tile(along.T, 9), np.tile(across.T, 9)
    line = np.tile(np.sum(p[:, :2] * across, axis=1), 9)
    ahead, aside = (a * q).sum(axis=0), (b * q).sum(axis=0)
    xi = ahead + factor * (points @ a - ahead)
    eta = aside - line + factor * (points @ b - aside)
    limit = friction_limit(loads, xi, eta)
    shape = (9, len(p))
    return limit.ratio.reshape(shape), limit.turn.reshape(shape) / h

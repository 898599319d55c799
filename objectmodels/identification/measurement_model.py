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
`objectmodels.mechanics.exact.exact_thresholds`. At a root the derivatives of r follow from those of
this one equation: all of them, and those of the turn rate, come from one evaluation of the friction
limit on slightly changed copies of the pushes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.base_shapes import Array, Base, Disc
from objectmodels.geometry.support_points import hull_polygon
from objectmodels.geometry.vector_arrays import dot
from objectmodels.identification.parameter_coordinates import (
    COM_X,
    FINGER,
    FRICTION,
    LOGARITHMIC,
    MASS,
    RADIUS,
    coordinates_of,
    values_at,
    with_values,
)
from objectmodels.identification.trial import Touches, Trial
from objectmodels.mechanics.exact.exact_thresholds import ExactThresholds
from objectmodels.mechanics.exact.support_springs import Springs
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
        self.normals = _tipping_normals(model, t)

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
        return Linear(values, now, jacobian, self._stated_deviations(values))

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

    def _stated_deviations(self, values: Array) -> Array:
        """Stated standard deviations; an error of the tilt counts by the force it makes."""
        t = self.touches
        sd = np.where(t.kind == "slip", t.ratio_sd, t.size_sd)
        (i,) = np.nonzero(t.tilt_sd > 0.0)
        if i.size:
            place = self.model.base, self.normals[i], t.p[i], t.u[i]
            more, less = (topple_force(*place, t.tilt[i] + d, values) for d in (_STEP, -_STEP))
            sd[i] = np.hypot(sd[i], (more - less) / (2.0 * _STEP) * t.tilt_sd[i])
        return np.concatenate((sd, t.turn_sd[self._turned]))


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
    if isinstance(base, Disc):
        n = _rim_normals(base, n, p, u, c)
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


def _rim_normals(base: Disc, n: Array, p: Array, u: Array, c: Array) -> Array:
    """Directions in which the load reaches the rim, n where it never does, shape (..., n, 2)."""
    s = base.topple_force(c[..., :2], push_moment(p, u), u[:, 2], 1.0)
    q = c[..., :2] + np.where(np.isfinite(s), s, 0.0)[..., None] * push_moment(p, u)
    found = q / np.maximum(np.hypot(q[..., 0], q[..., 1]), 1e-300)[..., None]
    return np.where(np.isfinite(s)[..., None], found, n)


def _tipping_normals(model: ObjectModel, t: Touches) -> Array:
    """Outward normals of the edges that the object would topple over first, shape (n, 2)."""
    normals = model.thresholds(t.p, t.u).tipping_normal
    facing = [model.base.facing_normal(u[:2] / max(np.hypot(*u[:2]), 1e-300)) for u in t.u]
    return np.where(np.isfinite(normals), normals, facing)


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
    if isinstance(model.base, Disc):
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

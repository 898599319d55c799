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
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array, Base, Disc
from objectmodels.geometry.planar_vectors import dot
from objectmodels.identification.exact_slides import exact_slides
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
from objectmodels.identification.trial import Trial
from objectmodels.mechanics.push_thresholds import GRAVITY, push_moment, slide_threshold, yaw_arm
from objectmodels.models.object_model import ObjectModel

TURN_RATE_SD = 0.5
"""Standard deviation of a turn rate that comes without one [rad/m]."""

_STEP = 1e-6  # of a logarithm, and of the base's size, in differences


@dataclass(frozen=True)
class Touches:
    """Trials as arrays.

    Attributes:
        kind: what gave way, shape (n,).
        p: contact points in B, shape (n, 3) [m].
        u: directions of the forces in B, shape (n, 3).
        size: sizes of the forces, shape (n,) [N].
        size_sd: their standard deviations [N].
        tilt: tilts, shape (n,) [rad].
        tilt_sd: their standard deviations [rad].
        turn: turn rates of slides, nan if not measured, shape (n,) [rad/m].
        turn_sd: their standard deviations [rad/m].
        ratio: tangential over normal force of slips, nan of others, shape (n,).
        ratio_sd: their standard deviations.
        sources: what the trials are called.
    """

    kind: NDArray[np.str_]
    p: Array
    u: Array
    size: Array
    size_sd: Array
    tilt: Array
    tilt_sd: Array
    turn: Array
    turn_sd: Array
    ratio: Array
    ratio_sd: Array
    sources: tuple[str, ...]

    @classmethod
    def from_trials(cls, trials: Sequence[Trial]) -> Touches:
        """Arrays of some trials.

        Raises:
            ModelError: `no_trials`; `bad_trial` if one makes no sense.
        """
        if not trials:
            raise ModelError("no_trials", "there is no trial to learn from")
        for trial in trials:
            _require_sense(trial)
        force = np.array([trial.force for trial in trials])
        size = np.linalg.norm(force, axis=1)
        ratios = np.array([_slip_ratio(trial) for trial in trials])
        rates = [(trial.turn_rate, trial.turn_rate_sd) for trial in trials]
        return cls(
            kind=np.array([trial.moved for trial in trials]),
            p=np.array([trial.point for trial in trials]),
            u=force / size[:, None],
            size=size,
            size_sd=np.array([trial.force_sd for trial in trials]),
            tilt=np.array([trial.tilt for trial in trials]),
            tilt_sd=np.array([trial.tilt_sd for trial in trials]),
            turn=np.array([np.nan if rate is None else rate for rate, _ in rates]),
            turn_sd=np.array([TURN_RATE_SD if sd is None else sd for _, sd in rates]),
            ratio=ratios[:, 0],
            ratio_sd=ratios[:, 1],
            sources=tuple(trial.source for trial in trials),
        )


def _require_sense(trial: Trial) -> None:
    figures = (*trial.point, *trial.force, trial.force_sd, trial.tilt, trial.tilt_sd,
               trial.turn_rate or 0.0, trial.turn_rate_sd or 0.0)  # fmt: skip
    wrong = None
    if not np.isfinite(figures).all():
        wrong = "has a figure that is no number"
    elif not any(trial.force):
        wrong = "has no force"
    elif trial.force_sd <= 0.0 or trial.tilt_sd < 0.0 or trial.turn_rate_sd == 0.0:
        wrong = "needs positive standard deviations"
    elif trial.moved == "slip" and (trial.normal is None or _slip_ratio(trial)[0] <= 0.0):
        wrong = "is a slip, which needs the face's normal and a force that presses on it aslant"
    elif trial.moved != "slip" and not any(trial.force[:2]):
        wrong = "has a vertical force, which neither slides nor tilts anything"
    if wrong:
        raise ModelError("bad_trial", f"{trial.source} {wrong}")


def _slip_ratio(trial: Trial) -> tuple[float, float]:
    """Tangential over normal force of a slip, and its standard deviation."""
    if trial.moved != "slip" or trial.normal is None:
        return np.nan, np.nan
    force, normal = np.array(trial.force), np.array(trial.normal)
    pressing = float(-force @ normal)
    if pressing <= 0.0:
        return 0.0, np.nan
    ratio = float(np.linalg.norm(force + pressing * normal)) / pressing
    return ratio, trial.force_sd / pressing * float(np.hypot(1.0, ratio))


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

        Args:
            values: the parameters in the order of `UNCERTAIN`, shape (..., 7).
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

        Args:
            values: the parameters in the order of `UNCERTAIN`, shape (7,).
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

    Args:
        p: contact points in B, shape (n, 3) [m].
        u: directions of the force, shape (n, 3).
        values: the parameters, shape (..., 7).
    """
    weight, radius = GRAVITY * values[..., MASS, None], values[..., RADIUS, None]
    arm = yaw_arm(p, u, values[..., None, COM_X:])
    share = slide_threshold(u, arm, values[..., FRICTION, None], radius, 1.0)  # s / G
    with np.errstate(divide="ignore", invalid="ignore"):
        a = arm / (1.0 - share * u[:, 2])
        turn = (a / radius**2) / (u[:, 0] ** 2 + u[:, 1] ** 2 + (a / radius) ** 2)
    return weight * share, turn


def topple_force(base: Base, n: Array, p: Array, u: Array, tilt: Array, values: Array) -> Array:
    """Force that holds the object at a tilt, shape (..., n) [N]; inf if it cannot.

    Args:
        base: what it stands on.
        n: outward normals of the edges tilted about, shape (n, 2); a round base has its own.
        p: contact points in B, shape (n, 3) [m].
        u: directions of the force, shape (n, 3).
        tilt: angles, shape (n,) [rad].
        values: the parameters, shape (..., 7).
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

    Args:
        base: what it stands on.
        n: outward normals of the edges, shape (..., n, 2).
        p: contact points in B, shape (n, 3) [m].
        u: directions of the force, shape (n, 3).
        tilt: angles, shape (n,) [rad].
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

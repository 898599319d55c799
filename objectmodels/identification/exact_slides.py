"""Slides of the exact tier, with their derivatives.

The force that slides an object is G r / (1 + r u_z), where the load ratio r is the root of
μ S(q, c̄) − r |u_xy| = 0, S the friction limit and q(r, c) the centre of pressure; see
`objectmodels.mechanics.exact.exact_thresholds`. At a root the derivatives of r follow from those of
this one equation: all of them, and those of the turn rate, come from one evaluation of the friction
limit on slightly changed copies of the pushes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.base_shapes import Array, Disc
from objectmodels.geometry.support_points import hull_polygon
from objectmodels.mechanics.exact.exact_thresholds import ExactThresholds
from objectmodels.mechanics.exact.support_springs import Springs, push_axes
from objectmodels.mechanics.friction_limit import friction_limit
from objectmodels.mechanics.push_thresholds import push_moment, ratio_at
from objectmodels.models.object_model import ObjectModel

_STEP = 1e-5  # relative, in differences; the limits are precise to 1e-10


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
    """Slides of the exact tier, with their derivatives.

    Args:
        model: the object.
        p: contact points in B, shape (n, 3) [m].
        u: directions of the forces, shape (n, 3).
    """
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
    steps = np.array([0.0, length, length, 1.0]) * _STEP
    limits, turns = _limits_around(model, t, p, u, r, steps)
    step_r = _STEP * r
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
        step = _STEP * r if k == 0 else steps[k]
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

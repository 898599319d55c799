"""Things that hang over a table's edge: what tips them, how far they may hang, and how one is held.

Model: a level, rigid base, of which the half-plane of a table {q : n·q ≤ d} carries what is over
it, so that the support is where both overlap. A force N pressing down at p on the top (or, of
N < 0, pushing up from below), with a force F along the top at a height h, moves the centre of
pressure from below the centre of mass c, over which the weight G acts, to

    q = (G c + N p + h F) / (G + N).

- It lies still while q is within the support: n_k·q ≤ d_k at each edge of base and table.
- Without F that is G (d_k − n_k·c) + N (d_k − n_k·p) ≥ 0, which bounds N at each edge.
- The farthest that it may hang beyond the table's edge is max n·(base) − n·q.

Held at the part that hangs over, by fingertips below it and a thumb that presses on top with N, the
line between the outer fingertips is all its support. The thumb's friction moves the centre of
pressure by up to h μ_f N / (G + N), and so it keeps level if without friction q is no farther off
that line. Else it turns about it, down at the side on which q is.

What twists it about the vertical is left out: the thumb is to be between the fingers.

Frame: everything in B, seen from above. A disc is taken as the polygon of its corners.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.geometry.base_shapes import Array, Polygon, hull_polygon
from objectmodels.geometry.rotations import cross
from objectmodels.mechanics.outcome_probability import normal_cdf
from objectmodels.mechanics.push_thresholds import centre_of_pressure

if TYPE_CHECKING:
    from objectmodels.geometry.pushed_body import PushedBody


_SURE = 1e-9  # least standard deviation of a margin [m]
_NONE = np.zeros(2)


@dataclass(frozen=True, eq=False)
class TableEdge:
    """A straight edge of a table, under an object.

    Attributes:
        normal: n, off the table, shape (2,).
        offset: d [m].
    """

    normal: Array
    offset: float


@dataclass(frozen=True, eq=False)
class TopLoad:
    """A force on an object from above, or from below.

    Attributes:
        point: p, shape (2,) [m].
        press: N, downwards [N].
        along: F, at the height of the top, shape (2,) [N].
    """

    point: Array
    press: float
    along: Array


UNLOADED = TopLoad(_NONE, 0.0, _NONE)


def loaded_centre(body: PushedBody, load: TopLoad = UNLOADED) -> Array:
    """The point q at which the table carries an object under a load, shape (2,) [m]."""
    p, force = np.append(load.point, body.top), np.append(load.along, -load.press)
    return centre_of_pressure(p, force, np.array(body.com), body.weight)


def edge_margins(body: PushedBody, edge: TableEdge, load: TopLoad = UNLOADED) -> Array:
    """Margins of q at each edge of the support, shape (k,) [m]: it tips if one is below 0.

    The table's edge comes last.
    """
    n, d = _support(body, edge)
    return np.asarray(d - n @ loaded_centre(body, load))


def lying_probability(
    body: PushedBody, edge: TableEdge, load: TopLoad = UNLOADED, *, edge_sd: float = 0.0
) -> float:
    """Least probability that an object lies still.

    Args:
        body: what is believed of it.
        edge: of the table.
        load: on it.
        edge_sd: standard deviation of where the table's edge is [m].
    """
    n, _ = _support(body, edge)
    share = body.weight / (body.weight + load.press)
    sds = share * np.sqrt(n**2 @ np.array(body.com_sd[:2]) ** 2)
    sds[-1] = np.hypot(sds[-1], edge_sd)
    falls = normal_cdf(-edge_margins(body, edge, load) / np.maximum(sds, _SURE))
    return max(0.0, 1.0 - float(falls.sum()))


def largest_overhang(
    body: PushedBody, normal: Array, load: TopLoad = UNLOADED, *, spare: float = 0.0
) -> float:
    """Farthest that a base may reach beyond the table's edge [m], so that it lies still.

    Args:
        body: what is believed of it.
        normal: of the edge, off the table, shape (2,).
        load: on it.
        spare: margin that is left at the edge [m].
    """
    reach = float((body.base.corners @ normal).max())
    return max(0.0, reach - float(normal @ loaded_centre(body, load)) - spare)


def touch_limits(body: PushedBody, edge: TableEdge, point: Array) -> tuple[float, float]:
    """The largest forces at a point, (2,) [m], down on top and up from below, that tip nothing [N].

    Both are 0 where it falls by itself, and infinite where nothing tips it; to lift it as a whole
    takes its weight.
    """
    n, d = _support(body, edge)
    moment, arm = body.weight * edge_margins(body, edge), d - n @ point
    if (moment < 0.0).any():
        return 0.0, 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        least = moment / np.abs(arm)
    down = np.where(arm < 0.0, least, np.inf).min()
    up = np.where(arm > 0.0, least, np.inf).min()
    return float(down), float(min(up, body.weight))


def pinch_margin(body: PushedBody, thumb: Array, press: float, fingers: Array) -> float:
    """Margin of q within what a thumb and fingertips below hold level [m]; below 0 it turns.

    Args:
        body: what is held.
        thumb: where it presses on top, shape (2,) [m].
        press: N with which it does [N].
        fingers: the two outer fingertips below, shape (2, 2) [m].
    """
    q = loaded_centre(body, TopLoad(thumb, press, _NONE))
    start, line = fingers[0], fingers[1] - fingers[0]
    length = float(np.hypot(*line))
    along = float((q - start) @ line) / length
    off = np.hypot(max(0.0, -along, along - length), float(cross(line, q - start)) / length)
    # The friction of a thumb moves q by h μ_f N / (G + N).
    return float(body.top * body.finger_friction * press / (body.weight + press) - off)


def _support(body: PushedBody, edge: TableEdge) -> tuple[Array, Array]:
    """Normals (k, 2) and offsets (k,) [m] of the edges of base and table, the table's last."""
    base = hull_polygon(body.base.corners)
    return np.vstack([base.normals, edge.normal]), np.append(base.offsets, edge.offset)


# Stability of a stack: rigid objects on one another, each on one or on the table.
#
# Model: the faces that meet are level and nothing slides. What stands above such a place presses
# on it where its common centre of mass c is, so that it stands while c lies within both faces,
# every edge k of which is n_k·q = d_k:
#
#     margin = min_k (d_k − n_k·c) > 0,    c = Σ m_i c_i / M,    M = Σ m_i over what is above.
#
# A stack stands if it does so at every place from its top down to the table. To first order in
# what is uncertain of the centres and masses
#
#     σ_k² = Σ (m_i / M)² n_kᵀ Σ_i n_k + Σ (σ_i n_k·(c_i − c) / M)²,
#
# and it stands with a probability of 1 − Σ_k Φ((n_k·c − d_k) / σ_k) at least.


@dataclass(frozen=True, eq=False)
class StackedBody:
    """A member of a stack.

    Attributes:
        mass, mass_sd: m and its standard deviation [kg].
        com: its centre of mass, shape (2,) [m].
        com_covariance: of that, shape (2, 2) [m²].
        base: face on which it stands.
        top: face on which others stand.
        below: place in the stack of what it stands on, before its own; None on the table.
    """

    mass: float
    mass_sd: float
    com: Array
    com_covariance: Array
    base: Polygon
    top: Polygon
    below: int | None = None


def stack_margins(bodies: Sequence[StackedBody]) -> Array:
    """Margins of bodies on what each stands on, shape (n,) [m].

    Less than 0 where it tips: what is above the place has its centre of mass beyond an edge.
    """
    return np.array([edges.min() for edges, _ in _edge_margins(bodies)])


def standing_probability(bodies: Sequence[StackedBody]) -> float:
    """Least probability that a stack stands."""
    falls = sum(float(normal_cdf(-edges / sds).sum()) for edges, sds in _edge_margins(bodies))
    return max(0.0, 1.0 - falls)


def _edge_margins(bodies: Sequence[StackedBody]) -> list[tuple[Array, Array]]:
    """Margin at each edge of the places on which bodies stand, and its standard deviation [m]."""
    found = []
    for k, body in enumerate(bodies):
        above = [bodies[i] for i in _above(bodies, k)]
        m, sd = (np.array([getattr(each, name) for each in above]) for name in ("mass", "mass_sd"))
        share, coms = m / m.sum(), np.array([each.com for each in above])
        c = share @ coms
        faces = [body.base] if body.below is None else [body.base, bodies[body.below].top]
        n = np.vstack([face.normals for face in faces])
        d = np.concatenate([face.offsets for face in faces])
        by_place = np.array([np.sum(n @ each.com_covariance * n, axis=1) for each in above])
        by_mass = (n @ (coms - c).T) * (sd / m.sum())
        sds = np.sqrt(share**2 @ by_place + np.sum(by_mass**2, axis=1))
        found.append((d - n @ c, np.maximum(sds, _SURE)))
    return found


def _above(bodies: Sequence[StackedBody], lowest: int) -> list[int]:
    """Places of a body and of all that it carries."""
    found = [lowest]
    for i in range(lowest + 1, len(bodies)):
        if bodies[i].below in found:
            found.append(i)
    return found

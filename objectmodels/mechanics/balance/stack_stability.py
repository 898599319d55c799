"""Stability of a stack: rigid objects on one another, each on one or on the table.

Model: the faces that meet are level and nothing slides. What stands above such a place presses on
it where its common centre of mass c is, so that it stands while c lies within both faces, every
edge k of which is n_k·q = d_k:

    margin = min_k (d_k − n_k·c) > 0,    c = Σ m_i c_i / M,    M = Σ m_i over what is above.

A stack stands if it does so at every place from its top down to the table. To first order in what
is uncertain of the centres and masses

    σ_k² = Σ (m_i / M)² n_kᵀ Σ_i n_k + Σ (σ_i n_k·(c_i − c) / M)²,

and it stands with a probability of 1 − Σ_k Φ((n_k·c − d_k) / σ_k) at least.

Frame: everything seen from above, in W's x and y.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from objectmodels.geometry.base_shapes import Array, Polygon
from objectmodels.mechanics.outcome_probability import normal_cdf

_SURE = 1e-9  # least standard deviation of a margin [m]


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

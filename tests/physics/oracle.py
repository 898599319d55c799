"""An oracle for the exact tier that shares no code with the models.

*Loads*: the elastic energy of the springs is minimised by Newton's method with a line search; they
count if they are what such springs carry and balance the push to rounding.

*Friction limit*: a barrier method on the friction forces. These are balanced and inside their
limits at every step, so the push they hold is a lower bound; the multipliers of balance are a
motion, whose dissipation is an upper one. A push holds if a lower bound says so and slides if an
upper one does: where the oracle fails to converge it decides nothing, and the test fails.

*Toppling*: moments in space about the edges of the base.

Arrays have the support points, if any, before the pushes: (k, n); vectors (2, n) or (3, n).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tests.physics.bodies import Array, Cases, Flags

# The oracle stops at a relative gap of its bounds of this, where it need not decide a push.
GAP = 1e-10
# Loads balance to this share of N, and of N times the support's size: rounding, with a margin.
BALANCED = 1e-12


def force_of(c: Cases, ratio: Array) -> Array:
    """Force s at which s/N is so large, N = G − s u_z."""
    return np.asarray(ratio * c.weight / (1.0 + ratio * c.u[2]))


def normal_load(c: Cases, s: Array) -> Array:
    return np.asarray(c.weight - s * c.u[2])


def pressure_centre(c: Cases, s: Array) -> Array:
    moment = c.weight * c.com[:2] + s * (c.p[2] * c.u[:2] - c.u[2] * c.p[:2])
    return np.asarray(moment / normal_load(c, s))


def acting(c: Cases, s: Array) -> Array:
    """Where friction acts, (2, k, n)."""
    q = pressure_centre(c, s)[:, None]
    return np.asarray(q + c.spread * (c.points - q))


def edge_force(c: Cases) -> Array:
    """Force at which the moment about an edge of the support first tips the body over it."""
    axis = np.stack((-c.normals[1], c.normals[0], np.zeros_like(c.normals[0])))
    foot = np.stack((*c.ends, np.zeros_like(c.ends[0])))
    down = np.zeros_like(c.com)
    down[2] = -c.weight
    holds = -(axis * np.cross((c.com[:, None] - foot), down[:, None], axis=0)).sum(axis=0)
    tips = (axis * np.cross((c.p[:, None] - foot), c.u[:, None], axis=0)).sum(axis=0)
    return np.asarray(np.where(tips > 0.0, holds / np.where(tips > 0.0, tips, 1.0), np.inf).min(0))


def overhang(c: Cases, s: Array, share: float = 1.0) -> Array:
    """How far load times place lies outside of a round base under that share of the weight."""
    moment = share * c.weight * c.com[:2] + s * (c.p[2] * c.u[:2] - c.u[2] * c.p[:2])
    return np.asarray(np.hypot(*moment) - c.rim * (share * c.weight - s * c.u[2]))


def spring_loads(c: Cases, q: Array) -> Array:
    """Loads as shares of N, nan where they are not exact, (k, n).

    The pressure a + b·(r − q) of least energy ½ Σ w max(0, ·)² − a; a change of the set of loaded
    points is a kink of its slope, so that a line search is needed.
    """
    place = (c.points - q[:, None]) / c.size()
    terms = np.stack((np.ones_like(c.weights), *place))
    z = np.zeros((3, q.shape[1]))
    z[0] = 1.0
    todo = np.arange(q.shape[1])
    for _ in range(60):
        if not todo.size:
            break
        new, off = _downhill(z[:, todo], terms[..., todo], c.weights[:, todo])
        z[:, todo] = new
        todo = todo[off > 0.01 * BALANCED]
    loads = c.weights * np.maximum((z[:, None] * terms).sum(axis=0), 0.0)
    sums = (loads * terms).sum(axis=1)
    off = np.abs(sums - np.array([[1.0], [0.0], [0.0]])).max(axis=0)
    return np.where(off <= BALANCED, loads, np.nan)


def _downhill(z: Array, terms: Array, weights: Array) -> tuple[Array, Array]:
    """A step towards the least energy, and by how much the start was off balance."""

    def energy(z: Array) -> Array:
        pressed = np.maximum((z[:, None] * terms).sum(axis=0), 0.0)
        return np.asarray(0.5 * (weights * pressed**2).sum(axis=0) - z[0])

    gap = (z[:, None] * terms).sum(axis=0)
    slope = (weights * np.maximum(gap, 0.0) * terms).sum(axis=1)
    slope[0] -= 1.0
    stiff = np.where(gap > 0.0, weights, 0.0)
    bend = np.einsum("kn,ikn,jkn->nij", stiff, terms, terms, optimize=True)
    # Where too few points are loaded there is no unique step; this picks one.
    bend += 1e-14 * np.trace(bend, axis1=1, axis2=2)[:, None, None] * np.eye(3)
    step = -np.linalg.solve(bend, slope.T[..., None])[..., 0].T
    settled = ((((z + step)[:, None] * terms).sum(axis=0) > 0.0) == (gap > 0.0)).all(axis=0)
    start, expected, share = energy(z), (slope * step).sum(axis=0), np.ones(z.shape[1])
    for _ in range(40):
        worse = ~settled & (energy(z + share * step) > start + 1e-4 * share * expected)
        if not worse.any():
            break
        share[worse] *= 0.5
    return z + share * step, np.abs(slope).max(axis=0)


@dataclass
class Barrier:
    """Friction forces N d that balance across a push and about its line, for n pushes.

    Axes along the push and to its left, from its contact; lengths in sizes of the support.
    Maximised: t Σ N d_x + Σ log(1 − |d|²); the multipliers of balance are a motion
    (1 − ω η, β + ω ξ) of the points.
    """

    loads: Array
    xi: Array
    eta: Array
    d: Array  # (2, k, n)
    t: Array

    def only(self, i: Flags) -> Barrier:
        return Barrier(*(value[..., i] for value in vars(self).values()))

    def step(self) -> tuple[Array, Array]:
        """A Newton step; then a push that is held, and one that slides."""
        (x, y), slack = self.d, 1.0 - (self.d**2).sum(axis=0)
        f = 2.0 / (2.0 - slack)
        m = 0.5 * self.t * self.loads**2 * slack
        m_x, m_xy, m_y = m * (1.0 - f * x * x), -m * f * x * y, m * (1.0 - f * y * y)
        row_x, row_y = self._about(m_x, m_xy), self._about(m_xy, m_y)
        kept = self.loads * (1.0 - slack) * f
        beta, omega = _two(
            m_y.sum(0), row_y.sum(0), self._about(row_x, row_y).sum(0),
            -(m_xy + kept * y).sum(0), -(row_x + self._about(kept * x, kept * y)).sum(0),
        )  # fmt: skip
        v = np.stack((1.0 - omega * self.eta, beta + omega * self.xi))
        pull = 0.5 * self.t * self.loads * slack
        step = pull * (v - f * self.d * (self.d * v).sum(axis=0)) - 0.5 * f * slack * self.d
        reach = _reach(self.d, step, slack)
        # Nearer to the limits a step no longer finds back to the middle between them.
        part = np.minimum(0.9 * reach, 1.0)
        self.d = self.d + part * step
        held = self._balanced()
        slides = (self.loads * np.hypot(*v)).sum(axis=0)
        narrow = 10.0 * len(self.loads) / np.maximum(slides - held, 1e-14)
        self.t = np.where(part == 1.0, np.maximum(self.t, narrow), self.t)
        return held, slides

    def _about(self, x: Array, y: Array) -> Array:
        """Moments about the contact of vectors at the points."""
        return self.xi * y - self.eta * x

    def _balanced(self) -> Array:
        """Push held by the forces once rounding is off their balance and they are in limits."""
        room = self.loads * np.maximum(1.0 - (self.d**2).sum(axis=0), 0.0) ** 2
        give = room * self.loads
        force = self.loads * self.d
        y, turn = _two(
            give.sum(0), (give * self.xi).sum(0), (give * (self.xi**2 + self.eta**2)).sum(0),
            -force[1].sum(0), -self._about(*force).sum(0),
        )  # fmt: skip
        d = self.d + room * np.stack((-turn * self.eta, y + turn * self.xi))
        most = np.maximum(np.hypot(*d).max(axis=0), 1.0)
        force = self.loads * d / most
        off = np.maximum(np.abs(force[1].sum(0)), np.abs(self._about(*force).sum(0)))
        # At its very limit a force would leave the barrier no room.
        self.d = np.where((off <= BALANCED) & (most == 1.0), d, self.d)
        return np.where(off <= BALANCED, force[0].sum(axis=0), 0.0)


def _two(a: Array, b: Array, d: Array, e: Array, f: Array) -> tuple[Array, Array]:
    """Solves a x + b y = e and b x + d y = f."""
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = 1.0 / (a * d - b * b)
        return (e * d - f * b) * scale, (a * f - b * e) * scale


def _reach(d: Array, step: Array, slack: Array) -> Array:
    """Largest share of a step at which all |d| ≤ 1."""
    ahead = (d * step).sum(axis=0)
    far = ahead + np.sqrt(ahead**2 + (step**2).sum(axis=0) * slack)
    return np.asarray((slack / np.maximum(far, 1e-300)).min(axis=0))


def friction_limit(c: Cases, s: Array, loads: Array) -> tuple[Flags, Flags]:
    """Which pushes friction at points of given loads surely holds, and which surely slide."""
    level, along = c.ahead()
    demand = s * level / (c.mu * normal_load(c, s))
    place = (acting(c, s) - c.p[:2, None]) / c.size()
    a, b = along[:, None]
    xi, eta = a * place[0] + b * place[1], a * place[1] - b * place[0]
    n = len(c.mu)
    barrier = Barrier(loads, xi, eta, np.zeros((2, *xi.shape)), np.full(n, float(len(xi))))
    lower, upper, todo = np.zeros(n), np.full(n, np.inf), np.arange(n)
    for _ in range(100):
        held, slides = barrier.step()
        low = np.fmax(lower[todo], held)
        up = np.fmin(upper[todo], slides)
        lower[todo], upper[todo] = low, up
        open_ = (low < demand[todo]) & (up >= demand[todo]) & ~(up - low <= GAP * up)
        barrier, todo = barrier.only(open_), todo[open_]
        if not todo.size:
            break
    return lower >= demand, upper < demand


def verdict(c: Cases, s: Array) -> tuple[Flags, Flags]:
    """Which pushes are surely held and which surely slide, on springs that carry them."""
    return friction_limit(c, s, spring_loads(c, pressure_centre(c, s)))

"""Outcomes of pushes over whole arrays: of slow ones, and of forces applied suddenly.

Slow pushes have no inertia: an object slides or topples at its thresholds.

A sudden force moves nothing below the onset of the closed form. Beyond it, the accelerations of a
rigid body from rest are seen in an upright plane through the centre of mass: along the force, or
across the edge that the object would topple over. Its base touches the table at a front and a back
edge, with Coulomb friction. Each way of moving is tried, and the one whose contact forces are
possible counts. In that plane x goes along the horizontal part of the force, z up, the origin is
the centre of mass, and angles tip the top forwards.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array, Base
from objectmodels.geometry.rotations import left_of
from objectmodels.html_table import html_table
from objectmodels.mechanics.push_thresholds import (
    Figures,
    blocks,
    centre_of_pressure,
    push_axes,
    slide_and_topple_forces,
    sliding_twist,
    toppling_twist,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from objectmodels.geometry.pushed_body import Friction, PushedBody

    Index = NDArray[np.int64]


UNDECIDED = 1e-9
"""Relative band in which two thresholds count as equal: the outcome is then `slide+topple`."""

OUTCOMES = np.array(["none", "slide", "topple", "slide+topple"])
"""Classes by code."""


@dataclass(frozen=True)
class Thresholds:
    """Forces at which slow pushes start to move an object; arrays over n pushes.

    Attributes:
        slide: force at which it slides, shape (n,) [N]; inf if the push jams.
        topple: force at which it topples, shape (n,) [N]; inf if it never does.
        friction: which coefficient at the table decided, `static` or `kinetic`.
        push: contact points and directions, each (n, 3).
        body: base, centre of mass, friction radius and weight that decided.
    """

    slide: Array
    topple: Array
    friction: Friction
    push: tuple[Array, Array] = field(repr=False)
    body: tuple[Base, Array, float, float] = field(repr=False)

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {_told_of(self.outcome)}, onset {_range_of(self.onset)} N>"

    def _repr_html_(self) -> str:
        header = ("contact [mm]", "direction", "slides at [N]", "topples at [N]", "first")
        forces = (_number_texts(self.slide), _number_texts(self.topple))
        rows = zip(*_push_texts(self.push), *forces, self.outcome.tolist(), strict=True)
        return html_table(f"Thresholds: {_told_of(self.outcome)}", header, rows)

    @cached_property
    def onset(self) -> Array:
        """The smaller of the two [N]."""
        return np.minimum(self.slide, self.topple)

    @cached_property
    def code(self) -> NDArray[np.uint8]:
        """Class at the onset as an index into `OUTCOMES`, shape (n,)."""
        if len(self.slide) == 1:
            return np.array([_single_code(self.slide.item(), self.topple.item())], dtype=np.uint8)
        code = np.empty(len(self.slide), dtype=np.uint8)
        for b in blocks(len(code)):
            code[b] = _codes(self.slide[b], self.topple[b])
        return code

    @property
    def outcome(self) -> NDArray[np.str_]:
        """Class at the onset: `slide`, `topple`, `slide+topple` or `none`, shape (n,).

        `slide+topple` is undecided: the two lie within the band `UNDECIDED`. `none`: neither ever
        happens.
        """
        return np.asarray(OUTCOMES[self.code])

    @cached_property
    def _tipping_edges(self) -> tuple[Array, NDArray[np.int64]]:
        """Outward normals of the edges it would topple about, and their indices."""
        (p, u), (base, c, _, weight) = self.push, self.body
        s = np.where(np.isfinite(self.topple), self.topple, 0.0)
        never = ~np.isfinite(self.topple)
        with np.errstate(divide="ignore", invalid="ignore"):
            q = centre_of_pressure(p, s[:, None] * u, c, weight)
        # Where the load has gone the place means nothing, but its edge is still the nearest.
        normals, edge = base.nearest_edge(np.nan_to_num(q, posinf=1e9, neginf=-1e9))
        return np.where(never[:, None], np.nan, normals), np.where(never, -1, edge)

    @property
    def edge(self) -> NDArray[np.int64]:
        """Base edge about which it would topple first, −1 if never or on a round base, (n,)."""
        return self._tipping_edges[1]

    @property
    def tipping_normal(self) -> Array:
        """Outward normal in B of the edge about which it would topple, nan if never, (n, 2)."""
        return self._tipping_edges[0]

    @cached_property
    def twist(self) -> Array:
        """Incipient twist V_WB in B at the onset, shape (n, 6).

        Angular velocity [rad/s] and velocity of B's origin [m/s], for a contact that moves at 1 m/s
        along its direction; nan where the outcome is not decided.
        """
        (p, u), (base, _, _, _) = self.push, self.body
        twist = np.full((len(p), 6), np.nan)
        i = self.code == 1
        twist[i] = self._sliding_twists(i)
        i = self.code == 2
        n = self.tipping_normal[i]
        twist[i] = toppling_twist(p[i], u[i], n, base.extent(n))
        return twist

    @cached_property
    def centre_of_rotation(self) -> Array:
        """Point of the table about which a sliding object begins to turn in B, shape (n, 2) [m].

        Infinitely far if it does not turn; nan where it does not slide first.
        """
        omega, v = self.twist[:, 2], self.twist[:, 3:5]
        with np.errstate(divide="ignore", invalid="ignore"):
            centre = left_of(v) / omega[:, None]
        still = np.abs(omega) * self.body[0].size < 1e-12 * np.hypot(*v.T)
        centre = np.where(still[:, None], np.inf, centre)
        return np.where((self.code == 1)[:, None], centre, np.nan)

    def _sliding_twists(self, i: NDArray[np.bool_]) -> Array:
        (p, u), (_, c, radius, weight) = self.push, self.body
        return sliding_twist(p[i], u[i], c, self.slide[i], radius, weight)


@dataclass(frozen=True)
class Prediction:
    """Outcomes of pushes with given forces, applied slowly; arrays over n pushes.

    Attributes:
        force: sizes of the forces, shape (n,) [N].
        thresholds: what the classes are decided by.
    """

    force: Array
    thresholds: Thresholds

    def __repr__(self) -> str:
        return f"<Prediction: {_told_of(self.outcome)}, force {_range_of(self.force)} N>"

    def _repr_html_(self) -> str:
        header = ("contact [mm]", "direction", "force [N]", "outcome", "margin [N]")
        told = (_number_texts(self.force), self.outcome.tolist(), _number_texts(self.margin))
        rows = zip(*_push_texts(self.thresholds.push), *told, strict=True)
        return html_table(f"Prediction: {_told_of(self.outcome)}", header, rows)

    @cached_property
    def moves(self) -> NDArray[np.bool_]:
        """Return True where the force reaches the onset."""
        t = self.thresholds
        return (self.force >= t.slide) | (self.force >= t.topple)

    @cached_property
    def code(self) -> NDArray[np.uint8]:
        """Outcome as an index into `OUTCOMES`."""
        t = self.thresholds
        if len(self.force) == 1:
            rests = self.force.item() < min(t.slide.item(), t.topple.item())
            return np.zeros(1, dtype=np.uint8) if rests else t.code
        return np.asarray(t.code * self.moves)

    @property
    def outcome(self) -> NDArray[np.str_]:
        """`none` (the force is below the onset) or the class at the onset."""
        return np.asarray(OUTCOMES[self.code])

    @cached_property
    def margin(self) -> Array:
        """Change of the force or of a threshold at which another class begins, shape (n,) [N].

        |force − onset|, and for a moving object also |slide − topple|, whichever is less.
        """
        t = self.thresholds
        with np.errstate(invalid="ignore"):
            apart = np.where(np.isinf(t.onset), np.inf, np.abs(t.slide - t.topple))
        margin = np.abs(self.force - t.onset)
        return np.where(self.moves, np.minimum(margin, apart), margin)


def _told_of(outcome: NDArray[np.str_]) -> str:
    """Outcomes of one push or of many, in a few words."""
    if len(outcome) == 1:
        return str(outcome[0])
    names, counts = np.unique(outcome, return_counts=True)
    told = ", ".join(f"{n} {name}" for name, n in zip(names, counts, strict=True))
    return f"{len(outcome)} pushes ({told})"


def _push_texts(push: tuple[Array, Array]) -> tuple[Iterator[str], Iterator[str]]:
    """Contact points [mm] and directions of pushes, for people."""
    points, directions = push
    return (
        (", ".join(f"{x:z.0f}" for x in point) for point in 1e3 * points),
        (", ".join(f"{x:z.2f}" for x in direction) for direction in directions),
    )


def _number_texts(values: Array) -> Iterator[str]:
    return (f"{value:.3g}" for value in values)


def _range_of(values: Array) -> str:
    """Least and largest of some values."""
    if not values.size:
        return "–"
    low, high = (f"{value:.3g}" for value in (values.min(), values.max()))
    return low if low == high else f"{low} to {high}"


def _single_code(slide: float, topple: float) -> int:
    """Class at the onset of one push."""
    onset = min(slide, topple)
    if onset == np.inf:
        return 0
    undecided = abs(slide - topple) <= UNDECIDED * onset
    return 3 if undecided else 1 if slide < topple else 2


def _codes(slide: Array, topple: Array) -> NDArray[np.uint8]:
    """Classes at the onset of pushes, (n,)."""
    onset = np.minimum(slide, topple)
    with np.errstate(invalid="ignore"):
        undecided = np.abs(slide - topple) <= UNDECIDED * onset
    code = 2 - (slide < topple).astype(np.uint8)
    code[undecided] = 3
    code[np.isinf(onset)] = 0
    return code


def closed_form_thresholds(
    model: PushedBody, p: Array, u: Array, friction: Friction = "static"
) -> Thresholds:
    """Thresholds of the closed form; see `ObjectModel.thresholds`, which checks its arguments.

    A zero direction never moves anything.
    """
    # One component after the other: numpy is much faster on arrays that lie in a row.
    p, u = np.asfortranarray(p), np.asfortranarray(u)
    mu, radius = model.friction_coefficient(friction), model.friction_radius
    body = Figures(model.base, np.array(model.com), mu, radius, model.weight)
    slide, topple = slide_and_topple_forces(body, p, u)
    return Thresholds(slide, topple, friction, (p, u), (body.base, body.com, radius, body.weight))


def size_and_direction(f: Array) -> tuple[Array, Array]:
    """Sizes (n,) and unit directions (n, 3) of forces; a zero force has the direction zero."""
    size, u = np.empty(len(f)), np.empty(f.shape, order="F")
    for b in blocks(len(f)):
        x, y, z = f[b].T
        with np.errstate(over="ignore"):
            size[b] = np.sqrt(x * x + y * y + z * z)
        shorter = 1.0 / np.maximum(size[b], np.finfo(float).tiny)
        u[b, 0], u[b, 1], u[b, 2] = x * shorter, y * shorter, z * shorter
    if np.isinf(size).any():
        raise ModelError(
            "bad_array", "a force is too large to have a size", suggestions=("give it in newtons",)
        )
    return size, u


def force_gap(first: Array, other: Array) -> Array:
    """Force by which `other` comes later than `first` [N]; −inf where `first` never comes."""
    with np.errstate(invalid="ignore"):
        return np.where(np.isinf(first), -np.inf, other - first)


@dataclass(frozen=True)
class SuddenPush:
    """Classes and accelerations of suddenly applied forces; arrays over n pushes.

    Attributes:
        outcome: `none`, `slide`, `topple`, `slide+topple` or `lift`.
        acceleration: of the centre of mass along the horizontal part of the force, (n,) [m/s²].
        angular: of the tilt, forwards positive, shape (n,) [rad/s²].
    """

    outcome: NDArray[np.str_]
    acceleration: Array
    angular: Array


def sudden_push(model: PushedBody, p: Array, f: Array) -> SuddenPush:
    """See `ObjectModel.sudden`, which checks its arguments."""
    force, u = size_and_direction(f)
    t = closed_form_thresholds(model, p, u)
    c, m, mu = np.array(model.com), model.mass, model.friction
    _, level, _ = push_axes(f)
    # Across the edge that it would topple over first, if it topples first; else along the force.
    tips = (t.code == 2)[:, None]
    along = np.where(tips, t.tipping_normal, level)
    across = left_of(along)
    fx, fz = np.sum(f[:, :2] * along, axis=1), f[:, 2]
    r = p - c
    x, z = np.sum(r[:, :2] * along, axis=1), r[:, 2]
    ahead = model.base.extent(along) - along @ c[:2]
    behind = model.base.extent(-along) + along @ c[:2]
    k_x, k_y, _ = model.gyration
    # About the axis across.
    inertia = m * (k_x * across[:, 0] ** 2 + k_y * across[:, 1] ** 2)
    load, torque, c_z, zero = model.weight - fz, z * fx - x * fz, c[2], np.zeros_like(fx)

    slides = _both_edges(torque + c_z * mu * load, load, ahead, behind) & (fx > mu * load)
    # What moves by turning about the vertical too, or slides aside, seems to rest in the plane.
    rests = _both_edges(torque + c_z * fx, load, ahead, behind) & (np.abs(fx) <= mu * load)
    ways = [
        (force < t.onset, "none", zero, zero),
        (rests, "", zero, zero),
        *_tipping_ways(fx, load, torque, inertia, m, mu, c_z, ahead),
        (slides, "slide", (fx - mu * load) / m, zero),
        *_tipping_ways(-fx, load, -torque, inertia, m, mu, c_z, behind, sign=-1.0),
        (np.ones(len(fx), dtype=bool), "lift", fx / m, torque / inertia),
    ]
    which = np.argmax([way[0] for way in ways], axis=0)
    row = np.arange(len(fx))
    outcome = np.array([way[1] for way in ways], dtype=OUTCOMES.dtype)[which]
    return SuddenPush(
        outcome=np.where(which == 1, t.outcome, outcome),
        acceleration=np.array([way[2] for way in ways])[which, row],
        angular=np.array([way[3] for way in ways])[which, row],
    )


def _both_edges(moment: Array, load: Array, ahead: Array, behind: Array) -> NDArray[np.bool_]:
    """Return True where both edges press for a moment that the normal forces must balance."""
    front = (moment + behind * load) / (ahead + behind)
    return np.asarray((front >= 0.0) & (front <= load))


Way = tuple[NDArray[np.bool_], str, Array, Array]


def _tipping_ways(
    fx: Array,
    load: Array,
    torque: Array,
    inertia: Array,
    m: float,
    mu: float,
    c_z: float,
    b: Array,
    sign: float = 1.0,
) -> list[Way]:
    """Tipping about the edge ahead, which stays or slides either way.

    About an edge that stays I α = torque + c_z f_x − b load − m α (b² + c_z²).
    """
    ways: list[Way] = []
    stays = (torque + c_z * fx - b * load) / (inertia + m * (b * b + c_z * c_z))
    normal, friction = load + m * stays * b, m * stays * c_z - fx
    possible = (stays > 0.0) & (normal >= 0.0) & (np.abs(friction) <= mu * normal)
    ways.append((possible, "topple", sign * stays * c_z, sign * stays))
    for slip in (1.0, -1.0):  # the edge slides ahead, or back
        alpha = (torque + (slip * mu * c_z - b) * load) / (inertia + m * b * (b - slip * mu * c_z))
        normal = load + m * alpha * b
        ahead = (fx - slip * mu * normal) / m
        possible = (alpha > 0.0) & (normal >= 0.0) & (slip * (ahead - alpha * c_z) > 0.0)
        ways.append((possible, "slide+topple", sign * ahead, sign * alpha))
    return ways


# Search for the direction in a fingertip's friction cone in which a margin is least.
#
# Directions are *shares* of the cone, in the unit disc; see
# `objectmodels.mechanics.friction_cone`.

STEPS = (0.1, 0.05, 0.025, 0.0125)
"""Steps of the search, in shares."""


def circle_corners(k: int) -> Array:
    """The corners of a regular k-gon in the unit circle, shape (k, 2)."""
    phi = 2.0 * np.pi * np.arange(k) / k
    return np.column_stack((np.cos(phi), np.sin(phi)))


def refine_directions(
    value: Callable[[Array], Array], shares: Array, best: Array, limit: float
) -> Array:
    """Smallest value near given directions, by a compass search with shrinking steps, (n,).

    `value` maps shares (n, j, 2) to what is to be small (n, j); the search begins at shares (n, 2),
    where it is `best`, (n,), and which stay in the disc of radius `limit`.
    """
    compass, rows = circle_corners(8), np.arange(len(shares))
    for step in STEPS:
        tries = shares[:, None, :] + step * compass
        length = np.hypot(tries[..., :1], tries[..., 1:])
        tries = tries * np.minimum(1.0, limit / np.maximum(length, 1e-12))
        values = value(tries)
        j = values.argmin(axis=1)
        better = values[rows, j] < best
        shares = np.where(better[:, None], tries[rows, j], shares)
        best = np.where(better, values[rows, j], best)
    return best


@dataclass(frozen=True)
class MarginSearch:
    """Search for the least margin of each contact over the cone.

    It starts from the worst direction of each quadrant of the cone that comes near the worst of
    all, since there may be several minima.

    Attributes:
        least: over fixed directions, shape (n,) [N].
        starts: shares to search from, a quadrant each, shape (4, n, 2).
        at_starts: margins there, shape (4, n) [N].
        near: which of them come near enough, shape (4, n).
        margin: maps contacts (m,) and shares (m, j, 2) to margins (m, j) [N].
        radius: of the disc that shares must stay in.
    """

    least: Array
    starts: Array
    at_starts: Array
    near: NDArray[np.bool_]
    margin: Callable[[Index, Array], Array]
    radius: float

    @classmethod
    def begin(
        cls,
        margins: Array,
        shares: Array,
        margin: Callable[[Index, Array], Array],
        near: float,
        radius: float,
    ) -> MarginSearch:
        """The search after the margins (n, j) of fixed directions, shares (n, j, 2).

        Args:
            margins: in those directions [N].
            shares: the directions.
            margin: that of any directions, as of the class.
            near: by how much a start may exceed the least margin [N].
            radius: of the disc that shares must stay in.
        """
        least, rows = margins.min(axis=1), np.arange(len(margins))
        quadrant = 2 * (shares[..., 0] > 0.0) + (shares[..., 1] > 0.0)
        inside = np.where(quadrant == np.arange(4)[:, None, None], margins, np.inf)
        j = inside.argmin(axis=2)
        at_starts = inside[np.arange(4)[:, None], rows, j]
        return cls(least, shares[rows, j], at_starts, at_starts <= least + near, margin, radius)

    def least_margin(self) -> Array:
        """Least margin of each contact, refined where it is positive, shape (n,) [N]."""
        least = self.least.copy()
        q, i = np.nonzero(self.near & (least > 0.0))
        found = np.full(self.near.shape, np.inf)
        found[q, i] = refine_directions(
            partial(self.margin, i), self.starts[q, i], self.at_starts[q, i], self.radius
        )
        for each in found:
            least = np.where(least > 0.0, np.minimum(least, each), least)
        return least

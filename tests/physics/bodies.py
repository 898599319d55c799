"""Random bodies and pushes for the exact tier's oracle, in plain numbers.

Arrays have the support points, if any, before the pushes: (k, n); vectors (2, n) or (3, n).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from objectmodels import BoxModel, CylinderModel, HullModel, ObjectModel, PrismModel

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

GRAVITY = 9.81
PUSHES = 10  # of each body
SEED = 9  # among the first 200 pushes on points friction grows again before one topples
KINDS = ("box", "prism", "cylinder", "hull", "points", "fitted")
MODELS: dict[str, type[ObjectModel]] = {
    "box": BoxModel,
    "prism": PrismModel,
    "cylinder": CylinderModel,
    "hull": HullModel,
    "points": BoxModel,
    "fitted": BoxModel,  # a box whose friction radius is not that of its corners
}


@dataclass
class Cases:
    """Pushes of bodies, in plain numbers; a support point that is not there weighs nothing."""

    points: Array  # (2, k, n)
    weights: Array  # (k, n)
    normals: Array  # outward, of the edges of the points' hull, (2, e, n)
    ends: Array  # a point of each edge, (2, e, n)
    rim: Array  # radius of a round base, else nan
    spread: Array  # friction acts so many times as far from the centre of pressure
    com: Array
    weight: Array
    mu: Array
    p: Array
    u: Array

    def only(self, i: NDArray[np.intp] | Flags) -> Cases:
        return Cases(**{name: value[..., i] for name, value in vars(self).items()})

    def ahead(self) -> tuple[Array, Array]:
        """Level part of the directions, and level unit vectors along them."""
        level = np.hypot(self.u[0], self.u[1])
        return level, self.u[:2] / level

    def size(self) -> Array:
        return np.asarray(np.hypot(*np.ptp(self.points, axis=1)))


@dataclass
class Answers:
    """What a model says of them."""

    slide: Array
    topple: Array
    onset: Array
    outcome: NDArray[np.str_]
    residual: Array
    twist: Array  # (6, n)


@dataclass
class Body:
    points: Array  # (k, 2)
    weights: Array
    low: Array  # outline on the table, (j, 2)
    high: Array  # and at the top
    height: float
    rim: float
    spread: float
    com: Array
    mass: float
    mu: float

    def model(self, kind: str) -> ObjectModel:
        fields: dict[str, Any] = {
            "name": "body",
            "com": self.com.tolist(),
            "mass": self.mass,
            "friction": self.mu,
            "support": "corners",
        }
        if self.spread != 1.0:
            fields["friction_radius"] = self.spread * np.hypot(*self.low[0])
        if kind in ("box", "points", "fitted"):
            fields["size"] = (*np.ptp(self.low, axis=0).tolist(), self.height)
        else:
            fields["height"] = self.height
        if kind == "points":
            fields["support"] = np.column_stack((self.points, self.weights)).tolist()
        elif kind == "cylinder":
            fields["radius"] = self.rim
        elif kind == "prism":
            fields["corners"] = self.low.tolist()
        elif kind == "hull":
            del fields["height"]
            levels = zip((0.0, self.height), (self.low, self.high), strict=True)
            fields["vertices"] = [[*v, z] for z, outline in levels for v in outline.tolist()]
        return MODELS[kind].model_validate(fields)


def random_polygon(rng: np.random.Generator) -> Array:
    """Corners of a convex polygon around the origin, counter-clockwise, 3 to 8 of them."""
    while True:
        angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, rng.integers(3, 9)))
        gap = np.diff(angle, append=angle[0] + 2.0 * np.pi)
        if gap.min() > 0.15 and gap.max() < 2.8:
            radii = rng.uniform(0.03, 0.12, 2)
            slant = np.array([[1.0, 0.0], [rng.uniform(-0.5, 0.5), 1.0]])
            circle = np.column_stack((np.cos(angle), np.sin(angle)))
            return np.asarray(circle * radii @ slant)


def random_body(kind: str, rng: np.random.Generator) -> Body:
    height, rim = rng.uniform(0.05, 0.3), np.nan
    half = 0.5 * rng.uniform(0.04, 0.2, 2)
    low = half * np.array([[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]])
    if kind == "cylinder":
        phi, rim = np.radians(15.0) * np.arange(24), half[0]
        low = rim * np.column_stack((np.cos(phi), np.sin(phi)))
    elif kind in ("prism", "hull"):
        low = random_polygon(rng)
    points, weights = low, np.ones(len(low))
    if kind == "points":
        points = half * rng.uniform(-1.0, 1.0, (rng.integers(4, 9), 2))
        weights = np.exp(rng.normal(0.0, 0.7, len(points)))
    high = low
    if kind == "hull":
        high = low * rng.uniform(0.5, 2.0) + rng.uniform(-0.01, 0.01, 2)
    share = rng.dirichlet(np.full(len(points), 0.7))
    over = 0.9 * share @ points + 0.1 * points.mean(axis=0)
    return Body(
        points=points,
        weights=weights / weights.sum(),
        low=low,
        high=high,
        height=height,
        rim=rim,
        spread=rng.uniform(0.5, 1.6) if kind == "fitted" else 1.0,
        com=np.append(over, height * rng.uniform(0.15, 0.7)),
        mass=rng.uniform(0.1, 3.0),
        mu=rng.uniform(0.1, 0.9),
    )


def random_pushes(body: Body, rng: np.random.Generator, n: int) -> tuple[Array, Array]:
    """Points on the sides of a body, and directions of any kind, some of them nearly level."""
    rise = rng.uniform(size=n)
    if np.isfinite(body.rim):
        phi = rng.uniform(0.0, 2.0 * np.pi, n)
        place = body.rim * np.stack((np.cos(phi), np.sin(phi)))
    else:
        side, along = rng.integers(len(body.low), size=n), rng.uniform(size=n)
        outline = rise[:, None, None] * body.high + (1.0 - rise[:, None, None]) * body.low
        one, other = outline[np.arange(n), side], outline[np.arange(n), side - 1]
        place = along * one.T + (1.0 - along) * other.T
    u = rng.normal(size=(3, n))
    u[2] *= rng.choice([0.1, 0.7, 1.0], n)
    return np.vstack((place, rise * body.height)), u / np.linalg.norm(u, axis=0)


def edges(points: Array) -> tuple[Array, Array]:
    """Outward normals of the edges of the hull of points (k, 2), and a point of each, (2, e)."""
    across = points[None] - points[:, None]
    turn = (
        across[:, :, None, 0] * across[:, None, :, 1]
        - across[:, :, None, 1] * across[:, None, :, 0]
    )
    first, second = np.nonzero((turn > -1e-15).all(axis=2) & ~np.eye(len(points), dtype=bool))
    along = across[first, second].T
    return np.stack((along[1], -along[0])) / np.hypot(*along), points[first].T


def padded(arrays: list[Array], *, zero: bool) -> Array:
    """Arrays that differ in their last axis, one behind the other in a new one after it."""
    most = max(a.shape[-1] for a in arrays)
    widths = [[(0, 0)] * (a.ndim - 1) + [(0, most - a.shape[-1])] for a in arrays]
    if zero:
        return np.stack([np.pad(a, w) for a, w in zip(arrays, widths, strict=True)], axis=-1)
    return np.stack([np.pad(a, w, "edge") for a, w in zip(arrays, widths, strict=True)], axis=-1)


def gathered(bodies: list[Body], pushes: list[tuple[Array, Array]]) -> Cases:
    hulls = [edges(b.points) for b in bodies]
    n = pushes[0][0].shape[1]
    of_bodies = {
        "points": padded([b.points.T for b in bodies], zero=False),
        "weights": padded([b.weights for b in bodies], zero=True),
        "normals": padded([normals for normals, _ in hulls], zero=False),
        "ends": padded([ends for _, ends in hulls], zero=False),
        "rim": np.array([b.rim for b in bodies]),
        "spread": np.array([b.spread for b in bodies]),
        "com": np.stack([b.com for b in bodies], axis=-1),
        "weight": np.array([b.mass * GRAVITY for b in bodies]),
        "mu": np.array([b.mu for b in bodies]),
    }
    return Cases(
        **{name: np.repeat(value, n, axis=-1) for name, value in of_bodies.items()},
        p=np.hstack([p for p, _ in pushes]),
        u=np.hstack([u for _, u in pushes]),
    )


@cache
def population(kind: str, count: int) -> tuple[Cases, Answers]:
    """Random pushes of one kind of body, and what its models say."""
    c, found = asked(kind, count // PUSHES, PUSHES, tuple(Answers.__dataclass_fields__))
    return c, Answers(**found)


@cache
def asked(
    kind: str, bodies: int, pushes: int, names: tuple[str, ...]
) -> tuple[Cases, dict[str, Any]]:
    """Random pushes of some bodies of a kind, and some attributes of the thresholds."""
    rng = np.random.default_rng([SEED, KINDS.index(kind), pushes])
    some = [random_body(kind, rng) for _ in range(bodies)]
    where = [random_pushes(b, rng, pushes) for b in some]
    found: dict[str, list[Any]] = {name: [] for name in names}
    for body, (p, u) in zip(some, where, strict=True):
        t = body.model(kind).thresholds(p.T, u.T, exact=True)
        for name, values in found.items():
            values.append(getattr(t, name).T)
    return gathered(some, where), {name: np.hstack(values) for name, values in found.items()}

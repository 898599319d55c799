"""Predictions per second: the closed forms against readable and numerical peers, in the same run.

Every method takes random pushes of the same box. The closed forms and their peers answer whether a
force moves it, and how; the peers take one push at a time: the seed's reference model, and contact
forces at the corners that balance the push, found by `scipy.optimize.nnls` (feasibility; it says
whether the box holds still, not what it does). The exact tier is asked for the onset; its peer
`scipy.optimize.linprog` for the largest push that corner forces balance. A search over a face takes
10,000 candidates, each a contact and a direction in the finger's friction cone, and finds the one
farthest from toppling. Run it as `python -m benchmarks.predictions`.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog, nnls

from objectmodels import BoxModel, ObjectModel, Registry
from tests.unit.objectmodels.mechanics.seed_model import SeedModel

Array = NDArray[np.float64]

CONE_SIDES = 8
_ON_CORNERS = {"support": "corners", "friction_radius": np.hypot(0.09, 0.09) / 2}


@dataclass(frozen=True)
class Row:
    """One method's speed.

    Attributes:
        method: what was measured.
        pushes: how many pushes it took at once.
        rate: pushes per second, the best of the repetitions.
    """

    method: str
    pushes: int
    rate: float


def random_pushes(box: ObjectModel, n: int, *, seed: int) -> tuple[Array, Array]:
    """Contact points and forces around the onset, shape (n, 3) each."""
    rng = np.random.default_rng(seed)
    points = np.array(box.extents) * rng.uniform([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0], (n, 3))
    directions = rng.normal(size=(n, 3)) * [1.0, 1.0, 0.4]
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return points, directions * rng.uniform(0.1, 0.9, (n, 1)) * box.weight


def corner_wrenches(box: ObjectModel) -> Array:
    """Wrenches of the edges of the friction pyramids at the base corners, shape (6, 4 · sides)."""
    x, y = box.extents[0] / 2, box.extents[1] / 2
    columns = []
    for corner in ((x, y, 0.0), (-x, y, 0.0), (-x, -y, 0.0), (x, -y, 0.0)):
        for angle in 2 * np.pi * np.arange(CONE_SIDES) / CONE_SIDES:
            f = (box.friction * np.cos(angle), box.friction * np.sin(angle), 1.0)
            columns.append(np.concatenate((f, np.cross(corner, f))))
    return np.column_stack(columns)


def rate(work: Callable[[], object], pushes: int, repetitions: int) -> float:
    """Pushes per second of the fastest repetition."""
    best = np.inf
    for _ in range(repetitions):
        start = perf_counter()
        work()
        best = min(best, perf_counter() - start)
    return pushes / best


def search(box: ObjectModel) -> tuple[Array, Array]:
    """10,000 candidates on the front face: 20 × 20 contacts with 25 directions each."""
    face = box.faces()[2]
    lateral, height = (a.ravel() for a in np.meshgrid(
        np.linspace(-0.04, 0.04, 20), np.linspace(0.005, face.top - 0.005, 20)
    ))  # fmt: skip
    points, normals = face.points_at(lateral, height)
    slope = np.linspace(-0.6, 0.6, 5)
    aside, up = (a.ravel()[:, None] for a in np.meshgrid(slope, slope))
    tangent, vertical = np.array(face.tangent), np.array([0.0, 0.0, 1.0])
    u = -normals[:, None, :] + aside * tangent + up * vertical
    u /= np.linalg.norm(u, axis=2, keepdims=True)
    return np.repeat(points, 25, axis=0), u.reshape(-1, 3)


def farthest_from_toppling(box: ObjectModel, points: Array, directions: Array) -> int:
    """The candidate that slides with the largest room to toppling."""
    t = box.thresholds(points, directions)
    return int(np.argmax(np.where(t.slide < t.topple, t.topple - t.slide, -np.inf)))


def closed_forms(box: ObjectModel, p: Array, f: Array, few: int, repetitions: int) -> list[Row]:
    """Whether forces move the box, and how: all at once, and by peers one at a time."""
    n = len(p)
    reference = SeedModel.of(box)
    face = box.faces()[2]
    lateral, height = np.meshgrid(np.linspace(-0.04, 0.04, 20), np.linspace(0.01, 0.22, n // 20))
    contacts, normals = face.points_at(lateral.ravel(), height.ravel())

    def one_by_one() -> list[str]:
        return [reference.outcome(a, b) for a, b in zip(p[:few], f[:few], strict=True)]

    def singly() -> None:
        for i in range(few):
            box.predict(p[i : i + 1], f[i : i + 1]).outcome.item()

    def in_the_cone() -> object:
        return box.cone_thresholds(contacts, normals, sigmas=2.0)

    return [
        Row("closed form, all at once", n, rate(lambda: box.predict(p, f).code, n, repetitions)),
        Row("closed form, one by one", few, rate(singly, few, repetitions)),
        Row("seed's reference", few, rate(one_by_one, few, repetitions)),
        Row("worst of the finger's cone", n, rate(in_the_cone, len(contacts), repetitions)),
    ]


def exact_tier(box: ObjectModel, p: Array, f: Array, few: int, repetitions: int) -> list[Row]:
    """Onsets by the exact tier, and what corner forces hold by general solvers."""
    n, some = len(p), 10 * few
    on_corners = BoxModel(**(box.model_dump() | _ON_CORNERS))
    u = f / np.linalg.norm(f, axis=1, keepdims=True)
    wrenches = corner_wrenches(box)
    weight = np.concatenate(([0.0, 0.0, -box.weight], np.cross(box.com, [0.0, 0.0, -box.weight])))
    pushes = np.hstack((f[:few], np.cross(p[:few], f[:few])))
    cost = np.append(np.zeros(wrenches.shape[1]), -1.0)

    def balanced() -> list[bool]:
        return [bool(nnls(wrenches, -weight - push)[1] < 1e-9) for push in pushes]

    def largest() -> list[float | None]:
        return [
            linprog(cost, A_eq=np.column_stack((wrenches, push)), b_eq=-weight).fun
            for push in pushes
        ]

    def all_at_once() -> object:
        return on_corners.thresholds(p, u, exact=True)

    def evenly() -> object:
        return box.thresholds(p[:some], u[:some], exact=True)

    return [
        Row("exact tier, four corners", n, rate(all_at_once, n, repetitions)),
        Row("exact tier, even pressure", some, rate(evenly, some, 1)),
        Row("corner forces, nnls", few, rate(balanced, few, repetitions)),
        Row("largest push, linprog", few, rate(largest, few, 1)),
    ]


def measure(n: int, few: int, repetitions: int, *, seed: int = 0) -> list[Row]:
    """Rates of all methods; the peers get `few` of the n pushes."""
    box = Registry.built_in().get("ice tea box")
    p, f = random_pushes(box, n, seed=seed)
    points, directions = search(box)
    k = len(points)

    def searched() -> int:
        return farthest_from_toppling(box, points, directions)

    return [
        *closed_forms(box, p, f, few, repetitions),
        *exact_tier(box, p, f, few, repetitions),
        Row("search over a face", k, rate(searched, k, repetitions)),
    ]


def table(rows: Sequence[Row]) -> str:
    """The rows as text, with each rate as a multiple of the reference's."""
    base = next(row.rate for row in rows if row.method == "seed's reference")
    lines = [f"{'method':28} {'pushes':>8} {'per second':>12} {'× reference':>12}"]
    lines += [
        f"{row.method:28} {row.pushes:8d} {row.rate:12,.0f} {row.rate / base:12.2f}" for row in rows
    ]
    by_name = {row.method: row for row in rows}
    exact, peer = by_name["exact tier, four corners"], by_name["largest push, linprog"]
    face = by_name["search over a face"]
    lines += [
        f"exact tier: {exact.rate / peer.rate:.0f} × linprog",
        f"search over a face: {1e3 * face.pushes / face.rate:.1f} ms for {face.pushes} candidates",
    ]
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description="Predictions per second.")
    parser.add_argument("--pushes", type=int, default=20_000)
    parser.add_argument("--few", type=int, default=500, help="pushes for the one-by-one methods")
    parser.add_argument("--repetitions", type=int, default=5)
    options = parser.parse_args()
    print(table(measure(options.pushes, options.few, options.repetitions)))


if __name__ == "__main__":
    main()

"""How far the closed form is from the exact tier, by the way an object stands.

For random objects of each kind of support, pushed by a fingertip anywhere on their sides with a
force in its friction cone: the ratio of the two onsets (closed form over exact tier), and how often
the classes agree, outside and inside of the border band in which the exact tier is asked anyway.
Run it as `python -m benchmarks.accuracy`.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from objectmodels import BoxModel, CylinderModel, ObjectModel, PrismModel
from objectmodels.exact.exact_thresholds import BORDER
from objectmodels.geometry.base_shapes import Support
from objectmodels.mechanics.friction_cone import contact_forces
from objectmodels.mechanics.outcome_map import BAND

Generator = np.random.Generator

PUSHES = 40
"""Pushes for each random object."""


@dataclass(frozen=True)
class Row:
    """One kind of support.

    Attributes:
        support: what the objects stand on.
        pushes: number of pushes whose onset is finite.
        median, p95, worst: of the onset's relative error; positive where the closed form is larger.
        agree: share of equal classes outside the border band, of those that the exact tier does
            not find within `BAND` of a tie.
        border: share of the pushes inside the border band.
    """

    support: str
    pushes: int
    median: float
    p95: float
    worst: float
    agree: float
    border: float


def box(rng: Generator, support: Support) -> BoxModel:
    """A random box whose centre of mass is off the middle by up to a quarter of each side."""
    size = rng.uniform([0.05, 0.05, 0.08], [0.2, 0.2, 0.3])
    com = size * rng.uniform([-0.25, -0.25, 0.25], [0.25, 0.25, 0.6])
    return BoxModel(
        name="box",
        size=tuple(size.tolist()),
        mass=1.0,
        friction=rng.uniform(0.2, 0.6),
        com=tuple(com.tolist()),
        support=support,
    )


def on_points(rng: Generator) -> BoxModel:
    """A box on three to six feet of different stiffness, its centre of mass among them."""
    made = box(rng, "corners")
    half = np.array(made.size[:2]) / 2
    while True:
        feet = rng.uniform(-half, half, (rng.integers(3, 7), 2))
        weights = rng.uniform(0.5, 2.0, len(feet))
        try:
            return BoxModel(
                **(
                    made.model_dump(exclude={"friction_radius", "friction_radius_sd"})
                    | {"support": np.column_stack((feet, weights)).tolist()}
                )
            )
        except ValueError:  # the centre of mass is not above the feet
            continue


def prism(rng: Generator) -> PrismModel:
    """A random prism of three to eight edges on its corners."""
    while True:
        angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, rng.integers(3, 9)))
        corners = rng.uniform(0.04, 0.1) * np.column_stack((np.cos(angles), np.sin(angles)))
        try:
            return PrismModel(
                name="prism",
                corners=corners.tolist(),
                height=rng.uniform(0.08, 0.3),
                mass=1.0,
                friction=rng.uniform(0.2, 0.6),
                support="corners",
            )
        except ValueError:  # the origin is outside of it
            continue


def cylinder(rng: Generator, support: Support) -> CylinderModel:
    """A random cylinder whose centre of mass is off the axis by up to a quarter of the radius."""
    radius, height = rng.uniform(0.03, 0.1), rng.uniform(0.08, 0.3)
    x, y = 0.25 * radius * rng.uniform(-1.0, 1.0, 2)
    return CylinderModel(
        name="cylinder",
        radius=radius,
        height=height,
        mass=1.0,
        friction=rng.uniform(0.2, 0.6),
        com=(x, y, rng.uniform(0.3, 0.6) * height),
        support=support,
    )


KINDS: dict[str, Callable[[Generator], ObjectModel]] = {
    "box, four corners": lambda rng: box(rng, "corners"),
    "box, even pressure": lambda rng: box(rng, "uniform"),
    "box, three to six feet": on_points,
    "prism, its corners": prism,
    "cylinder, its rim": lambda rng: cylinder(rng, "corners"),
    "cylinder, even pressure": lambda rng: cylinder(rng, "uniform"),
}


def pushes(model: ObjectModel, rng: Generator) -> tuple[np.ndarray, np.ndarray]:
    """Random contacts on the sides, and directions in a friction cone of 0.6, shape (n, 3) each."""
    faces = model.faces(rng.uniform(-np.pi, np.pi, 4))
    points, normals = [], []
    for k in range(PUSHES):
        face = faces[k % len(faces)]
        lateral = rng.uniform(-0.5, 0.5) * face.width
        p, n = face.points_at(lateral, rng.uniform(face.bottom, face.top))
        points.append(p)
        normals.append(n)
    share, turn = np.sqrt(rng.uniform(size=PUSHES)), rng.uniform(0.0, 2.0 * np.pi, PUSHES)
    tangential = 0.6 * share[:, None] * np.column_stack((np.cos(turn), np.sin(turn)))
    u = contact_forces(np.array(normals), tangential)
    return np.array(points), u / np.linalg.norm(u, axis=1, keepdims=True)


def measure(support: str, objects: int, *, seed: int = 0) -> Row:
    """The row of one kind of support."""
    rng = np.random.default_rng(seed)
    errors, same, close, tied = [], [], [], []
    for _ in range(objects):
        model = KINDS[support](rng)
        p, u = pushes(model, rng)
        fast, exact = model.thresholds(p, u), model.thresholds(p, u, exact=True)
        moves = np.isfinite(exact.onset)
        errors.append(fast.onset[moves] / exact.onset[moves] - 1.0)
        same.append(fast.code[moves] == exact.code[moves])
        close.append((np.abs(fast.slide - fast.topple) <= BORDER * fast.onset)[moves])
        tied.append((np.abs(exact.slide - exact.topple) <= BAND * exact.onset)[moves])
    error, agree, border, tie = (np.concatenate(x) for x in (errors, same, close, tied))
    return Row(
        support=support,
        pushes=len(error),
        median=float(np.median(error)),
        p95=float(np.quantile(np.abs(error), 0.95)),
        worst=float(np.abs(error).max()),
        agree=float(agree[~border & ~tie].mean()),
        border=float(border.mean()),
    )


def table(rows: list[Row]) -> str:
    """The rows as a table in Markdown."""
    lines = [
        "| support | pushes | median | 95th percentile | worst | class right outside the band "
        "| in the band |",
        "|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {r.support} | {r.pushes} | {100 * r.median:+.1f} % | {100 * r.p95:.1f} % "
        f"| {100 * r.worst:.0f} % | {100 * r.agree:.2f} % | {100 * r.border:.0f} % |"
        for r in rows
    ]
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description="The closed form against the exact tier.")
    parser.add_argument("--objects", type=int, default=50, help="random objects of each support")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    print(table([measure(kind, options.objects, seed=options.seed) for kind in KINDS]))


if __name__ == "__main__":
    main()

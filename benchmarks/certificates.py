"""Whether answers of the exact tier certify themselves: random pushes over random supports.

Supports are three to twelve feet of different stiffness, evenly pressed bases of boxes, prisms and
cylinders, and corners and rims; the centre of mass is anywhere above them, often near the edge.
Counted are answers that are refused (`not_solved`: a residual above 1e-6, or an onset outside
of its bounds), push by push, and residuals. The first pushes of each support are held against the
tests' oracle, which shares no code with the tier: half a percent short of the onset it must not
slide, half a percent beyond that of a slide it must.

    python -m benchmarks.certificates [--supports 2000] [--first 0] [--pushes 50] [--compared 2]
"""

from __future__ import annotations

import argparse
from collections import Counter

import numpy as np
from numpy.typing import NDArray

from objectmodels import BoxModel, CylinderModel, ModelError, ObjectModel, PrismModel
from objectmodels.exact.exact_thresholds import ExactThresholds
from objectmodels.geometry.base_shapes import mean_distance, support_points
from tests.physics.bodies import Cases, edges
from tests.physics.oracle import edge_force, verdict

Array = NDArray[np.float64]

FEET = 0.8
"""Share of supports that are feet; of the others half are evenly pressed."""
APART = 0.005
"""Share of the force within which classes are not compared."""


def random_object(rng: np.random.Generator) -> ObjectModel:
    """An object on a random support."""
    height, shape = rng.uniform(0.05, 0.3), rng.integers(3)
    half = 0.5 * rng.uniform(0.04, 0.2, 2)
    corners = half * np.array([[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]])
    fields = {"name": "b", "mass": rng.uniform(0.1, 3.0), "friction": rng.uniform(0.1, 1.2)}
    if rng.random() < FEET:
        feet = rng.uniform(-half, half, (rng.integers(3, 13), 2))
        weighted = np.column_stack((feet, rng.uniform(0.2, 3.0, len(feet))))
        fields |= {"support": weighted.tolist(), "com": _com_over(feet, height, rng)}
        return BoxModel.model_validate(fields | {"size": (*(2.0 * half), height)})
    fields["support"] = "uniform" if rng.random() < 0.5 else "corners"
    if shape == 0:
        angles = 2.0 * np.pi * np.arange(24) / 24
        rim = half[0] * np.column_stack((np.cos(angles), np.sin(angles)))
        fields |= {"com": _com_over(rim, height, rng), "radius": half[0], "height": height}
        return CylinderModel.model_validate(fields)
    if shape == 1:
        k = int(rng.integers(3, 9))
        angles = 2.0 * np.pi * (np.arange(k) + rng.uniform(-0.2, 0.2, k)) / k
        corners = half * np.column_stack((np.cos(angles), np.sin(angles)))
        fields |= {"corners": corners.tolist(), "height": height}
        return PrismModel.model_validate(fields | {"com": _com_over(corners, height, rng)})
    size = (*(2.0 * half), height)
    return BoxModel.model_validate(fields | {"size": size, "com": _com_over(corners, height, rng)})


def _com_over(points: Array, height: float, rng: np.random.Generator) -> tuple[float, float, float]:
    """A centre of mass above points, near one of them or their edge as often as amidst them."""
    share = rng.dirichlet(np.full(len(points), rng.choice([0.2, 1.0, 5.0])))
    x, y = ((1.0 - 1e-6) * share @ points + 1e-6 * points.mean(axis=0)).tolist()
    return x, y, height * rng.uniform(0.15, 0.7)


def random_pushes(model: ObjectModel, n: int, rng: np.random.Generator) -> tuple[Array, Array]:
    """Contacts on the sides, and directions of any kind, (n, 3) each."""
    faces = model.faces(rng.uniform(-np.pi, np.pi, 4))
    points = np.empty((n, 3))
    for i, k in enumerate(rng.integers(len(faces), size=n)):
        face = faces[k]
        lateral = rng.uniform(-0.5, 0.5) * face.width
        points[i], _ = face.points_at(lateral, rng.uniform(face.bottom, face.top))
    u = rng.normal(size=(n, 3)) * [1.0, 1.0, rng.choice([0.1, 0.3, 1.0, 5.0])]
    return points, u / np.linalg.norm(u, axis=1, keepdims=True)


def cases(model: ObjectModel, p: Array, u: Array) -> Cases:
    """The pushes as the oracle takes them: plain numbers."""
    points, weights = support_points(model.support, model.footprint)
    normals, ends = edges(points)
    n, spread = len(p), model.friction_radius / mean_distance(points, weights)
    of_body = {
        "points": points.T, "weights": weights, "normals": normals, "ends": ends,
        "rim": np.nan, "spread": spread, "com": np.array(model.com),
        "weight": model.weight, "mu": model.friction,
    }  # fmt: skip
    many = {name: np.repeat(np.asarray(v)[..., None], n, axis=-1) for name, v in of_body.items()}
    return Cases(**many, p=p.T, u=u.T)


def contradictions(model: ObjectModel, t: ExactThresholds, n: int) -> Counter[str]:
    """How often the oracle contradicts one of the first n classes, and how often it is not sure."""
    p, u = (v[:n] for v in t.push)
    c = cases(model, p, u)
    slides = t.code[:n] == 1
    found = Counter(compared=n)
    for share in (0.3, 0.7, 1.0):
        s = np.where(np.isfinite(t.onset[:n]), t.onset[:n] * share * (1.0 - APART), 0.0)
        held, moves = verdict(c, s)
        found += Counter(contradicted=int(moves.sum()), undecided=int((~held & ~moves).sum()))
    beyond = t.slide[:n] * (1.0 + APART)
    (i,) = np.nonzero(slides & (beyond < edge_force(c)))
    if i.size:
        held, moves = verdict(c.only(i), beyond[i])
        found += Counter(contradicted=int(held.sum()), undecided=int((~held & ~moves).sum()))
    return found


def measure(number: int, pushes: int, compared: int) -> Counter[str]:
    """Counts of one support."""
    rng = np.random.default_rng((11, number))
    model = random_object(rng)
    p, u = random_pushes(model, pushes, rng)
    found = Counter(supports=1, pushes=pushes)
    try:
        t = model.thresholds(p, u, exact=True)
        _ = t.pessimistic, t.optimistic
    except ModelError:
        return found + _singly(model, p, u)
    round_base = isinstance(model, CylinderModel)  # whose edge is not that of the oracle's points
    if not round_base and compared:
        found += contradictions(model, t, compared)
    return found + Counter({f"residual up to {_decade(t.residual.max())}": 1})


def _singly(model: ObjectModel, p: Array, u: Array) -> Counter[str]:
    refused: Counter[str] = Counter()
    for i in range(len(p)):
        try:
            t = model.thresholds(p[[i]], u[[i]], exact=True)
            _ = t.pessimistic, t.optimistic
        except ModelError as error:
            refused[error.code] += 1
    return refused


def _decade(residual: float) -> str:
    return f"1e{int(np.ceil(np.log10(max(residual, 1e-16))))}"


def main() -> None:
    parser = argparse.ArgumentParser(description="Whether the exact tier's answers are certain.")
    parser.add_argument("--supports", type=int, default=2_000)
    parser.add_argument("--first", type=int, default=0, help="number of the first support")
    parser.add_argument("--pushes", type=int, default=50, help="of each support")
    parser.add_argument("--compared", type=int, default=2, help="of these with the oracle")
    options = parser.parse_args()
    total: Counter[str] = Counter()
    for number in range(options.first, options.first + options.supports):
        total += measure(number, options.pushes, options.compared)
    for name, count in sorted(total.items()):
        print(f"{name:24} {count:8}")


if __name__ == "__main__":
    main()

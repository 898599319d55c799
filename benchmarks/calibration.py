"""Whether stated probabilities are true: how often pushes topple bodies that they may topple.

Five objects, each once on its corners and once evenly pressed. A set is one body, drawn from what
is believed of the object, and one push on a random face at a random place, with a force anywhere in
the finger's friction cone. Its truth is the class by the exact tier for just that body: its mass,
friction, centre of mass, and its support, wider or narrower as its friction radius says. With
`--mujoco` it is what MuJoCo does with the body on its corners (`benchmarks.pushes`), the round one
on 24 points of its rim; there the support is known.

ECE is the expected calibration error of P(topple) over ten bins. A perfect forecaster, who states
the same probabilities and is right, has one too, found by resampling; beside it stand the Brier
score and that forecaster's, E[p (1 − p)]. *Told* is how often the class came that was likeliest.

    python -m benchmarks.calibration [--corners 10000] [--even 2000] [--mujoco 300] [--seed 0]
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from objectmodels import BoxModel, ObjectModel, Registry
from objectmodels.exact.exact_thresholds import thresholds_of_sample
from objectmodels.mechanics.friction_cone import contact_forces
from objectmodels.mechanics.outcome_probability import Sample, sample_parameters

Array = NDArray[np.float64]

NAMES = ("ice tea box", "cereal box", "coffee box", "water bottle")
"""Built-in objects; the fifth one is the crate of the guide, with a spread of its own."""

BINS = 10
RESAMPLED = 400
"""Times that a perfect forecaster is tried."""


@dataclass(frozen=True)
class Row:
    """How probabilities came true.

    Attributes:
        name: object and support.
        sets: how many.
        error, perfect: expected calibration error, and that of a perfect forecaster.
        brier, noise: Brier score, and E[p (1 − p)].
        told: share of sets whose most probable class came.
    """

    name: str
    sets: int
    error: float
    perfect: float
    brier: float
    noise: float
    told: float


def objects(support: str) -> list[ObjectModel]:
    """The five objects on a support, and how sure the robot is of them."""
    crate = BoxModel(
        name="crate", size=(0.1, 0.1, 0.2), mass=1.0, mass_sd=0.05, friction=0.4, friction_sd=0.06,
        com_sd=(0.004, 0.004, 0.010), friction_radius_sd=0.004,
    )  # fmt: skip
    found = [*(Registry.built_in().get(name) for name in NAMES), crate]
    return [_standing_on(model, support) for model in found]


def _standing_on(model: ObjectModel, support: object) -> ObjectModel:
    of_base = {"friction_radius", "correlations", "container", "lid", "grasp", "kind"}
    fields = {key: getattr(model, key) for key in type(model).model_fields if key not in of_base}
    return type(model).model_validate(fields | {"support": support})


def random_pushes(model: ObjectModel, n: int, rng: np.random.Generator) -> tuple[Array, Array]:
    """Contacts anywhere on random faces, and unit directions in the friction cone, (n, 3) each."""
    faces = model.faces(rng.uniform(-np.pi, np.pi, 4))
    points, normals = np.empty((n, 3)), np.empty((n, 3))
    for i, k in enumerate(rng.integers(len(faces), size=n)):
        face = faces[k]
        lateral = rng.uniform(-0.5, 0.5) * face.width
        points[i], normals[i] = face.points_at(lateral, rng.uniform(face.bottom, face.top))
    share, turn = np.sqrt(rng.uniform(size=n)), rng.uniform(0.0, 2.0 * np.pi, n)
    aside = model.finger_friction * share[:, None] * np.column_stack((np.cos(turn), np.sin(turn)))
    u = contact_forces(normals, aside)
    return points, u / np.linalg.norm(u, axis=1, keepdims=True)


def calibration_error(stated: Array, came: NDArray[np.bool_]) -> float:
    """Mean distance of stated probabilities from how often it came, over bins of equal width."""
    place = np.minimum((stated * BINS).astype(int), BINS - 1)
    off = np.bincount(place, stated - came, BINS)
    return float(np.abs(off).sum() / len(stated))


def row(
    name: str, stated: Array, came: NDArray[np.bool_], right: NDArray[np.bool_],
    rng: np.random.Generator,
) -> Row:  # fmt: skip
    """The figures of one object, shape (n,) each."""
    n = len(stated)
    n = len(stated)
    perfect = [calibration_error(stated, rng.random(n) < stated) for _ in range(RESAMPLED)]
    return Row(
        name=name,
        sets=n,
        error=calibration_error(stated, came),
        perfect=float(np.mean(perfect)),
        brier=float(np.mean((stated - came) ** 2)),
        noise=float(np.mean(stated * (1.0 - stated))),
        told=float(right.mean()),
    )


def by_exact_tier(model: ObjectModel, n: int, seed: int) -> Row:
    """Stated and true classes of n sets of an object."""
    rng = np.random.default_rng(seed)
    p, u = random_pushes(model, n, rng)
    likely = model.likelihood(p, u, exact=True)
    sample = sample_parameters(model, n, int(rng.integers(2**32)))
    slide, topple = thresholds_of_sample(model, sample, p, u)
    came = np.select([np.isinf(np.minimum(slide, topple)), slide < topple], [0, 1], 2)
    told = np.argmax([likely.none, likely.slide, likely.topple], axis=0)
    support = "corners" if model.support == "corners" else "even pressure"
    return row(f"{model.name}, {support}", likely.topple, came == 2, told == came, rng)


def by_mujoco(
    model: ObjectModel, n: int, seed: int
) -> tuple[Array, NDArray[np.bool_], NDArray[np.bool_]]:
    """P(topple) that was stated, and where it toppled, where the told class came, (n,) each."""
    from benchmarks.mujoco_push import MujocoWorld, is_round, step_of
    from benchmarks.pushes import HEAVIEST, Push, roll_out

    if is_round(model):  # the points of the rim bound what it topples over
        model = _standing_on(model, tuple(map(tuple, model.footprint.corners.tolist())))
    model = model.model_copy(update={"friction_radius_sd": 0.0})
    rng = np.random.default_rng(seed)
    seen: list[tuple[float, bool, bool]] = []
    while len(seen) < n:
        p, u = random_pushes(model, 1, rng)
        drawn = sample_parameters(model, 1, int(rng.integers(2**32)))
        slide, topple = (force.item() for force in thresholds_of_sample(model, drawn, p, u))
        onset = min(slide, topple)
        if onset > HEAVIEST * model.weight:
            continue
        body, outcome = _drawn_body(model, drawn), "slide" if slide < topple else "topple"
        push = Push(len(seen), body, p[0], u[0], outcome, onset, apart=0.0)
        world, step = MujocoWorld(body), step_of(body)
        saw = roll_out(world, push, step, rocks=is_round(body)).outcome
        likely = model.likelihood(p, u, exact=True)
        told = "slide" if likely.slide.item() > likely.topple.item() else "topple"
        seen.append((likely.topple.item(), saw == "topple", saw == told))
    stated, came, right = (np.array(part) for part in zip(*seen, strict=True))
    return stated, came, right


def _drawn_body(model: ObjectModel, drawn: Sample) -> ObjectModel:
    """The first body of a sample."""
    mass = model.mass * drawn.weight[0] / model.weight
    com = tuple(drawn.com[0].tolist())
    return model.model_copy(update={"mass": mass, "friction": drawn.friction[0], "com": com})


def table(rows: Sequence[Row]) -> str:
    """The rows as a table in Markdown."""
    lines = [
        "| object | sets | ECE | perfect | Brier | E[p (1 − p)] | told class came |",
        "|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {r.name} | {r.sets} | {r.error:.3f} | {r.perfect:.3f} | {r.brier:.3f} | {r.noise:.3f} "
        f"| {100 * r.told:.1f} % |"
        for r in rows
    ]
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description="Whether stated probabilities are true.")
    parser.add_argument("--corners", type=int, default=10_000, help="sets of each on corners")
    parser.add_argument("--even", type=int, default=2_000, help="sets of each, evenly pressed")
    parser.add_argument("--mujoco", type=int, default=0, help="sets of each object in MuJoCo")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    rows = []
    seeds = range(10 * options.seed, 10 * options.seed + len(NAMES) + 1)
    for support, sets in (("corners", options.corners), ("uniform", options.even)):
        some = zip(objects(support), seeds, strict=True) if sets else ()
        rows += [by_exact_tier(model, sets, seed) for model, seed in some]
    if options.mujoco:
        rng = np.random.default_rng(0)
        some = zip(objects("corners"), seeds, strict=True)
        seen = {model.name: by_mujoco(model, options.mujoco, seed) for model, seed in some}
        rows += [row(f"{name}, in MuJoCo", *found, rng) for name, found in seen.items()]
        stated, came, right = (np.concatenate(part) for part in zip(*seen.values(), strict=True))
        rows.append(row("all five in MuJoCo", stated, came, right, rng))
    print(table(rows))


if __name__ == "__main__":
    main()

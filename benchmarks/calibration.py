"""Whether what the tiers say of themselves is true: probabilities, certificates, and the fast tier.

python -m benchmarks.calibration probabilities [--corners 10000] [--even 2000] [--mujoco 300]
python -m benchmarks.calibration certificates [--supports 2000] [--first 0]
python -m benchmarks.calibration closed-form [--objects 50]
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.commands import run_command
from benchmarks.worlds.pushes import HEAVIEST, Push, roll_out
from objectmodels import BoxModel, CylinderModel, ModelError, ObjectModel, PrismModel, Registry
from objectmodels.exact.exact_thresholds import BORDER, ExactThresholds, thresholds_of_sample
from objectmodels.geometry.base_shapes import Array, Support, mean_distance, support_points
from objectmodels.mechanics.friction_cone import contact_forces
from objectmodels.mechanics.outcome_map import BAND
from objectmodels.mechanics.outcome_probability import sample_parameters
from tests.physics.bodies import Cases, edges
from tests.physics.oracle import edge_force, verdict

Generator = np.random.Generator
Truths = NDArray[np.bool_]

NAMES = ("ice tea box", "cereal box", "coffee box", "water bottle")
"""Built-in objects; the fifth one is the crate of the guide, with a spread of its own."""


def side_contacts(
    model: ObjectModel, n: int, rng: Generator, *, by_turns: bool = False
) -> tuple[Array, Array]:
    """Contacts anywhere on random faces, or on each by turns, and their normals, (n, 3) each."""
    faces = model.faces(rng.uniform(-np.pi, np.pi, 4))
    chosen = np.arange(n) % len(faces) if by_turns else rng.integers(len(faces), size=n)
    points, normals = np.empty((n, 3)), np.empty((n, 3))
    for i, k in enumerate(chosen):
        face = faces[k]
        lateral = rng.uniform(-0.5, 0.5) * face.width
        points[i], normals[i] = face.points_at(lateral, rng.uniform(face.bottom, face.top))
    return points, normals


def cone_directions(normals: Array, friction: float, rng: Generator) -> Array:
    """Unit directions anywhere in the friction cones at contacts, (n, 3)."""
    n = len(normals)
    share, turn = np.sqrt(rng.uniform(size=n)), rng.uniform(0.0, 2.0 * np.pi, n)
    aside = friction * share[:, None] * np.column_stack((np.cos(turn), np.sin(turn)))
    u = contact_forces(normals, aside)
    return np.asarray(u / np.linalg.norm(u, axis=1, keepdims=True))


def fingertip_pushes(model: ObjectModel, n: int, rng: Generator) -> tuple[Array, Array]:
    """Contacts on the sides, and directions in the finger's friction cone, (n, 3) each."""
    points, normals = side_contacts(model, n, rng)
    return points, cone_directions(normals, model.finger_friction, rng)


class Forecast(NamedTuple):
    """Stated P(topple), where it toppled, and where the likeliest class came, (n,) each."""

    stated: Array
    came: Truths
    right: Truths

    def row(self, name: str, rng: Generator) -> str:
        """How these probabilities came true."""
        stated, came = self.stated, self.came
        perfect = [_calibration_error(stated, rng.random(len(stated)) < stated) for _ in range(400)]
        return (
            f"| {name} | {len(stated)} | {_calibration_error(stated, came):.3f} "
            f"| {np.mean(perfect):.3f} | {np.mean((stated - came) ** 2):.3f} "
            f"| {np.mean(stated * (1.0 - stated)):.3f} | {100 * self.right.mean():.1f} % |"
        )


def _calibration_error(stated: Array, came: Truths, bins: int = 10) -> float:
    """Mean distance of stated probabilities from how often it came, over bins of equal width."""
    place = np.minimum((stated * bins).astype(int), bins - 1)
    off = np.bincount(place, stated - came, bins)
    return float(np.abs(off).sum() / len(stated))


def probabilities(corners: int = 10_000, even: int = 2_000, mujoco: int = 0, seed: int = 0) -> None:
    """How often pushes topple bodies that they may topple, beside the stated probability.

    Five objects, each once on its corners and once evenly pressed. A set is one body, drawn from
    what is believed of the object, and one push on a random face at a random place, with a force
    anywhere in the finger's friction cone. Its truth is the class by the exact tier for just that
    body: its mass, friction, centre of mass, and its support, wider or narrower as its friction
    radius says. With `--mujoco` it is what MuJoCo does with the body on its corners
    (`benchmarks.worlds.pushes`), the round one on 24 points of its rim; there the support is known.

    ECE is the expected calibration error of P(topple) over ten bins. A perfect forecaster, who
    states the same probabilities and is right, has one too, found by resampling; beside it stand
    the Brier score and that forecaster's, E[p (1 − p)]. *Told* is how often the class came that was
    likeliest.
    """
    print("| object | sets | ECE | perfect | Brier | E[p (1 − p)] | told class came |")
    print("|---|---|---|---|---|---|---|")
    for support, sets in (("corners", corners), ("uniform", even)):
        for number, model in enumerate(_known_objects(support) if sets else ()):
            rng = np.random.default_rng(10 * seed + number)
            forecast = _by_exact_tier(model, sets, rng)
            where = "corners" if model.support == "corners" else "even pressure"
            print(forecast.row(f"{model.name}, {where}", rng), flush=True)
    if mujoco:
        seen = {
            model.name: _by_mujoco(model, mujoco, np.random.default_rng(10 * seed + number))
            for number, model in enumerate(_known_objects("corners"))
        }
        rng = np.random.default_rng(0)
        for name, forecast in seen.items():
            print(forecast.row(f"{name}, in MuJoCo", rng))
        parts = zip(*seen.values(), strict=True)
        print(Forecast(*(np.concatenate(part) for part in parts)).row("all five in MuJoCo", rng))


def _known_objects(support: str) -> list[ObjectModel]:
    """The five objects on a support, and how sure the robot is of them."""
    crate = BoxModel(
        name="crate",
        size=(0.1, 0.1, 0.2),
        mass=1.0,
        mass_sd=0.05,
        friction=0.4,
        friction_sd=0.06,
        com_sd=(0.004, 0.004, 0.010),
        friction_radius_sd=0.004,
    )
    found = [*(Registry.built_in().get(name) for name in NAMES), crate]
    return [_standing_on(model, support) for model in found]


def _standing_on(model: ObjectModel, support: object) -> ObjectModel:
    of_base = {"friction_radius", "correlations", "container", "lid", "grasp", "kind"}
    fields = {key: getattr(model, key) for key in type(model).model_fields if key not in of_base}
    return type(model).model_validate(fields | {"support": support})


def _by_exact_tier(model: ObjectModel, n: int, rng: Generator) -> Forecast:
    p, u = fingertip_pushes(model, n, rng)
    likely = model.likelihood(p, u, exact=True)
    sample = sample_parameters(model, n, int(rng.integers(2**32)))
    slide, topple = thresholds_of_sample(model, sample, p, u)
    came = np.select([np.isinf(np.minimum(slide, topple)), slide < topple], [0, 1], 2)
    told = np.argmax([likely.none, likely.slide, likely.topple], axis=0)
    return Forecast(likely.topple, came == 2, told == came)


def _by_mujoco(model: ObjectModel, n: int, rng: Generator) -> Forecast:
    from benchmarks.worlds.mujoco import MujocoWorld, is_round, step_of

    if is_round(model):  # the points of the rim bound what it topples over
        model = _standing_on(model, tuple(map(tuple, model.footprint.corners.tolist())))
    model = model.model_copy(update={"friction_radius_sd": 0.0})
    seen: list[tuple[float, bool, bool]] = []
    while len(seen) < n:
        p, u = fingertip_pushes(model, 1, rng)
        drawn = sample_parameters(model, 1, int(rng.integers(2**32)))
        slide, topple = (force.item() for force in thresholds_of_sample(model, drawn, p, u))
        onset = min(slide, topple)
        if onset > HEAVIEST * model.weight:
            continue
        truth = {
            "mass": model.mass * drawn.weight[0] / model.weight,
            "friction": drawn.friction[0],
            "com": tuple(drawn.com[0].tolist()),
        }
        body = model.model_copy(update=truth)
        outcome = "slide" if slide < topple else "topple"
        push = Push(len(seen), body, p[0], u[0], outcome, onset, apart=0.0)
        saw = roll_out(MujocoWorld(body), push, step_of(body), rocks=is_round(body)).outcome
        likely = model.likelihood(p, u, exact=True)
        told = "slide" if likely.slide.item() > likely.topple.item() else "topple"
        seen.append((likely.topple.item(), saw == "topple", saw == told))
    return Forecast(*(np.array(part) for part in zip(*seen, strict=True)))


_FEET = 0.8  # share of supports that are feet; of the others half are evenly pressed
_APART = 0.005  # share of the force within which classes are not compared


def certificates(
    supports: int = 2_000, first: int = 0, pushes: int = 50, compared: int = 2
) -> None:
    """Whether answers of the exact tier certify themselves: random pushes over random supports.

    Supports are three to twelve feet of different stiffness, evenly pressed bases of boxes, prisms
    and cylinders, and corners and rims; the centre of mass is anywhere above them, often near the
    edge. Counted are answers that are refused (`not_solved`: a residual above 1e-6, or an onset
    outside of its bounds), push by push, and residuals. The first pushes of each support are held
    against the tests' oracle, which shares no code with the tier: half a percent short of the onset
    it must not slide, half a percent beyond that of a slide it must.
    """
    total: Counter[str] = Counter()
    for number in range(first, first + supports):
        rng = np.random.default_rng((11, number))
        total += _certified(_random_support(rng), pushes, compared, rng)
    for name, count in sorted(total.items()):
        print(f"{name:24} {count:8}")


def _random_support(rng: Generator) -> ObjectModel:
    """An object on a random support."""
    height, shape = rng.uniform(0.05, 0.3), rng.integers(3)
    half = 0.5 * rng.uniform(0.04, 0.2, 2)
    size = (*(2.0 * half), height)
    corners = half * np.array([[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]])
    fields = {"name": "b", "mass": rng.uniform(0.1, 3.0), "friction": rng.uniform(0.1, 1.2)}
    if rng.random() < _FEET:
        feet = rng.uniform(-half, half, (rng.integers(3, 13), 2))
        weighted = np.column_stack((feet, rng.uniform(0.2, 3.0, len(feet))))
        fields |= {"support": weighted.tolist(), "com": _com_over(feet, height, rng)}
        return BoxModel.model_validate(fields | {"size": size})
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
    return BoxModel.model_validate(fields | {"size": size, "com": _com_over(corners, height, rng)})


def _com_over(points: Array, height: float, rng: Generator) -> tuple[float, float, float]:
    """A centre of mass above points, near one of them or their edge as often as amidst them."""
    share = rng.dirichlet(np.full(len(points), rng.choice([0.2, 1.0, 5.0])))
    x, y = ((1.0 - 1e-6) * share @ points + 1e-6 * points.mean(axis=0)).tolist()
    return x, y, height * rng.uniform(0.15, 0.7)


def _certified(model: ObjectModel, n: int, compared: int, rng: Generator) -> Counter[str]:
    """Counts of n pushes of any direction over one support."""
    p, _ = side_contacts(model, n, rng)
    u = rng.normal(size=(n, 3)) * [1.0, 1.0, rng.choice([0.1, 0.3, 1.0, 5.0])]
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    found = Counter(supports=1, pushes=n)

    def thresholds(which: slice) -> ExactThresholds:
        t = model.thresholds(p[which], u[which], exact=True)
        _ = t.pessimistic, t.optimistic
        return t

    try:
        t = thresholds(slice(None))
    except ModelError:
        for i in range(n):
            try:
                thresholds(slice(i, i + 1))
            except ModelError as error:
                found[error.code] += 1
        return found
    round_base = isinstance(model, CylinderModel)  # whose edge is not that of the oracle's points
    if not round_base and compared:
        found += _contradictions(model, t, compared)
    decade = int(np.ceil(np.log10(max(t.residual.max(), 1e-16))))
    return found + Counter({f"residual up to 1e{decade}": 1})


def _contradictions(model: ObjectModel, t: ExactThresholds, n: int) -> Counter[str]:
    """How often the oracle contradicts one of the first n classes, and how often it is not sure."""
    cases = _oracle_cases(model, *(v[:n] for v in t.push))
    found = Counter(compared=n)
    for share in (0.3, 0.7, 1.0):
        s = np.where(np.isfinite(t.onset[:n]), t.onset[:n] * share * (1.0 - _APART), 0.0)
        held, moves = verdict(cases, s)
        found += Counter(contradicted=int(moves.sum()), undecided=int((~held & ~moves).sum()))
    beyond = t.slide[:n] * (1.0 + _APART)
    (i,) = np.nonzero((t.code[:n] == 1) & (beyond < edge_force(cases)))
    if i.size:
        held, moves = verdict(cases.only(i), beyond[i])
        found += Counter(contradicted=int(held.sum()), undecided=int((~held & ~moves).sum()))
    return found


def _oracle_cases(model: ObjectModel, p: Array, u: Array) -> Cases:
    """The pushes as the oracle takes them: plain numbers."""
    points, weights = support_points(model.support, model.footprint)
    normals, ends = edges(points)
    of_body = {
        "points": points.T,
        "weights": weights,
        "normals": normals,
        "ends": ends,
        "rim": np.nan,
        "spread": model.friction_radius / mean_distance(points, weights),
        "com": np.array(model.com),
        "weight": model.weight,
        "mu": model.friction,
    }
    many = {
        name: np.repeat(np.asarray(value)[..., None], len(p), axis=-1)
        for name, value in of_body.items()
    }
    return Cases(**many, p=p.T, u=u.T)


_PUSHES = 40  # of each random object


def closed_form(objects: int = 50, seed: int = 0) -> None:
    """How far the closed form is from the exact tier, by the way an object stands.

    For random objects of each kind of support, pushed by a fingertip anywhere on their sides with a
    force in a friction cone of 0.6: the ratio of the two onsets (closed form over exact tier; its
    median is positive where the closed form is larger), and how often the classes agree, outside of
    the border band in which the exact tier is asked anyway, ties of the exact tier left out.
    """
    print(
        "| support | pushes | median | 95th percentile | worst | class right outside the band "
        "| in the band |"
    )
    print("|---|---|---|---|---|---|---|")
    for support, draw in KINDS.items():
        rng = np.random.default_rng(seed)
        parts = [_compared(draw(rng), rng) for _ in range(objects)]
        error, same, close, tied = (np.concatenate(part) for part in zip(*parts, strict=True))
        print(
            f"| {support} | {len(error)} | {100 * np.median(error):+.1f} % "
            f"| {100 * np.quantile(np.abs(error), 0.95):.1f} % | {100 * np.abs(error).max():.0f} % "
            f"| {100 * same[~close & ~tied].mean():.2f} % | {100 * close.mean():.0f} % |",
            flush=True,
        )


def _compared(model: ObjectModel, rng: Generator) -> tuple[NDArray[Any], ...]:
    """Error of the onset, same class, in the border band, tied; of the pushes that move it."""
    p, normals = side_contacts(model, _PUSHES, rng, by_turns=True)
    u = cone_directions(normals, 0.6, rng)
    fast, exact = model.thresholds(p, u), model.thresholds(p, u, exact=True)
    moves = np.isfinite(exact.onset)
    return (
        fast.onset[moves] / exact.onset[moves] - 1.0,
        fast.code[moves] == exact.code[moves],
        (np.abs(fast.slide - fast.topple) <= BORDER * fast.onset)[moves],
        (np.abs(exact.slide - exact.topple) <= BAND * exact.onset)[moves],
    )


def _box(rng: Generator, support: Support) -> BoxModel:
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


def _box_on_feet(rng: Generator) -> BoxModel:
    """A box on three to six feet of different stiffness, its centre of mass among them."""
    made = _box(rng, "corners")
    stated = made.model_dump(exclude={"friction_radius", "friction_radius_sd"})
    half = np.array(made.size[:2]) / 2
    while True:
        feet = rng.uniform(-half, half, (rng.integers(3, 7), 2))
        weighted = np.column_stack((feet, rng.uniform(0.5, 2.0, len(feet))))
        try:
            return BoxModel(**(stated | {"support": weighted.tolist()}))
        except ValueError:  # the centre of mass is not above the feet
            continue


def _prism(rng: Generator) -> PrismModel:
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


def _cylinder(rng: Generator, support: Support) -> CylinderModel:
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
    "box, four corners": lambda rng: _box(rng, "corners"),
    "box, even pressure": lambda rng: _box(rng, "uniform"),
    "box, three to six feet": _box_on_feet,
    "prism, its corners": _prism,
    "cylinder, its rim": lambda rng: _cylinder(rng, "corners"),
    "cylinder, even pressure": lambda rng: _cylinder(rng, "uniform"),
}


if __name__ == "__main__":
    sys.exit(run_command(probabilities, certificates, closed_form))

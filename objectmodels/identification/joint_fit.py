"""Joint fit of an object's parameters to all trials, by prediction error.

The parameters make the models' own thresholds fit what was felt, each row weighted by its noise
(`least_squares`); slides by the exact tier, on the support that explains them best
(`support_choice`). Trials that the others contradict are left out (`outlying_trials`).

The scale of the force sensor cannot be seen from inside: a common factor of all forces goes into
the mass alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import exp

import numpy as np

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import (
    Array,
    Support,
    SupportPoint,
    carrying_base,
    friction_radius,
    mean_distance,
    support_points,
)
from objectmodels.geometry.pushed_body import UNCERTAIN
from objectmodels.geometry.rotations import cross, dot, left_of
from objectmodels.html_table import html_table
from objectmodels.identification.belief_update import belief_of
from objectmodels.identification.experiment_design import identifiable_parameters
from objectmodels.identification.least_squares import (
    Solution,
    require_possible,
    robust_rows,
    solution_without_outliers,
    solve_least_squares,
)
from objectmodels.identification.measurement_model import (
    COM_X,
    FRICTION,
    LOGARITHMIC,
    MASS,
    RADIUS,
    Balance,
    coordinate_units,
    coordinates_of,
    correlation_of,
    tilt_arms,
    with_belief,
    with_values,
)
from objectmodels.identification.trial import Statistics, Trial
from objectmodels.mechanics.push_thresholds import GRAVITY, yaw_arm
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.parameters import Provenance

# Points that carry an object, found from how it moved under known pushes.
#
# Model: a point of load N_i resists along its slip ŝ_i with μ N_i, whatever the others do. So the
# friction of a motion that was seen is linear in the loads. It balances the push F felt at p:
#
#     Σ N_i (ŝ_i, [x_i × ŝ_i]_z) = (F, [(p − c) × F]_z) / μ,    Σ N_i x_i = 0
#
# with places x_i from the centre of mass c. Loads that are not negative solve this for many
# places at once by least squares, and few of them carry (Lawson and Hanson 1974); neighbours
# among these stand for one foot between them. A push that is high up shifts the loads, which is
# left out here.

LEAST_TRIALS = 12
"""Slides of known motion from which on carrying points are sought; each has three figures."""

_BALANCED = 10.0  # weight of the balance about the centre of mass, of that of a trial


def pressure_points(model: ObjectModel, trials: Sequence[Trial]) -> tuple[SupportPoint, ...] | None:
    """Few points (x, y, weight) that explain slides of known motion; None if there are too few.

    The model gives the footprint and the centre of mass.
    """
    known = [
        t for t in trials if t.moved == "slide" and t.turn_rate is not None and t.drift is not None
    ]
    if len(known) < LEAST_TRIALS:
        return None
    c, radius = np.array(model.com[:2]), friction_radius("uniform", model.footprint)
    places = support_points("uniform", model.footprint)[0] - c
    loads = _carried_loads(known, model.weight, c, places, radius)
    # Distance of places that stand for one foot, of that of all from their middle.
    apart = 0.5 * mean_distance(places, loads / loads.sum())
    points, share = _merged_neighbours(places, loads, apart)
    found = tuple(
        (float(x), float(y), float(w)) for (x, y), w in zip(points + c, share, strict=True)
    )
    try:
        stands = carrying_base(found, model.footprint).contains(c[None], -1e-6 * radius)
    except ModelError:  # the points are on a line
        return None
    return found if stands else None


def _carried_loads(
    trials: Sequence[Trial], weight: float, c: Array, places: Array, radius: float
) -> Array:
    """Loads at places (k, 2) from the centre of mass, in any unit, shape (k,)."""
    from scipy.optimize import nnls  # takes a while to import

    force = np.array([t.force for t in trials])
    push = force[:, :2] / (weight - force[:, 2:])
    size = np.hypot(*push.T)
    r = np.array([t.point[:2] for t in trials]) - c
    u = push / size[:, None]
    turn = np.array([t.turn_rate for t in trials], dtype=np.float64)
    drift = np.array([t.drift for t in trials], dtype=np.float64)
    v = u + drift[:, None] * left_of(u) - turn[:, None] * left_of(r)
    speed = np.sqrt(dot(v, v) + (radius * turn) ** 2)
    slip = (v[:, None] + turn[:, None, None] * left_of(places)) / speed[:, None, None]
    # Of a motion, as a share of it: how well the direction of a slow slip is known.
    slip /= np.sqrt(dot(slip, slip) + 0.02**2)[..., None]
    balance = _BALANCED * np.sqrt(len(trials)) * places.T
    A = np.vstack((slip[..., 0], slip[..., 1], cross(places, slip) / radius, balance / radius))
    b = np.concatenate((push[:, 0], push[:, 1], cross(r, push) / radius, np.zeros(2)))
    loads, _ = nnls(A, b / size.mean())
    return np.asarray(loads)


def _merged_neighbours(places: Array, loads: Array, apart: float) -> tuple[Array, Array]:
    """Middles (k, 2) of places that carry and lie within a distance, and their shares (k,)."""
    from scipy.cluster.hierarchy import fclusterdata

    carry = loads > 1e-6 * loads.sum()
    places, loads = places[carry], loads[carry]
    group = np.zeros(len(loads), dtype=np.intp)
    if len(loads) > 1:
        group += fclusterdata(places, apart, criterion="distance", method="average") - 1
    share = np.bincount(group, weights=loads)
    middle = np.column_stack([np.bincount(group, weights=loads * x) / share for x in places.T])
    keep = share > 0.02 * share.sum()  # least share of the load that counts
    return middle[keep], share[keep] / share[keep].sum()


# Support that explains the trials best.
#
# How the base carries the object decides how it turns, so off-centre slides are tried with the
# model's own support, `uniform`, `corners` and, where motions are known, few points that explain
# these (`pressure_points`). The one that predicts best is taken; each point that was found counts
# against it like a parameter (Akaike 1974).

_OFF_CENTRE = 0.1  # arm as a share of c̄


_Tried = tuple[float, Solution, Balance]
"""The misfit of a support, the solution with it, and its balance."""


def best_support(
    model: ObjectModel,
    trials: Sequence[Trial],
    first: Solution,
    belief: Array,
    prior: bool,
    exact: bool,
    supports: Sequence[Support] | None,
) -> tuple[Solution, Balance, Array, list[str]]:
    """The solution of the support that predicts best, what doubt of it adds, what was compared."""
    coarse = Balance(model, trials)
    if not exact or not _has_turning_slide(coarse, first.values):
        return first, coarse, np.zeros((7, 7)), []
    tried = dict.fromkeys(supports or (model.support, "uniform", "corners"), 0.0)
    if not first.free[RADIUS] and supports is None:
        tried = {model.support: 0.0}
    if supports is None:
        points = pressure_points(with_values(model, first.values), trials)
        # What a point that was found must explain of −2 log likelihood.
        tried |= {} if points is None else {points: 2.0 * len(points)}
    found: list[_Tried] = []
    for support, price in tried.items():
        balance = Balance(_standing_on(model, support), trials, exact=True)
        solution = solve_least_squares(balance, first.values, first.free, belief, prior=prior)
        # Rows that no support can be blamed for missing are left out.
        rows = robust_rows(balance, solution)
        rest, variance = (balance.observed - solution.at.predicted)[rows], solution.variance[rows]
        misfit = float((rest**2 / variance + np.log(variance)).sum())
        found.append((misfit + price, solution, balance))
    best = min(found, key=lambda one: one[0])
    return best[1], best[2], _between_supports(found, best), _comparison_note(found, best[2])


def _between_supports(found: Sequence[_Tried], best: _Tried) -> Array:
    """Covariance from not being sure of the support: how far off the others are, by likelihood."""
    weights = np.exp(-0.5 * (np.array([misfit for misfit, _, _ in found]) - best[0]))
    apart = np.array(
        [coordinates_of(s.values) - coordinates_of(best[1].values) for _, s, _ in found]
    )
    return np.asarray(apart.T @ (weights / weights.sum() * apart.T).T)


def _standing_on(model: ObjectModel, support: Support) -> ObjectModel:
    """The model carried otherwise; its friction radius changes as that of the support does."""
    ratio = friction_radius(support, model.footprint) / friction_radius(
        model.support, model.footprint
    )
    return model.model_copy(
        update={"support": support, "friction_radius": model.friction_radius * ratio}
    )


def _comparison_note(found: Sequence[_Tried], taken: Balance) -> list[str]:
    """Notes on the supports that were tried."""
    if len(found) < 2:
        return []
    misfits = sorted(misfit for misfit, _, _ in found)
    said = ", ".join(f"{_support_name(b.model.support)} {misfit:.1f}" for misfit, _, b in found)
    why = "it predicts better"
    # Difference of −2 log likelihood from which on one support surely predicts better than another.
    if misfits[1] - misfits[0] < 4.0:
        why = "though the trials hardly tell them apart"
    name = _support_name(taken.model.support)
    return [f"the support {name} was taken, {why} (−2 log likelihood: {said})"]


def _support_name(support: Support) -> str:
    return support if isinstance(support, str) else f"of {len(support)} points"


def _has_turning_slide(balance: Balance, values: Array) -> bool:
    """Return True if a slide is so far off-centre that the object turns."""
    t = balance.touches
    i = t.kind == "slide"
    arm = yaw_arm(t.p[i], t.u[i], values[COM_X:])
    return bool((np.abs(arm) > _OFF_CENTRE * values[RADIUS]).any() or balance.turns.any())


@dataclass(frozen=True)
class Fit:
    """A fitted model and how well it is known.

    Attributes:
        model: the model with the values found; its standard deviations say what to expect of the
            next trial, so that of the friction includes the spread.
        found: names of the parameters that were sought.
        values: all parameters, those kept included.
        deviations: standard deviations of the values.
        correlation: of the values, in the order of `UNCERTAIN`, shape (7, 7).
        spread: relative standard deviation of the friction from slide to slide.
        noise: factor by which the stated standard deviations were too small, 1 if they stand.
        residuals: measured minus predicted, in standard deviations of the row, by trial; a slide
            with a turn rate has two.
        rms: root mean square of the relative errors of the predicted forces of the trials kept.
        dropped: trials left out, by source, with the reason.
        notes: what a reader should know, in sentences.
    """

    model: ObjectModel
    found: tuple[str, ...]
    values: Mapping[str, float]
    deviations: Mapping[str, float]
    correlation: Array
    spread: float
    noise: float
    residuals: tuple[tuple[float, ...], ...]
    rms: float
    dropped: Mapping[str, str]
    notes: tuple[str, ...]
    _solution: Solution = field(repr=False)

    def _repr_html_(self) -> str:
        sd = self.deviations
        rows = [(name, f"{self.values[name]:.4g}", f"{sd[name]:.2g}") for name in self.found]
        caption = f"{self.model.name}: forces predicted within {100.0 * self.rms:.1f} %"
        return html_table(caption, ("found", "value [SI]", "± standard deviation"), rows)

    def interval(self, name: str, level: float = 0.95) -> tuple[float, float]:
        """Interval in which a parameter lies with some probability.

        Args:
            name: of the parameter, one of `UNCERTAIN`.
            level: the probability.

        Raises:
            ModelError: `bad_value` if there is no such parameter or probability.
        """
        if name not in UNCERTAIN or not 0.0 < level < 1.0:
            raise ModelError(
                "bad_value",
                f"no interval of {name!r} at the level {level}",
                suggestions=(f"a level between 0 and 1, and one of: {', '.join(UNCERTAIN)}",),
            )
        k, s = UNCERTAIN.index(name), self._solution
        half = _interval_quantile(level, _degrees_of_freedom(s, k)) * float(
            np.sqrt(s.covariance[k, k])
        )
        value = self.values[name]
        if LOGARITHMIC[k]:
            return value * exp(-half), value * exp(half)
        return value - half, value + half


def fit(
    model: ObjectModel,
    trials: Sequence[Trial],
    *,
    parameters: Sequence[str] | None = None,
    prior: bool = False,
    exact: bool = True,
    supports: Sequence[Support] | None = None,
) -> Fit:
    """Fits a model's parameters to trials.

    Args:
        model: what is believed: its shape, and the values of what is not found.
        trials: what was felt.
        parameters: names of those to find, of `UNCERTAIN`; if not given, all that the trials
            identify by themselves. What is kept adds its standard deviation to those found.
        prior: whether the model's beliefs count as measurements. The parameters are then all that
            are wanted and uncertain, and nothing is refused.
        exact: whether slides are predicted by the exact tier.
        supports: that are tried; the model's own first, then `uniform` and `corners`.

    Raises:
        ModelError: `not_identifiable` with the experiments that are missing; `no_trials`,
            `bad_trial`, `impossible_trial`; `no_fit` or `not_possible` if the trials make no sense.
    """
    coarse = Balance(model, trials)
    belief = belief_of(model)
    notes: list[str] = []
    if prior:
        wanted = UNCERTAIN if parameters is None else parameters
        free = np.array([name in wanted for name in UNCERTAIN]) & (np.diag(belief) > 0.0)
    else:
        start = coarse.linear_predictions(model.means)
        require_possible(coarse, start)
        free, lost = identifiable_parameters(coarse, start, belief, parameters)
        notes += [f"{m.name} is kept as believed: {m.reason}" for m in lost]
    first = solve_least_squares(coarse, model.means, free, belief, prior=prior)
    chosen, balance, doubt, told = best_support(
        model, trials, first, belief, prior, exact, supports
    )
    notes += told
    solution, dropped = solution_without_outliers(balance, chosen, belief, prior)
    solution = replace(solution, covariance=solution.covariance + doubt)
    return _fit_from(balance, solution, dropped, notes)


def _fit_from(
    balance: Balance, solution: Solution, dropped: Mapping[int, float], notes: list[str]
) -> Fit:
    values, sources = solution.values, balance.touches.sources
    per = coordinate_units(values)
    covariance = solution.covariance * np.outer(per, per)
    sd = np.sqrt(np.diag(covariance))
    z = (balance.observed - solution.at.predicted) / np.sqrt(solution.variance)
    forces = ~balance.turns & solution.rows
    relative = (balance.observed - solution.at.predicted)[forces] / balance.observed[forces]
    found = tuple(name for name, free in zip(UNCERTAIN, solution.free, strict=True) if free)
    if solution.noise > 1.0:
        notes.append(
            f"the residuals are {solution.noise:.1f} times as large as stated; "
            "the standard deviations are scaled by that"
        )
    if solution.spread >= 0.005:  # Spread of the friction from which on it is told
        notes.append(f"the friction differs by {solution.spread:.1%} from slide to slide")
    return Fit(
        model=_fitted_model(balance, solution, covariance, found),
        found=found,
        values=dict(zip(UNCERTAIN, values.tolist(), strict=True)),
        deviations=dict(zip(UNCERTAIN, sd.tolist(), strict=True)),
        correlation=correlation_of(covariance),
        spread=solution.spread,
        noise=solution.noise,
        residuals=tuple(tuple(z[balance.trial == i].tolist()) for i in range(len(sources))),
        rms=float(np.sqrt(np.mean(relative**2))),
        dropped={
            sources[i]: f"{far:.1f} standard deviations from what the others predict"
            for i, far in dropped.items()
        },
        notes=tuple(notes),
        _solution=solution,
    )


def _fitted_model(
    balance: Balance, solution: Solution, covariance: Array, found: tuple[str, ...]
) -> ObjectModel:
    """Model with the values found; the next slide's friction differs from the mean."""
    covariance = covariance.copy()
    covariance[FRICTION, FRICTION] += (solution.spread * solution.values[FRICTION]) ** 2
    fitted = with_belief(with_values(balance.model, solution.values), covariance)
    provenance = Provenance(
        source="found by touching it",
        method=f"joint fit of {', '.join(found)}",
        trials=len(np.unique(balance.trial[solution.rows])),
    )
    return fitted.model_copy(update={"provenance": provenance})


def _degrees_of_freedom(solution: Solution, k: int) -> float:
    """Degrees of freedom behind the standard deviation of parameter k.

    Those of the spread count by the share that it has in the variance (Satterthwaite 1946).
    """
    freedom = solution.noise_freedom
    variance = solution.covariance[k, k]
    if solution.spread > 0.0 and variance > 0.0:
        rows = solution.rows
        J = solution.at.jacobian[rows]
        gain = solution.own @ (J.T / solution.variance[rows])
        slides = np.where(solution.slides[rows], J[:, FRICTION], 0.0)
        share = float((gain[k] ** 2 * (solution.spread * slides) ** 2).sum() / variance)
        if share > 1e-6:
            freedom = min(freedom, solution.spread_freedom / share**2)
    return freedom


def _interval_quantile(level: float, freedom: float) -> float:
    """Half-width of an interval in standard deviations: Student's t, or normal."""
    from scipy.special import ndtri, stdtrit

    p = 0.5 + level / 2.0
    return float(ndtri(p)) if np.isinf(freedom) else float(stdtrit(freedom, p))


# Estimates in closed form, in the paper's order: weight, then friction; and its Table I.
#
# 1. *Weight and centre of mass* from tilts. About edge k each gives a moment M = s (u_n h − u_z x)
# = G (d_k − n_k·c_xy) cos θ − G c_z sin θ, linear in G, G c_x, G c_y, G c_z.
#    Opposite sides tell G from G c; one side alone gives only m·b, and the believed place of the
#    centre of mass is used. Two angles give c_z.
# 2. *Friction radius* from turn rates ω: c̄ = sqrt(a/ω − a²) / |u_xy|, a = (G/N) [(p − c) × u]_z; if
#    none was measured, from how much easier than straight ones off-centre slides are:
#    c̄ = |a| / sqrt((μ N/s)² − |u_xy|²).
#    Low slides count: pushed high, a base turns otherwise than its ellipsoid.
# 3. *Friction* from the straight slides, or from all if none is: μ = (s/N) sqrt(|u_xy|² + (a/c̄)²),
#    N = G − F_z, which is F_xy / (G − F_z) for a = 0. How a straight one turned nevertheless tells
#    its a/c̄ = x better than the believed centre of mass: ω c̄ = x / (1 + x²).
# 4. *Finger friction* from slips: |f_t| / f_n.
#
# The ellipsoidal limit surface underlies 2 and 3; the joint fit (`fit`) does better where the
# exact tier differs. "The paper" is "Prediction of action outcomes using an object model".

_OPPOSITE = -0.5  # cosine between the ways of tilts to opposite sides
_STRAIGHT = 0.1  # arm as a share of c̄ up to which a slide counts as straight
_LOW = 1.5  # a slide moves the load by so many times as much as the lowest one, or less
_LEAST_TURN = 0.04  # turn rate times arm from which on it tells c̄ well: an arm of c̄ / 5
_MOST_TURN = 0.5  # turn rate times c̄ that no slide exceeds
_ACROSS = 0.3  # share of a tilt's way along an axis from which on it tells the place along it


@dataclass(frozen=True)
class Estimates:
    """Values found, None for what the trials do not give.

    Attributes:
        mass: m [kg].
        friction: μ at the table.
        finger_friction: μ at the finger.
        friction_radius: c̄ [m].
        com_x: centre of mass in B [m].
        com_y: the same along y.
        com_z: the same along z.
        notes: what was believed on the way, in sentences.
    """

    mass: float | None = None
    friction: float | None = None
    finger_friction: float | None = None
    friction_radius: float | None = None
    com_x: float | None = None
    com_y: float | None = None
    com_z: float | None = None
    notes: tuple[str, ...] = ()


def repetition_table(estimates: Iterable[Estimates]) -> dict[str, Statistics]:
    """Table I: statistics over repetitions of every parameter that was found, by its name."""
    repetitions = list(estimates)
    found = {
        name: [value for one in repetitions if (value := getattr(one, name)) is not None]
        for name in UNCERTAIN
    }
    return {name: _statistics(np.array(values)) for name, values in found.items() if values}


def _statistics(values: Array) -> Statistics:
    mean = float(values.mean())
    sd = float(values.std(ddof=1)) if len(values) > 1 else None
    percent = None if sd is None or mean == 0.0 else abs(100.0 * sd / mean)
    return Statistics(mean, sd, percent, float(values.min()), float(values.max()), len(values))


def estimates_by_repetition(model: ObjectModel, trials: Sequence[Trial]) -> tuple[Estimates, ...]:
    """Estimates of every repetition by itself, in their order.

    Raises:
        ModelError: as for `estimates`.
    """
    numbers = sorted({trial.repetition for trial in trials})
    return tuple(
        estimates_from_trials(model, [trial for trial in trials if trial.repetition == number])
        for number in numbers
    )


def estimates_from_trials(model: ObjectModel, trials: Sequence[Trial]) -> Estimates:
    """Estimates from all trials together.

    Args:
        model: what is believed, used for what the trials do not give; `Estimates.notes` says so.
        trials: what was felt.

    Raises:
        ModelError: `no_trials`, `bad_trial`; `not_possible` if the weight comes out negative.
    """
    balance = Balance(model, trials)
    values = model.means
    found: dict[str, float] = {}
    notes: list[str] = []
    if (balance.touches.kind == "topple").any():
        found |= _of_tilts(balance, notes)
    values = np.array([found.get(name, v) for name, v in zip(UNCERTAIN, values, strict=True)])
    if (balance.touches.kind == "slide").any():
        if "mass" not in found:
            notes.append("nothing tilted: the friction is that for the believed mass")
        found |= _of_slides(balance, values)
    slips = balance.touches.ratio[balance.touches.kind == "slip"]
    if slips.size:
        found["finger_friction"] = float(slips.mean())
    return Estimates(**found, notes=tuple(notes))


def _of_tilts(balance: Balance, notes: list[str]) -> dict[str, float]:
    """Mass and what there is of the centre of mass, by linear least squares."""
    t = balance.touches
    i = t.kind == "topple"
    n, tilt = balance.normals[i], t.tilt[i]
    lever, d = tilt_arms(balance.model.base, n, t.p[i], t.u[i], tilt)
    held, sd = t.size[i] * lever, t.size_sd[i] * np.abs(lever)
    per = {
        "com_x": -n[:, 0] * np.cos(tilt),
        "com_y": -n[:, 1] * np.cos(tilt),
        "com_z": -np.sin(tilt),
    }
    believed = dict(zip(("com_x", "com_y", "com_z"), balance.model.com, strict=True))
    opposite = (n @ n.T).min() < _OPPOSITE
    sought = [
        name
        for name in ("com_x", "com_y", "com_z")
        if np.abs(per[name]).max() > (0.0 if name == "com_z" else _ACROSS)
        and (opposite or name == "com_z")
    ]
    # What cannot be told from the weight is believed, the height first.
    while not _are_independent(_moment_columns(d * np.cos(tilt), per, sought, believed)):
        sought.pop()
    if not opposite:
        notes.append(
            "tilts of one side give only mass times distance: the believed centre of mass is used"
        )
    if tilt.any() and "com_z" not in sought:
        notes.append(
            "tilts to one angle do not give the height of the centre of mass: the "
            "believed one is used"
        )
    A = _moment_columns(d * np.cos(tilt), per, sought, believed)
    x = np.linalg.lstsq(A / sd[:, None], held / sd, rcond=None)[0]
    if not x[0] > 0.0:
        raise ModelError(
            "not_possible",
            "the tilts make the weight negative",
            suggestions=("check where the contacts were, the directions and the object's size",),
        )
    moments = dict(zip(sought, (x[1:] / x[0]).tolist(), strict=True))
    return {"mass": float(x[0]) / GRAVITY} | moments


def _moment_columns(
    distance: Array, per: dict[str, Array], sought: list[str], believed: dict[str, float]
) -> Array:
    """Columns of G, then of G times each coordinate sought; the others are as believed."""
    kept = [per[name] * c for name, c in believed.items() if name not in sought]
    weight = distance + np.sum(kept, axis=0) if kept else distance
    return np.column_stack((weight, *(per[name] for name in sought)))


def _are_independent(A: Array) -> bool:
    if A.shape[1] == 1:
        return True
    scaled = A / np.linalg.norm(A, axis=0)
    # Least singular value of columns of unit length that are told apart.
    return len(A) >= A.shape[1] and bool(np.linalg.svd(scaled)[1][-1] > 0.02)


def _of_slides(balance: Balance, values: Array) -> dict[str, float]:
    """Friction, and friction radius if a slide went off-centre."""
    t = balance.touches
    i = t.kind == "slide"
    weight, radius = GRAVITY * values[MASS], float(values[UNCERTAIN.index("friction_radius")])
    s, u = t.size[i], t.u[i]
    load = weight - s * u[:, 2]
    if (load <= 0.0).any():
        k = int(np.flatnonzero(i)[np.argmin(load)])
        raise ModelError(
            "not_possible",
            f"{t.sources[k]}: such a pull would lift the object",
            suggestions=("check the force of this touch and its direction",),
        )
    r, h = s / load, np.hypot(u[:, 0], u[:, 1])
    a = weight / load * yaw_arm(t.p[i], u, values[COM_X:])
    straight = np.abs(a) <= _STRAIGHT * radius
    shift = t.p[i, 2] * r * h
    low = shift <= _LOW * shift.min()
    found = _radius_by_turn(a[low], h[low], t.turn[i][low])
    off = low & ~straight
    if found is None and straight.any() and off.any():
        found = _radius_by_force(a[off], h[off], r[off], (r * h)[straight])
    if found is not None:
        radius = found
    share = np.where(
        straight & np.isfinite(t.turn[i]), _off_by_turn(t.turn[i] * radius), a / radius
    )
    mu = (r * np.hypot(h, share))[straight if straight.any() else slice(None)]
    result = {"friction": float(mu.mean())}
    return result if found is None else result | {"friction_radius": found}


def _off_by_turn(turn: Array) -> Array:
    """The x of ω c̄ = x / (1 + x²) that is 0 without a turn."""
    w = np.clip(np.nan_to_num(turn), -_MOST_TURN, _MOST_TURN)
    return np.asarray(2.0 * w / (1.0 + np.sqrt(1.0 - 4.0 * w * w)))


def _radius_by_turn(a: Array, h: Array, turn: Array) -> float | None:
    """c̄ = sqrt(a/ω − a²) / |u_xy|, the median over the slides that turned."""
    with np.errstate(invalid="ignore", divide="ignore"):
        square = a / turn - a * a
        told = (a * turn > _LEAST_TURN) & (square > 0.0)  # a ω = x² / (1 + x²), x = a/c̄
        radii = np.sqrt(square[told]) / h[told]
    return float(np.median(radii)) if radii.size else None


def _radius_by_force(a: Array, h: Array, r: Array, straight: Array) -> float | None:
    """c̄ = |a| / sqrt((μ/r)² − |u_xy|²) with μ of the straight slides; the mean moment counts."""
    square = (straight.mean() / r) ** 2 - h**2
    if not square.mean() > 0.0:
        return None
    return float(np.sqrt((a * a).mean() / square.mean()))

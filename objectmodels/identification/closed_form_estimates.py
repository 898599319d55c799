"""Estimates in closed form, in the paper's order: weight, then friction; and its Table I.

1. *Weight and centre of mass* from tilts. About edge k each gives a moment
   M = s (u_n h − u_z x) = G (d_k − n_k·c_xy) cos θ − G c_z sin θ, linear in G, G c_x, G c_y, G c_z.
   Opposite sides tell G from G c; one side alone gives only m·b, and the believed place of the
   centre of mass is used. Two angles give c_z.
2. *Friction radius* from turn rates ω: c̄ = sqrt(a/ω − a²) / |u_xy|, a = (G/N) [(p − c) × u]_z; if
   none was measured, from how much easier than straight ones off-centre slides are:
   c̄ = |a| / sqrt((μ N/s)² − |u_xy|²).
   Low slides count: pushed high, a base turns otherwise than its ellipsoid.
3. *Friction* from the straight slides, or from all if none is: μ = (s/N) sqrt(|u_xy|² + (a/c̄)²),
   N = G − F_z, which is F_xy / (G − F_z) for a = 0. How a straight one turned nevertheless tells
   its a/c̄ = x better than the believed centre of mass: ω c̄ = x / (1 + x²).
4. *Finger friction* from slips: |f_t| / f_n.

The ellipsoidal limit surface underlies 2 and 3; the joint fit (`fit`) does better where the exact
tier differs. "The paper" is "Prediction of action outcomes using an object model".
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.pushed_body import UNCERTAIN
from objectmodels.identification.measurement_model import Balance, tilt_arms
from objectmodels.identification.parameter_coordinates import COM_X, MASS
from objectmodels.identification.trial import Statistics, Trial
from objectmodels.mechanics.push_thresholds import GRAVITY, yaw_arm
from objectmodels.models.object_model import ObjectModel

_INDEPENDENT = 0.02  # least singular value of columns of unit length that are told apart
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

    def value(self, name: str) -> float | None:
        """The value of a parameter of `UNCERTAIN`."""
        found: float | None = getattr(self, name)
        return found


def repetition_table(estimates: Iterable[Estimates]) -> dict[str, Statistics]:
    """Table I: statistics over repetitions of every parameter that was found, by its name."""
    repetitions = list(estimates)
    found = {
        name: [value for one in repetitions if (value := one.value(name)) is not None]
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
    values = _fill_values(values, found)
    if (balance.touches.kind == "slide").any():
        if "mass" not in found:
            notes.append("nothing tilted: the friction is that for the believed mass")
        found |= _of_slides(balance, values)
    slips = balance.touches.ratio[balance.touches.kind == "slip"]
    if slips.size:
        found["finger_friction"] = float(slips.mean())
    return Estimates(**found, notes=tuple(notes))


def _fill_values(values: Array, found: dict[str, float]) -> Array:
    return np.array([found.get(name, v) for name, v in zip(UNCERTAIN, values, strict=True)])


def _of_tilts(balance: Balance, notes: list[str]) -> dict[str, float]:
    """Mass and what there is of the centre of mass, by linear least squares."""
    t = balance.touches
    i = t.kind == "topple"
    n, tilt = balance.normals[i], t.tilt[i]
    lever, d = tilt_arms(balance.model.base, n, t.p[i], t.u[i], tilt)
    held, sd = t.size[i] * lever, t.size_sd[i] * np.abs(lever)
    per = {"com_x": -n[:, 0] * np.cos(tilt), "com_y": -n[:, 1] * np.cos(tilt),
           "com_z": -np.sin(tilt)}  # fmt: skip
    believed = dict(zip(("com_x", "com_y", "com_z"), balance.model.com, strict=True))
    opposite = (n @ n.T).min() < _OPPOSITE
    sought = [
        name for name in ("com_x", "com_y", "com_z")
        if np.abs(per[name]).max() > (0.0 if name == "com_z" else _ACROSS)
        and (opposite or name == "com_z")
    ]  # fmt: skip
    # What cannot be told from the weight is believed, the height first.
    while not _are_independent(_moment_columns(d * np.cos(tilt), per, sought, believed)):
        sought.pop()
    if not opposite:
        notes.append("tilts of one side give only mass times distance: the believed centre of "
                     "mass is used")  # fmt: skip
    if tilt.any() and "com_z" not in sought:
        notes.append("tilts to one angle do not give the height of the centre of mass: the "
                     "believed one is used")  # fmt: skip
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
    return len(A) >= A.shape[1] and bool(np.linalg.svd(scaled)[1][-1] > _INDEPENDENT)


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

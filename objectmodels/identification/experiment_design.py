"""Choice of the next experiment, and of when to stop.

A candidate is an experiment with the trials that it would yield: where, in which direction, what
would move, how precisely it is felt. By the Kalman filter's covariance (`update`), which does not
depend on what will be measured, each says how well the parameters would be known after it. What it
is worth is the sum over the wanted parameters of log max(σ/asked, 1) before minus after: of no use
is what makes precise what is precise enough. Precisions are relative, those of the centre of mass
in metres.

One step is looked ahead. That is enough here as tilts and slides each tell a product of which the
next kind of experiment tells a factor, and the covariance carries the product.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from objectmodels.errors import ModelError, suggest
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.pushed_body import UNCERTAIN
from objectmodels.geometry.rotations import cross
from objectmodels.identification.belief_update import belief_of, kalman_gain, updated_covariance
from objectmodels.identification.measurement_model import (
    COM_X,
    COM_Y,
    COM_Z,
    FINGER,
    FRICTION,
    LOGARITHMIC,
    MASS,
    RADIUS,
    Balance,
    Linear,
    Mask,
    coordinate_units,
)
from objectmodels.identification.trial import Trial
from objectmodels.models.object_model import ObjectModel

# Parameters that trials identify, and the experiments that are missing for the others.
#
# A parameter counts as identified if the trials alone, with everything else that is sought
# unknown too, leave less of it open than `UNKNOWN`: the covariance of a fit from almost no prior
# knowledge says so, whose wide directions are what the trials cannot see. What is not sought, or
# cannot be found, is kept as believed; then a value found may hang on that belief: by no more
# than `HANGS` of itself if the parameters are chosen here, `HANGS_WHEN_ASKED` if the caller named
# them. Slides alone give only friction times mass: the better known of the two is kept. A
# standard deviation of zero is one of certainty where the model states it, else of knowing
# nothing.

UNKNOWN = 0.5
"""Standard deviation of a logarithm from which on a parameter counts as not found. Of the
horizontal centre of mass, half of this share of the base's size."""

HANGS, HANGS_WHEN_ASKED = 0.05, 0.1
"""Largest standard deviation of a value, relative to it, that may come from what is believed of
others. Of the horizontal centre of mass, as a share of the base's size."""

_OFF_CENTRE = 0.1  # arm from which on a slide counts as off-centre, as a share of c̄
_GIVEN_UP = (FINGER, COM_Z, COM_Y, COM_X, RADIUS, FRICTION, MASS)


@dataclass(frozen=True)
class Missing:
    """Reason that a parameter cannot be found, and what would find it.

    Attributes:
        name: of the parameter.
        reason: what the trials do not tell.
        experiments: what would tell it: `tilt`, `tilt from the opposite side`, `tilt to a second
            angle`, `slide`, `off-centre slide`, `rub`; or to find another parameter too.
    """

    name: str
    reason: str
    experiments: tuple[str, ...]


HOW = {
    "tilt": "tilt: push it near its top until it tilts",
    "tilt from the opposite side": "tilt from the opposite side: push it near its top there too",
    "tilt to a second angle": "tilt to a second angle: hold it tilted and measure the force again",
    "slide": "slide: push it low, until it slides",
    "off-centre slide": "off-centre slide: push it low, near the edge of a face",
    "rub": "rub: press the finger on a face and drag it along until it slips",
}
"""The experiments, and how to carry them out."""


def require_names(parameters: Sequence[str]) -> None:
    """Raise an error if a parameter does not exist.

    Raises:
        ModelError: `bad_value`.
    """
    for name in parameters:
        if name not in UNCERTAIN:
            raise ModelError(
                "bad_value",
                f"no parameter is called {name!r}",
                suggestions=suggest(name, UNCERTAIN) or UNCERTAIN,
            )


def identifiable_parameters(
    balance: Balance, at: Linear, belief: Array, parameters: Sequence[str] | None
) -> tuple[Mask, tuple[Missing, ...]]:
    """Parameters to seek, and reasons against the others that the trials touch.

    Args:
        balance: the trials and their model.
        at: predictions near some values.
        belief: covariance of what is believed, in coordinates, shape (7, 7).
        parameters: names of those that are wanted; if not given, all that can be found.

    Raises:
        ModelError: `not_identifiable` if one that is wanted cannot be found, or, where the object
            moved, neither mass nor friction can.
    """
    if parameters is not None:
        require_names(parameters)
        free = np.array([name in parameters for name in UNCERTAIN])
        left_open = _open_parameters(balance, at, free)
        wanting = left_open | _belief_dependent(balance, at, free, belief, HANGS_WHEN_ASKED)
        if wanting.any():
            kept = belief if not left_open.any() else None
            raise not_identifiable_error(
                [
                    missing_parameter(balance, at, int(k), free, kept)
                    for k in np.flatnonzero(wanting)
                ]
            )
        return free, ()
    free = np.ones(len(UNCERTAIN), dtype=bool)
    everything = free.copy()
    unknown = (np.diag(belief) == 0.0) & ~_stated(balance.model)
    unsure = belief + np.diag(np.where(unknown, _weak_deviations(balance) ** 2, 0.0))
    order = _GIVEN_UP
    if unsure[MASS, MASS] < unsure[FRICTION, FRICTION]:
        order = (*_GIVEN_UP[:-2], MASS, FRICTION)
    while True:
        wanting = _open_parameters(balance, at, free)
        if not wanting.any():
            wanting = _belief_dependent(balance, at, free, unsure, HANGS)
        if not wanting.any():
            break
        free[next(k for k in order if wanting[k])] = False
    lost = tuple(missing_parameter(balance, at, int(k), everything) for k in np.flatnonzero(~free))
    kinds = set(balance.touches.kind)
    if not free[[MASS, FRICTION]].any() and (kinds != {"slip"} or not free.any()):
        relevant = [m for m in lost if _is_concerned(m.name, kinds)]
        raise not_identifiable_error(relevant)
    return free, lost


def _stated(model: ObjectModel) -> Mask:
    """Parameters whose standard deviations the model states, shape (7,)."""
    by_field = [name for name in UNCERTAIN if not name.startswith("com_")] + 3 * ["com"]
    return np.array([f"{name}_sd" in model.model_fields_set for name in by_field])


def _is_concerned(name: str, kinds: set[str]) -> bool:
    """Return True if trials of such kinds may have been meant to find a parameter."""
    by = {"topple": ("mass", "com_x"), "slide": ("mass", "friction"), "slip": ("finger_friction",)}
    return any(name in names for kind, names in by.items() if kind in kinds)


def not_identifiable_error(lost: Sequence[Missing]) -> ModelError:
    """Error that says which parameters cannot be found, why, and what would find them."""
    said = "; ".join(f"{m.name}: {m.reason}" for m in lost)
    names = dict.fromkeys(name for m in lost for name in m.experiments)
    return ModelError(
        "not_identifiable",
        f"not identifiable: {said}",
        suggestions=tuple(HOW.get(name, name) for name in names),
    )


def _weak_deviations(balance: Balance) -> Array:
    """Standard deviations of coordinates of which nothing is known, shape (7,)."""
    # Standard deviation of a logarithm of which nothing is known, a factor of seven.
    return np.where(LOGARITHMIC, 2.0, balance.model.base.size)


def open_covariance(balance: Balance, at: Linear, free: Mask) -> Array:
    """Covariance of the parameters sought, from the trials and almost no prior knowledge."""
    J = at.jacobian[:, free] / at.sd[:, None]
    return np.asarray(np.linalg.inv(J.T @ J + np.diag(_weak_deviations(balance)[free] ** -2.0)))


def _open_parameters(balance: Balance, at: Linear, free: Mask) -> Mask:
    """Parameters sought that the trials leave open."""
    wide = np.zeros(len(free), dtype=bool)
    limit = np.where(LOGARITHMIC, UNKNOWN, 0.5 * UNKNOWN * balance.model.base.size)
    wide[free] = np.sqrt(np.diag(open_covariance(balance, at, free))) > limit[free]
    return wide


def _belief_dependent(
    balance: Balance, at: Linear, free: Mask, belief: Array, limit: float
) -> Mask:
    """Parameters sought that would hang too much on beliefs about the others."""
    hangs = np.zeros(len(free), dtype=bool)
    shift = _shift_by_beliefs(balance, at, free)
    variance = np.einsum("ij,jk,ik->i", shift, belief[np.ix_(~free, ~free)], shift)
    size = np.where(LOGARITHMIC, 1.0, balance.model.base.size)
    hangs[free] = np.sqrt(variance) > limit * size[free]
    return hangs


def _shift_by_beliefs(balance: Balance, at: Linear, free: Mask) -> Array:
    """Change of the parameters sought with those that are kept, shape (sought, kept)."""
    J = at.jacobian / at.sd[:, None]
    return np.asarray(open_covariance(balance, at, free) @ J[:, free].T @ J[:, ~free])


def missing_parameter(
    balance: Balance, at: Linear, k: int, free: Mask, kept: Array | None = None
) -> Missing:
    """Reason that parameter k cannot be found, from what its wide direction is made of.

    Args:
        balance: the trials and their model.
        at: predictions near some values.
        k: place of the parameter.
        free: the parameters sought.
        kept: covariance of what is believed, if nothing but that leaves k in doubt.
    """
    t, name = balance.touches, UNCERTAIN[k]
    tied = _tied_parameters(balance, at, k, free)
    tilts = t.kind == "topple"
    if k == FINGER:
        return Missing(name, "the finger never slipped", ("rub",))
    if k in (FRICTION, RADIUS) and not (t.kind == "slide").any():
        need = "slide" if k == FRICTION else "off-centre slide"
        return Missing(name, "it never slid", (need,))
    if k == RADIUS:
        return Missing(name, *_of_radius(balance, at.values))
    if not tilts.any():
        experiments = ("tilt", "tilt from the opposite side")[: 1 if k in (MASS, FRICTION) else 2]
        why = "it never tilted"
        if k in (MASS, FRICTION) and (t.kind == "slide").any():
            why = "a slide gives only friction times mass"
        elif k in (MASS, FRICTION):
            why = "the ratio of forces at the finger does not depend on it"
        return Missing(name, why, experiments)
    if k == COM_Z or (k in (MASS, FRICTION) and COM_Z in tied and not _one_sided(balance)):
        why = "the tilts are at one angle, which gives only mass times the weight's lever arm there"
        # Tilts that differ by less count as at one angle [rad].
        if COM_Z in tied and np.ptp(t.tilt[tilts]) > 0.02:
            why = "the tilts do not tell it from the mass and the rest of the centre of mass"
        return Missing(name, why, ("tilt to a second angle",))
    if not _one_sided(balance) and kept is not None:
        row = np.flatnonzero(free).tolist().index(k)
        shares = np.abs(_shift_by_beliefs(balance, at, free)[row]) * np.sqrt(np.diag(kept)[~free])
        other = UNCERTAIN[int(np.flatnonzero(~free)[np.argmax(shares)])]
        return Missing(name, f"it hangs on what is believed of {other}", (f"find {other} too",))
    if not _one_sided(balance) and k in (MASS, FRICTION):
        why = "the forces are too noisy, or too few, to tell it from the centre of mass"
        return Missing(name, why, ("tilt", "tilt from the opposite side"))
    b = _least_lever(balance, at.values)
    return Missing(
        name,
        "tilts of one side give only mass times the weight's distance from the edge: 1 mm of "
        f"offset is {0.1 / b:.1f} % of mass",
        ("tilt from the opposite side",),
    )


def _tied_parameters(balance: Balance, at: Linear, k: int, free: Mask) -> set[int]:
    """Parameters that make up the widest direction in which parameter k is open."""
    weak = _weak_deviations(balance)[free]
    variance, directions = np.linalg.eigh(open_covariance(balance, at, free) / np.outer(weak, weak))
    row = np.flatnonzero(free).tolist().index(k)
    widest = directions[:, np.argmax(variance * directions[row] ** 2)]
    # Share of a wide direction that counts as part of it.
    return set(np.flatnonzero(free)[np.abs(widest) > 0.2].tolist())


def _of_radius(balance: Balance, values: Array) -> tuple[str, tuple[str, ...]]:
    """Reason that slides do not show the friction radius."""
    t = balance.touches
    i = t.kind == "slide"
    arm = np.abs(cross(t.p[i] - values[COM_X:], t.u[i]))
    if (arm < _OFF_CENTRE * values[RADIUS]).all():
        return "all slides went through the centre, which does not turn it", ("off-centre slide",)
    return (
        "the slides do not tell it from the friction or the centre of mass",
        ("off-centre slide", "slide"),
    )


def _one_sided(balance: Balance) -> bool:
    """Return True if no two tilts went to opposite sides."""
    n = balance.normals[balance.touches.kind == "topple"]
    return bool((n @ n.T).min() > -0.5)


def _least_lever(balance: Balance, values: Array) -> float:
    """Least distance of the weight from the edges tilted about [m]."""
    n = balance.normals[balance.touches.kind == "topple"]
    b = balance.model.base.extent(n) - n @ values[[COM_X, COM_Y]]
    return max(float(np.min(b)), 1e-6)


@dataclass(frozen=True)
class Candidate:
    """An experiment that could be done.

    Attributes:
        name: what to call it.
        trials: what it would yield; the sizes of the forces and the turn rates do not count, but
            whether there are any and their standard deviations do.
        cost: what it takes, in units of the caller's; gains are compared for each unit.
    """

    name: str
    trials: tuple[Trial, ...]
    cost: float = 1.0


@dataclass(frozen=True)
class Worth:
    """Worth of an experiment.

    Attributes:
        candidate: the experiment.
        gain: what it is worth, for each unit of cost.
        precisions: of the wanted parameters after it.
    """

    candidate: Candidate
    gain: float
    precisions: Mapping[str, float]


def parameter_precisions(
    model: ObjectModel, wanted: Sequence[str] = UNCERTAIN, *, spread: float = 0.0
) -> dict[str, float]:
    """Relative standard deviations of the wanted parameters, of the centre of mass in metres.

    The relative `spread` of friction from slide to slide does not count.
    """
    require_names(wanted)
    return _precisions_from(model, belief_of(model, spread), wanted)


def is_precise_enough(
    model: ObjectModel, asked: Mapping[str, float], *, spread: float = 0.0
) -> bool:
    """Return True if all parameters are known as precisely as asked by name: time to stop.

    Precisions and spread are as in `parameter_precisions`.
    """
    known = parameter_precisions(model, tuple(asked), spread=spread)
    return all(known[name] <= asked[name] for name in asked)


def rank_candidates(
    model: ObjectModel,
    candidates: Sequence[Candidate],
    asked: Mapping[str, float] | Sequence[str],
    *,
    spread: float = 0.0,
) -> list[Worth]:
    """Candidates in the order of their worth, the best first.

    Args:
        model: what is believed, with its uncertainty.
        candidates: experiments that could be done.
        asked: precisions by name of the wanted parameters, or only the names.
        spread: relative standard deviation of friction from slide to slide.

    Raises:
        ModelError: `no_candidates`; `bad_value` if a name or a cost is wrong; `bad_trial`.
    """
    if not candidates:
        raise ModelError(
            "no_candidates",
            "there is no experiment to choose from",
            suggestions=("give one candidate or more",),
        )
    if any(not candidate.cost > 0.0 for candidate in candidates):
        raise ModelError(
            "bad_value",
            "the cost of an experiment must be positive",
            suggestions=("1 for each, if they cost the same",),
        )
    require_names(tuple(asked))
    # Precision that no experiment reaches: for a parameter that is wanted as well as it can be.
    goal = dict(asked) if isinstance(asked, Mapping) else dict.fromkeys(asked, 1e-9)
    before = belief_of(model, spread)
    lacking = _missing_precision(_precisions_from(model, before, tuple(goal)), goal)
    worths = []
    for candidate in candidates:
        balance = Balance(model, candidate.trials)
        at = balance.linear_predictions(model.means)
        tells = np.isfinite(at.predicted)  # what would never move tells nothing
        H, R = at.jacobian[tells], at.sd[tells] ** 2
        R = R + np.where(balance.slides[tells], spread * H[:, FRICTION], 0.0) ** 2
        known = _precisions_from(
            model, updated_covariance(before, H, R, kalman_gain(before, H, R)), tuple(goal)
        )
        gain = (lacking - _missing_precision(known, goal)) / candidate.cost
        worths.append(Worth(candidate, gain, known))
    return sorted(worths, key=lambda worth: -worth.gain)


def _precisions_from(model: ObjectModel, P: Array, wanted: Sequence[str]) -> dict[str, float]:
    sd = np.sqrt(np.diag(P))
    metres = np.array([name.startswith("com") for name in UNCERTAIN])
    sd = np.where(metres, sd * coordinate_units(model.means), sd)
    return {name: float(sd[UNCERTAIN.index(name)]) for name in wanted}


def _missing_precision(known: Mapping[str, float], asked: Mapping[str, float]) -> float:
    """Σ log max(σ/asked, 1)."""
    return sum(float(np.log(max(known[name] / asked[name], 1.0))) for name in asked)

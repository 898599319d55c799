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

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.pushed_body import UNCERTAIN
from objectmodels.identification.belief_update import belief_of, kalman_gain, updated_covariance
from objectmodels.identification.identifiability import require_names
from objectmodels.identification.measurement_model import Balance
from objectmodels.identification.parameter_coordinates import FRICTION, coordinate_units
from objectmodels.identification.trial import Trial
from objectmodels.models.object_model import ObjectModel

LEAST = 1e-9
"""Precision that no experiment reaches: for a parameter that is wanted as well as it can be."""


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
    goal = dict(asked) if isinstance(asked, Mapping) else dict.fromkeys(asked, LEAST)
    before = belief_of(model, spread)
    lacking = _missing_precision(_precisions_from(model, before, tuple(goal)), goal)
    worths = []
    for candidate in candidates:
        known = _precisions_from(
            model, _covariance_after(model, before, candidate.trials, spread), tuple(goal)
        )
        gain = (lacking - _missing_precision(known, goal)) / candidate.cost
        worths.append(Worth(candidate, gain, known))
    return sorted(worths, key=lambda worth: -worth.gain)


def _covariance_after(
    model: ObjectModel, P: Array, trials: Sequence[Trial], spread: float
) -> Array:
    """Covariance after trials, in coordinates, shape (7, 7)."""
    balance = Balance(model, trials)
    at = balance.linear_predictions(model.means)
    tells = np.isfinite(at.predicted)  # what would never move tells nothing
    H, R = at.jacobian[tells], at.sd[tells] ** 2
    R = R + np.where(balance.slides[tells], spread * H[:, FRICTION], 0.0) ** 2
    return updated_covariance(P, H, R, kalman_gain(P, H, R))


def _precisions_from(model: ObjectModel, P: Array, wanted: Sequence[str]) -> dict[str, float]:
    sd = np.sqrt(np.diag(P))
    metres = np.array([name.startswith("com") for name in UNCERTAIN])
    sd = np.where(metres, sd * coordinate_units(model.means), sd)
    return {name: float(sd[UNCERTAIN.index(name)]) for name in wanted}


def _missing_precision(known: Mapping[str, float], asked: Mapping[str, float]) -> float:
    """Σ log max(σ/asked, 1)."""
    return sum(float(np.log(max(known[name] / asked[name], 1.0))) for name in asked)

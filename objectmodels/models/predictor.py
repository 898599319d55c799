"""What planner and checks ask of a model's predictions.

Object models answer all of it by their physics. A kind of another package may answer some of it in
its own way, learned from data for instance; such predictions are judged by pushes that were seen
(`objectmodels.models.predictor`) before the model is let in.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array

if TYPE_CHECKING:
    from objectmodels.geometry.pushed_body import Friction
    from objectmodels.mechanics.friction_cone import ConeThresholds
    from objectmodels.mechanics.outcome_probability import Likelihood
    from objectmodels.mechanics.push_motion import Stroke
    from objectmodels.mechanics.push_outcomes import Prediction, Thresholds


class Predictor(Protocol):
    """Predictions for pushes of one object; see `ObjectModel` for arguments, units and frames."""

    def thresholds(
        self,
        points: ArrayLike,
        directions: ArrayLike,
        *,
        exact: bool | Literal["border"] = False,
        friction: Friction = "static",
    ) -> Thresholds:
        """Forces at which slow pushes slide and topple it: contacts are confirmed by them."""

    def predict(
        self,
        points: ArrayLike,
        forces: ArrayLike,
        *,
        exact: bool = False,
        friction: Friction = "static",
    ) -> Prediction:
        """Outcomes of given forces: questions are answered by them."""

    def cone_thresholds(
        self, points: ArrayLike, normals: ArrayLike, *, sigmas: float = 0.0, yaw: bool = True
    ) -> ConeThresholds:
        """Extremes over all that a fingertip transmits: contacts are searched by them."""

    def likelihood(
        self,
        points: ArrayLike,
        directions: ArrayLike,
        *,
        force: float | None = None,
        exact: bool = True,
    ) -> Likelihood:
        """Probabilities of the outcomes: its own uncertainty, by which it is judged."""

    def is_slipping(
        self, normals: ArrayLike, forces: ArrayLike, *, friction: Friction = "static"
    ) -> Any:
        """Return True where a finger slips along a face, shape (n,)."""

    def stroke(
        self,
        points: ArrayLike,
        normals: ArrayLike,
        direction: ArrayLike,
        travel: ArrayLike,
        *,
        exact: bool = False,
        tip_radius: float = 0.0,
    ) -> Stroke:
        """Motion by strokes of one finger or two."""

    def angle_of_no_return(self, direction: ArrayLike, *, sigmas: float = 0.0) -> float:
        """Tilt past which it falls by itself [rad]."""

    def topple_stroke(self, direction: ArrayLike, height: float, angle: float) -> float:
        """Travel of a finger that tilts it by an angle [m]."""


PREDICTIONS = tuple(name for name in vars(Predictor) if not name.startswith("_"))
"""Names of the protocol's methods."""


def own_predictions(kind: type, physics: type) -> tuple[str, ...]:
    """Names of the predictions that a kind answers otherwise than the physics it descends from."""
    return tuple(n for n in PREDICTIONS if getattr(kind, n) is not getattr(physics, n))


# Calibration of a predictor: what it says of its own uncertainty, beside pushes that were seen.
#
# Two tests, each of which a calibrated predictor fails in one case of a hundred. A push that
# needed the force F to move the object had moved it at less with the probability 1 − P(none | F):
# over many pushes these are evenly spread between 0 and 1 (Kolmogorov and Smirnov). And outcomes
# y of probability p make Σ (y − p)(1 − 2p) normal with the variance Σ (1 − 2p)² p(1 − p)
# (Spiegelhalter 1986).

LEAST_PUSHES = 20
"""Pushes from which on a calibration is judged."""

LEVEL = 0.01
"""Probability by chance below which a test fails."""

_SURE = 1e-3  # probabilities nearer to 0 or 1 count as this near


@dataclass(frozen=True, eq=False)
class SeenPushes:
    """Pushes that moved the object; arrays over n of them.

    Attributes:
        points: contact points p_BC, shape (n, 3) [m].
        forces: f_BC_B at the onset, shape (n, 3) [N].
        slid: whether it slid and did not topple, shape (n,).
    """

    points: Array
    forces: Array
    slid: NDArray[np.bool_]


@dataclass(frozen=True)
class Calibration:
    """Probabilities by chance of what was seen, if the predictor were calibrated.

    Attributes:
        of_forces: of the spread of the onset forces.
        of_outcomes: of what moved.
    """

    of_forces: float
    of_outcomes: float

    @property
    def is_good(self) -> bool:
        """Return True if neither test fails."""
        return min(self.of_forces, self.of_outcomes) >= LEVEL


def calibration_of(predictor: Predictor, seen: SeenPushes) -> Calibration:
    """Calibration of a predictor on pushes that it was not made from."""
    from scipy.special import erfc, kolmogorov

    size = np.linalg.norm(seen.forces, axis=1)
    p, u, n = seen.points, seen.forces / size[:, None], len(size)
    stood = [
        float(predictor.likelihood(p[k : k + 1], u[k : k + 1], force=float(size[k])).none[0])
        for k in range(n)
    ]
    moved = np.sort(1.0 - np.array(stood))
    steps = np.arange(n + 1) / n
    apart = max(float((moved - steps[:-1]).max()), float((steps[1:] - moved).max()))
    chances = predictor.likelihood(p, u)
    # What nothing ever moves was moved: that counts as surely wrong.
    share = chances.slide / np.maximum(chances.slide + chances.topple, _SURE)
    share = np.clip(share, _SURE, 1.0 - _SURE)
    weight = 1.0 - 2.0 * share
    off = float(((seen.slid - share) * weight).sum())
    sd = float(np.sqrt((weight**2 * share * (1.0 - share)).sum()))
    return Calibration(float(kolmogorov(np.sqrt(n) * apart)), float(erfc(abs(off) / sd / 2**0.5)))


def require_calibration(predictor: Predictor, seen: SeenPushes | None, name: str) -> None:
    """Refuse a predictor whose probabilities do not hold for pushes that were seen.

    Raises:
        ModelError: `not_calibrated`, also where too few pushes are given.
    """
    count = 0 if seen is None else len(seen.forces)
    if seen is None or count < LEAST_PUSHES:
        raise ModelError(
            "not_calibrated",
            f"{name} has predictions of its own, and {count} pushes to judge them by, "
            f"expected {LEAST_PUSHES}",
            suggestions=("give it `seen_pushes`: those that it was not made from",),
        )
    found = calibration_of(predictor, seen)
    if not found.is_good:
        what = "forces" if found.of_forces < LEVEL else "outcomes"
        chance = min(found.of_forces, found.of_outcomes)
        raise ModelError(
            "not_calibrated",
            f"the {what} of {count} pushes are not those that {name} expects: by chance they would "
            f"be so in {chance:.1e} of all cases",
            suggestions=("widen its uncertainty", "look at its mean error by these pushes"),
        )

"""What planner and checks ask of a model's predictions.

Object models answer all of it by their physics. A kind of another package may answer some of it in
its own way, learned from data for instance; such predictions are judged by pushes that were seen
(`objectmodels.models.calibration`) before the model is let in.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, Protocol

from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from objectmodels.geometry.pushed_body import Friction
    from objectmodels.mechanics.friction_cone import ConeThresholds
    from objectmodels.mechanics.outcome_probability import Likelihood
    from objectmodels.mechanics.push_motion import Stroke
    from objectmodels.mechanics.push_outcomes import Prediction, Thresholds


class Predictor(Protocol):
    """Predictions for pushes of one object; see `ObjectModel` for arguments, units and frames."""

    def thresholds(
        self, points: ArrayLike, directions: ArrayLike, *,
        exact: bool | Literal["border"] = False, friction: Friction = "static",
    ) -> Thresholds:  # fmt: skip
        """Forces at which slow pushes slide and topple it: contacts are confirmed by them."""

    def predict(
        self, points: ArrayLike, forces: ArrayLike, *,
        exact: bool = False, friction: Friction = "static",
    ) -> Prediction:  # fmt: skip
        """Outcomes of given forces: questions are answered by them."""

    def cone_thresholds(
        self, points: ArrayLike, normals: ArrayLike, *, sigmas: float = 0.0, yaw: bool = True
    ) -> ConeThresholds:
        """Extremes over all that a fingertip transmits: contacts are searched by them."""

    def likelihood(
        self, points: ArrayLike, directions: ArrayLike, *,
        force: float | None = None, exact: bool = True,
    ) -> Likelihood:  # fmt: skip
        """Probabilities of the outcomes: its own uncertainty, by which it is judged."""

    def is_slipping(
        self, normals: ArrayLike, forces: ArrayLike, *, friction: Friction = "static"
    ) -> Any:
        """Return True where a finger slips along a face, shape (n,)."""

    def stroke(
        self, points: ArrayLike, normals: ArrayLike, direction: ArrayLike, travel: ArrayLike,
        *, exact: bool = False, tip_radius: float = 0.0,
    ) -> Stroke:  # fmt: skip
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

"""Trial: one touch of an object, with its contact, its force and what moved.

Frame: B is the object's, origin at the centre of its base, z up. Forces are given in the axes that
B has while the object stands upright with its heading of that moment: a tilt does not turn them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array

Moved = Literal["slide", "topple", "slip", "none"]
"""What gave way: the object slid, it tilted about an edge of its base, the finger slipped on it; or
nothing did, so that the force is less than what moves the object."""

Vector = tuple[float, float, float]

TURN_RATE_SD = 0.5
"""Standard deviation of a turn rate that comes without one [rad/m]."""


@dataclass(frozen=True)
class Trial:
    """A balance of forces at which something moved.

    Attributes:
        moved: what gave way.
        point: contact point p_BC, a point of the object [m].
        force: whole force f_BC on the object then, in the level axes of B [N]. Of a slide the mean
            on the way, with the axes and the contact half-way; of a tilt, what holds it at `tilt`.
        force_sd: standard deviation of the force along its direction [N].
        tilt: angle about the edge at which the force was felt [rad]; 0 at the onset.
        tilt_sd: its standard deviation [rad].
        turn_rate: of a slide, by how much the object turned for each metre that the contact went
            along the force, counter-clockwise [rad/m]; None if that was not measured.
        turn_rate_sd: its standard deviation [rad/m].
        normal: of a slip, the outward unit normal of the touched face in B.
        repetition: number of the repetition of the experiments that it belongs to.
        source: what to call it in messages, such as `row 3` or `tilt at the front, 8°`.
    """

    moved: Moved
    point: Vector
    force: Vector
    force_sd: float
    tilt: float = 0.0
    tilt_sd: float = 0.0
    turn_rate: float | None = None
    turn_rate_sd: float | None = None
    normal: Vector | None = None
    repetition: int = 0
    source: str = "a trial"


@dataclass(frozen=True)
class Statistics:
    """A line of the paper's Table I.

    Attributes:
        mean: over the repetitions.
        sd: standard deviation of one repetition; None of a single one.
        percent: the same in per cent of the mean.
        least: smallest value.
        most: largest value.
        n: number of repetitions with a value.
    """

    mean: float
    sd: float | None
    percent: float | None
    least: float
    most: float
    n: int


@dataclass(frozen=True)
class Touches:
    """Trials as arrays.

    Attributes:
        kind: what gave way, shape (n,).
        p: contact points in B, shape (n, 3) [m].
        u: directions of the forces in B, shape (n, 3).
        size: sizes of the forces, shape (n,) [N].
        size_sd: their standard deviations [N].
        tilt: tilts, shape (n,) [rad].
        tilt_sd: their standard deviations [rad].
        turn: turn rates of slides, nan if not measured, shape (n,) [rad/m].
        turn_sd: their standard deviations [rad/m].
        ratio: tangential over normal force of slips, nan of others, shape (n,).
        ratio_sd: their standard deviations.
        sources: what the trials are called.
    """

    kind: NDArray[np.str_]
    p: Array
    u: Array
    size: Array
    size_sd: Array
    tilt: Array
    tilt_sd: Array
    turn: Array
    turn_sd: Array
    ratio: Array
    ratio_sd: Array
    sources: tuple[str, ...]

    @classmethod
    def from_trials(cls, trials: Sequence[Trial]) -> Touches:
        """Arrays of some trials.

        Raises:
            ModelError: `no_trials`; `bad_trial` if one makes no sense.
        """
        if not trials:
            raise ModelError("no_trials", "there is no trial to learn from")
        for trial in trials:
            _require_sense(trial)
        force = np.array([trial.force for trial in trials])
        size = np.linalg.norm(force, axis=1)
        ratios = np.array([_slip_ratio(trial) for trial in trials])
        rates = [(trial.turn_rate, trial.turn_rate_sd) for trial in trials]
        return cls(
            kind=np.array([trial.moved for trial in trials]),
            p=np.array([trial.point for trial in trials]),
            u=force / size[:, None],
            size=size,
            size_sd=np.array([trial.force_sd for trial in trials]),
            tilt=np.array([trial.tilt for trial in trials]),
            tilt_sd=np.array([trial.tilt_sd for trial in trials]),
            turn=np.array([np.nan if rate is None else rate for rate, _ in rates]),
            turn_sd=np.array([TURN_RATE_SD if sd is None else sd for _, sd in rates]),
            ratio=ratios[:, 0],
            ratio_sd=ratios[:, 1],
            sources=tuple(trial.source for trial in trials),
        )


def _require_sense(trial: Trial) -> None:
    figures = (*trial.point, *trial.force, trial.force_sd, trial.tilt, trial.tilt_sd,
               trial.turn_rate or 0.0, trial.turn_rate_sd or 0.0)  # fmt: skip
    wrong = None
    if not np.isfinite(figures).all():
        wrong = "has a figure that is no number"
    elif not any(trial.force):
        wrong = "has no force"
    elif trial.force_sd <= 0.0 or trial.tilt_sd < 0.0 or trial.turn_rate_sd == 0.0:
        wrong = "needs positive standard deviations"
    elif trial.moved == "slip" and (trial.normal is None or _slip_ratio(trial)[0] <= 0.0):
        wrong = "is a slip, which needs the face's normal and a force that presses on it aslant"
    elif trial.moved != "slip" and not any(trial.force[:2]):
        wrong = "has a vertical force, which neither slides nor tilts anything"
    if wrong:
        raise ModelError("bad_trial", f"{trial.source} {wrong}")


def _slip_ratio(trial: Trial) -> tuple[float, float]:
    """Tangential over normal force of a slip, and its standard deviation."""
    if trial.moved != "slip" or trial.normal is None:
        return np.nan, np.nan
    force, normal = np.array(trial.force), np.array(trial.normal)
    pressing = float(-force @ normal)
    if pressing <= 0.0:
        return 0.0, np.nan
    ratio = float(np.linalg.norm(force + pressing * normal)) / pressing
    return ratio, trial.force_sd / pressing * float(np.hypot(1.0, ratio))

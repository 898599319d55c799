"""Trials that a given object would show, with noise or without."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from objectmodels import BoxModel, ObjectModel
from objectmodels.identification import Trial
from objectmodels.identification.measurement_model import Balance, topple_force

TRUTH = BoxModel(
    name="b", size=(0.09, 0.09, 0.23), mass=1.06, friction=0.345, finger_friction=0.7,
    com=(0.003, -0.002, 0.08), support="corners",
)  # fmt: skip
BELIEF = TRUTH.model_copy(
    update={"mass": 1.5, "mass_sd": 0.4, "friction": 0.25, "friction_sd": 0.1,
            "finger_friction": 0.6, "finger_friction_sd": 0.1, "friction_radius": 0.05,
            "com": (0.0, 0.0, 0.115), "com_sd": (0.003, 0.003, 0.03)}
)  # fmt: skip
"""What is believed of it: wrong."""

FORCE_SD, TILT_SD, TURN_SD = 0.02, 0.002, 0.3
SIDES = {"front": (-1.0, 0.0), "back": (1.0, 0.0), "right": (0.0, -1.0), "left": (0.0, 1.0)}


def tilt(side: str = "front", angle: float = 0.0) -> Trial:
    """A tilt by a push on one side, 1 cm below the top."""
    x, y = SIDES[side]
    return Trial(
        "topple", (0.045 * x, 0.045 * y, 0.22), (-x, -y, 0.0), FORCE_SD, tilt=angle,
        tilt_sd=TILT_SD if angle else 0.0, source=f"tilt at the {side}, {angle}",
    )  # fmt: skip


def slide(off: float = 0.0, turn: bool = True) -> Trial:
    """A slide by a push on the front, `off` metres from its middle."""
    return Trial(
        "slide", (-0.045, off, 0.02), (1.0, 0.0, 0.0), FORCE_SD, turn_rate=0.0 if turn else None,
        turn_rate_sd=TURN_SD if turn else None, source=f"slide at {off}",
    )  # fmt: skip


def slip() -> Trial:
    """A finger that slips up the front."""
    return Trial(
        "slip", (-0.045, 0.0, 0.1), (0.8, 0.0, 0.6), FORCE_SD, normal=(-1.0, 0.0, 0.0),
        source="slip",
    )  # fmt: skip


def everything(times: int = 2) -> list[Trial]:
    """Trials that tell all parameters."""
    tilts = [tilt(side, angle) for side in SIDES for angle in (0.0, 0.12)]
    return times * [*tilts, *(2 * [slide(off) for off in (0.0, 0.03, -0.03)]), slip(), slip()]


def touched(
    model: ObjectModel,
    plan: Iterable[Trial],
    *,
    seed: int | None = None,
    exact: bool = False,
    spread: float = 0.0,
    noise: float = 1.0,
    gain: float = 1.0,
) -> list[Trial]:
    """What the trials of a plan would show.

    Args:
        model: the truth.
        plan: trials whose figures are not yet known.
        seed: of the noise; none if not given.
        exact: whether slides are those of the exact tier.
        spread: relative standard deviation of friction from slide to slide.
        noise: how much larger the noise is than stated.
        gain: factor of all forces felt.
    """
    plan = list(plan)
    balance = Balance(model, plan, exact=exact)
    shown = balance.linear_predictions(model.means).predicted
    rng = np.random.default_rng(seed)
    loud = 0.0 if seed is None else noise
    turned = dict(zip(balance.trial[balance.turns], shown[balance.turns], strict=True))
    trials = []
    for i, trial in enumerate(plan):
        error = loud * trial.force_sd * rng.standard_normal()
        if trial.moved == "slip":
            pressing = 4.0
            across = pressing * shown[i] + np.hypot(1.0, shown[i]) * error
            trials.append(replace(trial, force=(pressing, 0.0, float(across))))
            continue
        size = shown[i]
        if trial.moved == "slide":
            size *= 1.0 + (spread * rng.standard_normal() if seed is not None else 0.0)
        if trial.tilt_sd:
            angle = np.array([trial.tilt + loud * trial.tilt_sd * rng.standard_normal()])
            t, one = balance.touches, slice(i, i + 1)
            size = topple_force(
                model.base, balance.normals[one], t.p[one], t.u[one], angle, model.means
            ).item()
        force = gain * (size + error) * balance.touches.u[i]
        rate = None
        if trial.turn_rate is not None and trial.turn_rate_sd is not None:
            rate = float(turned[i] + loud * trial.turn_rate_sd * rng.standard_normal())
        x, y, z = force.tolist()
        trials.append(replace(trial, force=(x, y, z), turn_rate=rate))
    return trials

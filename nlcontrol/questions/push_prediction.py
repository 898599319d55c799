"""Prediction of one push, in words and as data, and how well its forces are known.

Model of the deviations: a threshold is taken as linear in the uncertain parameters over one
standard deviation, so its variance is dᵀ C d with C the correlations of the parameters and d_i half
the difference of the threshold at ±1 standard deviation of parameter i. All numbers are those of
the exact tier. Frame B.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict

from nlcontrol.errors import error
from nlcontrol.json_document import Document, finite_or_none
from nlcontrol.text_format import aside_text
from objectmodels import Face, ObjectModel
from objectmodels.mechanics.outcome_probability import sample_at
from planner.problem.directions import HEADINGS, angle_between, heading_of
from planner.types.refusal import probability_text

# The direction of a push that is asked about: as a unit vector, and in words.


def unit_direction(direction: tuple[float, float, float]) -> np.ndarray:
    """A direction as a unit vector, shape (3,).

    Raises:
        ControlError: `bad_push` if it is none.
    """
    v = np.asarray(direction, dtype=np.float64)
    if v.shape != (3,) or not np.isfinite(v).all() or not v.any():
        raise error(
            "bad_push",
            f"{direction} is no direction",
            suggestions=("give three numbers of which one is not 0, like 1,0,0 for away",),
        )
    return np.asarray(v / np.linalg.norm(v))


def heading_text(heading: float) -> str:
    """A heading in words: the nearest name, and the angle off it."""
    off = {name: angle_between(heading, value) for name, value in HEADINGS.items()}
    name = min(off, key=lambda key: abs(off[key]))
    degrees = np.degrees(off[name])
    if abs(degrees) < 0.5:
        return name
    return f"{abs(degrees):.0f}° {'left' if degrees > 0 else 'right'} of '{name}'"


Array = NDArray[np.float64]

VERBS = {
    "none": "stays where it is",
    "slide": "slides",
    "topple": "topples",
    "slide+topple": "slides or topples, too close to call",
    "lift": "is lifted",
}


SURE = 0.95
"""Outcomes that are less probable than this are told to be unsure."""

CERTAIN = 1.959964
"""Standard deviations to either side that hold 95 % of a normal distribution."""


class AskedPush(BaseModel):
    """A push as it was asked for, in B.

    Attributes:
        face: that is touched, as it was named.
        lateral: along the face from its middle, to the right of who looks at it [m].
        height: above the table [m].
        point: the same place in B [m].
        direction: unit direction of the force in B.
        force: its size [N]; null if none was given.
        yaw: how B is turned from the robot's axes [rad].
    """

    model_config = ConfigDict(defer_build=True, frozen=True)

    face: str
    lateral: float
    height: float
    point: tuple[float, float, float]
    direction: tuple[float, float, float]
    force: float | None
    yaw: float = 0.0


class PushPrediction(Document):
    """Prediction of one push by the object model; SI units.

    Attributes:
        object: name of the model.
        push: the push.
        outcome: the most probable one at the given force, or at the onset if none is given: `none`,
            `slide` or `topple`.
        nominal: that of the parameters just as they are believed; `slide+topple` is a tie.
        onset: force at which it moves; null if it never does.
        slide, topple: force at which it slides, topples; null if never.
        slide_sd, topple_sd: standard deviations of these; null if it may never slide, topple, or if
            the friction is kinetic, whose deviation is not known.
        optimistic, pessimistic: onset if its weight is borne as well, as badly as can be; null if
            it never moves, or if its friction radius was fitted; the second also where it may bear
            on a single spot, on which any push would turn it.
        residual: relative violation of balance in the solution.
        probability: of each outcome under the model's uncertainty.
        suddenly: class if the force is applied at once; null without a force.
        slips: whether the finger slips along the face.
        motion: how it begins to move: `turning` [rad/m of the contact's travel, counter-clockwise],
            `heading` of the base's centre [rad], and the angle of no return for a topple; empty
            where the nominal outcome is another one.
        friction: which coefficient at the table decided.
        tier: `exact`.
        text: all of it in words.
    """

    object: str
    push: AskedPush
    outcome: str
    nominal: str
    onset: float | None
    slide: float | None
    topple: float | None
    slide_sd: float | None
    topple_sd: float | None
    optimistic: float | None
    pessimistic: float | None
    residual: float
    probability: dict[str, float]
    suddenly: str | None
    slips: bool
    motion: dict[str, float]
    friction: Literal["static", "kinetic"]
    tier: Literal["exact"] = "exact"
    text: str


def predict_push(
    model: ObjectModel,
    face_name: str,
    face: Face,
    *,
    lateral: float,
    height: float,
    direction: tuple[float, float, float] | None = None,
    force: float | None = None,
    friction: Literal["static", "kinetic"] = "static",
    yaw: float = 0.0,
) -> PushPrediction:
    """The prediction of a push at a place of a face.

    Args:
        model: what is believed about the object.
        face_name: how the face is called.
        face: the face.
        lateral: along the face from its middle, to the right of who looks at it [m].
        height: above the table [m].
        direction: of the force in B; straight into the face if not given.
        force: its size [N]; the class at the onset is told if not given.
        friction: which coefficient at the table decides.
        yaw: how the object is turned from the robot's axes, for the directions in words [rad].

    Raises:
        ControlError: `bad_push` if the place is not on the face, or the force does not press on it.
    """
    point, normal = _place(face_name, face, lateral, height)
    u = -normal if direction is None else unit_direction(direction)
    if u @ normal >= 0.0:
        raise error(
            "bad_push",
            f"that force does not press on the {face_name} face",
            suggestions=("leave the direction out: it is then straight in",),
        )
    push = AskedPush(
        face=face_name,
        lateral=lateral,
        height=height,
        point=_triple(point),
        direction=_triple(u),
        force=force,
        yaw=yaw,
    )
    found = _prediction_text(model, push, point[None], u[None], normal, friction)
    return found.model_copy(update={"text": "\n".join(_sentences(found))})


def _place(
    face_name: str, face: Face, lateral: float, height: float
) -> tuple[np.ndarray, np.ndarray]:
    """Point and outward normal of a place that must be on the face."""
    if not bool(face.contains(lateral, height)):
        raise error(
            "bad_push",
            f"{1e3 * lateral:z.0f} mm, {1e3 * height:.0f} mm is not on the {face_name} face",
            suggestions=(
                f"it reaches {1e3 * face.width / 2:.0f} mm to either side and from "
                f"{1e3 * face.bottom:.0f} to {1e3 * face.top:.0f} mm in height",
            ),
        )
    return face.points_at(lateral, height)


def _prediction_text(
    model: ObjectModel,
    push: AskedPush,
    p: np.ndarray,
    u: np.ndarray,
    normal: np.ndarray,
    friction: Literal["static", "kinetic"],
) -> PushPrediction:
    """All that the model says of one push, but for the words."""
    t: Any = model.thresholds(p, u, exact=True, friction=friction)
    believed = model.model_copy(update={"friction": model.friction_coefficient(friction)})
    likely = believed.likelihood(p, u, force=push.force, exact=True)
    onset, force = float(t.onset[0]), push.force
    probability = {name: getattr(likely, name).item() for name in ("none", "slide", "topple")}
    outcome = max(probability, key=probability.__getitem__)
    nominal = "none" if force is not None and force < onset else str(t.outcome[0])
    slide_sd, topple_sd = deviations(model, p[0], u[0])
    size = force if force is not None else (onset if np.isfinite(onset) else 1.0)
    return PushPrediction(
        object=model.name,
        push=push,
        outcome=outcome,
        nominal=nominal,
        onset=finite_or_none(onset),
        slide=finite_or_none(t.slide[0]),
        topple=finite_or_none(t.topple[0]),
        slide_sd=slide_sd if friction == "static" else None,
        topple_sd=topple_sd,
        optimistic=None if t.fitted else finite_or_none(t.optimistic[0]),
        # Of an even pressure it is nothing: such a base may bear on a single spot.
        pessimistic=None if t.fitted else finite_or_none(t.pessimistic[0]) or None,
        residual=float(t.residual[0]),
        probability=probability,
        suddenly=None if force is None else str(model.sudden(p, force * u).outcome[0]),
        slips=bool(model.is_slipping(normal[None], size * u)[0]),
        motion=_motion(model, t) if outcome == nominal else {},
        friction=friction,
        text="",
    )


def _motion(model: ObjectModel, t: Any) -> dict[str, float]:
    """Beginning of the motion."""
    twist = t.twist[0]
    if np.isnan(twist).any():
        return {}
    if t.outcome[0] == "topple":
        n = np.append(t.tipping_normal[0], 0.0)
        return {"heading": heading_of(n), "angle_of_no_return": model.angle_of_no_return(n)}
    return {"heading": heading_of(twist[3:]), "turning": float(twist[2])}


def _sentences(found: PushPrediction) -> list[str]:
    push = found.push
    how = "" if push.force is None else f" with {push.force:g} N"
    aside = aside_text(push.lateral) or "in the middle"
    lines = [
        f"Pushed on the {push.face} face, {aside}, {1e3 * push.height:.0f} mm up, "
        f"{_towards(push)}{how}, the {found.object} {VERBS[found.outcome]}."
    ]
    first, other = in_turn(found)
    lines.append(f"It {threshold(found, first)}; it {threshold(found, other)}.")
    if found.nominal != found.outcome:
        lines.append(
            f"Just as it is believed it {VERBS[found.nominal]}; over all that it may be, "
            f"it more probably {VERBS[found.outcome]}."
        )
    chance = found.probability[found.outcome]
    if chance < SURE:
        lines.append(f"That is not sure: its probability is {probability_text(chance)}.")
    if found.optimistic is not None:
        low, high = found.pessimistic, found.optimistic
        if low is None:
            lines.append(f"However it stands, it moves from {high:.2f} N on.")
        elif high > 1.005 * low:
            lines.append(
                f"It moves between {low:.2f} N and {high:.2f} N, depending on how it stands."
            )
    lines.append(
        "Probabilities: "
        + ", ".join(f"{k} {probability_text(v)}" for k, v in found.probability.items())
        + "."
    )
    lines += particulars(found)
    lines.append(f"({found.friction} friction; exact tier, residual {found.residual:.0e})")
    return lines


def particulars(found: PushPrediction) -> list[str]:
    """Sentences on the motion, on a finger that slips, and on a force that comes all at once."""
    lines = _moving(found)
    if found.slips:
        lines.append("The finger slips along the face: the force is outside its friction cone.")
    if found.suddenly is not None:
        lines.append(f"If the force comes all at once, it {VERBS[found.suddenly]}.")
    return lines


def in_turn(found: PushPrediction) -> tuple[str, str]:
    """The outcome that comes first, and the other one."""
    slide, topple = (np.inf if force is None else force for force in (found.slide, found.topple))
    return ("slide", "topple") if slide <= topple else ("topple", "slide")


def needed_force(found: PushPrediction, outcome: str) -> tuple[float | None, float | None]:
    """Force from which on an outcome would come, and its standard deviation; None if never [N]."""
    slides = outcome == "slide"
    return (found.slide, found.slide_sd) if slides else (found.topple, found.topple_sd)


def _two_digits(force: float, _: float | None) -> str:
    return f"{force:.2f} N"


def threshold(
    found: PushPrediction,
    outcome: str,
    told: Callable[[float, float | None], str] = _two_digits,
    *,
    only: bool = False,
) -> str:
    """When an outcome comes: "slides from 3.69 N on", or "never slides".

    Args:
        found: what will happen.
        outcome: `slide` or `topple`.
        told: a force and its standard deviation in words.
        only: say "only from", as of what comes second.
    """
    force, sd = needed_force(found, outcome)
    if force is None:
        return f"never {VERBS[outcome]}"
    return f"{VERBS[outcome]} {'only ' if only else ''}from {told(force, sd)} on"


def _moving(found: PushPrediction) -> list[str]:
    m = found.motion
    if not m:
        return []
    way = heading_text(m["heading"] + found.push.yaw)
    if "angle_of_no_return" in m:
        angle = np.degrees(m["angle_of_no_return"])
        return [f"It tips {way} and falls by itself beyond {angle:.1f}°."]
    turning = np.degrees(m["turning"]) / 100.0
    if abs(turning) < 0.05:
        return [f"It moves {way} without turning."]
    sense = "left" if turning > 0.0 else "right"
    return [
        f"It moves {way} and turns {sense}, {abs(turning):.1f}° for each centimetre of the finger."
    ]


def _towards(push: AskedPush) -> str:
    u = push.direction
    level = np.hypot(u[0], u[1])
    slope = np.degrees(np.arctan2(u[2], level))
    words = heading_text(heading_of(np.array(u)) + push.yaw) if level > 1e-9 else "straight"
    if abs(slope) < 0.5:
        return words
    return f"{words}, {abs(slope):.0f}° {'upwards' if slope > 0 else 'downwards'}"


def _triple(v: np.ndarray) -> tuple[float, float, float]:
    x, y, z = (np.asarray(v) + 0.0).tolist()
    return x, y, z


def deviations(model: ObjectModel, p: Array, u: Array) -> tuple[float | None, float | None]:
    """Standard deviations of the forces that slide and that topple an object [N].

    Args:
        model: what is believed.
        p: contact point in B, shape (3,) [m].
        u: unit direction of the force in B, shape (3,).

    Returns:
        Of sliding and of toppling; None for what does not happen all over the parameters' range.
    """
    from objectmodels.exact.exact_thresholds import thresholds_of_sample

    shifts = np.diag(model.deviations)
    means = model.means + np.vstack((shifts, -shifts, np.zeros(len(shifts))))
    n, sample = len(means), sample_at(model, means)
    found = np.array(thresholds_of_sample(model, sample, np.tile(p, (n, 1)), np.tile(u, (n, 1))))
    high, low, nominal = found[:, : len(shifts)], found[:, len(shifts) : -1], found[:, -1]
    with np.errstate(invalid="ignore"):
        changes = np.where(model.deviations > 0.0, (high - low) / 2.0, 0.0)
    slide, topple = (
        None if np.isinf(never) else _root(d, model.correlation)
        for never, d in zip(nominal, changes, strict=True)
    )
    return slide, topple


def _root(d: Array, correlation: Array) -> float | None:
    """The root of dᵀ C d."""
    return float(np.sqrt(max(float(d @ correlation @ d), 0.0))) if np.isfinite(d).all() else None

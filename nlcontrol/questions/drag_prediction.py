"""Prediction of one drag: a fingertip that presses on top of an object and is led along it.

All numbers are those of the exact tier (`objectmodels.exact.top_drag`), by which drags
are planned, too. Frame B: the origin in the middle of the base, z up.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict

from nlcontrol.errors import error
from nlcontrol.json_document import Document, finite_or_none
from nlcontrol.questions.push_prediction import heading_text, unit_direction
from objectmodels import ObjectModel
from objectmodels.exact.top_drag import DragOutcome, drag_probability, top_drag
from planner.problem.directions import heading_of
from planner.types.refusal import probability_text

_VERBS: dict[DragOutcome, str] = {
    "drags": "goes along",
    "slips": "stays behind: the fingertip slips over it",
    "tips": "tips",
}


class AskedDrag(BaseModel):
    """A drag as it was asked for, in B.

    Attributes:
        point: the contact on the top face [m].
        direction: level unit direction along which the fingertip is led.
        press: force with which it presses down [N].
    """

    model_config = ConfigDict(defer_build=True, frozen=True)

    point: tuple[float, float, float]
    direction: tuple[float, float, float]
    press: float


class DragPrediction(Document):
    """Prediction of one drag by the object model; SI units.

    Attributes:
        object: name of the model.
        drag: the drag.
        outcome: of the parameters just as they are believed: `drags`, `slips` or `tips`.
        force: along the top with which it goes along [N].
        grip: most that the fingertip transmits [N].
        tips_at: force along the top from which on it tips [N]; null if it never does.
        turning: of the object if it goes along, counter-clockwise [rad/m of the fingertip's way].
        probability: with which it goes along under the model's uncertainty.
        friction: which coefficient at the table decided.
        tier: `exact`.
        text: all of it in words.
    """

    object: str
    drag: AskedDrag
    outcome: DragOutcome
    force: float
    grip: float
    tips_at: float | None
    turning: float
    probability: float
    friction: Literal["static", "kinetic"]
    tier: Literal["exact"] = "exact"
    text: str


def predict_drag(
    model: ObjectModel,
    at: tuple[float, float],
    *,
    press: float,
    direction: tuple[float, float, float] | None = None,
    friction: Literal["static", "kinetic"] = "static",
) -> DragPrediction:
    """The prediction of a drag from a place on top of an object.

    Args:
        model: what is believed about the object.
        at: x and y of the place in B [m].
        press: force with which the fingertip presses down [N].
        direction: level, in B, along which it is led; along x if not given.
        friction: which coefficient at the table decides.

    Raises:
        ControlError: `bad_push` if the place is on no level top, the direction is not level, or
            nothing presses.
    """
    u = unit_direction((1.0, 0.0, 0.0) if direction is None else direction)
    _require_drag(model, at, u, press)
    believed = model.model_copy(update={"friction": model.friction_coefficient(friction)})
    point = np.array([*at, model.top])
    found = top_drag(believed, point[None], u[None], press)
    grip, outcome = float(found.grip[0]), found.outcome[0].item()
    force = float(np.hypot(*found.force[0]))
    x, y, z = point.tolist()
    answer = DragPrediction(
        object=model.name,
        drag=AskedDrag(point=(x, y, z), direction=(float(u[0]), float(u[1]), 0.0), press=press),
        outcome=outcome,
        force=force,
        grip=grip,
        tips_at=finite_or_none(found.tip_ratio[0] * min(force, grip)),
        turning=float(found.turn[0]),
        probability=float(drag_probability(believed, point[None], u[None], press)[0]),
        friction=friction,
        text="",
    )
    return answer.model_copy(update={"text": "\n".join(_sentences(answer))})


def _require_drag(model: ObjectModel, at: tuple[float, float], u: np.ndarray, press: float) -> None:
    """Make sure that a fingertip presses on a level top and is led along it."""
    face = model.top_face
    if face is None or not face.contains(np.array([at]), 0.0):
        x, y = (1e3 * value for value in at)
        raise error(
            "bad_push",
            f"{x:z.0f} mm, {y:z.0f} mm is not on the top of the {model.name}",
            suggestions=("give x and y from the middle of its base, like 0,0",),
        )
    if abs(u[2]) > 0.0:
        raise error(
            "bad_push",
            "a fingertip that presses from above is led along the top, which is level",
            suggestions=("give 0 as the last number of the direction",),
        )
    if press <= 0.0:
        raise error(
            "bad_push",
            "a fingertip that draws something along presses on it",
            suggestions=("give more than 0 N",),
        )


def _sentences(found: DragPrediction) -> list[str]:
    drag = found.drag
    x, y, _ = (1e3 * value for value in drag.point)
    way = heading_text(heading_of(np.array(drag.direction)))
    lines = [
        f"Pressed with {drag.press:g} N on its top, at {x:z.0f} mm, {y:z.0f} mm, and led {way}, "
        f"the {found.object} {_VERBS[found.outcome]}.",
        f"To go along takes {found.force:.2f} N along its top; the fingertip transmits "
        f"{found.grip:.2f} N.",
    ]
    if found.tips_at is not None:
        lines.append(f"It tips from {found.tips_at:.2f} N on.")
    # A turn is told from 5° a metre on, as of pushes.
    if abs(found.turning) >= np.radians(5.0):
        sense, rate = ("left" if found.turning > 0.0 else "right"), abs(found.turning)
        lines.append(f"It turns {sense}, {np.degrees(rate) / 100.0:.1f}° for each centimetre.")
    chance = probability_text(found.probability)
    lines.append(f"The probability that it goes along is {chance}.")
    lines.append(f"({found.friction} friction; exact tier)")
    return lines

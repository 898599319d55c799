"""A drag in words: an object that a fingertip presses from above and draws along."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from nlcontrol.text_format import quantity
from planner.problem.directions import phrase
from planner.types.refusal import probability_text

if TYPE_CHECKING:
    from planner.types.actions import Push, PushAction


def drag_text(push: Push, extent: str) -> str:
    """One drag in words: which way, pressed how hard, how fast, and how far, in words."""
    x, y, _ = push.direction_W
    return (
        f"draw the {push.object} {phrase(math.atan2(y, x))}, pressed from above with "
        f"{quantity(push.press, 'N')} by one finger, at {quantity(push.speed, 'm/s')} {extent}"
    )


def drag_prediction(push: PushAction) -> str:
    """Prediction of a drag."""
    p = push.prediction
    return (
        f"it goes along (probability {probability_text(p.probability)}), which takes "
        f"{quantity(p.onset, 'N')} along its top."
    )


def drag_safety(push: PushAction) -> str:
    """Force that is left before the fingertip slips."""
    return (
        f"the fingertip would slip over it with {quantity(push.margins.force, 'N')} more, as it is "
        "believed to be; that is seen, and ends it."
    )


def drag_reason(push: PushAction, way: str) -> str:
    """Reason why an object goes along on its way, which is given in words."""
    return (
        f"Pressed from above with {quantity(push.press, 'N')}, the {push.object} {way} with the "
        f"fingertip: that takes {quantity(push.prediction.onset, 'N')} along its top, and the "
        f"fingertip slips only with {quantity(push.margins.force, 'N')} more."
    )

"""Reasons why a motion ends: each with its words, and what follows from it.

One row for each reason; what is tried again, what a push shows of its object and what contradicts
its prediction is read from here. What ends a motion for a reason is a guard (`sim.control.guards`)
or the law of its controller.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple, get_args

if TYPE_CHECKING:
    from objectmodels.identification import Moved

EndReason = Literal[
    "stroke",
    "turned",
    "returned",
    "event",
    "reached",
    "toppled",
    "force",
    "speed",
    "tilted",
    "slid",
    "turned_off",
    "too_close",
    "lost",
    "duration",
    "guard",
    "no_touch",
    "unreachable",
    "handled",
    "no_grasp",
    "slipped",
    "missed",
    "nudged",
    "stopped",
]


class Ended(NamedTuple):
    """How a motion ended: the reason, and why in words."""

    end: EndReason
    detail: str


@dataclass(frozen=True)
class EndMeaning:
    """The meaning of a reason to end.

    Attributes:
        words: what happened.
        is_planned: it is as it was meant.
        is_of_hand: only a whole hand ends so.
        elsewhere: a push is tried at another contact, where there is one.
        once_more: the hand tries once more, if it may.
        contradicts: why the prediction of a push was wrong; None if it may have been right.
        shows: how the object moved, or that it did not; None if that is not clear.
    """

    words: str
    is_planned: bool = False
    is_of_hand: bool = False
    elsewhere: bool = False
    once_more: bool = False
    contradicts: str | None = None
    shows: Moved | None = None


END_REASONS: Mapping[EndReason, EndMeaning] = {
    "stroke": EndMeaning("the stroke was travelled", is_planned=True, shows="slide"),
    "turned": EndMeaning("the object was seen to have turned by the asked angle", is_planned=True),
    "returned": EndMeaning(
        "it was tilted by the asked angle and stands on its base again", is_planned=True
    ),
    "event": EndMeaning("what the push was to last until has happened", is_planned=True),
    "reached": EndMeaning("nothing had to be done", is_planned=True),
    "toppled": EndMeaning(
        "the object was seen to pass its angle of no return", is_planned=True, shows="topple"
    ),
    "force": EndMeaning(
        "the force limit was reached and nothing moved any more",
        once_more=True,
        contradicts="it did not move with the force that was to be enough",
        shows="none",
    ),
    "speed": EndMeaning("the object or the finger became faster than allowed", elsewhere=True),
    "tilted": EndMeaning(
        "the object tilted where it was to slide",
        once_more=True,
        contradicts="it tilted where it was to slide",
        shows="topple",
    ),
    "slid": EndMeaning(
        "it slid where it was to tilt",
        contradicts="it slid where it was to tilt",
        shows="slide",
    ),
    "turned_off": EndMeaning("it turned where it was not to", elsewhere=True),
    "too_close": EndMeaning("it came too close to another object", elsewhere=True),
    "lost": EndMeaning("the fingertips lost the object", elsewhere=True, once_more=True),
    "duration": EndMeaning(
        "it took longer than it may, or than it should", elsewhere=True, once_more=True
    ),
    "guard": EndMeaning("another guard stopped the motion", elsewhere=True, once_more=True),
    "no_touch": EndMeaning(
        "the guarded approach ended without contact", elsewhere=True, once_more=True
    ),
    "unreachable": EndMeaning("the hand could not get there", elsewhere=True, once_more=True),
    "handled": EndMeaning("all steps of the hand were made", is_planned=True),
    "no_grasp": EndMeaning(
        "the fingers closed on nothing, or on less than they should",
        is_of_hand=True,
        once_more=True,
    ),
    "slipped": EndMeaning(
        "what was held slipped in the hand, or a fingertip over what it drew",
        is_of_hand=True,
        once_more=True,
        contradicts="the fingertip slipped over it",
        shows="slip",
    ),
    "missed": EndMeaning("the lid did not follow the finger", is_of_hand=True, once_more=True),
    "nudged": EndMeaning("another object was seen to be moved", is_of_hand=True, once_more=True),
    "stopped": EndMeaning("it was told to stop"),
}
"""What each reason means."""

assert tuple(END_REASONS) == get_args(EndReason), "every reason has a row"

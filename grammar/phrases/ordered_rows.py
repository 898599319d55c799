"""Rows in the order in which their things are named, and pairs that are to be so far apart.

Each but one stands beside the one that is named before it, so that the row is several clauses.
"""

from __future__ import annotations

import re
from functools import cache

_MOST = 6
"""Things in a row."""

_NO_ITEM = "(?!(?:and|in|into|from|with|left|right|then|next) )"
_ITEM = rf"({_NO_ITEM}[^ ,.;!?]+(?: {_NO_ITEM}[^ ,.;!?]+)*)"
_BESIDE = r"(?: ,|(?: ,)? and(?: then)?| ,? ?then) "
_VERB = (
    r"(?:(?:now|then|and|so|please|ok|right) (?:, )?)*(?:(?:please )?(?:put|place|arrange|set|"
    r"bring|get|move|have|i want|i would like|line up|set up|i would like to have) )?"
)
_ROW = r"(?:(?: ,)? (?:in|into) (?:a|one) (?:straight |neat |single )?(?:row|line))?"
_IN_ORDER = r"(?: ,)? in (?:that|this|the same|exactly that|exactly this) order"
_RIGHTWARD = (
    rf"(?:(?:{_IN_ORDER})?(?: ,)?(?: from)?(?: the)? left to (?:the )?right(?:{_IN_ORDER})?|"
    rf"{_IN_ORDER}(?:(?: ,)? (?:from|starting (?:on|at|from)) the left)?)"
)
_LEFTWARD = (
    rf"(?:(?:{_IN_ORDER})?(?: ,)?(?: from)?(?: the)? right to (?:the )?left(?:{_IN_ORDER})?|"
    rf"{_IN_ORDER}(?: ,)? (?:from|starting (?:on|at|from)) the right)"
)
_GAP = (
    r"(?:(?: ,)?(?: with| leaving)?(?: gaps of| a gap of)? ((?:\d|a |one |two |three |four |five |"
    r"six |seven |eight |nine |ten |twelve |fifteen |twenty )[^,.;!?]*?)(?: of space)? (?:gaps?|"
    r"apart|between (?:them|each|each of them|each other)|in between))"
)
_APART = re.compile(
    rf"^{_VERB}{_ITEM} and {_ITEM} (\d[^,.;!?]*?|(?:a|one|two|three|four|five|six|seven|eight|"
    r"nine|ten|twelve|fifteen|twenty) [^,.;!?]*?|further|farther)(?: away)? (?:apart(?: from "
    r"(?:each other|one another))?|from (?:each other|one another))(?: please)?$"
)
_HAND = "a hand's breadth"
_EVEN = r"(?:(?: ,)?(?: and)? (?:evenly|equally) spaced)?"
_END = r"(?: ,)?(?: please)?$"


def row_in_order(text: str) -> tuple[re.Match[str], str] | None:
    """The match of a row in a sentence that is one, and what it is put in; None if it is none."""
    if apart := _APART.match(text):
        if apart[3].startswith(("further", "farther")):
            return apart, "move {1} {3} away from {2}"
        by_hand = apart[3] in ("a hand", "a palm")
        return apart, f"put {{1}} {_HAND if by_hand else '{3}'} away from {{2}}"
    if "left" not in text and "right" not in text and " order" not in text:
        return None
    for count in range(_MOST, 2, -1):
        for pattern, means in _patterns(count):
            if row := pattern.match(text):
                return row, means
    return None


@cache
def _patterns(count: int) -> list[tuple[re.Pattern[str], str]]:
    """Templates of rows of so many things, and what each means."""
    things = _BESIDE.join([_ITEM] * count)
    return [
        (
            re.compile(f"^{_VERB}{things}{_ROW}{order}{gap or _EVEN}{_END}"),
            _clauses(count, way, gap),
        )
        for order, way in ((_RIGHTWARD, ("left", "right")), (_LEFTWARD, ("right", "left")))
        for gap in (_GAP, "")
    ]


def _clauses(count: int, sides: tuple[str, str], gap: str) -> str:
    """The clauses of a row: the second thing stays where it is."""
    far = f" {{{count + 1}}}" if gap else ""
    first = f"put {{1}}{far} to the {sides[0]} of {{2}}"
    rest = (
        f" , then put {{{k}}}{far} to the {sides[1]} of {{{k - 1}}}" for k in range(3, count + 1)
    )
    return first + "".join(rest)

"""From a code and its numbers to a refusal."""

from __future__ import annotations

import math
import string
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from math import isfinite
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from planner.refusals.sentences import SENTENCES
from planner.types.refusal import NoPlanError, Refusal, RefusalReason, probability_text
from planner.types.world_state import (
    HeightMark,
    LengthMark,
    Mark,
    TiltMark,
    obstacle_mark,
    plain_vector,
)

if TYPE_CHECKING:
    from planner.types.robot import ReachAnswer


_About = Literal["topples", "slides", "asked", "reach"]
_HEIGHTS: dict[str, tuple[_About, str]] = {
    "critical_height": ("topples", "above {} it topples"),
    "critical_height_worst": ("slides", "below {} it is sure to slide"),
    "lowest_asked": ("asked", "{} and more are asked"),
    "highest_asked": ("asked", "up to {} are asked"),
    "lowest_height": ("reach", "the lowest contact is {}"),
    "highest_height": ("reach", "the highest contact is {}"),
    "lowest": ("reach", "it may be held from {} up"),
    "highest": ("reach", "it may be held up to {}"),
}


def length_mark(
    start_W: NDArray[np.float64],
    direction_W: NDArray[np.float64],
    length: float,
    text: str,
    asked: float | None = None,
) -> LengthMark:
    """The mark of a length from a point along a unit direction, both in W, shape (3,) [m]."""
    end_W = start_W + max(length, 0.0) * direction_W
    # To a hundredth of a millimetre.
    return LengthMark(
        start_W=plain_vector(start_W.round(5)),
        end_W=plain_vector(end_W.round(5)),
        asked=asked,
        text=text,
    )


def tilt_mark(
    name: str,
    edge_W: NDArray[np.float64],
    direction_W: NDArray[np.float64],
    angle: float,
    text: str,
) -> TiltMark:
    """The mark of an object that tips over a point of its edge (3,) along a horizontal direction.

    Args:
        name: of the object.
        edge_W: the point [m].
        direction_W: unit direction in which its top goes, shape (3,).
        angle: by which it is tipped [rad].
        text: what happens there.
    """
    axis_W = np.cross([0.0, 0.0, 1.0], direction_W)
    return TiltMark(
        object=name,
        edge_W=plain_vector(edge_W.round(5)),
        axis_W=plain_vector(axis_W.round(5)),
        angle=angle,
        text=text,
    )


Spans = tuple[tuple[int, int], ...]


def _floor(value: float) -> int:
    """The largest whole number below, but for what comes of binary fractions."""
    return math.floor(value + 1e-6)


QUANTITIES: dict[str, Callable[[float], str]] = {
    "mm": lambda length: f"{1e3 * length:z.0f} mm",
    "mm_down": lambda length: f"{10 * _floor(100 * length)} mm",
    "deg": lambda angle: f"{math.degrees(abs(angle)):.0f}°",
    "deg1": lambda angle: f"{math.degrees(angle):z.1f}°",
    "deg_exact": lambda angle: f"{math.degrees(angle):z.1f}°".replace(".0°", "°"),
    "deg_floor": lambda angle: f"{math.floor(10.0 * math.degrees(angle)) / 10.0:g}°",
    "mm/s": lambda speed: f"{1e3 * speed:z.0f} mm/s",
    "mm/s_down": lambda speed: f"{_floor(1000 * speed)} mm/s",
    "N": lambda force: f"{force:z.1f} N",
    "N2": lambda force: f"{force:z.2f} N",
    "N_down": lambda force: f"{math.floor(10.0 * force) / 10.0:g} N",
    "N_up": lambda force: f"{math.ceil(2.0 * force) / 2.0:g} N",
    "Nm": lambda torque: f"{torque:.3f} N·m",
    "s": lambda time: f"{time:.1f} s",
    "s_up": lambda time: f"{math.ceil(2.0 * time) / 2.0:g} s",
    "kg": lambda mass: f"{mass:.2f} kg",
    "ml": lambda volume: f"{1e6 * volume:.0f} ml",
    "ml_down": lambda volume: f"{_floor(1e6 * volume)} ml",
    "chance": probability_text,
    "share": lambda share: f"{share:.2f}",
    "times": lambda factor: f"{factor:.1f} times",
    "count": lambda number: f"{number:.0f}",
}
"""How people read a number in SI units, by what stands behind the colon."""


class _Formatter(string.Formatter):
    def format_field(self, value: object, format_spec: str) -> str:
        """One number or word of a sentence."""
        if format_spec:
            assert isinstance(value, float | int), f"{value!r} is no number"
            if not isfinite(value):
                return "more than any" if value > 0.0 else "an unknown amount"
            return QUANTITIES[format_spec](value)
        return str(value)


def filled_in(text: str, values: Mapping[str, object]) -> str:
    """A sentence with its words and numbers."""
    return _Formatter().vformat(text, (), values)


def refusal(
    code: str,
    numbers: Mapping[str, float] | None = None,
    *,
    spans: Spans = (),
    reason: RefusalReason | None = None,
    instead: tuple[str, ...] = (),
    marks: tuple[Mark, ...] = (),
    **words: object,
) -> Refusal:
    """Refusal in the words of its code.

    Args:
        code: in `SENTENCES`.
        numbers: that decide, by name [SI].
        spans: the words that cannot be satisfied.
        reason: the kind of obstacle, where it is not that of the code.
        instead: what would be possible, where it is not that of the code.
        marks: of numbers that the other words do not place.
        words: other words and numbers of the sentence.
    """
    said, values = SENTENCES[code], {**(numbers or {}), **words}
    numbers = {name: each for name, each in (numbers or {}).items() if isfinite(each)}
    return Refusal(
        code=code,
        reason=reason or said.reason,
        message=filled_in(said.text, values),
        numbers=numbers,
        capability=said.capability and filled_in(said.capability, values),
        spans=spans,
        suggestions=instead or _suggestions(said.instead, values),
        marks=(*marks, *_marks(said.reason, numbers, values)),
    )


def _suggestions(instead: tuple[str, ...], values: Mapping[str, object]) -> tuple[str, ...]:
    """Phrases of what would be possible; what takes an amount that nobody has is not."""
    endless = {n for n, each in values.items() if isinstance(each, float) and not isfinite(each)}
    parsed = ((one, {name for _, name, _, _ in _Formatter().parse(one)}) for one in instead)
    return tuple(filled_in(one, values) for one, names in parsed if not names & endless)


def _marks(
    reason: RefusalReason, numbers: Mapping[str, float], words: Mapping[str, Any]
) -> Iterator[Mark]:
    """Heights on the object that a refusal is about, and what stands in the way."""
    if "object" in words:
        marked: set[float] = set()
        for key, (about, text) in _HEIGHTS.items():
            height = numbers.get(key, 0.0)
            if height > 0.0 and height not in marked:
                marked.add(height)
                length = f"{1e3 * height:.0f} mm"
                yield HeightMark(
                    object=words["object"], height=height, about=about, text=text.format(length)
                )
    other = words.get("blocker") or (words.get("other") if reason == "blocked" else None)
    if other is not None:
        yield obstacle_mark(other)


def not_capable(capability: str, message: str, spans: Spans, *instead: str) -> NoPlanError:
    """Dead end because this robot, or this version, lacks a capability."""
    return no_plan(
        "not_capable", spans=spans, instead=instead, capability=capability, message=message
    )


def unsupported_while(what: str, doing: str, spans: Spans) -> NoPlanError:
    """Dead end because no hand of this version does something meanwhile."""
    return no_plan("not_while", spans=spans, what=what, doing=doing)


def no_plan(
    code: str, numbers: Mapping[str, float] | None = None, *, spans: Spans = (), **words: Any
) -> NoPlanError:
    """Dead end in the words of its code; see `refusal`."""
    return NoPlanError(refusal(code, numbers, spans=spans, **words))


def no_push_reached(
    name: str, answers: Sequence[ReachAnswer], spared: Collection[str]
) -> NoPlanError:
    """Dead end since contacts exist on an object, but the hand gets to none of them."""
    last, words = _obstacle(answers, spared, object=name)
    numbers = {"ways": float(len(answers)), **last.numbers}
    return no_plan(_code(words, "pushes_blocked", "no_push_reached"), numbers, **words)


def search_given_up(
    name: str, answers: Sequence[ReachAnswer], spared: Collection[str]
) -> NoPlanError:
    """Dead end since the search ended before the hand could make a whole way."""
    failed = [answer for answer in answers if not answer.ok]
    _, words = _obstacle(failed, spared, object=name)
    numbers = {"looks": float(len(answers)), "out_of_reach": float(len(failed))}
    code = "search_blocked" if words["blocker"] else "search_given_up"
    return NoPlanError(no_plan(code, numbers, **words).refusal, ends_search=True)


def no_grasp_reached(
    doing: str, name: str, answers: Sequence[ReachAnswer], spared: Collection[str], *, held: bool
) -> NoPlanError:
    """Dead end since there are ways with a whole hand, but it cannot make them."""
    last, words = _obstacle(answers, spared, object=name, doing=doing)
    code = _code(words, "grasps_blocked", "no_grasp_reached")
    if held:
        code = _code(words, "blocked_in_hand", "no_reach_in_hand")
    one = len(answers) == 1
    return no_plan(
        code,
        {"ways": float(len(answers)), **last.numbers},
        are="is" if one else "are",
        number="one way" if one else f"{len(answers)} ways",
        **words,
    )


def _code(words: dict[str, Any], blocked: str, beyond: str) -> str:
    return blocked if words["blocker"] else "no_way_past" if words["other"] else beyond


def _obstacle(
    answers: Sequence[ReachAnswer], spared: Collection[str], **words: Any
) -> tuple[ReachAnswer, dict[str, Any]]:
    """The first answer that names an obstacle, else the nearest miss; and the words of a refusal.

    What is spared stays where it is, since the sentence tells a place by it: that it is met, as
    `other`, is no more than that no way was found past it.
    """
    met = [each for each in answers if each.reason == "obstacle" and each.blocker]
    found = next((each for each in met if each.blocker not in spared), None)
    last = found or min(answers, key=lambda each: each.numbers.get("lacks", 0.0))
    other = met[0].blocker if met and not found else None
    return last, {**words, "last": last.message, "blocker": found and found.blocker, "other": other}


# Account of a search that found nothing: what was tried, and that it proves nothing.
#
# What is `impossible` follows from the physics of the object, whatever hand pushes it. Where the
# hand does not get, a sample of its postures was looked at: another one may still get there.


def with_account(refusal: Refusal, answers: Collection[ReachAnswer], work: int) -> Refusal:
    """The refusal with what was tried, if it is one of a search for what the hand can do.

    Args:
        refusal: why there is no plan.
        answers: of the robot, each to another question.
        work: units of work that were done.
    """
    if refusal.reason not in ("out_of_reach", "blocked", "out_of_time") or not answers:
        return refusal
    ways, postures = len(answers), sum(answer.postures for answer in answers)
    among = f"{ways} ways of the hand" + (f" in {postures} postures" if postures else "")
    account = (
        f"{refusal.message}; none was found among {among} ({work} units of work), which does not "
        "prove that there is none"
    )
    counted = {"tried_ways": ways, "tried_postures": postures, "tried_work": work}
    tried = {name: float(count) for name, count in counted.items()}
    return refusal.model_copy(update={"message": account, "numbers": {**refusal.numbers, **tried}})

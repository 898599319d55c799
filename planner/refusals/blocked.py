"""What a stage of planning returns where it goes no further, and how that becomes a refusal.

A stage names a row of the table of sentences and gives the numbers and names that decide. Most dead
ends of a search are never told; the one that is gets its words here, once.
"""

from __future__ import annotations

import math
import string
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from typing import Any, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from planner.refusals.sentences import FACTS, REACH, SENTENCES
from planner.types.cure import Cure
from planner.types.refusal import Refusal, RefusalReason, probability_text
from planner.types.robot import ReachAnswer
from planner.types.world_state import (
    HeightMark,
    LengthMark,
    Mark,
    TiltMark,
    obstacle_mark,
    plain_vector,
)

Spans = tuple[tuple[int, int], ...]
MadeT = TypeVar("MadeT")


@dataclass(frozen=True, eq=False)
class Blocked:
    """Why a stage of planning goes no further.

    Attributes:
        key: of its row in `SENTENCES`.
        reason: the kind of obstacle.
        numbers: that decide, by name [SI].
        words: names, and other numbers of the sentence.
        spans: the words that cannot be satisfied.
        cures: what would do instead, its names and numbers still in braces.
        obstacles: names of what stands in the way.
        marks: of numbers that heights and obstacles do not place.
        facts: keys of `FACTS` with which the sentence goes on.
    """

    key: str
    reason: RefusalReason
    numbers: Mapping[str, float]
    words: Mapping[str, Any]
    spans: Spans
    cures: tuple[Cure, ...]
    obstacles: tuple[str, ...]
    marks: tuple[Mark, ...] = ()
    facts: tuple[str, ...] = ()

    @property
    def code(self) -> str:
        """Stable name of what decides."""
        return self.key.partition(".")[0]

    @property
    def sentence(self) -> str:
        """Reason in one plain sentence, with the deciding numbers."""
        texts = [SENTENCES[self.key].text, *(FACTS[fact].text for fact in self.facts)]
        return "; ".join(filled_in(text, self._values) for text in texts)

    def with_fact(self, fact: str, numbers: Mapping[str, float], **words: Any) -> Blocked:
        """The same with one more fact, whose cures come first."""
        return replace(
            self,
            numbers={**self.numbers, **numbers},
            words={**self.words, **words},
            cures=(*FACTS[fact].cures, *self.cures),
            facts=(*self.facts, fact),
        )

    @property
    def refusal(self) -> Refusal:
        """The refusal in words."""
        capability, values = SENTENCES[self.key].capability, self._values
        numbers = {name: each for name, each in self.numbers.items() if isfinite(each)}
        # Nothing is suggested with an amount that nobody has.
        endless = {
            n for n, each in values.items() if isinstance(each, float) and not isfinite(each)
        }
        cures = tuple(
            replace(
                cure, text=filled_in(cure.text, values), command=filled_in(cure.command, values)
            )
            for cure in self.cures
            if endless.isdisjoint(name for _, name, _, _ in _Formatter().parse(cure.text))
        )
        return Refusal(
            code=self.code,
            reason=self.reason,
            message=self.sentence,
            numbers=numbers,
            capability=capability and filled_in(capability, values),
            spans=self.spans,
            suggestions=tuple(cure.text for cure in cures),
            marks=(
                *self.marks,
                *_height_marks(self.words.get("object"), numbers),
                *map(obstacle_mark, self.obstacles),
            ),
            cures=cures,
        )

    @property
    def _values(self) -> dict[str, Any]:
        return {**self.numbers, **self.words}


class SearchEndedError(Exception):
    """The search has used up what it may take, so that nothing else is worth trying.

    Attributes:
        blocked: what it ended in.
    """

    def __init__(self, blocked: Blocked) -> None:
        super().__init__(blocked.code)
        self.blocked = blocked


def dead_end(
    key: str,
    numbers: Mapping[str, float] | None = None,
    *,
    spans: Spans = (),
    reason: RefusalReason | None = None,
    marks: tuple[Mark, ...] = (),
    obstacles: tuple[str, ...] = (),
    **words: Any,
) -> Blocked:
    """A dead end in the words of a row.

    Args:
        key: of the row in `SENTENCES`.
        numbers: that decide, by name [SI].
        spans: the words that cannot be satisfied.
        reason: the kind of obstacle, where it is not that of the row.
        marks: of numbers that the other words do not place.
        obstacles: names of what stands in the way, beside `blocker` and `other` of the words.
        words: other words and numbers of the sentence.
    """
    row = SENTENCES[key]
    other = words.get("blocker") or (words.get("other") if row.reason == "blocked" else None)
    met = obstacles if other is None else (*obstacles, other)
    return Blocked(key, reason or row.reason, numbers or {}, words, spans, row.cures, met, marks)


def first_made(ways: Iterable[MadeT | Blocked]) -> MadeT | Blocked:
    """The first of some ways that is not blocked; else why the first of them is.

    Ways are made one after the other, no more than it takes.
    """
    first: Blocked | None = None
    for made in ways:
        if not isinstance(made, Blocked):
            return made
        first = first or made
    assert first is not None, "there is a way, or a reason why there is none"
    return first


def all_made(ways: Iterable[MadeT | Blocked]) -> list[MadeT] | Blocked:
    """Those of some ways that are not blocked; if all are, why the first of them is."""
    made = list(ways)
    free = [each for each in made if not isinstance(each, Blocked)]
    return free or next(each for each in made if isinstance(each, Blocked))


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


def _floor(value: float) -> int:
    """The largest whole number below, but for what comes of binary fractions."""
    return math.floor(value + 1e-6)


QUANTITIES: dict[str, Callable[[float], str]] = {
    "mm": lambda length: f"{1e3 * length:z.0f} mm",
    "in_mm": lambda length: f"{1e3 * length:.0f}",
    "mm_down": lambda length: f"{10 * _floor(100 * length)} mm",
    "m": lambda length: f"{length:.2f} m",
    "deg": lambda angle: f"{math.degrees(abs(angle)):.0f}°",
    "deg1": lambda angle: f"{math.degrees(angle):z.1f}°",
    "deg_exact": lambda angle: f"{math.degrees(angle):z.1f}°".replace(".0°", "°"),
    "deg_floor": lambda angle: f"{math.floor(10.0 * math.degrees(angle)) / 10.0:g}°",
    "mm/s": lambda speed: f"{1e3 * speed:z.0f} mm/s",
    "mm/s_down": lambda speed: f"{_floor(1000 * speed)} mm/s",
    "N": lambda force: f"{force:z.1f} N",
    "N0": lambda force: f"{force:.0f} N",
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
        return reach_sentence(value) if isinstance(value, ReachAnswer) else str(value)


def filled_in(text: str, values: Mapping[str, object]) -> str:
    """A sentence with its words and numbers."""
    return _Formatter().vformat(text, (), values)


def reach_sentence(answer: ReachAnswer) -> str:
    """Why arm and hand do not carry something out, in one plain sentence; of a denial."""
    values = {**answer.numbers, **answer.words, "other": answer.blocker}
    return filled_in(REACH[answer.code], values)


def _height_marks(name: str | None, numbers: Mapping[str, float]) -> Iterator[Mark]:
    """Heights on the object that a refusal is about."""
    marked: set[float] = set()
    for key, (about, text) in _HEIGHTS.items() if name is not None else ():
        height = numbers.get(key, 0.0)
        if height > 0.0 and height not in marked:
            marked.add(height)
            length = f"{1e3 * height:.0f} mm"
            yield HeightMark(object=name, height=height, about=about, text=text.format(length))


def no_push_reached(name: str, answers: Sequence[ReachAnswer], spared: Collection[str]) -> Blocked:
    """Dead end since contacts exist on an object, but the hand gets to none of them."""
    last, words = _obstacle(answers, spared, object=name)
    numbers = {"ways": float(len(answers)), **last.numbers}
    return dead_end(_key(words, "pushes_blocked", "no_push_reached"), numbers, **words)


def search_given_up(
    name: str, answers: Sequence[ReachAnswer], spared: Collection[str]
) -> SearchEndedError:
    """The end of a search before the hand could make a whole way."""
    failed = [answer for answer in answers if not answer.ok]
    _, words = _obstacle(failed, spared, object=name)
    numbers = {"looks": float(len(answers)), "out_of_reach": float(len(failed))}
    key = "search_blocked" if words["blocker"] else "search_given_up"
    return SearchEndedError(dead_end(key, numbers, **words))


def no_grasp_reached(
    doing: str, name: str, answers: Sequence[ReachAnswer], spared: Collection[str], *, held: bool
) -> Blocked:
    """Dead end since there are ways with a whole hand, but it cannot make them."""
    last, words = _obstacle(answers, spared, object=name, doing=doing)
    key = _key(words, "grasps_blocked", "no_grasp_reached")
    if held:
        key = _key(words, "blocked_in_hand", "no_reach_in_hand")
    one = len(answers) == 1
    return dead_end(
        key,
        {"ways": float(len(answers)), **last.numbers},
        are="is" if one else "are",
        number="one way" if one else f"{len(answers)} ways",
        **words,
    )


def _key(words: dict[str, Any], blocked: str, beyond: str) -> str:
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
    return last, {**words, "last": last, "blocker": found and found.blocker, "other": other}


# Account of a search that found nothing: what was tried, and that it proves nothing.
#
# What is `impossible` follows from the physics of the object, whatever hand pushes it. Where the
# hand does not get, a sample of its postures was looked at: another one may still get there.


def with_account(why: Blocked, answers: Collection[ReachAnswer], work: int) -> Blocked:
    """The dead end with what was tried, if it is one of a search for what the hand can do.

    Args:
        why: there is no plan.
        answers: of the robot, each to another question.
        work: units of work that were done.
    """
    if why.reason not in ("out_of_reach", "blocked", "out_of_time") or not answers:
        return why
    postures = sum(answer.postures for answer in answers)
    counted = {"tried_ways": len(answers), "tried_postures": postures, "tried_work": work}
    tried = {name: float(count) for name, count in counted.items()}
    return why.with_fact("tried" if postures else "tried.ways", tried)

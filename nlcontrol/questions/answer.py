"""The answer to a question as a value, and the words that answers are made of.

Values are SI inside; people read newtons, millimetres and chances.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from textwrap import shorten
from typing import TYPE_CHECKING, Annotated

from pydantic import Field
from pydantic.json_schema import SkipJsonSchema

from grammar.frames.command import Query
from nlcontrol.json_document import DocumentPart
from objectmodels.mechanics.outcome_map import OutcomeMap
from sim.robots.cell_description import AsItIs

if TYPE_CHECKING:
    from planner.affordances import Affordance


DOES = {
    "moves": "moves",
    "slides": "slides",
    "tips": "topples",
    "tilts": "tilts",
    "turns": "turns",
    "stays_upright": "stays upright",
    "slide": "slides",
    "topple": "topples",
    "holds": "stays where it is",
}
"""Events and outcomes as what "it" does."""


class Chart(DocumentPart):
    """Which outcome map shows an answer.

    Attributes:
        object: name in the scene.
        face: the face, as the robot calls it.
    """

    object: str
    face: str


class Considered(DocumentPart):
    """The push that a question is about.

    Attributes:
        face: the face, as the robot calls it.
        height: of the contact above the table [m]; None if the answer is about the whole face.
        lateral: to the right of the face's middle [m].
        heading: of the push in W [rad].
        force: of the push [N]; None if the question leaves it open.
    """

    face: str
    height: float | None
    lateral: float = 0.0
    heading: float
    force: float | None = None


class Answer(DocumentPart):
    """The answer to one question, or to a remark.

    Attributes:
        query: what kind of question it was; None if a remark is answered.
        text: the answer in one sentence.
        lines: what stands below it, one thing in each line.
        objects: of a question which one it is, or which ones can, their names in the scene.
        numbers: the figures behind it, by name [SI]; `force` is what a question about a force asks.
        probability: of what is asked, under the model's uncertainty; None if it has none.
        yes: of a yes-no question, what is more probable; of a question how hard or where, whether
            it can be had at all; None for other questions.
        reason: why not: the reason of a refusal; None if there is none.
        suggestions: what would be possible instead.
        push: what was considered; None if the question is about no push.
        chart: which outcome map shows it, for a question of places.
        map: that map; not a part of the JSON document.
    """

    query: Query | None = None
    text: str
    lines: tuple[str, ...] = ()
    objects: tuple[str, ...] = ()
    numbers: dict[str, float] = Field(default={})
    probability: float | None = None
    yes: bool | None = None
    reason: str | None = None
    suggestions: tuple[str, ...] = ()
    push: Considered | None = None
    chart: Chart | None = None
    map: SkipJsonSchema[Annotated[OutcomeMap, AsItIs()] | None] = Field(
        default=None, exclude=True, repr=False
    )

    def __repr__(self) -> str:
        return f"<Answer: {shorten(self.text, 150, placeholder=' …')}>"


def force_text(value: float, sd: float | None = None) -> str:
    """A force and its standard deviation, if there is one: "3.7 N ± 0.7 N"."""
    digits = 2 if value < 1.0 or (sd is not None and sd < 0.1) else 1
    text = f"{value:.{digits}f} N"
    return text if not sd else f"{text} ± {sd:.{digits}f} N"


def affordance_lines(found: Sequence[Affordance]) -> Iterator[str]:
    """The things that may be done with an object, each in up to three lines.

    Those of which the same is told stand together.
    """
    for (can, told, *below), alike in groupby(found, _told):
        yield f"{'✓' if can else '✗'} {_ways(alike)}: {told}"
        yield from (f"    {line}" for line in below)


def _ways(alike: Iterable[Affordance]) -> str:
    """What is brought about, with its directions: "topple away, left; tilt away"."""
    return "; ".join(
        f"{outcome} {', '.join(each.direction for each in ways)}".rstrip()
        for outcome, ways in groupby(alike, lambda each: each.outcome)
    )


def _told(found: Affordance) -> tuple[bool, str, *tuple[str, ...]]:
    """Whether it can be done, and the lines on it."""
    if found.least_force is None or found.place is None:
        return found.can, found.message
    sure = "sure nowhere"
    if found.heights is not None:
        low, high = (1e3 * h for h in found.heights)
        sure = (
            f"sure from {low:.0f} to {high:.0f} mm" if high - low > 0.5 else f"sure at {low:.0f} mm"
        )
    below = [found.message]
    if not found.can and found.suggestions:
        below.append(f"→ {'; '.join(found.suggestions)}")
    return found.can, f"from the {found.face}, {found.least_force:.2f} N at least ({sure})", *below

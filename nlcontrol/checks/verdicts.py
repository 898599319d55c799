"""A verdict on one quantity of one clause: it held, it did not, or it cannot be told.

A measure is a number, a name, or None where nothing was recorded that could tell. What was not
perceived neither holds nor fails, whatever was asked.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, Protocol

from grammar.frames.command import Bound, Spans
from nlcontrol.json_document import DocumentPart
from nlcontrol.text_format import quantity
from objectmodels.html_table import html_table

if TYPE_CHECKING:
    from planner.problem.places import Measure

Relation = Literal["about", "at_most", "at_least", "is"]
Unit = Literal["m", "rad", "N", "m/s", "s", "m³", ""]

PLANNED_ENDS = frozenset({"stroke", "turned", "returned", "event", "reached", "toppled", "handled"})
"""Ends of a push, or of what a hand did, that are as they were meant."""

HAND_ENDS = frozenset({"no_grasp", "slipped", "missed", "nudged"})
"""Ends of what a whole hand did that are not as they were meant."""


Verdict = Literal["held", "not_held", "unknown"]
"""What is known of a clause."""

NOT_PERCEIVED = "not perceived"
"""What stands for a measure that nothing was recorded of."""


class Clause(Protocol):
    """A goal or a constraint: a kind, and the words it comes from."""

    @property
    def kind(self) -> str:
        """Its kind in the frame contract."""

    @property
    def spans(self) -> Spans:
        """The words it comes from."""


class Observed(DocumentPart):
    """The same clause as an observer saw it, who knows the truth of a simulation.

    Attributes:
        measured: what was true.
        ok: whether it holds.
    """

    measured: float | str
    ok: bool


class Check(DocumentPart):
    """One clause: what it asked and what was measured, in SI units.

    Attributes:
        clause: kind of the goal or constraint; `others` for what is implied, that nothing else is
            touched.
        spans: the words it comes from, `[start, end)` in the sentence.
        quantity: what was measured, in words.
        relation: how `measured` must stand to `expected`.
        expected: asked value, or a name.
        measured: what the trace says; `not perceived` if it says nothing.
        tolerance: by how much it may miss; None for names.
        unit: of the values.
        verdict: `held`, `not_held`, or `unknown`: it can be neither confirmed nor denied.
        ok: it is known to hold.
        low, high: where `measured` lies with all that was perceived; None if that is not limited.
        why: of what is unknown: `too_near` to the limit, or `not_perceived`.
        observed: what an observer saw of it; None if there was none.
    """

    clause: str
    spans: Spans = ()
    quantity: str
    relation: Relation
    expected: float | str
    measured: float | str
    tolerance: float | None = None
    unit: Unit = ""
    verdict: Verdict
    ok: bool
    low: float | None = None
    high: float | None = None
    why: Literal["too_near", "not_perceived"] | None = None
    observed: Observed | None = None

    @property
    def differs(self) -> bool:
        """An observer has another verdict; true as well of what only the observer could tell."""
        seen = self.observed
        return seen is not None and self.verdict != ("held" if seen.ok else "not_held")

    def _repr_html_(self) -> str:
        values = (self.measured, self.expected, self.tolerance or 0.0)
        texts = [v if isinstance(v, str) else quantity(v, self.unit) for v in values]
        row = (self.quantity, texts[0], f"{self.relation.replace('_', ' ')} {texts[1]}", texts[2])
        header = ("quantity", "measured", "asked", "tolerance")
        came = {"held": "held", "not_held": "missed", "unknown": "cannot be told"}[self.verdict]
        return html_table(f"{self.clause}: {came}", header, [row])


def compare(
    clause: Clause,
    relation: Relation,
    quantity: str,
    expected: float,
    measured: float | None,
    tolerance: float,
    unit: Unit,
) -> Check:
    """A verdict on a number; None if nothing tells it."""
    if measured is None:
        return _untold(clause, relation, quantity, float(expected), tolerance, unit)
    ok = holds(relation, expected, measured, tolerance)
    return Check(
        clause=clause.kind,
        spans=clause.spans,
        quantity=quantity,
        relation=relation,
        expected=float(expected),
        measured=float(measured),
        tolerance=tolerance,
        unit=unit,
        verdict="held" if ok else "not_held",
        ok=ok,
    )


def relation_of(bound: Bound) -> Relation:
    """How a measure must stand to an amount that is meant so."""
    return bound if bound in ("at_least", "at_most") else "about"


def holds(relation: Relation, expected: float, measured: float, tolerance: float) -> bool:
    """Whether a number stands to another one as asked, within a tolerance."""
    excess = measured - expected
    miss = {"about": abs(excess), "at_most": excess, "at_least": -excess}[relation]
    return bool(miss <= tolerance)


def _untold(
    clause: Clause,
    relation: Relation,
    quantity: str,
    expected: float | str,
    tolerance: float | None = None,
    unit: Unit = "",
) -> Check:
    """The verdict on what nothing was recorded of."""
    return Check(
        clause=clause.kind, spans=clause.spans, quantity=quantity, relation=relation,
        expected=expected, measured=NOT_PERCEIVED, tolerance=tolerance, unit=unit,
        verdict="unknown", ok=False, why="not_perceived",
    )  # fmt: skip


def object_name(clause: Clause, quantity: str, expected: str, measured: str | None) -> Check:
    """A verdict on a name; None if nothing tells it."""
    if measured is None:
        return _untold(clause, "is", quantity, expected)
    return Check(
        clause=clause.kind,
        spans=clause.spans,
        quantity=quantity,
        relation="is",
        expected=expected,
        measured=measured,
        verdict="held" if expected == measured else "not_held",
        ok=expected == measured,
    )


def place_check(clause: Clause, measure: Measure) -> Check:
    """A verdict on a place."""
    return compare(
        clause, measure.relation, measure.quantity,
        measure.expected, measure.measured, measure.tolerance, "m",
    )  # fmt: skip

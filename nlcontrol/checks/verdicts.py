"""A verdict on one quantity of one clause."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, Protocol

from grammar.frames.command import Spans
from nlcontrol.json_document import DocumentPart
from nlcontrol.text_format import quantity
from objectmodels.html_table import html_table

if TYPE_CHECKING:
    from planner.problem.place_measures import Measure

Relation = Literal["about", "at_most", "at_least", "is"]
Unit = Literal["m", "rad", "N", "m/s", "s", "m³", ""]

PLANNED_ENDS = frozenset({"stroke", "turned", "returned", "event", "reached", "toppled", "handled"})
"""Ends of a push, or of what a hand did, that are as they were meant."""

HAND_ENDS = frozenset({"no_grasp", "slipped", "missed", "nudged"})
"""Ends of what a whole hand did that are not as they were meant."""


class Clause(Protocol):
    """A goal or a constraint: a kind, and the words it comes from."""

    @property
    def kind(self) -> str:
        """Its kind in the frame contract."""

    @property
    def spans(self) -> Spans:
        """The words it comes from."""


class Check(DocumentPart):
    """One clause: what it asked and what was measured, in SI units.

    Attributes:
        clause: kind of the goal or constraint; `others` for what is implied, that nothing else is
            touched.
        spans: the words it comes from, `[start, end)` in the sentence.
        quantity: what was measured, in words.
        relation: how `measured` must stand to `expected`.
        expected: asked value, or a name.
        measured: what the trace says.
        tolerance: by how much it may miss; None for names.
        unit: of the three values.
        ok: whether it holds.
    """

    clause: str
    spans: Spans = ()
    quantity: str
    relation: Relation
    expected: float | str
    measured: float | str
    tolerance: float | None = None
    unit: Unit = ""
    ok: bool

    def _repr_html_(self) -> str:
        values = (self.measured, self.expected, self.tolerance or 0.0)
        texts = [v if isinstance(v, str) else quantity(v, self.unit) for v in values]
        row = (self.quantity, texts[0], f"{self.relation.replace('_', ' ')} {texts[1]}", texts[2])
        header = ("quantity", "measured", "asked", "tolerance")
        return html_table(f"{self.clause}: {'held' if self.ok else 'missed'}", header, [row])


def compare(
    clause: Clause,
    relation: Relation,
    quantity: str,
    expected: float,
    measured: float,
    tolerance: float,
    unit: Unit,
) -> Check:
    """A verdict on a number."""
    excess = measured - expected
    miss = {"about": abs(excess), "at_most": excess, "at_least": -excess}[relation]
    return Check(
        clause=clause.kind,
        spans=clause.spans,
        quantity=quantity,
        relation=relation,
        expected=float(expected),
        measured=float(measured),
        tolerance=tolerance,
        unit=unit,
        ok=bool(miss <= tolerance),
    )


def object_name(clause: Clause, quantity: str, expected: str, measured: str) -> Check:
    """A verdict on a name."""
    return Check(
        clause=clause.kind,
        spans=clause.spans,
        quantity=quantity,
        relation="is",
        expected=expected,
        measured=measured,
        ok=expected == measured,
    )


def place_check(clause: Clause, measure: Measure) -> Check:
    """A verdict on a place."""
    return compare(
        clause, measure.relation, measure.quantity,
        measure.expected, measure.measured, measure.tolerance, "m",
    )  # fmt: skip

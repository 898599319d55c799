"""What "higher" and "lower" say: how far something is lifted, or where it is touched.

"Lift it 8 cm higher" says how far, "push it higher" where to touch it. Beside a length nothing but
a lift can go higher, so that "push it 8 cm higher" is refused.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from grammar.clauses.clause_parts import Parts
from grammar.frames import command as g
from grammar.phrases import phrase_parts as ph
from grammar.words.normalisation import Normalised

_COMPARED = re.compile(r"\b(?:higher|lower)(?: (?:up|down))?$")


def with_heights_told(parts: Sequence[ph.Part], lifts: bool, sentence: Normalised) -> Parts:
    """The parts of a clause, of which "higher" says how far if something is lifted.

    Raises:
        ParseError: `does_not_apply` at "lower" of a lift, and at "3 cm higher" of anything else.
    """
    for part in parts:
        if not isinstance(part, ph.Constraint) or not _is_compared(part, sentence):
            continue
        length = next((p for p in parts if _is_beside(p, part, sentence)), None)
        if lifts:
            return _lifted_so_far(parts, part, length, sentence)
        if length is not None:
            message = "may say how far, or where to touch it"
            suggestions = "lift it 3 cm higher", "at 3 cm above the table"
            span = _joint_span(length, part)
            raise sentence.error_at(span, "does_not_apply", message, *suggestions)
    return list(parts)


def _is_compared(part: ph.Constraint, sentence: Normalised) -> bool:
    touched = isinstance(part.constraint, g.ContactRegion)
    return touched and bool(_COMPARED.search(sentence.words_as_written(part.span).casefold()))


def _is_beside(part: ph.Part, compared: ph.Part, sentence: Normalised) -> bool:
    start, end = sorted((part.span, compared.span))
    between = sentence.original[start[1] : end[0]]
    return isinstance(part, ph.Length) and not between.strip()


def _joint_span(one: ph.Part, other: ph.Part) -> g.Span:
    return min(one.span[0], other.span[0]), max(one.span[1], other.span[1])


def _lifted_so_far(
    parts: Sequence[ph.Part], compared: ph.Constraint, length: ph.Part | None, sentence: Normalised
) -> Parts:
    """The parts without where to touch it; a length is higher than now, without "more"."""
    if "lower" in sentence.words_as_written(compared.span).casefold():
        message = "goes the other way than lifting"
        suggestions = "8 cm higher", "set it down"
        raise sentence.error_at(compared.span, "does_not_apply", message, *suggestions)
    rest = [part for part in parts if part is not compared]
    if length is None:
        return rest
    whole = replace(length, span=_joint_span(length, compared))
    more = [p for p in rest if isinstance(p, ph.Remark) and p.span == compared.span]
    return [whole if part is length else part for part in rest if part not in more]

"""Goals of the whole hand, from the parts of a clause: lifted, opened, closed, poured, filled."""

from __future__ import annotations

from grammar.clauses.clause_parts import Clause
from grammar.frames import command as g
from grammar.phrases.phrase_parts import (
    FilledWithPart,
    FullPart,
    IntoPart,
    LengthPart,
    LidPart,
    SharePart,
    ThingPart,
    VolumePart,
)


def lifted(clause: Clause) -> g.Lift:
    """Lift the mug by 10 cm."""
    amount, height = clause.amount(), clause.take(LengthPart)
    return g.Lift(
        height=None if height is None else height.value,
        bound="exact" if height is None else height.bound,
        amount=amount,
        spans=clause.all_spans,
    )


def opened(clause: Clause) -> g.Open:
    """Take the lid off the jar."""
    return g.Open(part=_part(clause), spans=clause.all_spans)


def closed(clause: Clause) -> g.Close:
    """Put the lid back on the jar."""
    return g.Close(part=_part(clause), spans=clause.all_spans)


def _part(clause: Clause) -> str | None:
    lid = clause.take(LidPart)
    return None if lid is None else lid.name


def poured(clause: Clause) -> g.Pour:
    """Pour half of the ice tea into the mug; until it is half full."""
    full, said = clause.take(FullPart), clause.how_much()
    into, amount, share = clause.take(IntoPart), clause.amount(), clause.take(SharePart)
    volume = clause.take(VolumePart)
    if share is not None and share.of_way:
        raise clause.refused(share, "is no part of a liquid", "half of the water")
    if full is not None and full.subject and into and not _same(full.subject, into):
        raise clause.refused(full, "is about something else", "until it is half full")
    if full is not None and into is None:
        raise clause.refused(full, "needs to say what is filled", "into the mug")
    if full is not None and said:
        raise clause.twice(*sorted((full, said[0]), key=lambda part: part.span))
    if len(said) > 1:
        raise clause.twice(said[0], said[1])
    return g.Pour(
        into=None if into is None else into.target,
        amount=amount,
        fraction=None if share is None else share.value,
        volume=None if volume is None else volume.value,
        fill=None if full is None else full.value,
        spans=clause.all_spans,
    )


def _same(subject: ThingPart, into: IntoPart) -> bool:
    words, name = subject.ref.text.casefold().split(), into.target.text.casefold().split()
    return subject.ref.pronoun or words == name[-len(words) :]


def filled(clause: Clause) -> g.Pour:
    """Fill the mug with ice tea: to the brim, if nothing else is said."""
    into, share = clause.first(IntoPart), clause.first(SharePart)
    if into and share and share.span < into.span and not share.of_way:
        clause.put(share, FullPart(share.span, share.value))  # fill half of the mug
    clause.take(FilledWithPart)
    goal = poured(clause)
    said = (goal.amount, goal.fraction, goal.volume, goal.fill)
    return goal if any(said) else goal.model_copy(update={"fill": 1.0})

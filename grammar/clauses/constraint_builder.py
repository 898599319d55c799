"""From parts to constraints: what must not happen, where the object is touched, and how."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from grammar.clauses.consistency import contradiction_error, join_equal
from grammar.errors import ParseError
from grammar.frames import command as g
from grammar.frames.constraints import CONSTRAINTS, STILL, new_constraint
from grammar.phrases import phrase_parts as ph
from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised

_NO_MOVE = "no_move"
"""Word of the lexicon for the kinds that together keep an object where it is."""

_SAYS_HOW_FAR = (ph.Angle, ph.Length, ph.Place)
_MANNERS = frozenset({"fast", "gentle", "hard", "slow"})


def constraints_of(
    parts: Sequence[ph.Part], thing: ph.Thing, lexicon: Lexicon, sentence: Normalised
) -> tuple[list[ph.Part], tuple[g.Constraint, ...]]:
    """Separates the constraints, in their order, from the parts that belong to the goal."""
    rest: list[ph.Part] = []
    constraints: list[g.Constraint] = []
    previous: ph.Part | None = None
    for part in _with_degrees(_with_bounds(_with_ranges(parts)), sentence):
        if isinstance(part, ph.Avoid | ph.FurtherNoTouch):
            _require_opened(part, previous, sentence)
        if isinstance(part, ph.Avoid):
            constraints += _avoidance_constraints(part, thing, sentence)
        elif isinstance(part, ph.Constraint):
            require_same(part.subject, thing, part, sentence)
            constraints.append(part.constraint)
        elif isinstance(part, ph.FurtherNoTouch):
            constraints.append(part.constraint)
        else:
            rest.append(part)
        previous = part
    return rest, tuple(join_equal(_one_contact(constraints, sentence)))


def _with_degrees(parts: Sequence[ph.Part], sentence: Normalised) -> list[ph.Part]:
    """Takes "5 cm to the left a bit slowly" for slowly, where something else says how far."""
    if not any(isinstance(part, _SAYS_HOW_FAR) or _is_stop(part) for part in parts):
        return list(parts)
    out: list[ph.Part] = []
    for part in parts:
        before = out[-1] if out else None
        if isinstance(part, ph.Constraint) and isinstance(before, ph.Amount):
            kind, (start, end) = part.constraint.kind, (before.span[0], part.span[1])
            between = sentence.original[before.span[1] : part.span[0]]
            if kind in _MANNERS and not between.strip():
                said = part.constraint.model_copy(update={"spans": ((start, end),)})
                out[-1] = replace(part, span=(start, end), constraint=said)
                continue
        out.append(part)
    return out


def _is_stop(part: ph.Part) -> bool:
    return isinstance(part, ph.Constraint) and isinstance(part.constraint, g.Until)


def require_same(
    mention: ph.Thing | None, thing: ph.Thing, part: ph.Part, sentence: Normalised
) -> None:
    """Refuses a phrase that is about another object than the clause.

    Raises:
        ParseError: `other_object`.
    """
    if mention is None or can_be_same(mention, thing.ref):
        return
    raise ParseError(
        "other_object",
        f'the sentence is about "{thing.ref.text}", but "{sentence.words_as_written(part.span)}" '
        f'is about "{mention.ref.text}"',
        mention.span,
        (f'name "{thing.ref.text}" in both places, or say "it"',),
        spans=(thing.span, mention.span),
    )


def can_be_same(mention: ph.Thing, ref: g.ObjectRef) -> bool:
    """Check for a mention that can be the object itself: "it", or the end of its name."""
    words, name = mention.ref.text.casefold().split(), ref.text.casefold().split()
    return mention.ref.pronoun or words == name[-len(words) :]


def _require_opened(
    part: ph.Avoid | ph.FurtherNoTouch, previous: ph.Part | None, sentence: Normalised
) -> None:
    """A further thing to avoid needs a first one before it."""
    listed = isinstance(previous, ph.Avoid | ph.FurtherNoTouch) or (
        isinstance(previous, ph.Constraint) and _may_be_continued(previous.constraint)
    )
    if not getattr(part, "further", True) or listed:
        return
    suggestion = f"without {sentence.words_as_written(part.span)}"
    raise sentence.error_at(part.span, "unexpected_words", 'needs "without" before it', suggestion)


def _may_be_continued(constraint: g.Constraint) -> bool:
    """Check for a constraint that further things to avoid may follow."""
    limits = {kind.words.limit for kind in CONSTRAINTS.values()}
    return isinstance(constraint, g.NoTouch) or constraint.kind in limits


def complete_avoidances(parts: Sequence[ph.Part], lexicon: Lexicon) -> list[ph.Part]:
    """Gives "over" in "without knocking it over" to the verb that it stands behind.

    What does not touch "the jar" does not "hit the jar over" either.
    """
    out: list[ph.Part] = []
    for part in parts:
        before = out[-1] if out else None
        over = isinstance(part, ph.Particle) and part.word == "over" and not part.optional
        if over and isinstance(before, ph.Constraint | ph.FurtherNoTouch):
            clause, span = before.constraint, (before.span[0], part.span[1])
            if isinstance(clause, g.NoTouch):
                told = clause.model_copy(update={"spans": (span,)})
                out[-1] = replace(before, constraint=told, span=span)
                continue
        if isinstance(part, ph.Particle) and isinstance(before, ph.Avoid) and before.word:
            phrase = f"{before.word} {part.word}"
            kind = lexicon.terminals["AVOIDING"].get(phrase, lexicon.terminals["AVOID"].get(phrase))
            if kind is not None:
                span = before.span[0], part.span[1]
                out[-1] = replace(before, kind=kind, word=phrase, span=span)
                continue
        out.append(part)
    return out


def _with_ranges(parts: Sequence[ph.Part]) -> list[ph.Part]:
    """Turns the upper ends of distances ("5 to 10 cm", "…, at most 10 cm") into constraints."""
    out: list[ph.Part] = []
    known: ph.Length | None = None
    for part in parts:
        if not isinstance(part, ph.Length):
            out.append(part)
            continue
        if part.most is not None:
            out += [replace(part, most=None), _at_most(part, part.most)]
        elif part.bound == "at_most" and known is not None and isinstance(part.value, float):
            out.append(_at_most(part, part.value))
        else:
            out.append(part)
        known = known or part
    return out


def _at_most(part: ph.Length, value: float) -> ph.Constraint:
    return ph.Constraint(part.span, g.MaxDistance(value=value, spans=(part.span,)))


def _with_bounds(parts: Sequence[ph.Part]) -> list[ph.Part]:
    """Joins "without tilting it" and "more than 5 degrees" to one limit."""
    out: list[ph.Part] = []
    for part in parts:
        before = out[-1] if out else None
        limit = _limit_part(before, part) if isinstance(before, ph.Avoid) else None
        if limit is not None:
            out[-1] = limit
        else:
            out.append(part)
    return out


def _limit_part(avoid: ph.Avoid, part: ph.Part) -> ph.Constraint | None:
    if not isinstance(part, ph.Angle | ph.Length) or part.bound != "at_least":
        return None
    avoided = CONSTRAINTS.get(STILL[0] if avoid.kind == _NO_MOVE else avoid.kind)
    limit = avoided.words.limit if avoided else ""
    unit = "rad" if isinstance(part, ph.Angle) else "m"
    if not limit or CONSTRAINTS[limit].words.unit != unit or not isinstance(part.value, float):
        return None
    span = avoid.span[0], part.span[1]
    constraint = new_constraint(limit, value=part.value, spans=(span,))
    return ph.Constraint(span, constraint, avoid.thing)


def _avoidance_constraints(
    part: ph.Avoid, thing: ph.Thing, sentence: Normalised
) -> list[g.Constraint]:
    if not part.kind:
        message = f'"{part.word}" alone says nothing to avoid'
        raise ParseError("unexpected_words", message, part.span, (f"{part.word} it over",))
    other = part.thing and not can_be_same(part.thing, thing.ref)
    disturbs = part.kind == _NO_MOVE and not thing.ref.pronoun
    if part.thing and other and (disturbs or part.word.startswith("knock")):
        # What is not touched is neither moved nor knocked over.
        return [g.NoTouch(object=part.thing.ref, spans=(part.span,))]
    require_same(part.thing, thing, part, sentence)
    kinds = STILL if part.kind == _NO_MOVE else (part.kind,)
    return [new_constraint(kind, spans=(part.span,)) for kind in kinds]


def _one_contact(constraints: Sequence[g.Constraint], sentence: Normalised) -> list[g.Constraint]:
    """Joins what is said of the contact ("at the top", "from the left") in one constraint."""
    out: list[g.Constraint] = []
    for new in constraints:
        known = next((c for c in out if isinstance(c, g.ContactRegion)), None)
        if known is None or not isinstance(new, g.ContactRegion):
            out.append(new)
            continue
        said = known.model_dump(exclude_none=True, exclude={"kind", "spans"})
        more = new.model_dump(exclude_none=True, exclude={"kind", "spans"})
        if any(said.get(key, value) != value for key, value in more.items()):
            message = "name different places to touch"
            raise contradiction_error(known.spans[-1:], new.spans[-1:], sentence, message)
        update = {key: getattr(new, key) for key in more}
        spans = known.spans + new.spans
        out[out.index(known)] = known.model_copy(update={**update, "spans": spans})
    return out

"""From parts to constraints: what must not happen, where the object is touched, and how."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from grammar.errors import ParseError
from grammar.frames import (
    Constraint,
    ContactRegion,
    NoLift,
    NoSlide,
    NoSpill,
    NoTilt,
    NoTopple,
    NoTurn,
)
from grammar.lexicon import Lexicon
from grammar.normalise import Normalised
from grammar.parts import AvoidPart, ConstraintPart, ObjectPart, Part, ParticlePart

_AVOIDED: dict[str, type[NoTopple | NoTilt | NoTurn | NoSlide | NoLift | NoSpill]] = {
    "no_topple": NoTopple,
    "no_tilt": NoTilt,
    "no_turn": NoTurn,
    "no_slide": NoSlide,
    "no_lift": NoLift,
    "no_spill": NoSpill,
}


def constraints_of(
    parts: list[Part], thing: ObjectPart, lexicon: Lexicon, sentence: Normalised
) -> tuple[list[Part], tuple[Constraint, ...]]:
    """Separates the constraints, in their order, from the parts that belong to the goal."""
    rest: list[Part] = []
    constraints: list[Constraint] = []
    previous: Part | None = None
    for part in _with_particles(parts, lexicon):
        if isinstance(part, AvoidPart):
            if part.further and not isinstance(previous, AvoidPart):
                raise ParseError(
                    "unexpected_words",
                    f'"{sentence.written(part.span)}" needs "without" before it',
                    part.span,
                    (f"without {sentence.written(part.span)}",),
                )
            constraints.append(_avoided(part, thing, lexicon, sentence))
        elif isinstance(part, ConstraintPart):
            constraints.append(part.constraint)
        else:
            rest.append(part)
        previous = part
    return rest, tuple(_once(_one_contact(constraints, sentence)))


def _with_particles(parts: list[Part], lexicon: Lexicon) -> list[Part]:
    """Gives "over" in "without knocking it over" to the verb that it stands behind."""
    out: list[Part] = []
    for part in parts:
        before = out[-1] if out else None
        if isinstance(part, ParticlePart) and isinstance(before, AvoidPart) and before.word:
            phrase = f"{before.word} {part.word}"
            kind = lexicon.terminals["AVOIDING"].get(phrase, lexicon.terminals["AVOID"].get(phrase))
            if kind is not None:
                span = before.span[0], part.span[1]
                out[-1] = replace(before, kind=kind, word=phrase, span=span)
                continue
        out.append(part)
    return out


def _avoided(
    part: AvoidPart, thing: ObjectPart, lexicon: Lexicon, sentence: Normalised
) -> Constraint:
    if not part.kind:
        raise ParseError(
            "unexpected_words",
            f'"{part.word}" alone says nothing to avoid',
            part.span,
            (f"{part.word} it over",),
        )
    if part.thing is not None and not _same(part.thing, thing):
        raise ParseError(
            "other_object",
            f'the sentence is about "{thing.ref.text}", but "{sentence.written(part.span)}" '
            f'is about "{part.thing.ref.text}"',
            part.thing.span,
            (f'name "{thing.ref.text}" in both places, or say "it"',),
        )
    return _AVOIDED[part.kind](spans=(part.span,))


def _same(mention: ObjectPart, thing: ObjectPart) -> bool:
    """Whether a later mention can be the object itself: "it", or the end of its name."""
    words, name = mention.ref.text.casefold().split(), thing.ref.text.casefold().split()
    return mention.is_pronoun or words == name[-len(words) :]


def _one_contact(constraints: Sequence[Constraint], sentence: Normalised) -> list[Constraint]:
    """Joins what is said of the contact ("at the top", "from the left") in one constraint."""
    out: list[Constraint] = []
    for new in constraints:
        known = next((c for c in out if isinstance(c, ContactRegion)), None)
        if known is None or not isinstance(new, ContactRegion):
            out.append(new)
            continue
        said = known.model_dump(exclude_none=True, exclude={"kind", "spans"})
        more = new.model_dump(exclude_none=True, exclude={"kind", "spans"})
        if any(said.get(key, value) != value for key, value in more.items()):
            quoted = [f'"{sentence.written(c.spans[-1])}"' for c in (known, new)]
            raise ParseError(
                "contradiction",
                f"{quoted[0]} and {quoted[1]} name different places to touch",
                new.spans[-1],
                tuple(f"say only {quote}" for quote in quoted),
            )
        update = {key: getattr(new, key) for key in more}
        spans = known.spans + new.spans
        out[out.index(known)] = known.model_copy(update={**update, "spans": spans})
    return out


def _once(constraints: Sequence[Constraint]) -> list[Constraint]:
    """Joins constraints that say the same ("gently … carefully")."""
    out: list[Constraint] = []
    for new in constraints:
        bare = new.model_copy(update={"spans": ()})
        for i, known in enumerate(out):
            if known.model_copy(update={"spans": ()}) == bare:
                out[i] = known.model_copy(update={"spans": (*known.spans, *new.spans)})
                break
        else:
            out.append(new)
    return out

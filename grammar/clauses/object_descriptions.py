"""Descriptions that distinguish objects: "the box next to the mug", "the one on the left".

A place behind an object is where the object is, if the verb takes no place or the sentence says
elsewhere where to go; else it is where to go. A length before a place is the gap to it.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, cast

from grammar.clauses.clause_parts import ON_THE_TABLE, Parts, unexpected_part
from grammar.clauses.owned_parts import part_and_owner
from grammar.frames import command as g
from grammar.phrases import phrase_parts as ph
from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised

_TAKES_PLACE = ("displace", "contact", "place", "set_down")
_ELSEWHERE = (ph.Heading, ph.Toward, ph.AwayFrom, ph.Length)
_TELLING = ("next_to", "left_of", "right_of", "in_front_of", "behind", "between", "touching",
            "on", "in", "above", "below", "front_left_of", "front_right_of", "behind_left_of",
            "behind_right_of", "nearest")  # fmt: skip
"""Relations that can tell an object from others."""

_TOUCHING_ONLY = (None, "rotate", "tilt", "topple")
"""Goals for which a side always says where to touch."""

_TOUCHING = ("displace", "contact")
"""Goals for which it may."""

_SIDES: dict[str, g.Quality] = {
    "middle": "middle", "center": "middle", "centre": "middle", "front": "near", "back": "far",
    "left": "left", "right": "right",
}  # fmt: skip
_REGIONS: dict[g.Quality, g.TableRegion] = {
    "middle": "center", "near": "front_edge", "far": "back_edge", "left": "left_edge",
    "right": "right_edge",
}  # fmt: skip
_PUSHED_TO: dict[g.Quality, g.Direction] = {
    "near": "away", "far": "toward", "left": "right", "right": "left",
}  # fmt: skip
"""Direction in which a touch on that side pushes."""

SIDES_COUNTED_FROM: dict[g.Quality, str] = {
    "left": "left", "right": "right", "near": "front", "far": "back",
}  # fmt: skip
"""Quality that things are counted by → the side from which they are counted."""

_STOP = re.compile(r"[.;!](?: |$)")


def attach_descriptions(parts: Sequence[ph.Part], lexicon: Lexicon, sentence: Normalised) -> Parts:
    """The parts of a clause, with the places that tell objects apart given to the objects.

    Raises:
        ParseError: `unexpected_words` if there is nothing that they could belong to.
    """
    out: Parts = []
    parts = _with_touching_as_place(_with_touched_parts(parts, lexicon, sentence))
    parts = _with_sides(_with_ordinals(parts, lexicon, sentence), lexicon, sentence)
    parts = _with_beside_it(parts, sentence)
    for i, part in enumerate(parts):
        telling = isinstance(part, ph.Side)
        before = out[-1] if out else None
        placed = isinstance(before, ph.Place) and not isinstance(before.reference, tuple)
        if telling and (placed or isinstance(before, ph.Result)):
            # "so that it stands on the left", "to the edge in front"
            raise unexpected_part(part, sentence)
        if isinstance(part, ph.Place):
            _require_no_side(part, sentence)
            told = isinstance(before, ph.ThatIs) and part.relation in _TELLING
            moved = _is_way_to(part, out, sentence)
            rest = _of_same_sentence(parts, i, sentence)
            telling = not moved and _is_description(part, rest, i, out, lexicon)
            telling = told or telling or _tells_reference(part, out, sentence)
            if told:
                out.pop()
        if telling:
            _attach_to_last(cast("ph.Side | ph.Place", part), out, sentence)
        else:
            out.append(part)
    for part in out:
        if isinstance(part, ph.ThatIs):
            raise unexpected_part(part, sentence)
    return out


def _require_no_side(part: ph.Place, sentence: Normalised) -> None:
    """Refuse "up to the left", which names a side and no object."""
    refs = part.reference if isinstance(part.reference, tuple) and part.relation != "on" else ()
    quoted = '"' in sentence.words_as_written(part.span)
    if not quoted and any(ref.text.casefold() in _SIDES for ref in refs):
        message = "names a side, and no object"
        raise sentence.error_at(part.span, "does_not_apply", message, "to the left")


def _with_touched_parts(parts: Sequence[ph.Part], lexicon: Lexicon, sentence: Normalised) -> Parts:
    """Takes "the top of the box" for the box, touched at the top, unless it is opened."""
    if _goal_of_verb(list(parts), lexicon) in ("open", "remove", "close", None):
        return list(parts)
    return [
        said
        for part in parts
        for said in (
            _split_touched_part(part, lexicon, sentence) if isinstance(part, ph.Thing) else [part]
        )
    ]


def _split_touched_part(thing: ph.Thing, lexicon: Lexicon, sentence: Normalised) -> Parts:
    """A thing as it is, but "the top of the box" as the box and where it is touched."""
    parted = part_and_owner(thing, lexicon, sentence)
    contact = _contact_region(parted[0], lexicon) if parted else None
    if parted is None or contact is None:
        return [thing]
    _, span, whole = parted
    return [whole, ph.Constraint(span, contact.model_copy(update={"spans": (span,)}))]


def _contact_region(where: str, lexicon: Lexicon) -> g.ContactRegion | None:
    """The third or the face of an object that some words name."""
    region = lexicon.terminals["REGION"].get(f"at the {where}")
    face = lexicon.terminals["FACE"].get(f"on the {where}")
    if region is None and face is None:
        return None
    return g.ContactRegion.model_validate({"region": region, "face": None if region else face})


def _with_touching_as_place(parts: Sequence[ph.Part]) -> Parts:
    """Takes "touching the block" for a place, unless it goes on with what is to be avoided."""
    out: Parts = []
    for part in parts:
        before = out[-1] if out else None
        avoiding = isinstance(before, ph.Avoid | ph.FurtherNoTouch) or (
            isinstance(before, ph.Constraint) and before.constraint.kind == "no_touch"
        )
        if isinstance(part, ph.FurtherNoTouch) and not avoiding and not part.either:
            touched = part.constraint.object
            if touched is not None:
                out.append(ph.Place(part.span, "touching", (touched,)))
                continue
        out.append(part)
    return out


def _is_way_to(part: ph.Place, before: Parts, sentence: Normalised) -> bool:
    """Check for words of going: "over to the left of it", "onto it"; "take the mug to it"."""
    words = sentence.words_as_written(part.span).casefold()
    taken = any(isinstance(p, ph.Verb) and p.word == "take" for p in before)
    return words.startswith(("over ", "onto ", "up onto ", "to " if taken else "over "))


def _is_kept(parts: Parts, lexicon: Lexicon) -> bool:
    """Check for a verb behind whose object a place says where it is kept: "hold it next to"."""
    verb = next((p for p in parts if isinstance(p, ph.Verb)), None)
    found = verb and lexicon.find_verb(verb.word)
    return bool(found and found.kept)


def _of_same_sentence(parts: Parts, i: int, sentence: Normalised) -> Parts:
    """The parts up to the full stop behind a part: what follows tells nothing about it."""
    end = parts[i].span[1]
    return [p for p in parts if not _STOP.search(sentence.original[end : p.span[0]])]


def _is_description(part: ph.Place, parts: Parts, i: int, before: Parts, lexicon: Lexicon) -> bool:
    """Check for a place that distinguishes an object, rather than saying where to go."""
    if part.relation == "nearest":
        return True
    owner = before[-1] if before else None
    asked = isinstance(owner, ph.Ask | ph.Explore) and owner.thing is not None
    known = part.relation in _TELLING or part.relation == "from"
    if not known or not (isinstance(owner, ph.Thing) or asked):
        return False
    if isinstance(owner, ph.Thing) and owner.ref.text.casefold() == "it":
        return False  # it is told apart already
    if asked or any(isinstance(p, ph.Result) and p.event == "ends_up" for p in parts[:i]):
        return asked
    goal = _goal_of_verb(parts, lexicon)
    if goal is None and isinstance(owner, ph.Thing):
        return _is_nobody(owner, lexicon)  # "now the one next to it"
    if goal in ("lift", "remove") and (part.relation == "from" or _is_kept(parts, lexicon)):
        return False
    into = any(isinstance(p, ph.Into) for p in parts)
    if goal == "pour" and part.relation in ("in", "on") and not into:
        return False  # pour it in the mug, onto the plate
    if goal not in _TAKES_PLACE:
        # "Lean it against the wall" is no box that stands against the wall.
        return goal is not None and part.relation not in ("touching", "above", "below")
    rest = _without_avoidances(parts[i + 1 :])
    if any(
        isinstance(p, ph.Place) and p.relation != "nearest" and not isinstance(before, ph.ThatIs)
        for before, p in zip([None, *rest], rest, strict=False)
    ):
        return True
    said = [*parts[:i], *rest]
    directed = any(isinstance(p, ph.Direction) and not p.implied for p in said)
    directed = directed or _brings_me(said, lexicon)
    return goal not in ("place", "set_down") and (
        directed or any(isinstance(p, _ELSEWHERE) for p in said)
    )


def _brings_me(parts: Parts, lexicon: Lexicon) -> bool:
    """Check for "bring me the mug next to it"; "push me the mug next to it" may be for me."""
    said = next((part.word for part in parts if isinstance(part, ph.Verb)), "")
    verb = lexicon.find_verb(said)
    brings = verb is not None and verb.direction == "toward"
    return brings and any(isinstance(part, ph.Me) for part in parts)


def _tells_reference(part: ph.Place, before: Parts, sentence: Normalised) -> bool:
    """Check for a place right behind the name in another one: "to the jar behind the tin"."""
    owner = before[-1] if before else None
    if not isinstance(owner, ph.Place) or part.relation not in _TELLING:
        return False
    between = sentence.original[owner.span[1] : part.span[0]]
    return _last_reference(owner) is not None and not between.strip()


def _last_reference(part: ph.Part) -> g.ObjectRef | None:
    """The one object that a place names, unless it is told apart already."""
    match part:
        case ph.Place(reference=(g.ObjectRef(pronoun=False, relation=None) as only,)):
            return only
    return None


def _with_ordinals(parts: Parts, lexicon: Lexicon, sentence: Normalised) -> Parts:
    """Takes "from the right" behind "the third tin" for where it is counted from."""
    out: Parts = []
    for part in parts:
        before = out[-1] if out else None
        asks = isinstance(before, ph.Ask | ph.Explore)
        thing = before.thing if isinstance(before, ph.Ask | ph.Explore) else before
        if not isinstance(thing, ph.Thing):
            out.append(part)
            continue
        side = _side_counted_from(part, sentence)
        if side is not None and _is_counted(thing, lexicon, sentence):
            told = _described_thing(thing, ph.Side(part.span, side), sentence)
            out[-1] = replace(cast(Any, before), thing=told) if asks else told
        elif not (isinstance(part, ph.Direction) and part.implied and part.span in thing.ref.spans):
            out.append(part)
    return out


def _side_counted_from(part: ph.Part, sentence: Normalised) -> g.Quality | None:
    """The side from which things are counted: "from the right"."""
    if not isinstance(part, ph.Constraint) or not isinstance(part.constraint, g.ContactRegion):
        return None
    face = part.constraint.face
    sides = (quality for quality, side in SIDES_COUNTED_FROM.items() if side == face)
    said = sentence.words_as_written(part.span).casefold()
    return next(sides, None) if "from" in said.split() else None


def _is_counted(thing: ph.Thing, lexicon: Lexicon, sentence: Normalised) -> bool:
    """Check for the third tin, or the lid of the third tin."""
    parted = part_and_owner(thing, lexicon, sentence)
    return (parted[2] if parted else thing).ref.ordinal is not None


def _with_sides(parts: Parts, lexicon: Lexicon, sentence: Normalised) -> Parts:
    """Takes "in the middle", "at the front" for a place or a mark of the object, not a touch.

    That is so where the verb touches nothing in particular, or moves it another way.
    """
    goal = _goal_of_verb(parts, lexicon)
    placed = any(isinstance(part, ph.Place) for part in parts)
    said = {part.value for part in parts if isinstance(part, ph.Direction) and not part.implied}
    out: Parts = []
    for part in parts:
        side, before = _side_of_table(part, sentence), out[-1] if out else None
        ends = isinstance(before, ph.Result) and before.event == "ends_up"
        if side is not None and ends:
            out.append(ph.Place(part.span, "at", _REGIONS[side]))
        elif side is None or not isinstance(before, ph.Thing) or goal in _TOUCHING_ONLY:
            out.append(part)
        elif goal == "place" and not placed:
            out.append(ph.Place(part.span, "at", _REGIONS[side]))
        else:
            elsewhere = bool(said) and _PUSHED_TO.get(side) not in (None, *said)
            told = goal not in _TOUCHING or elsewhere or _is_nobody(before, lexicon)
            told = told and not before.ref.pronoun
            out.append(ph.Side(part.span, side) if told else part)
    return out


def _with_beside_it(parts: Parts, sentence: Normalised) -> Parts:
    """Takes "next to the tin, on its left" for left of the tin.

    Raises:
        ParseError: `unexpected_words` at "next to the tin, on the left", which may be of the table.
    """
    out: Parts = []
    for part in parts:
        before = out[-1] if out else None
        place = before if isinstance(before, ph.Place) and before.relation == "next_to" else None
        paused = place and "," in sentence.original[place.span[1] : part.span[0]]
        if place and isinstance(part, ph.Place) and part.beside:
            span = place.span[0], part.span[1]
            out[-1] = replace(place, relation=part.relation, span=span)
        elif paused and isinstance(part, ph.Side):
            raise unexpected_part(part, sentence)
        else:
            out.append(part)
    return out


def _is_nobody(part: ph.Thing, lexicon: Lexicon) -> bool:
    """Check for a name that names no object: "the one in the middle"."""
    return part.ref.text.casefold() in lexicon.nobodies


def _side_of_table(part: ph.Part, sentence: Normalised) -> g.Quality | None:
    """The side or the middle that may be the table's: "at the front", but no "front face"."""
    if not isinstance(part, ph.Constraint) or not isinstance(part.constraint, g.ContactRegion):
        return None
    return side_of_table_in(sentence.words_as_written(part.span).casefold())


def side_of_table_in(phrase: str) -> g.Quality | None:
    """The side or the middle that a phrase may mean of the table; "its middle" is the object's."""
    words = phrase.split()
    return _SIDES.get(words[-1]) if words[0] in ("at", "in", "on") and "its" not in words else None


def _without_avoidances(parts: Parts) -> Parts:
    """The parts that say where to go; "more than 5 cm" behind something to avoid is its limit."""
    return [
        part
        for before, part in zip([None, *parts], parts, strict=False)
        if not isinstance(part, ph.Avoid | ph.Constraint)
        and not (isinstance(part, ph.Length) and isinstance(before, ph.Avoid))
    ]


def _goal_of_verb(parts: Parts, lexicon: Lexicon) -> str | None:
    """Goal of the clause's verb; None if it has none."""
    verb = next((p for p in parts if isinstance(p, ph.Verb)), None)
    if verb is None:
        return "none" if any(isinstance(p, ph.Remark) for p in parts) else None
    particle = next((p for p in parts if isinstance(p, ph.Particle)), None)
    found = particle and lexicon.find_verb(verb.word, particle.word)
    found = found or lexicon.find_verb(verb.word)
    return found.goal if found else "displace"


def _attach_to_last(part: ph.Side | ph.Place, out: Parts, sentence: Normalised) -> None:
    """Gives what tells it apart to the last thing that was named."""
    for i in reversed(range(len(out))):
        owner = out[i]
        if isinstance(owner, ph.Place) and (ref := _last_reference(owner)):
            told = _described_thing(ph.Thing(owner.span, ref), part, sentence).ref
            out[i] = replace(owner, reference=(told,))
            return
        if isinstance(owner, ph.Toward | ph.Into) and isinstance(owner.target, g.ObjectRef):
            told = _described_thing(ph.Thing(owner.span, owner.target), part, sentence).ref
            out[i] = replace(owner, target=told)
            return
        if isinstance(part, ph.Place) and not isinstance(part.reference, tuple):
            break  # a part of the table tells no objects apart
        if isinstance(owner, ph.Thing):
            out[i] = _described_thing(owner, part, sentence)
            return
        if isinstance(owner, ph.Ask | ph.Explore) and owner.thing is not None:
            out[i] = replace(owner, thing=_described_thing(owner.thing, part, sentence))
            return
    raise unexpected_part(part, sentence)


def _described_thing(thing: ph.Thing, part: ph.Side | ph.Place, sentence: Normalised) -> ph.Thing:
    ref = thing.ref
    if isinstance(part, ph.Place) and ref.relation is not None:
        return _with_told_reference(thing, part, sentence)
    noun = ref.noun if ref.qualities or ref.quantifier else _noun_of(ref)
    update: dict[str, object] = {"spans": (*ref.spans, part.span)}
    if isinstance(part, ph.Side):
        update |= {"qualities": (*ref.qualities, part.quality), "noun": noun}
    elif part.relation == "nearest":
        update |= {
            "qualities": (*ref.qualities, "near"), "noun": noun, "reference": part.reference
        }  # fmt: skip
    else:
        stood_on = "on" if part.relation == "from" else part.relation
        relation = ON_THE_TABLE.get(stood_on, stood_on)
        update |= {"relation": relation, "reference": part.reference}
    return replace(thing, ref=ref.model_copy(update=update))


def _with_told_reference(thing: ph.Thing, part: ph.Place, sentence: Normalised) -> ph.Thing:
    """The mug next to the box that is behind the jar: the place is that of the box."""
    ref = thing.ref
    if len(ref.reference) != 1 or ref.reference[0].pronoun:
        raise unexpected_part(part, sentence)
    other = _described_thing(ph.Thing(part.span, ref.reference[0]), part, sentence).ref
    update = {"reference": (other,), "spans": (*ref.spans, part.span)}
    return replace(thing, ref=ref.model_copy(update=update))


def _noun_of(ref: g.ObjectRef) -> str:
    return "" if ref.pronoun or ref.text.casefold() in ("one", "ones") else ref.text.casefold()

"""The objects of a clause: what it names, "it", or what a clause of lids or contents is about.

"Take the lid off the jar" is about the jar, "fill the mug with ice tea" about the ice tea. Where
the sentence names only the lid, or only what is filled, it is about what was spoken of before.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from grammar.clauses.clause_parts import Parts, several_objects, unexpected_part
from grammar.clauses.compared_heights import with_heights_told
from grammar.clauses.constraint_builder import require_same
from grammar.clauses.owned_parts import QUOTES, part_and_owner
from grammar.errors import ParseError
from grammar.frames import command as g
from grammar.phrases import phrase_parts as ph
from grammar.words.lexicon import Lexicon, Verb
from grammar.words.normalisation import Normalised

NOBODY = ph.Thing((0, 0), g.ObjectRef(text="it", pronoun=True))
"""What a remark is about that names nothing."""

_MOVED_BY = {"from": "off", "off": "off", "on": "on"}
"""Particle that a lid's verb has where the sentence names what it goes off or on."""


_MOVES_LID = {"off": "take", "on": "put"}
"""Particle → verb by which a lid is said to be moved, of one that is pushed or slid."""

_MOVES_PART = {"up": "open", "out": "open", "down": "shut", "in": "shut"}
"""Where a lid or a drawer is moved, and what becomes of its owner."""


# --- which object ------------------------------------------------------------------------------


def clause_objects(
    parts: Sequence[ph.Part],
    ask: Sequence[ph.Ask],
    remarks: Sequence[ph.Remark],
    lexicon: Lexicon,
    sentence: Normalised,
) -> list[ph.Thing]:
    """Find the objects of a clause with a verb: one, or several of a list.

    Raises:
        ParseError: `no_object`, `several_objects`, `other_object`, `unexpected_words`.
    """
    named = [part.thing for part in ask if part.thing is not None]
    things = [part for part in parts if isinstance(part, ph.Thing)]
    if named and len(things) > 1:
        raise several_objects(things[1], sentence)
    if named and named[0].ref.pronoun and things:
        return things
    if named and things and not things[0].ref.pronoun:
        require_same(named[0], things[0], ask[0], sentence)
    if named:
        spans = named[0].ref.spans + tuple(s for t in things for s in t.ref.spans)
        return [replace(named[0], ref=named[0].ref.model_copy(update={"spans": spans}))]
    if not things and (remarks or any(part.query in ("why", "capable") for part in ask)):
        return [NOBODY]
    verb = next(part for part in parts if isinstance(part, ph.Verb))
    if not things:
        after = [part.span for part in parts if part.span[0] >= verb.span[1]]
        message = "the name of an object is missing"
        suggestion = f'say what to {verb.word}: "{verb.word} the box"'
        raise ParseError("no_object", message, after[0] if after else verb.span, (suggestion,))
    if not (verb.passive or remarks or ask) and things[0].span < verb.span:
        raise unexpected_part(things[0], sentence)
    for thing in things:
        if thing.ref.text.casefold() in lexicon.robot_parts and _is_plain(thing, sentence):
            message = "is the robot itself, and no object that it moves"
            hint = f'say what it should do: "{verb.word} the box"'
            raise sentence.error_at(thing.span, "no_object", message, hint)
    if things[0].ref.pronoun and (earlier := _object_of_constraints(things[0], parts)):
        return [earlier]
    if len(things) > 1 and not _is_list(things, lexicon, sentence):
        raise several_objects(things[1], sentence)
    return things


def _is_plain(thing: ph.Thing, sentence: Normalised) -> bool:
    """Check for a name that stands without quotation marks."""
    return not sentence.original[: thing.span[0]].endswith(QUOTES)


def _object_of_constraints(thing: ph.Thing, parts: Sequence[ph.Part]) -> ph.Thing | None:
    """Object of "it" after "be careful not to topple the jar when you push it"."""
    named = [part.thing for part in parts if isinstance(part, ph.Avoid)]
    named += [part.subject for part in parts if isinstance(part, ph.Constraint)]
    for other in named:
        if other is not None and not other.ref.pronoun and other.span < thing.span:
            spans = other.ref.spans + thing.ref.spans
            return replace(other, ref=other.ref.model_copy(update={"spans": spans}))
    return None


def _is_list(things: Sequence[ph.Thing], lexicon: Lexicon, sentence: Normalised) -> bool:
    """Check for things that stand side by side, joined by "and", or changed one for another.

    Behind a comma alone "the blue one" may be the thing before it.
    """
    pairing = {"and", *lexicon.terminals["EXCHANGED_WITH"]}
    counting = {word for phrase in lexicon.terminals["QUANTIFIER"] for word in phrase.split()}
    joints = {",", "&", *pairing, *lexicon.terminals["THE"], "a", "an", *counting}
    for one, other in pairwise(things):
        between = sentence.original[one.span[1] : other.span[0]].casefold()
        words = set(between.replace(",", " , ").split())
        paired = not words.isdisjoint(pairing)
        named = other.ref.text.casefold().rpartition(" ")[2] not in lexicon.nobodies
        if not words <= joints or not (paired or ("," in words and named)):
            return False
    return True


# --- objects that are implied ------------------------------------------------------------------


def attach_objects(parts: Sequence[ph.Part], lexicon: Lexicon, sentence: Normalised) -> Parts:
    """The parts of a clause, once it is about the object that its verb handles."""
    verb = next((part for part in parts if isinstance(part, ph.Verb)), None)
    asks = None if verb is None else _asks_for(verb, parts, lexicon)
    parts = with_heights_told(parts, asks is not None and asks.goal == "lift", sentence)
    if verb is None:
        return parts
    if asks is not None and asks.goal == "fill":
        return _with_fill_as_pour(parts, verb)
    if asks is not None and asks.goal == "topple" and any(isinstance(p, ph.Into) for p in parts):
        # "Tip the milk into the mug".
        asks, pours = lexicon.find_verb("pour"), replace(verb, word="pour")
        parts = [pours if part is verb else part for part in parts]
    if asks is not None and asks.goal == "pour":
        _require_target(parts, sentence)
        return _with_poured_object(parts, verb)
    parts = _with_it_placed(parts, verb, lexicon, sentence)
    parts = _with_moved_part(parts, verb, lexicon, sentence)
    asks = _asks_for(verb, parts, lexicon)
    parts = _with_owner_of_lid(parts, verb, asks, lexicon, sentence)
    said = any(isinstance(part, ph.Length | ph.Amount) for part in parts)
    if asks is not None and asks.goal == "lift" and not said:
        return [_with_lift_height(part, sentence) for part in parts]
    return list(parts)


def _asks_for(verb: ph.Verb, parts: Sequence[ph.Part], lexicon: Lexicon) -> Verb | None:
    particle = next((p for p in parts if isinstance(p, ph.Particle)), None)
    with_it = particle and lexicon.find_verb(verb.word, particle.word)
    return with_it or lexicon.find_verb(verb.word)


def _pronoun_after(after: ph.Part) -> ph.Thing:
    """A pronoun behind a part, for the object that was spoken of before."""
    end = after.span[1]
    return ph.Thing((end, end), g.ObjectRef(text="it", pronoun=True))


def _with_it_placed(
    parts: Sequence[ph.Part], verb: ph.Verb, lexicon: Lexicon, sentence: Normalised
) -> Parts:
    """Takes "place on the plate" for "place it on the plate"; "put on the lid" is of a lid."""
    thing = next((part for part in parts if isinstance(part, ph.Thing)), None)
    particle = next((part for part in parts if isinstance(part, ph.Particle)), None)
    alone = lexicon.find_verb(verb.word)
    if thing is None or particle is None or alone is None or alone.goal != "place":
        return list(parts)
    named = thing.ref.text.casefold().split()[-1]
    if particle.word != "on" or particle.span > thing.span or named in lexicon.parts:
        return list(parts)
    if part_and_owner(thing, lexicon, sentence) is not None:
        return list(parts)
    place = ph.Place((particle.span[0], thing.span[1]), "on", (thing.ref,))
    rest = [part for part in parts if part is not particle]
    return [_pronoun_after(verb), *(place if part is thing else part for part in rest)]


# --- contents ---------------------------------------------------------------------------------


def _with_fill_as_pour(parts: Sequence[ph.Part], verb: ph.Verb) -> Parts:
    """Takes "fill the mug with ice tea" for pouring the ice tea into the mug."""
    filled = next((part for part in parts if isinstance(part, ph.Thing)), None)
    if filled is None or any(isinstance(part, ph.Into) for part in parts):
        return list(parts)
    out: Parts = [ph.Into(filled.span, filled.ref) if p is filled else p for p in parts]
    liquid = next((part.thing for part in parts if isinstance(part, ph.FilledWith)), None)
    if (poured := _with_source(out, liquid)) is not None:
        return poured
    return [*out, liquid or _pronoun_after(verb)]


def _with_poured_object(parts: Sequence[ph.Part], verb: ph.Verb) -> Parts:
    """Takes "pour 100 ml into the mug" for 100 ml of what was spoken of before."""
    amount = any(isinstance(part, ph.Volume | ph.Amount) for part in parts)
    liquid = next((part for part in parts if isinstance(part, ph.Thing)), None)
    rest = [part for part in parts if part is not liquid]
    if (poured := _with_source(rest, liquid)) is not None:
        return poured
    return list(parts) if liquid or not amount else [*parts, _pronoun_after(verb)]


def _require_target(parts: Sequence[ph.Part], sentence: Normalised) -> None:
    """Refuses "pour the milk out of the jug", which says where from and not where to."""
    places = [part for part in parts if isinstance(part, ph.Place | ph.Into)]
    liquid = any(isinstance(part, ph.Thing) for part in parts)
    if len(places) == 1 and liquid and getattr(places[0], "relation", "") in ("from", "out_of"):
        message = "says where from, and not where to"
        raise sentence.error_at(places[0].span, "does_not_apply", message, "into the mug")


def _with_source(parts: Parts, liquid: ph.Thing | None) -> Parts | None:
    """Takes "(the milk) from the jug" for the jug, or the milk in it; None without a source."""
    for i, part in enumerate(parts):
        match part:
            case ph.Place(relation="from" | "out_of", reference=(g.ObjectRef() as jug,)):
                spans = (*jug.spans, part.span)
                whole = ph.Thing(part.span, jug.model_copy(update={"spans": spans}))
                milk = liquid and [liquid, replace(part, relation="in")]
                return [*parts[:i], *(milk or [whole]), *parts[i + 1 :]]
    return None


# --- lids -------------------------------------------------------------------------------------


def _with_moved_part(
    parts: Sequence[ph.Part], verb: ph.Verb, lexicon: Lexicon, sentence: Normalised
) -> Parts:
    """Takes "pull the drawer out", "push the lid down" for opening and closing."""
    thing = next((part for part in parts if isinstance(part, ph.Thing)), None)
    particle = next((part for part in parts if isinstance(part, ph.Particle)), None)
    if thing is None or particle is None:
        return list(parts)
    parted = part_and_owner(thing, lexicon, sentence)
    moved = parted[0] if parted else thing.ref.text.casefold().split()[-1]
    word = _MOVES_PART.get(particle.word, "")
    if moved not in lexicon.parts or lexicon.find_verb(verb.word, word) is None:
        return list(parts)
    return [replace(part, word=word) if part is particle else part for part in parts]


def _with_owner_of_lid(
    parts: Sequence[ph.Part],
    verb: ph.Verb,
    asks: Verb | None,
    lexicon: Lexicon,
    sentence: Normalised,
) -> Parts:
    """Takes what is done to a lid for something done to the object that it belongs to."""
    thing = next((part for part in parts if isinstance(part, ph.Thing)), None)
    if thing is None or any(isinstance(part, ph.FromTable) for part in parts):
        return list(parts)
    place = next((part for part in parts if isinstance(part, ph.Place)), None)
    off = lexicon.find_verb(verb.word, "off")
    words = " ".join(thing.ref.text.casefold().split())
    if words not in lexicon.lids:
        parted = part_and_owner(thing, lexicon, sentence)
        removes = asks is not None and asks.goal == "remove"
        lifts = asks is not None and asks.goal == "lift" and off is not None
        if parted is None or parted[0] not in lexicon.lids or not (lifts or removes):
            return list(parts)
        name, span, whole = parted
        own: Parts = [] if removes else [ph.Particle(verb.span, "off")]
        own += [ph.Lid(span, name), whole]
        said = [p for p in parts if not (isinstance(p, ph.Particle) and p.word == "up")]
        return [p for part in said for p in (own if part is thing else [part])]
    if place is None:
        return _with_lid_of_known_object(parts, verb, asks, off, ph.Lid(thing.span, words))
    particle = _MOVED_BY.get(place.relation, "")
    goal = None if asks is None else asks.goal
    measured = any(isinstance(part, ph.Length) for part in parts)
    pushed = goal in ("displace", "contact") and particle in _MOVES_LID and not measured
    moving = replace(verb, word=_MOVES_LID[particle]) if pushed else verb
    known = lexicon.find_verb(moving.word, particle)
    opens = (goal in ("open", "remove") and particle == "off") or (goal, particle) == (
        "close",
        "on",
    )
    closes_or_opens = known is not None and known.goal in ("open", "remove", "close")
    if not isinstance(place.reference, tuple) or not (opens or closes_or_opens):
        return list(parts)
    whole = ph.Thing(place.reference[0].spans[0], place.reference[0])
    start, end = _relation_span(place, whole, sentence)
    lid = ph.Lid((thing.span[0], end) if opens else thing.span, words)
    moved: Parts = [whole] if opens else [ph.Particle((start, end), particle), whole]
    instead: dict[int, Parts] = {id(thing): [lid], id(verb): [moving], id(place): moved}
    return [p for part in parts for p in instead.get(id(part), [part])]


_OF_LIDS = ("on", "off", "from")
"""Relations of a lid to what it belongs to."""


def with_lid_as_pronoun(
    clause: Parts, previous: Parts, lexicon: Lexicon, sentence: Normalised
) -> Parts:
    """Takes "it" in "…, and put it on the jar", "… take it off the jar" for the lid before it."""
    lid = next((part for part in previous if isinstance(part, ph.Thing)), None)
    it = next((part for part in clause if isinstance(part, ph.Thing)), None)
    placed = any(isinstance(part, ph.Place) and part.relation in _OF_LIDS for part in clause)
    if lid is None or it is None or not (it.ref.pronoun and placed):
        return clause
    parted = part_and_owner(lid, lexicon, sentence)
    name = parted[0] if parted else lid.ref.text.casefold()
    if name not in lexicon.lids:
        return clause
    named = ph.Thing(it.span, g.ObjectRef(text=name, spans=it.ref.spans))
    return [named if part is it else part for part in clause]


def sets_lid_down(frame: g.Frame, before: g.Frame, lexicon: Lexicon) -> bool:
    """Check for a lid that is taken off, or set down, once it is off: "…, and set it down"."""
    if not isinstance(before.goal, g.Open) or frame.constraints or frame.query or frame.dialogue:
        return False
    lid, it = before.goal.part, frame.object is not None and frame.object.pronoun
    if isinstance(frame.goal, g.Open) and it and frame.goal.part in (lid, None):
        return True  # "open the jar, and leave it open"
    if lid not in lexicon.lids:
        return False
    if isinstance(frame.goal, g.Open) and frame.goal.part == lid:
        return (
            frame.object is not None
            and before.object is not None
            and (frame.object.text.casefold().endswith(before.object.text.casefold()))
        )  # "unscrew the bottle cap and take it off the wine bottle"
    return it and isinstance(frame.goal, g.SetDown)


def _with_lid_of_known_object(
    parts: Sequence[ph.Part], verb: ph.Verb, asks: Verb | None, off: Verb | None, lid: ph.Lid
) -> Parts:
    """Takes "lift the lid", "put the lid back on" for the lid of what was spoken of before."""
    said = [p for p in parts if not (isinstance(p, ph.Thing) and p.span == lid.span)]
    if asks is not None and asks.goal in ("open", "remove", "close"):
        return [*said, lid, _pronoun_after(lid)]
    if asks is not None and asks.goal == "lift" and off is not None:
        return [*said, ph.Particle(verb.span, "off"), lid, _pronoun_after(lid)]
    return list(parts)


def _relation_span(place: ph.Place, whole: ph.Thing, sentence: Normalised) -> g.Span:
    """Span of the relation of a place, without the object and its article."""
    start, end = place.span[0], whole.span[0]
    return start, start + len(sentence.original[start:end].rstrip())


# --- heights ----------------------------------------------------------------------------------


def _with_lift_height(part: ph.Part, sentence: Normalised) -> ph.Part:
    """Takes "10 cm above the table" for how high it is lifted; "at 10 cm …" is where to touch."""
    if not isinstance(part, ph.Constraint) or not isinstance(part.constraint, g.ContactRegion):
        return part
    clause = part.constraint
    height = clause.height
    touched = sentence.words_as_written(part.span).casefold().startswith("at ")
    if height is None or height.origin != "table" or height.bound != "exact" or touched:
        return part
    return ph.Length(part.span, height.value, "exact", above="table")

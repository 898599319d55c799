"""Parts from phrases of outcomes, wanted or to be avoided, of questions and of remarks."""

from __future__ import annotations

from typing import Any, cast

from grammar.frames import command as g
from grammar.frames.constraints import CONSTRAINTS, new_constraint
from grammar.phrases import phrase_parts as ph
from grammar.phrases.token_reader import Children, TokenReader, parts_in, things_in, tokens_in
from grammar.words.phrase_lexer import Token
from grammar.words.plurals import singular

_STOPS = {"moves": "moves", "slides": "moves", "tips": "tips", "about_to_tip": "about_to_tip",
          "tilts": "about_to_tip"}  # fmt: skip
"""Events at which a push may be stopped."""

_ENDS = ("ends_up", "opens", "closes")
"""Events that say what has become of the object, so that it is done then."""

_PURPOSES = {"moves": "moves", "slides": "slides", "tips": "tips", "about_to_tip": "tips",
             "tilts": "tilts", "turns": "turns", "stays_upright": "stays_upright"}  # fmt: skip
"""Events that a question may ask about."""

_FORBIDDEN = {"moves": "no_move"} | {
    kind.words.event: name for name, kind in CONSTRAINTS.items() if kind.words.event
}
"""Event that may be avoided → constraint that forbids it."""

_AVOIDED = ("AVOIDING", "AVOID", "KEEPS", "KEPT", "STAYS")
_PROPERTIES = ("HOW", "HOW_MUCH_IN", "QUALITY", "THE_PROPERTY", "THE_PROPERTY_OF", "THE_SIDE_OF",
               "ITS_PROPERTY")  # fmt: skip

STANDS_BESIDE = ("next_to", "touching", "left_of", "right_of", "in_front_of", "behind", "on", "in",
                 "between", "front_left_of", "front_right_of", "behind_left_of",
                 "behind_right_of")  # fmt: skip
"""Relations in which a question may ask whether an object stands."""

_STATES: dict[str, type[g.Upright | g.Topple | g.Open | g.Close]] = {
    "lying": g.Topple, "open": g.Open, "closed": g.Close,
}  # fmt: skip
"""What is asked to be so already → the goal that would bring it about."""

_HELD = {"in": "fill", "on": "load", "under": "support", "below": "support"}
"""Where things are asked for → the property of the object that has them there."""

QUESTIONS: dict[str, dict[str, Any]] = {
    "what_if": {"query": "predict"},  # what happens if
    "how_much_spills": {"query": "predict", "event": "spills"},  # how much will spill
    "possible": {"query": "possible"},  # is it possible to
    "how_hard": {"query": "how_hard"},  # how hard must I
    "which_can": {"query": "capable"},  # which of them can you
    "destination": {"query": "predict", "event": "ends_up"},  # where will it be
    "did": {"query": "did", "whole": True},  # what did you do
    "seen": {"query": "seen", "whole": True},  # what do you see
    "where": {"query": "where"},  # where can I
    "affordances": {"query": "affordances", "whole": True},  # what can you do with the box
    "abilities": {"query": "affordances", "whole": True},  # what can you do
    "how_sure": {"query": "why", "state": g.Parameters(), "whole": True},  # how do you know that
}
"""Node → what is asked."""


def _first_thing(children: Children) -> ph.Thing | None:
    return next(iter(things_in(children)), None)


class Outcomes(TokenReader):
    """Builders of parts for outcomes: to be avoided, wanted, or to stop at."""

    def avoid_part(self, children: Children) -> list[ph.Part]:
        """Without toppling it; so that it does not fall."""
        return self._with_manner(children, [self._avoidance(children)])

    def further_part(self, children: Children) -> ph.Avoid:
        """… or turning it."""
        return self._avoidance(children, further=True)

    def _avoidance(self, children: Children, *, further: bool = False) -> ph.Avoid:
        word = tokens_in(children, *_AVOIDED)[0]
        kind, thing = self.lexicon.value_of(word.type, str(word)), _first_thing(children)
        return ph.Avoid(self.span_of(children), kind, str(word), thing, further)

    def neither_part(self, children: Children) -> list[ph.Part]:
        """So that it neither tips nor turns."""
        thing = things_in(children)[0]
        parts: list[ph.Part] = []
        for token in tokens_in(children, "EVENT"):
            event = self.value_of([token], "EVENT")
            if event not in _FORBIDDEN:
                suggestion = "so that it does not tip"
                raise self.does_not_apply_error([token], "cannot be avoided", suggestion)
            span = self.span_of([token] if parts else children)
            parts.append(ph.Avoid(span, _FORBIDDEN[event], str(token), thing))
        return parts

    def _with_manner(self, children: Children, parts: list[ph.Part]) -> list[ph.Part]:
        """The manner of "so lightly that…", and what should come of it."""
        if kind := self.value_of(children[:1], "SO_MANNER"):
            span = self.span_of(children[:1])
            return [ph.Constraint(span, new_constraint(kind, spans=(span,))), *parts]
        return parts

    def no_touch_part(self, children: Children) -> ph.Constraint:
        """Without touching the mug."""
        things = things_in(children)
        subject = things[0] if tokens_in(children, "DOES_NOT") else None
        touched = things[-1].ref if things and things[-1] is children[-1] else None
        span = self.span_of(children)
        return ph.Constraint(span, g.NoTouch(object=touched, spans=(span,)), subject)

    def further_no_touch_part(self, children: Children) -> ph.FurtherNoTouch:
        """… or touching the mug."""
        part, either = self.no_touch_part(children), bool(tokens_in(children, "OR"))
        return ph.FurtherNoTouch(part.span, cast(g.NoTouch, part.constraint), either)

    def keep_off_part(self, children: Children) -> ph.Constraint:
        """Keep 5 cm away from the mug."""
        span = self.span_of(children)
        clearance = next(iter(self.lengths_in(children)), None)
        if self.bound_of(children) == "at_most":
            suggestion = "keep at least 5 cm away from it"
            raise self.does_not_apply_error(children, "is no distance to keep", suggestion)
        other = things_in(children)[-1].ref
        return ph.Constraint(span, g.NoTouch(object=other, clearance=clearance, spans=(span,)))

    def result_part(self, children: Children) -> list[ph.Part]:
        """So that it slightly moves."""
        event = self.value_of(children, "EVENT")
        amount = self.value_of(children, "AMOUNT") or None
        span, subject = self.span_of(children), things_in(children)[0]
        if event == "about_to_tip":
            stop = g.Until(event="about_to_tip", spans=(span,))
            return self._with_manner(children, [ph.Constraint(span, stop, subject)])
        return self._with_manner(children, [ph.Result(span, event, subject, amount)])

    def result_touching_part(self, children: Children) -> list[ph.Part]:
        """So that it touches the mug."""
        relation = self.value_of(children, "TOUCHES")
        if relation == "in_line":
            raise self.does_not_apply_error(children, "is no place", "until it is in line with it")
        subject, other = things_in(children)
        span = self.span_of(children)
        result = ph.Result(self.span_of(children[:2]), "ends_up", subject)
        return self._with_manner(children, [result, ph.Place(span, relation, (other.ref,))])

    def until_part(self, children: Children) -> ph.Constraint | ph.Result:
        """Until it touches the mug; until it is in the middle of the table."""
        things, span = things_in(children), self.span_of(children)
        said = self.value_of(children, "EVENT")
        if tokens_in(children, "TOUCHES", "TOUCHING", "LEVEL_WITH"):
            event = self.value_of(children, "TOUCHES", self.value_of(children, "LEVEL_WITH"))
            event = event or "touching"
            subject = things[0] if len(things) > 1 else None
            if self.value_of(children, "UNTIL") == "before":
                if event != "touching":
                    message = "is no event to stop at"
                    raise self.does_not_apply_error(children, message, "until it touches the mug")
                return ph.Constraint(span, g.NoTouch(object=things[-1].ref, spans=(span,)), subject)
            stop = g.Until(event=cast(Any, event), object=things[-1].ref, spans=(span,))
            return ph.Constraint(span, stop, subject)
        if not self.value_of(children, "UNTIL") and said in _ENDS:
            return ph.Result(span, said, things[0])
        event = "edge" if tokens_in(children, "REACHES_EDGE") else self._stop_event(children)
        return ph.Constraint(span, g.Until(event=cast(Any, event), spans=(span,)), things[0])

    def _stop_event(self, children: Children) -> str:
        """The event before or at which a push is stopped."""
        said, message = self.value_of(children, "EVENT"), "is no event to stop at"
        if said not in _STOPS:
            raise self.does_not_apply_error(
                children, message, "until it touches the mug", "until it moves",
                "until it almost tips",
            )  # fmt: skip
        if self.value_of(children, "UNTIL") != "before":
            return _STOPS[said]
        if said != "tips":
            raise self.does_not_apply_error(children, message, "until it almost tips")
        return "about_to_tip"

    def purpose_part(self, children: Children) -> ph.Purpose:
        """To make it slide; before it tips."""
        said = self.value_of(children, "EVENT_INFINITIVE") or self.value_of(children, "EVENT")
        if said not in _PURPOSES:
            raise self.does_not_apply_error(children, "cannot be asked about", "to make it slide")
        before, event = bool(tokens_in(children, "BEFORE")), cast(g.Event, _PURPOSES[said])
        return ph.Purpose(self.span_of(children), event, _first_thing(children), before)


class Questions(TokenReader):
    """Builders of parts for questions and remarks."""

    def question_part(self, children: Children, **asked: Any) -> ph.Ask:
        """The opening of a question, with the object if it names one."""
        return ph.Ask(self.span_of(children), thing=_first_thing(children), **asked)

    def passive_part(self, children: Children) -> list[ph.Part]:
        """A passive condition: "what happens if the box is pushed", "if pushed"."""
        span = self.span_of(children[:1])
        asks = tokens_in(children[:1], "WHAT_IF")
        return [ph.Ask(span, "predict") if asks else ph.If(span), *self._passive_parts(children)]

    def can_part(self, children: Children) -> list[ph.Part]:
        """Can the box be pushed; can it please be pushed."""
        span, parts = self.span_of(children[:1]), self._passive_parts(children)
        if "please" in self.sentence.original.casefold():
            return [ph.Filler(span, anywhere=False, asks=True), *parts]
        return [ph.Ask(span, "possible"), *parts]

    def _passive_parts(self, children: Children) -> list[ph.Part]:
        """A participle, what it is about, and how."""
        token = tokens_in(children, "VERB_ED")[0]
        word = self.lexicon.verb_words["VERB_ED"][str(token)]
        return [ph.Verb(self.span_of([token]), word, passive=True), *parts_in(children)]

    def will_part(self, children: Children) -> ph.Ask | list[ph.Part]:
        """Will it topple; could it topple; can it be toppled."""
        event = self.value_of(children, "EVENT_INFINITIVE")
        said = tokens_in(children, "EVENT_INFINITIVE")
        if children[0].type == "CAN" and said[0].startswith("be "):
            verb = ph.Verb(self.span_of(said), "topple" if event == "tips" else "move", True)
            return [ph.Ask(self.span_of(children[:1]), "possible"), *things_in(children), verb]
        return self.question_part(children, query="predict", event=event)

    def can_you_part(self, children: Children) -> ph.Ask:
        """Can you."""
        polite = str(children[0]) == "can you"
        return self.question_part(children, query=None if polite else "possible")

    def why_part(self, children: Children) -> ph.Ask:
        """Why; why did you."""
        negated = self.value_of(children, "WHY_DID") == "not"
        whole = children[0].type == "WHY"
        return self.question_part(children, query="why", whole=whole, negated=negated)

    def compare_part(self, children: Children) -> ph.Ask:
        """Which is heavier, the box or the mug; which is the heaviest."""
        span, things = self.span_of(children), things_in(children)
        if children[0].type == "THAN":  # "and than the mug?"
            return ph.Ask(span, "compare", than=(things[0].ref,), whole=True)
        which, _, quality = (
            self.value_of(children, "COMPARATIVE") or self.value_of(children, "SUPERLATIVE")
        ).partition(" ")
        superlative = tokens_in(children, "SUPERLATIVE")
        if not superlative and children[0].type in ("WHICH_IS", "WHICH_OF") and len(things) < 2:
            superlative = tokens_in(children, "COMPARATIVE")  # "which of them is heavier?"
            quality = self.lexicon.adjectives[str(superlative[0])]
        if superlative:
            word = tokens_in(children, "WORD", "CAN")
            things = [self._most(superlative, cast(g.Quality, quality), word, things)]
        elif len(things) < 2:  # "is the mug taller?"; "taller than the mug?"
            _, end = self.span_of(children[-1:])
            it = ph.Thing((end, end), g.ObjectRef(text="it", pronoun=True))
            things = [it, *things] if tokens_in(children, "THAN") else [*things, it]
        others = tuple(thing.ref for thing in things[1:])
        return ph.Ask(span, "compare", thing=things[0], which=(which,), than=others, whole=True)

    def _most(
        self,
        superlative: Children,
        quality: g.Quality,
        name: list[Token],
        among: list[ph.Thing],
    ) -> ph.Thing:
        """The heaviest; of a name that is said before or behind, the one that is."""
        at = self.span_of(superlative)
        if among:
            ref = among[0].ref
            named = "" if ref.pronoun or ref.quantifier else ref.text
            noun = singular(ref.noun or named)
            chosen = (quality, *ref.qualities)
            text = f"{superlative[0].split()[0]} {noun or 'one'}"
            spans = tuple(sorted([at, *ref.spans]))
            one = g.ObjectRef(text=text, spans=spans, qualities=chosen, noun=noun)
            return ph.Thing(at, one)
        spans = tuple(sorted([at, self.span_of(name)])) if name else (at,)
        written = [self.sentence.words_as_written(self.span_of([word])) for word in name]
        told = [self.lexicon.adjectives[word] for word in name if word in self.lexicon.adjectives]
        nouns = [said for said in written if said.casefold() not in self.lexicon.adjectives]
        one = g.ObjectRef(
            text=" ".join([superlative[0].split()[0], *written]),
            spans=spans,
            qualities=(quality, *told),
            noun=" ".join(nouns),
        )
        return ph.Thing(at, one)

    def seen_at_part(self, children: Children) -> ph.Ask:
        """A question: what is next to the box."""
        span, where = self.span_of(children), children[-1]
        if isinstance(where, ph.Place) and (which := _HELD.get(where.relation)):
            (other,) = cast("tuple[g.ObjectRef]", where.reference)
            thing = ph.Thing(span, other)
            return ph.Ask(span, "value", thing=thing, which=(which,), whole=True)
        return ph.Ask(span, "seen", state=self._relation_asked(where, children), whole=True)

    def _relation_asked(self, where: ph.Part, children: Children) -> g.Place:
        """The place that a question asks about."""
        span = self.span_of(children)
        if (
            not isinstance(where, ph.Place)
            or where.relation not in STANDS_BESIDE
            or not isinstance(where.reference, tuple)
        ):
            hint = "is it next to the mug?"
            raise self.does_not_apply_error(children, "is no place to ask about", hint)
        relation = cast(g.Relation, where.relation)
        return g.Place(relation=relation, reference=where.reference, spans=(span,))

    def standing_part(self, children: Children) -> ph.Ask:
        """Is the box standing; is it next to the mug; is it on the table."""
        span, thing, where = self.span_of(children), things_in(children)[0], children[-1]
        said = self.value_of(children, "STANDING")
        state: g.State = _STATES.get(said, g.Upright)(spans=(span,))
        if tokens_in(children, "ON_TABLE"):
            state = g.SetDown(spans=(span,))
        elif isinstance(where, ph.Place):
            state = self._relation_asked(where, children)
        return ph.Ask(span, "value", thing=thing, state=state, whole=True)

    def edge_distance_part(self, children: Children) -> ph.Ask:
        """A question: how far is the box from the edge."""
        span, region = self.span_of(children), self.value_of(children, "FROM_REGION")
        state = g.Displace(away_from=cast(g.TableRegion, region), spans=(span,))
        return ph.Ask(span, "value", thing=things_in(children)[0], state=state, whole=True)

    def distance_part(self, children: Children) -> ph.Ask:
        """A question for a distance: how far is the box from the mug, how far apart are they."""
        span, (one, *others) = self.span_of(children), things_in(children)
        which, than = ("distance",), tuple(other.ref for other in others)
        return ph.Ask(span, "value", thing=one, which=which, than=than, whole=True)

    def same_with_part(self, children: Children) -> list[ph.Part]:
        """Do the same with the mug."""
        return [ph.Remark(self.span_of(children[:1]), "same"), *things_in(children)]

    def how_about_part(self, children: Children) -> list[ph.Part]:
        """The same, asked of something else: "how about the mug"."""
        mind, said = children
        span = self.span_of([mind])
        goes_on = ph.Filler(span, anywhere=False, goes_on=True)
        return [ph.Remark(span, "repeat"), goes_on, *(said if isinstance(said, list) else [said])]

    def value_part(self, children: Children) -> ph.Ask:
        """A question: "how heavy is it"."""
        which, thing = self._parameters_and_thing(children)
        return ph.Ask(self.span_of(children), "value", thing=thing, which=which, whole=True)

    def explore_part(self, children: Children) -> ph.Explore:
        """Find out how heavy it is."""
        return ph.Explore(self.span_of(children), *self._parameters_and_thing(children))

    def _parameters_and_thing(self, children: Children) -> tuple[tuple[str, ...], ph.Thing]:
        said = tokens_in(children, *_PROPERTIES)
        which = tuple(self.lexicon.value_of(token.type, str(token)) for token in said)
        which = which or (("position",) if tokens_in(children, "WHERE_IS") else ("mass",))
        if things := things_in(children):
            return which, things[0]
        start, _ = self.span_of(children[-1:])
        span = start, start + len("its")
        return which, ph.Thing(span, g.ObjectRef(text="its", spans=(span,), pronoun=True))

    def undo_part(self, children: Children) -> list[ph.Part]:
        """Undo that; undo the push of the box."""
        return [ph.Remark(self.span_of(children[:1]), "undo"), *things_in(children)]

    def more_part(self, children: Children) -> list[ph.Part]:
        """More; bit more."""
        span, amount = self.span_of(children), self.value_of(children, "MORE")
        return [ph.Remark(span, "more"), *([ph.Amount(span, amount)] if amount else [])]

    def not_there_part(self, children: Children) -> ph.NotThere:
        """Not to the right."""
        way = cast(g.Direction, self.value_of(children, "DIRECTION"))
        return ph.NotThere(self.span_of(children), way)

    def not_this_part(self, children: Children) -> ph.NotThis:
        """Not the mug."""
        if str(children[0]) != "not":
            suggestion = "without touching it"
            raise self.does_not_apply_error(children, "says nothing to avoid", suggestion)
        return ph.NotThis(self.span_of(children), children[1])

"""What phrases say of outcomes (what must not happen, what should), questions and remarks."""

from __future__ import annotations

from typing import Any, cast

from grammar.errors import ParseError
from grammar.frames import command as g
from grammar.frames.constraints import CONSTRAINTS, new_constraint
from grammar.phrases.phrase_parts import (
    AskPart,
    AvoidPart,
    ConstraintPart,
    ExplorePart,
    FurtherNoTouchPart,
    IfPart,
    NotThisPart,
    Part,
    PlacePart,
    PurposePart,
    RemarkPart,
    ResultPart,
    ThingPart,
    VerbPart,
)
from grammar.phrases.token_reader import TokenReader
from grammar.words.phrase_lexer import Token

_STOPS = {"moves": "moves", "slides": "moves", "tips": "tips", "about_to_tip": "about_to_tip",
          "tilts": "about_to_tip"}  # fmt: skip
"""Events at which a push may be stopped."""

_PURPOSES = {"moves": "moves", "slides": "slides", "tips": "tips", "about_to_tip": "tips",
             "tilts": "tilts", "turns": "turns", "stays_upright": "stays_upright"}  # fmt: skip
"""Events that a question may ask about."""

_FORBIDDEN = {"moves": "no_move"} | {
    kind.words.event: name for name, kind in CONSTRAINTS.items() if kind.words.event
}
"""Event that may be avoided → constraint that forbids it."""

Children = list[Any]


def _things(children: Children) -> list[ThingPart]:
    return [child for child in children if isinstance(child, ThingPart)]


class Phrases:
    """What all phrases need: the words, and a way to refuse them."""

    _w: TokenReader

    def _refuse(self, children: Children, message: str, *suggestions: str) -> ParseError:
        span = self._w.span(children)
        quoted = f'"{self._w.sentence.written(span)}"'
        return ParseError("does_not_apply", f"{quoted} {message}", span, suggestions)


class Outcomes(Phrases):
    """What must not happen, what should happen, and when to stop."""

    def avoid(self, children: Children) -> list[Part]:
        """Without toppling it; so that it does not fall."""
        word = next(c for c in children if isinstance(c, Token) and c.type in _AVOIDED)
        thing = next(iter(_things(children)), None)
        kind = self._w.lexicon.value(word.type, str(word))
        parts: list[Part] = [AvoidPart(self._w.span(children), kind, str(word), thing)]
        return self._with_manner(children, parts)

    def neither(self, children: Children) -> list[Part]:
        """So that it neither tips nor turns."""
        thing = _things(children)[0]
        parts: list[Part] = []
        for token in children:
            if not (isinstance(token, Token) and token.type == "EVENT"):
                continue
            event = self._w.value([token], "EVENT")
            if event not in _FORBIDDEN:
                raise self._refuse([token], "cannot be avoided", "so that it does not tip")
            spans = children if not parts else [token]
            kind = _FORBIDDEN[event]
            parts.append(AvoidPart(self._w.span(spans), kind, str(token), thing))
        return parts

    def _with_manner(self, children: Children, parts: list[Part]) -> list[Part]:
        """The manner of "so lightly that…", and what should come of it."""
        first = children[0]
        if isinstance(first, Token) and first.type == "SO_MANNER":
            span = self._w.span([first])
            manner = new_constraint(self._w.value([first], "SO_MANNER"), spans=(span,))
            return [ConstraintPart(span, manner), *parts]
        return parts

    def further(self, children: Children) -> AvoidPart:
        """… or turning it."""
        word = next(c for c in children if isinstance(c, Token) and c.type in _AVOIDED)
        thing = next(iter(_things(children)), None)
        kind = self._w.lexicon.value(word.type, str(word))
        return AvoidPart(self._w.span(children), kind, str(word), thing, further=True)

    def no_touch(self, children: Children) -> ConstraintPart:
        """Without touching the mug."""
        things = _things(children)
        subject = things[0] if any(t == "DOES_NOT" for t in _kinds(children)) else None
        touched = things[-1].ref if things and things[-1] is children[-1] else None
        span = self._w.span(children)
        return ConstraintPart(span, g.NoTouch(object=touched, spans=(span,)), subject)

    def further_no_touch(self, children: Children) -> FurtherNoTouchPart:
        """… or touching the mug."""
        part, either = self.no_touch(children), "OR" in _kinds(children)
        return FurtherNoTouchPart(part.span, cast(g.NoTouch, part.constraint), either)

    def keep_off(self, children: Children) -> ConstraintPart:
        """Keep 5 cm away from the mug."""
        span = self._w.span(children)
        clearance = next(iter(self._w.lengths(children)), None)
        if self._w.bound(children) == "at_most":
            raise self._refuse(
                children, "is no distance to keep", "keep at least 5 cm away from it"
            )
        other = _things(children)[-1].ref
        return ConstraintPart(span, g.NoTouch(object=other, clearance=clearance, spans=(span,)))

    def result(self, children: Children) -> list[Part]:
        """So that it slightly moves."""
        event = self._w.value(children, "EVENT")
        amount = self._w.value(children, "AMOUNT") or None
        span, subject = self._w.span(children), _things(children)[0]
        if event == "about_to_tip":
            stop = g.Until(event="about_to_tip", spans=(span,))
            return self._with_manner(children, [ConstraintPart(span, stop, subject)])
        return self._with_manner(children, [ResultPart(span, event, subject, amount)])

    def result_touching(self, children: Children) -> list[Part]:
        """So that it touches the mug."""
        relation = self._w.value(children, "TOUCHES")
        if relation == "in_line":
            raise self._refuse(children, "is no place", "until it is in line with it")
        subject, other = _things(children)
        span = self._w.span(children)
        result = ResultPart(self._w.span(children[:2]), "ends_up", subject)
        return self._with_manner(children, [result, PlacePart(span, relation, (other.ref,))])

    def until(self, children: Children) -> ConstraintPart:
        """Until it touches the mug."""
        things, kinds, span = _things(children), _kinds(children), self._w.span(children)
        if "TOUCHES" in kinds or "TOUCHING" in kinds:
            event = self._w.value(children, "TOUCHES", "touching")
            subject = things[0] if len(things) > 1 else None
            stop = g.Until(event=cast(Any, event), object=things[-1].ref, spans=(span,))
            return ConstraintPart(span, stop, subject)
        event = "edge"
        if "REACHES_EDGE" not in kinds:
            said = self._w.value(children, "EVENT")
            if said not in _STOPS:
                raise self._refuse(
                    children, "is no event to stop at",
                    "until it touches the mug", "until it moves", "until it almost tips",
                )  # fmt: skip
            if self._w.value(children, "UNTIL") == "before":
                said = "about_to_tip" if said == "tips" else ""
            if said not in _STOPS:
                raise self._refuse(children, "is no event to stop at", "until it almost tips")
            event = _STOPS[said]
        return ConstraintPart(span, g.Until(event=cast(Any, event), spans=(span,)), things[0])

    def purpose(self, children: Children) -> PurposePart:
        """To make it slide; before it tips."""
        said = self._w.value(children, "EVENT_INFINITIVE") or self._w.value(children, "EVENT")
        if said not in _PURPOSES:
            raise self._refuse(children, "cannot be asked about", "to make it slide")
        thing = next(iter(_things(children)), None)
        before = "BEFORE" in _kinds(children)
        return PurposePart(self._w.span(children), cast(g.Event, _PURPOSES[said]), thing, before)


class Questions(Phrases):
    """What is asked, and what remarks do."""

    def _ask(self, children: Children, query: g.Query | None, **more: Any) -> AskPart:
        thing = next(iter(_things(children)), None)
        return AskPart(self._w.span(children), query, thing=thing, **more)

    def what_if(self, children: Children) -> AskPart:
        """What happens if."""
        return self._ask(children, "predict")

    def passive(self, children: Children) -> list[Part]:
        """What happens if the box is pushed; if pushed."""
        ask = isinstance(children[0], Token) and children[0].type == "WHAT_IF"
        span = self._w.span(children[:1])
        opening: Part = AskPart(span, "predict") if ask else IfPart(span)
        return [opening, self._done(children), *_things(children)]

    def _done(self, children: Children) -> VerbPart:
        token = next(c for c in children if isinstance(c, Token) and c.type == "VERB_ED")
        word = self._w.lexicon.verb_words["VERB_ED"][str(token)]
        return VerbPart(self._w.span([token]), word, passive=True)

    def if_(self, children: Children) -> IfPart:
        """If."""
        return IfPart(self._w.span(children))

    def will(self, children: Children) -> AskPart:
        """Will it topple."""
        event = cast(g.Event, self._w.value(children, "EVENT_INFINITIVE"))
        return self._ask(children, "predict", event=event)

    def how_much_spills(self, children: Children) -> AskPart:
        """How much will spill."""
        return self._ask(children, "predict", event="spills")

    def can_you(self, children: Children) -> AskPart:
        """Can you."""
        return self._ask(children, None if str(children[0]) == "can you" else "possible")

    def possible(self, children: Children) -> AskPart:
        """Is it possible to."""
        return self._ask(children, "possible")

    def can(self, children: Children) -> list[Part]:
        """Can the box be pushed."""
        ask = AskPart(self._w.span(children[:1]), "possible")
        return [ask, self._done(children), *_things(children)]

    def how_hard(self, children: Children) -> AskPart:
        """How hard must I."""
        return self._ask(children, "how_hard")

    def where(self, children: Children) -> AskPart:
        """Where can I."""
        return self._ask(children, "where")

    def why(self, children: Children) -> AskPart:
        """Why; why did you."""
        whole = children[0].type == "WHY"
        negated = not whole and self._w.value(children, "WHY_DID") == "not"
        return self._ask(children, "why", whole=whole, negated=negated)

    def affordances(self, children: Children) -> AskPart:
        """What can you do with the box."""
        return self._ask(children, "affordances", whole=True)

    def value(self, children: Children) -> AskPart:
        """How heavy is it."""
        which, thing = self._parameter(children)
        return AskPart(self._w.span(children), "value", thing=thing, which=which, whole=True)

    def explore(self, children: Children) -> ExplorePart:
        """Find out how heavy it is."""
        which, thing = self._parameter(children)
        return ExplorePart(self._w.span(children), which, thing)

    def _parameter(self, children: Children) -> tuple[tuple[str, ...], ThingPart]:
        which = tuple(
            self._w.lexicon.value(token.type, str(token))
            for token in children
            if isinstance(token, Token) and token.type in _PROPERTIES
        )
        which = which or (("position",) if "WHERE_IS" in _kinds(children) else ("mass",))
        if things := _things(children):
            return which, things[0]
        start, _ = self._w.span(children[-1:])
        its = g.ObjectRef(text="its", spans=((start, start + 3),), pronoun=True)
        return which, ThingPart((start, start + 3), its)

    def undo(self, children: Children) -> list[Part]:
        """Undo that; undo the push of the box."""
        return [RemarkPart(self._w.span(children[:1]), "undo"), *_things(children)]

    def stop(self, children: Children) -> RemarkPart:
        """Stop."""
        return RemarkPart(self._w.span(children), "stop")

    def repeat(self, children: Children) -> RemarkPart:
        """Do it again; again."""
        return RemarkPart(self._w.span(children), "repeat")

    def more(self, children: Children) -> RemarkPart:
        """Further."""
        return RemarkPart(self._w.span(children), "more")

    def correct(self, children: Children) -> RemarkPart:
        """No; I meant."""
        return RemarkPart(self._w.span(children), "correct")

    def not_this(self, children: Children) -> NotThisPart:
        """Not the mug."""
        if str(children[0]) != "not":
            raise self._refuse(children, "says nothing to avoid", "without touching it")
        return NotThisPart(self._w.span(children), children[1])


_AVOIDED = ("AVOIDING", "AVOID", "KEEPS", "KEPT", "STAYS")


_PROPERTIES = (
    "HOW",
    "HOW_MUCH_IN",
    "THE_PROPERTY",
    "THE_PROPERTY_OF",
    "THE_SIDE_OF",
    "ITS_PROPERTY",
)


def _kinds(children: Children) -> list[str]:
    return [child.type for child in children if isinstance(child, Token)]

"""Parts from phrases of outcomes, wanted or to be avoided, of questions and of remarks."""

from __future__ import annotations

from typing import Any, cast

from grammar.errors import ParseError
from grammar.frames import command as g
from grammar.frames.constraints import CONSTRAINTS, new_constraint
from grammar.phrases import phrase_parts as ph
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


def _things_in(children: Children) -> list[ph.Thing]:
    return [child for child in children if isinstance(child, ph.Thing)]


class Phrases:
    """Base of the builders of parts: the words, and the error for those that do not apply."""

    _w: TokenReader

    def _does_not_apply_error(
        self, children: Children, message: str, *suggestions: str
    ) -> ParseError:
        span = self._w.span_of(children)
        quoted = f'"{self._w.sentence.words_as_written(span)}"'
        return ParseError("does_not_apply", f"{quoted} {message}", span, suggestions)


class Outcomes(Phrases):
    """Builders of parts for outcomes: to be avoided, wanted, or to stop at."""

    def avoid_part(self, children: Children) -> list[ph.Part]:
        """Without toppling it; so that it does not fall."""
        word = next(c for c in children if isinstance(c, Token) and c.type in _AVOIDED)
        thing = next(iter(_things_in(children)), None)
        kind = self._w.lexicon.value_of(word.type, str(word))
        parts: list[ph.Part] = [ph.Avoid(self._w.span_of(children), kind, str(word), thing)]
        return self._with_manner(children, parts)

    def neither_part(self, children: Children) -> list[ph.Part]:
        """So that it neither tips nor turns."""
        thing = _things_in(children)[0]
        parts: list[ph.Part] = []
        for token in children:
            if not (isinstance(token, Token) and token.type == "EVENT"):
                continue
            event = self._w.value_of([token], "EVENT")
            if event not in _FORBIDDEN:
                raise self._does_not_apply_error(
                    [token], "cannot be avoided", "so that it does not tip"
                )
            spans = children if not parts else [token]
            kind = _FORBIDDEN[event]
            parts.append(ph.Avoid(self._w.span_of(spans), kind, str(token), thing))
        return parts

    def _with_manner(self, children: Children, parts: list[ph.Part]) -> list[ph.Part]:
        """The manner of "so lightly that…", and what should come of it."""
        first = children[0]
        if isinstance(first, Token) and first.type == "SO_MANNER":
            span = self._w.span_of([first])
            manner = new_constraint(self._w.value_of([first], "SO_MANNER"), spans=(span,))
            return [ph.Constraint(span, manner), *parts]
        return parts

    def further_part(self, children: Children) -> ph.Avoid:
        """… or turning it."""
        word = next(c for c in children if isinstance(c, Token) and c.type in _AVOIDED)
        thing = next(iter(_things_in(children)), None)
        kind = self._w.lexicon.value_of(word.type, str(word))
        return ph.Avoid(self._w.span_of(children), kind, str(word), thing, further=True)

    def no_touch_part(self, children: Children) -> ph.Constraint:
        """Without touching the mug."""
        things = _things_in(children)
        subject = things[0] if any(t == "DOES_NOT" for t in _token_kinds(children)) else None
        touched = things[-1].ref if things and things[-1] is children[-1] else None
        span = self._w.span_of(children)
        return ph.Constraint(span, g.NoTouch(object=touched, spans=(span,)), subject)

    def further_no_touch_part(self, children: Children) -> ph.FurtherNoTouch:
        """… or touching the mug."""
        part, either = self.no_touch_part(children), "OR" in _token_kinds(children)
        return ph.FurtherNoTouch(part.span, cast(g.NoTouch, part.constraint), either)

    def keep_off_part(self, children: Children) -> ph.Constraint:
        """Keep 5 cm away from the mug."""
        span = self._w.span_of(children)
        clearance = next(iter(self._w.lengths_in(children)), None)
        if self._w.bound_of(children) == "at_most":
            raise self._does_not_apply_error(
                children, "is no distance to keep", "keep at least 5 cm away from it"
            )
        other = _things_in(children)[-1].ref
        return ph.Constraint(span, g.NoTouch(object=other, clearance=clearance, spans=(span,)))

    def result_part(self, children: Children) -> list[ph.Part]:
        """So that it slightly moves."""
        event = self._w.value_of(children, "EVENT")
        amount = self._w.value_of(children, "AMOUNT") or None
        span, subject = self._w.span_of(children), _things_in(children)[0]
        if event == "about_to_tip":
            stop = g.Until(event="about_to_tip", spans=(span,))
            return self._with_manner(children, [ph.Constraint(span, stop, subject)])
        return self._with_manner(children, [ph.Result(span, event, subject, amount)])

    def result_touching_part(self, children: Children) -> list[ph.Part]:
        """So that it touches the mug."""
        relation = self._w.value_of(children, "TOUCHES")
        if relation == "in_line":
            raise self._does_not_apply_error(children, "is no place", "until it is in line with it")
        subject, other = _things_in(children)
        span = self._w.span_of(children)
        result = ph.Result(self._w.span_of(children[:2]), "ends_up", subject)
        return self._with_manner(children, [result, ph.Place(span, relation, (other.ref,))])

    def until_part(self, children: Children) -> ph.Constraint:
        """Until it touches the mug."""
        things, kinds, span = (
            _things_in(children),
            _token_kinds(children),
            self._w.span_of(children),
        )
        if "TOUCHES" in kinds or "TOUCHING" in kinds:
            event = self._w.value_of(children, "TOUCHES", "touching")
            subject = things[0] if len(things) > 1 else None
            stop = g.Until(event=cast(Any, event), object=things[-1].ref, spans=(span,))
            return ph.Constraint(span, stop, subject)
        event = "edge"
        if "REACHES_EDGE" not in kinds:
            said = self._w.value_of(children, "EVENT")
            if said not in _STOPS:
                raise self._does_not_apply_error(
                    children, "is no event to stop at",
                    "until it touches the mug", "until it moves", "until it almost tips",
                )  # fmt: skip
            if self._w.value_of(children, "UNTIL") == "before":
                said = "about_to_tip" if said == "tips" else ""
            if said not in _STOPS:
                raise self._does_not_apply_error(
                    children, "is no event to stop at", "until it almost tips"
                )
            event = _STOPS[said]
        return ph.Constraint(span, g.Until(event=cast(Any, event), spans=(span,)), things[0])

    def purpose_part(self, children: Children) -> ph.Purpose:
        """To make it slide; before it tips."""
        said = self._w.value_of(children, "EVENT_INFINITIVE") or self._w.value_of(children, "EVENT")
        if said not in _PURPOSES:
            raise self._does_not_apply_error(children, "cannot be asked about", "to make it slide")
        thing = next(iter(_things_in(children)), None)
        before = "BEFORE" in _token_kinds(children)
        return ph.Purpose(self._w.span_of(children), cast(g.Event, _PURPOSES[said]), thing, before)


class Questions(Phrases):
    """Builders of parts for questions and remarks."""

    def _ask_part(self, children: Children, query: g.Query | None, **more: Any) -> ph.Ask:
        thing = next(iter(_things_in(children)), None)
        return ph.Ask(self._w.span_of(children), query, thing=thing, **more)

    def what_if_part(self, children: Children) -> ph.Ask:
        """A condition: "what happens if"."""
        return self._ask_part(children, "predict")

    def passive_part(self, children: Children) -> list[ph.Part]:
        """A passive condition: "what happens if the box is pushed", "if pushed"."""
        ask = isinstance(children[0], Token) and children[0].type == "WHAT_IF"
        span = self._w.span_of(children[:1])
        opening: ph.Part = ph.Ask(span, "predict") if ask else ph.If(span)
        return [opening, self._passive_verb(children), *_things_in(children)]

    def _passive_verb(self, children: Children) -> ph.Verb:
        token = next(c for c in children if isinstance(c, Token) and c.type == "VERB_ED")
        word = self._w.lexicon.verb_words["VERB_ED"][str(token)]
        return ph.Verb(self._w.span_of([token]), word, passive=True)

    def if_part(self, children: Children) -> ph.If:
        """If."""
        return ph.If(self._w.span_of(children))

    def will_part(self, children: Children) -> ph.Ask:
        """Will it topple."""
        event = cast(g.Event, self._w.value_of(children, "EVENT_INFINITIVE"))
        return self._ask_part(children, "predict", event=event)

    def how_much_spills_part(self, children: Children) -> ph.Ask:
        """A question: "how much will spill"."""
        return self._ask_part(children, "predict", event="spills")

    def can_you_part(self, children: Children) -> ph.Ask:
        """Can you."""
        return self._ask_part(children, None if str(children[0]) == "can you" else "possible")

    def possible_part(self, children: Children) -> ph.Ask:
        """Is it possible to."""
        return self._ask_part(children, "possible")

    def can_part(self, children: Children) -> list[ph.Part]:
        """Can the box be pushed."""
        ask = ph.Ask(self._w.span_of(children[:1]), "possible")
        return [ask, self._passive_verb(children), *_things_in(children)]

    def how_hard_part(self, children: Children) -> ph.Ask:
        """A question: "how hard must I"."""
        return self._ask_part(children, "how_hard")

    def where_part(self, children: Children) -> ph.Ask:
        """A question: "where can I"."""
        return self._ask_part(children, "where")

    def why_part(self, children: Children) -> ph.Ask:
        """Why; why did you."""
        whole = children[0].type == "WHY"
        negated = not whole and self._w.value_of(children, "WHY_DID") == "not"
        return self._ask_part(children, "why", whole=whole, negated=negated)

    def affordances_part(self, children: Children) -> ph.Ask:
        """A question: "what can you do with the box"."""
        return self._ask_part(children, "affordances", whole=True)

    def value_part(self, children: Children) -> ph.Ask:
        """A question: "how heavy is it"."""
        which, thing = self._parameters_and_thing(children)
        return ph.Ask(self._w.span_of(children), "value", thing=thing, which=which, whole=True)

    def explore_part(self, children: Children) -> ph.Explore:
        """Find out how heavy it is."""
        which, thing = self._parameters_and_thing(children)
        return ph.Explore(self._w.span_of(children), which, thing)

    def _parameters_and_thing(self, children: Children) -> tuple[tuple[str, ...], ph.Thing]:
        which = tuple(
            self._w.lexicon.value_of(token.type, str(token))
            for token in children
            if isinstance(token, Token) and token.type in _PROPERTIES
        )
        which = which or (("position",) if "WHERE_IS" in _token_kinds(children) else ("mass",))
        if things := _things_in(children):
            return which, things[0]
        start, _ = self._w.span_of(children[-1:])
        its = g.ObjectRef(text="its", spans=((start, start + 3),), pronoun=True)
        return which, ph.Thing((start, start + 3), its)

    def undo_part(self, children: Children) -> list[ph.Part]:
        """Undo that; undo the push of the box."""
        return [ph.Remark(self._w.span_of(children[:1]), "undo"), *_things_in(children)]

    def stop_part(self, children: Children) -> ph.Remark:
        """Stop."""
        return ph.Remark(self._w.span_of(children), "stop")

    def repeat_part(self, children: Children) -> ph.Remark:
        """Do it again; again."""
        return ph.Remark(self._w.span_of(children), "repeat")

    def more_part(self, children: Children) -> ph.Remark:
        """Further."""
        return ph.Remark(self._w.span_of(children), "more")

    def correct_part(self, children: Children) -> ph.Remark:
        """No; I meant."""
        return ph.Remark(self._w.span_of(children), "correct")

    def not_this_part(self, children: Children) -> ph.NotThis:
        """Not the mug."""
        if str(children[0]) != "not":
            raise self._does_not_apply_error(
                children, "says nothing to avoid", "without touching it"
            )
        return ph.NotThis(self._w.span_of(children), children[1])


_AVOIDED = ("AVOIDING", "AVOID", "KEEPS", "KEPT", "STAYS")


_PROPERTIES = (
    "HOW",
    "HOW_MUCH_IN",
    "THE_PROPERTY",
    "THE_PROPERTY_OF",
    "THE_SIDE_OF",
    "ITS_PROPERTY",
)


def _token_kinds(children: Children) -> list[str]:
    return [child.type for child in children if isinstance(child, Token)]

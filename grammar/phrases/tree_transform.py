"""From the parse tree to parts with spans: the meaning of each phrase."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, cast

from grammar.errors import ParseError
from grammar.frames import command as g
from grammar.frames.constraints import new_constraint
from grammar.phrases import phrase_parts as ph
from grammar.phrases.lalr_parser import Tree
from grammar.phrases.manner_phrases import Manners
from grammar.phrases.named_things import Names
from grammar.phrases.outcome_phrases import QUESTIONS, Outcomes, Questions
from grammar.phrases.token_reader import (
    MAX_LENGTH_M,
    MAX_VOLUME,
    Children,
    parts_in,
    things_in,
    tokens_in,
)
from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised
from grammar.words.phrase_lexer import Token

_CAUSED = {"moves": "move", "slides": "slide", "tips": "topple", "tilts": "tilt", "turns": "turn"}
"""Verbs for what is made to happen."""

_WISHES = frozenset({"appreciate", "if", "like", "love", "prefer", "rather", "suggest", "that",
                     "time", "wish"})  # fmt: skip
"""Words behind which "you pushed it" asks for it."""


def _place(relation: str) -> Callable[[g.Span, g.TableRegion], ph.Place]:
    """The place that has a relation to a part of the table."""
    return lambda span, region: ph.Place(span, relation, region)


_PLAIN: dict[str, tuple[Callable[..., ph.Part], str]] = {
    "next": (ph.Next, "NEXT"),  # then
    "me": (ph.Me, ""),  # to me
    "there": (ph.There, ""),
    "diagonally": (ph.Diagonal, ""),
    "that_is": (ph.ThatIs, ""),  # that is, which stands
    "side": (ph.Side, "SIDE_QUALITY"),  # on the left
    "toward_region": (ph.Toward, "TOWARD_REGION"),  # towards the edge
    "away_from_region": (ph.AwayFrom, "AWAY_FROM_REGION"),  # away from the edge
    "region_of_table": (_place("at"), "REGION_OF_TABLE"),  # to the left edge
    "from_region": (_place("from"), "FROM_REGION"),  # from the left edge
    "over_region": (_place("over"), "OVER_REGION"),  # over the left edge
    "out_of_region": (_place("clear_of"), "OUT_OF_REGION"),  # out of the left half
    "sense": (ph.Sense, "SENSE"),  # clockwise
    "facing_way": (ph.Facing, "FACING_WAY"),  # facing me
    "parallel_edge": (ph.Parallel, "PARALLEL_EDGE"),  # parallel to the edge
    "amount": (ph.Amount, "AMOUNT"),  # a little
    "on_table": (ph.Table, ""),  # on the table
    "from_table": (ph.FromTable, ""),  # from the table
    "let_go": (ph.LetGo, ""),  # and let it go
    "settles": (ph.Settles, ""),  # and let it fall back
    "method": (ph.Method, "METHOD"),  # by lifting it
    "lid": (ph.Lid, "WITH_LID"),  # with its lid
    "if": (ph.If, ""),  # if, when
    **{
        dialogue: (ph.Remark, dialogue)
        for dialogue in ("stop", "repeat", "correct", "do", "reverse")
    },
}
"""Node → its part, and the terminal whose value the part has; a remark has its own name."""


class Parts(Names, Manners, Outcomes, Questions):
    """Turns the tree of one sentence into its parts: a row or a method for each name of a node."""

    def build_part(self, name: str, children: Children) -> Any:
        """The part, or the parts, of a node of the tree."""
        if name in QUESTIONS:
            return self.question_part(children, **QUESTIONS[name])
        if name not in _PLAIN:
            return getattr(self, f"{name}_part")(children)
        kind, terminal = _PLAIN[name]
        said = terminal if terminal.islower() else self.value_of(children, terminal)
        return kind(self.span_of(children), *([said] if terminal else []))

    def start_part(self, children: Children) -> list[ph.Part]:
        """The parts of the sentence."""
        return [p for c in children for p in (c if isinstance(c, list) else [c])]

    # --- what holds the sentence together -----------------------------------------------------

    def separator_part(self, children: Children) -> ph.Separator:
        """And."""
        word = self.value_of(children, "SEPARATOR") or self.value_of(children, "OR")
        return ph.Separator(self.span_of(children), word)

    def filler_part(self, children: Children) -> ph.Filler:
        """Please; could you."""
        value = self.value_of(children, "FILLER")
        anywhere, goes_on = value in ("please", "just", "next"), value in ("next", "also")
        return ph.Filler(self.span_of(children), anywhere, goes_on, value in ("please", "you"))

    # --- the verb and things ------------------------------------------------------------------

    def verb_part(self, children: Children) -> list[ph.Part]:
        """Push; you push; would you mind pushing."""
        token = next(c for c in children if isinstance(c, Token) and c.type.startswith("VERB"))
        word = self.lexicon.verb_words[token.type][str(token)]
        if token.type == "VERB_ED" and (you := tokens_in(children, "YOU")):
            self._require_wish(you)
        said = [token, *tokens_in(children, "UPON")]
        verb: list[ph.Part] = [ph.Verb(self.span_of(said), word), *parts_in(children)]
        if polite := tokens_in(children, "MIND"):
            return [ph.Filler(self.span_of(polite), anywhere=False, asks=True), *verb]
        return verb

    def _require_wish(self, you: Children) -> None:
        """Refuses "you pushed it", which tells what was done, but behind "I'd rather"."""
        span = self.span_of(you)
        if _WISHES.isdisjoint(self.sentence.original[: span[1]].casefold().split()):
            message, hint = "tells what was done, and asks for nothing", "push it …"
            raise self.does_not_apply_error(you, message, hint)

    def causes_part(self, children: Children) -> list[ph.Part]:
        """Make the box slide: slide the box."""
        event = self.value_of(children, "EVENT_INFINITIVE")
        if event not in _CAUSED:
            raise self.does_not_apply_error(children, "asks for nothing to be done", "push it …")
        ends = [c for c in children if isinstance(c, Token)]
        first, last = self.span_of(ends[:1]), self.span_of(ends[-1:])
        return [ph.Verb(first, _CAUSED[event], completed=last), *things_in(children)]

    def made_to_face_part(self, children: Children) -> list[ph.Part]:
        """Make the box face the mug: turn it."""
        cause, thing, *facing = children
        target = things_in(facing)[0].ref if things_in(facing) else None
        way = target or cast(g.Direction, self.value_of(facing, "FACING_WAY"))
        verb = ph.Verb(self.span_of([cause]), "turn", completed=self.span_of(facing[:1]))
        return [verb, thing, ph.Facing(self.span_of(facing), way)]

    def clears_part(self, children: Children) -> list[ph.Part]:
        """Clear the left half of the table."""
        span = self.span_of(children)
        region = cast(g.TableRegion, self.value_of(children, "CLEARED"))
        return [*self._everything_cleared(span), ph.Place(span, "clear_of", region)]

    def rights_part(self, children: Children) -> list[ph.Part]:
        """Right the box: stand it upright."""
        span = self.span_of(children)
        return [ph.Verb(span, "stand"), ph.Particle(span, "upright")]

    def makes_room_part(self, children: Children) -> list[ph.Part]:
        """Make room for the box; around the mug; next to it."""
        span = self.span_of(children[:1])
        room = [ph.Room(self.span_of(children), thing.ref) for thing in things_in(children)]
        return [*self._everything_cleared(span), *room]

    def _everything_cleared(self, span: g.Span) -> list[ph.Part]:
        everything = g.ObjectRef(text="everything", spans=(span,), quantifier="all")
        return [ph.Verb(span, "clear"), ph.Thing(span, everything)]

    def held_part(self, children: Children) -> list[ph.Part]:
        """Use the handle to: take hold of the handle, then."""
        thing, span = children[1], self.span_of(children[:1])
        if thing.ref.text.split()[-1].casefold() not in self.lexicon.handles:
            hint = 'say it in two steps: "grip …, then …"'
            raise self.does_not_apply_error(children[:2], "is no tool of this robot", hint)
        return [ph.Verb(span, "grip"), thing, ph.Next(self.span_of(children[-1:]), "then")]

    def done_part(self, children: Children) -> list[ph.Part]:
        """The box should be pushed, needs pushing; of a list, each of them."""
        token = tokens_in(children, "VERB_ED", "VERB_ING")[0]
        word = self.lexicon.verb_words[token.type][str(token)]
        verb = ph.Verb(self.span_of([token]), word, passive=True)
        return [children[0], verb, *parts_in(children[1:])]

    def wish_part(self, children: Children) -> list[ph.Part]:
        """I want the box pushed; I want the box further left."""
        if tokens_in(children, "VERB_ED"):
            return self.done_part(children[1:])
        wish, to_be = (tokens_in(children, kind) for kind in ("WISH", "TO_BE"))
        state = self.span_of(to_be) if to_be else None
        return [ph.Wish(self.span_of(wish or to_be), state), *parts_in(children)]

    def needs_part(self, children: Children) -> list[ph.Part]:
        """The box needs a push."""
        *before, stroke = children
        verb = ph.Verb(self.span_of(tokens_in(before, "NEEDS")), "give", passive=True)
        return [*things_in(before), verb, *self.stroke_part([stroke])]

    def stroke_part(self, children: Children) -> list[ph.Part]:
        """A push; a gentle push."""
        span = self.span_of(children)
        verb, _, how = self.value_of(children, "STROKE").partition(" ")
        stroke = ph.Stroke(span, verb)
        if how == "little":
            return [stroke, ph.Amount(span, how)]
        return [stroke, *([ph.Constraint(span, new_constraint(how, spans=(span,)))] if how else [])]

    def particle_part(self, children: Children) -> list[ph.Part]:
        """Over, up, down."""
        word = self.value_of(children, "PARTICLE")
        return [ph.Particle(self.span_of(children[:1]), word), *parts_in(children)]

    def exception_part(self, children: Children) -> ph.Except:
        """But the red one."""
        return ph.Except(self.span_of(children), children[1])

    # --- where to -----------------------------------------------------------------------------

    def direction_part(self, children: Children) -> list[ph.Part]:
        """Away, over to the left."""
        span = self.span_of(children)
        direction = ph.Direction(span, cast(g.Direction, self.value_of(children, "DIRECTION")))
        if str(children[0]).startswith("over "):
            return [ph.Particle((span[0], span[0] + 4), "over", optional=True), direction]
        return [direction]

    def off_straight_part(self, children: Children) -> ph.Heading:
        """30 degrees left of straight ahead."""
        sign = 1.0 if self.value_of(children, "OFF_STRAIGHT") == "left" else -1.0
        return ph.Heading(self.span_of(children), sign * self.angle_in(children))

    def heading_part(self, children: Children) -> ph.Heading:
        """At a heading of 30 degrees."""
        return ph.Heading(self.span_of(children), self.angle_in(children, signed=True))

    def toward_part(self, children: Children) -> ph.Toward:
        """Towards the mug."""
        return ph.Toward(self.span_of(children), children[1].ref)

    def into_part(self, children: Children) -> ph.Into:
        """Into the mug."""
        return ph.Into(self.span_of(children), children[1].ref)

    def place_part(self, children: Children) -> ph.Place:
        """Next to the mug; between the mug and the box."""
        things = tuple(thing.ref for thing in things_in(children))
        relation = self.value_of(children, "RELATION")
        if beside := self.value_of(children, "BESIDE_IT"):
            span = self.span_of(children)
            it = g.ObjectRef(text="it", spans=(span,), pronoun=True)
            return ph.Place(span, beside, (it,), beside=True)
        if children[0].type == "BETWEEN":
            relation, (_, first, *joint) = "between", children
            two = len(things) > 1 or first.ref.quantifier in ("both", "all")
            if not two or (joint and self.value_of(joint, "SEPARATOR") != "and"):
                raise ParseError(
                    "unexpected_words",
                    'two things are joined by "and"',
                    self.span_of(joint[:1] or [first]),
                    ('say "between the one and the other"',),
                )
        return ph.Place(self.span_of(children), relation, things)

    def mutual_part(self, children: Children) -> ph.Place:
        """In a row; together; out of the way; back."""
        return ph.Place(self.span_of(children), self.value_of(children, "MUTUAL"), ())

    def where_stands_part(self, children: Children) -> ph.Place:
        """To where the mug is."""
        if children[1].ref.pronoun:  # "leave the mug where it is"
            raise self.does_not_apply_error(children, "is no place to go to", "to where the jar is")
        return ph.Place(self.span_of(children), "place_of", (children[1].ref,))

    def facing_part(self, children: Children) -> ph.Facing:
        """Facing the mug."""
        return ph.Facing(self.span_of(children), children[1].ref)

    def parallel_part(self, children: Children) -> ph.Parallel:
        """Parallel to the box."""
        return ph.Parallel(self.span_of(children), children[1].ref)

    def point_part(self, children: Children) -> ph.Place:
        """To x 0.6 y −0.1."""
        units = tokens_in(children, "LENGTH_UNIT")
        scale = float(self.lexicon.value_of("LENGTH_UNIT", str(units[-1]))) if units else 1.0
        x, y = (float(number) * scale for number in self.numbers_in(children))
        for value in (x, y):
            # A place may lie on either side of the middle, so only its size is of interest.
            range_ = f"a place is at most {MAX_LENGTH_M:g} m away"
            self.require_possible(children, max(abs(value), 1e-9), MAX_LENGTH_M, range_)
        return ph.Place(self.span_of(children), "at", g.Point(x=x, y=y))

    # --- how far ------------------------------------------------------------------------------

    def length_part(self, children: Children) -> ph.Length:
        """By at least 10 cm."""
        value, span = self.lengths_in(children)[0], self.span_of(children)
        return ph.Length(span, value, self.strict_bound_of(children))

    def length_range_part(self, children: Children) -> ph.Length:
        """5 to 10 cm."""
        low, high = self.lengths_in(children)
        span = self.span_of(children)
        if low >= high or self.bound_of(children) != "exact":
            raise self.sentence.error_at(
                span, "impossible_quantity", "is no range", 'say it like "5 to 10 cm"'
            )
        return ph.Length(span, low, "at_least", high)

    def relative_part(self, children: Children) -> ph.Length:
        """Twice its width; the width of the mug."""
        if things := things_in(children):
            side = self.value_of(children, "THE_SIDE_OF")
            return self._relative_length_part(children, things[0].ref, side)
        its = tokens_in(children, "ITS")
        start = self.span_of(its)[0] if its else 0
        spans = ((start, start + len("its")),) if its else ()
        of = g.ObjectRef(text="its", spans=spans, pronoun=True)
        return self._relative_length_part(children, of, self.value_of(children, "SIDE_OF_OBJECT"))

    def relative_to_word_part(self, children: Children) -> ph.Length:
        """Two box widths."""
        span = self.span_of(tokens_in(children, "WORD"))
        of = g.ObjectRef(text=self.sentence.words_as_written(span), spans=(span,))
        return self._relative_length_part(children, of, self.value_of(children, "SIDE_OF_OBJECT"))

    def _relative_length_part(self, children: Children, of: g.ObjectRef, side: str) -> ph.Length:
        times = float(next(iter(self.numbers_in(children)), 1))
        range_ = "a length is at most 100 objects long"
        times = self.require_possible(children, times, 100.0, range_)
        length = g.RelativeLength(value=times, of=of, side=cast(g.Side, side))
        return ph.Length(self.span_of(children), length, self.strict_bound_of(children))

    def angle_part(self, children: Children) -> ph.Angle:
        """By 30 degrees."""
        angle, bound = self.angle_in(children), self.strict_bound_of(children)
        return ph.Angle(self.span_of(children), angle, bound)

    def way_part(self, children: Children) -> ph.Share:
        """Halfway."""
        value = _fraction_value(self.value_of(children, "WAY"))
        return ph.Share(self.span_of(children), value, of_way=True)

    # --- how much of a liquid, and until it is how full ----------------------------------------

    def volume_part(self, children: Children) -> list[ph.Part]:
        """100 ml; 100 ml of ice tea."""
        said = [child for child in children if isinstance(child, Token)]
        span = self.span_of(said)
        if self.bound_of(children) != "exact":
            raise self.sentence.error_at(
                span, "does_not_apply", "leaves open how much to pour", "100 ml", "half of it"
            )
        range_ = f"a volume is more than 0 and at most {1e3 * MAX_VOLUME:g} l"
        value = self.in_unit(children, "CUPS" if tokens_in(said, "CUPS") else "VOLUME_UNIT")[0]
        value = self.require_possible(said, value, MAX_VOLUME, range_)
        return [ph.Volume(span, value), *parts_in(children)]

    def some_of_part(self, children: Children) -> list[ph.Part]:
        """A little of the ice tea."""
        amount = ph.Amount(self.span_of(children[:1]), self.value_of(children, "SOME_OF"))
        return [amount, *parts_in(children)]

    def portion_part(self, children: Children) -> list[ph.Part]:
        """Half of the ice tea."""
        value = _fraction_value(self.value_of(children, "PORTION"))
        return [ph.Share(self.span_of(children[:1]), value, of_way=False), *parts_in(children)]

    def until_full_part(self, children: Children) -> ph.Full:
        """Until it is half full; so that it is 80 percent full."""
        level = self._fill_level(children, "IS_FULL")
        return ph.Full(self.span_of(children), level, things_in(children)[0])

    def full_part(self, children: Children) -> ph.Full:
        """To the brim; half full; to 80 percent."""
        return ph.Full(self.span_of(children), self._fill_level(children, "FILLED"))

    def _fill_level(self, children: Children, terminal: str) -> float:
        if said := self.value_of(children, terminal):
            return _fraction_value(said)
        share = float(self.numbers_in(children)[0] / 100)
        range_ = "what is filled is filled up to at most 100 percent"
        return self.require_possible(children, share, 1.0, range_)

    def filled_with_part(self, children: Children) -> list[ph.Part]:
        """With ice tea; with half of the ice tea; with 100 ml of what was spoken of before."""
        parts, span = parts_in(self.start_part(children)), self.span_of(children[:1])
        thing = next(iter(things_in(parts)), None)
        others = [part for part in parts if part is not thing]
        if thing is None:
            return [replace(others[0], span=(span[0], others[0].span[1]))]
        return [ph.FilledWith(span, thing), *others]


def _fraction_value(text: str) -> float:
    """The number that "2/3" stands for."""
    over, _, under = text.partition("/")
    return float(over) / float(under or 1)


def parts_of(tree: Tree, lexicon: Lexicon, sentence: Normalised) -> list[ph.Part]:
    """The parts of a parsed sentence.

    Raises:
        ParseError: `impossible_quantity`, `does_not_apply` or `unexpected_words`.
    """
    parts: list[ph.Part] = tree.transform(Parts(lexicon, sentence).build_part)
    return parts

"""From the parse tree to parts with spans: the meaning of each phrase."""

from __future__ import annotations

from typing import Any, cast

from grammar.errors import ParseError
from grammar.frames import command as g
from grammar.phrases import phrase_parts as ph
from grammar.phrases import token_reader as q
from grammar.phrases.container_phrases import Contents
from grammar.phrases.lalr_parser import Tree
from grammar.phrases.manner_phrases import Manners
from grammar.phrases.outcome_phrases import Outcomes, Questions
from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised
from grammar.words.phrase_lexer import Token

_CAUSED = {"moves": "move", "slides": "slide", "tips": "topple", "tilts": "tilt", "turns": "turn"}
"""Verbs for what is made to happen."""

Children = list[Any]


class Parts(Manners, Contents, Outcomes, Questions):
    """Turns the tree of one sentence into its parts: a method for each name of a node."""

    def __init__(self, lexicon: Lexicon, sentence: Normalised) -> None:
        self._w = q.TokenReader(lexicon, sentence)

    # --- what holds the sentence together -----------------------------------------------------

    def separator_part(self, children: Children) -> ph.Separator:
        """And."""
        word = self._w.value_of(children, "SEPARATOR") or self._w.value_of(children, "OR")
        return ph.Separator(self._w.span_of(children), word)

    def next_part(self, children: Children) -> ph.Next:
        """Then."""
        return ph.Next(self._w.span_of(children), self._w.value_of(children, "NEXT"))

    def filler_part(self, children: Children) -> ph.Filler:
        """Please."""
        polite = self._w.value_of(children, "FILLER") == "please"
        return ph.Filler(self._w.span_of(children), anywhere=polite)

    def me_part(self, children: Children) -> ph.Me:
        """To me."""
        return ph.Me(self._w.span_of(children))

    def there_part(self, children: Children) -> ph.There:
        """There."""
        return ph.There(self._w.span_of(children))

    def diagonally_part(self, children: Children) -> ph.Diagonal:
        """Diagonally."""
        return ph.Diagonal(self._w.span_of(children))

    # --- the verb and things ------------------------------------------------------------------

    def verb_part(self, children: Children) -> list[ph.Part]:
        """Push; you push; would you mind pushing."""
        token = next(c for c in children if isinstance(c, Token) and c.type.startswith("VERB"))
        word = self._w.lexicon.verb_words[token.type][str(token)]
        rest = [c for c in children if isinstance(c, ph.Part)]
        return [ph.Verb(self._w.span_of([token]), word), *rest]

    def causes_part(self, children: Children) -> list[ph.Part]:
        """Make the box slide: slide the box."""
        event = self._w.value_of(children, "EVENT_INFINITIVE")
        if event not in _CAUSED:
            raise self._does_not_apply_error(children, "asks for nothing to be done", "push it …")
        thing = next(c for c in children if isinstance(c, ph.Thing))
        ends = [c for c in children if isinstance(c, Token)]
        first, last = self._w.span_of(ends[:1]), self._w.span_of(ends[-1:])
        return [ph.Verb(first, _CAUSED[event], completed=last), thing]

    def particle_part(self, children: Children) -> list[ph.Part]:
        """Over, up, down."""
        rest = [c for c in children if isinstance(c, ph.Part)]
        word = self._w.value_of(children, "PARTICLE")
        return [ph.Particle(self._w.span_of(children[:1]), word), *rest]

    def name_part(self, children: Children) -> ph.Thing:
        """A name, without its article; quotation marks are no part of it."""
        words = [c for c in children if c.type in ("WORD", "QUOTED", "IT")]
        contents = any(c.type == "CONTENTS" for c in children)
        if not words:
            words = [c for c in children if c.type == "THAT"]
        first, last = self._w.span_of(words[:1])[0], self._w.span_of(words[-1:])[1]
        span = first, last
        if words[0].type == "QUOTED":
            span = span[0] + 1, span[1] - 1
            inner = self._w.sentence.original[span[0] : span[1]]
            span = span[0] + len(inner) - len(inner.lstrip()), span[0] + len(inner.rstrip())
        text = self._w.sentence.words_as_written(span)
        if words[0].type in ("IT", "THAT"):
            ref = g.ObjectRef(text=text, spans=(span,), pronoun=True)
        else:
            ref = self._named_object(text, span, [w for w in words if w.type == "WORD"])
        return ph.Thing(span, ref, contents)

    def _named_object(self, text: str, span: g.Span, words: list[Token]) -> g.ObjectRef:
        """A name with what its adjectives say; a quoted name has none."""
        lexicon = self._w.lexicon
        qualities = tuple(lexicon.adjectives[w] for w in words if w in lexicon.adjectives)
        if not qualities and not set(words) <= {"one", "ones"}:
            return g.ObjectRef(text=text, spans=(span,))
        nouns = [w for w in words if w not in lexicon.adjectives and w not in lexicon.nobodies]
        noun = " ".join(self._w.sentence.words_as_written(self._w.span_of([w])) for w in nouns)
        return g.ObjectRef(text=text, spans=(span,), qualities=qualities, noun=noun)

    def that_is_part(self, children: Children) -> ph.ThatIs:
        """Words such as "that is"."""
        return ph.ThatIs(self._w.span_of(children))

    def side_part(self, children: Children) -> ph.Side:
        """On the left."""
        quality = cast(g.Quality, self._w.value_of(children, "SIDE_QUALITY"))
        return ph.Side(self._w.span_of(children), quality)

    # --- where to -----------------------------------------------------------------------------

    def direction_part(self, children: Children) -> list[ph.Part]:
        """Away, over to the left."""
        span = self._w.span_of(children)
        direction = ph.Direction(span, cast(g.Direction, self._w.value_of(children, "DIRECTION")))
        if str(children[0]).startswith("over "):
            return [ph.Particle((span[0], span[0] + 4), "over", optional=True), direction]
        return [direction]

    def off_straight_part(self, children: Children) -> ph.Heading:
        """30 degrees left of straight ahead."""
        sign = 1.0 if self._w.value_of(children, "OFF_STRAIGHT") == "left" else -1.0
        return ph.Heading(self._w.span_of(children), sign * self._w.angle_in(children))

    def heading_part(self, children: Children) -> ph.Heading:
        """At a heading of 30 degrees."""
        return ph.Heading(self._w.span_of(children), self._w.angle_in(children, signed=True))

    def toward_part(self, children: Children) -> ph.Toward:
        """Towards the mug."""
        return ph.Toward(self._w.span_of(children), children[1].ref)

    def toward_region_part(self, children: Children) -> ph.Toward:
        """Towards the edge."""
        region = cast(g.TableRegion, self._w.value_of(children, "TOWARD_REGION"))
        return ph.Toward(self._w.span_of(children), region)

    def away_from_region_part(self, children: Children) -> ph.AwayFrom:
        """Away from the edge."""
        region = cast(g.TableRegion, self._w.value_of(children, "AWAY_FROM_REGION"))
        return ph.AwayFrom(self._w.span_of(children), region)

    def into_part(self, children: Children) -> ph.Into:
        """Into the mug."""
        return ph.Into(self._w.span_of(children), children[1].ref)

    def place_part(self, children: Children) -> ph.Place:
        """Next to the mug; between the mug and the box."""
        things = tuple(c.ref for c in children if isinstance(c, ph.Thing))
        if children[0].type == "BETWEEN":
            joined = children[2]
            if self._w.value_of([joined], "SEPARATOR") != "and":
                raise ParseError(
                    "unexpected_words",
                    'two things are joined by "and"',
                    self._w.span_of([joined]),
                    ('say "between the one and the other"',),
                )
            return ph.Place(self._w.span_of(children), "between", things)
        return ph.Place(self._w.span_of(children), self._w.value_of(children, "RELATION"), things)

    def region_of_table_part(self, children: Children) -> ph.Place:
        """To the middle of the table."""
        region = cast(g.TableRegion, self._w.value_of(children, "REGION_OF_TABLE"))
        return ph.Place(self._w.span_of(children), "at", region)

    def point_part(self, children: Children) -> ph.Place:
        """To x 0.6 y −0.1."""
        numbers = [float(number) for number in self._w.numbers_in(children)]
        units = [
            float(self._w.lexicon.value_of("LENGTH_UNIT", str(c)))
            for c in children
            if isinstance(c, Token) and c.type == "LENGTH_UNIT"
        ]
        scale = units[-1] if units else 1.0
        x, y = (value * scale for value in numbers)
        for value in (x, y):
            # A place may lie on either side of the middle, so only its size is of interest.
            range_ = f"a place is at most {q.MAX_LENGTH_M:g} m away"
            self._w.require_possible(children, max(abs(value), 1e-9), q.MAX_LENGTH_M, range_)
        return ph.Place(self._w.span_of(children), "at", g.Point(x=x, y=y))

    # --- how far ------------------------------------------------------------------------------

    def length_part(self, children: Children) -> ph.Length:
        """By at least 10 cm."""
        value, span = self._w.lengths_in(children)[0], self._w.span_of(children)
        return ph.Length(span, value, self._w.bound_of(children))

    def length_range_part(self, children: Children) -> ph.Length:
        """5 to 10 cm."""
        low, high = self._w.lengths_in(children)
        span = self._w.span_of(children)
        if low >= high or self._w.bound_of(children) != "exact":
            raise ParseError(
                "impossible_quantity",
                f'"{self._w.sentence.words_as_written(span)}" is no range',
                span,
                ('say it like "5 to 10 cm"',),
            )
        return ph.Length(span, low, "at_least", high)

    def relative_part(self, children: Children) -> ph.Length:
        """Twice its width; the width of the mug."""
        things = [c for c in children if isinstance(c, ph.Thing)]
        its = [c for c in children if isinstance(c, Token) and c.type == "ITS"]
        terminal = "THE_SIDE_OF" if things else "SIDE_OF_OBJECT"
        if things:
            of = things[0].ref
        elif its:
            start, _ = self._w.span_of(its)
            of = g.ObjectRef(text="its", spans=((start, start + 3),), pronoun=True)
        else:
            of = g.ObjectRef(text="its", pronoun=True)
        return self._relative_length_part(children, of, self._w.value_of(children, terminal))

    def relative_to_word_part(self, children: Children) -> ph.Length:
        """Two box widths."""
        words = [c for c in children if isinstance(c, Token) and c.type == "WORD"]
        span = self._w.span_of(words)
        of = g.ObjectRef(text=self._w.sentence.words_as_written(span), spans=(span,))
        return self._relative_length_part(
            children, of, self._w.value_of(children, "SIDE_OF_OBJECT")
        )

    def _relative_length_part(self, children: Children, of: g.ObjectRef, side: str) -> ph.Length:
        span = self._w.span_of(children)
        times = float(next(iter(self._w.numbers_in(children)), 1))
        times = self._w.require_possible(
            children, times, 100.0, "a length is at most 100 objects long"
        )
        length = g.RelativeLength(value=times, of=of, side=cast(g.Side, side))
        return ph.Length(span, length, self._w.bound_of(children))

    def angle_part(self, children: Children) -> ph.Angle:
        """By 30 degrees."""
        value = self._w.angle_in(children)
        return ph.Angle(self._w.span_of(children), value, self._w.bound_of(children))

    def sense_part(self, children: Children) -> ph.Sense:
        """Clockwise."""
        return ph.Sense(self._w.span_of(children), self._w.value_of(children, "SENSE"))

    def amount_part(self, children: Children) -> ph.Amount:
        """A little."""
        return ph.Amount(self._w.span_of(children), self._w.value_of(children, "AMOUNT"))

    def way_part(self, children: Children) -> ph.Share:
        """Halfway."""
        value = self.fraction_value(self._w.value_of(children, "WAY"))
        return ph.Share(self._w.span_of(children), value, of_way=True)

    # --- the whole ----------------------------------------------------------------------------

    def start_part(self, children: Children) -> list[ph.Part]:
        """The parts of the sentence."""
        parts: list[ph.Part] = []
        for child in children:
            parts += child if isinstance(child, list) else [child]
        return parts


def parts_of(tree: Tree, lexicon: Lexicon, sentence: Normalised) -> list[ph.Part]:
    """The parts of a parsed sentence.

    Raises:
        ParseError: `impossible_quantity`, `does_not_apply` or `unexpected_words`.
    """
    parts: list[ph.Part] = tree.transform(Parts(lexicon, sentence))
    return parts

"""Parts from phrases of contents: how much is poured, until it is how full, by lifting."""

from __future__ import annotations

from typing import Any, cast

from grammar.errors import ParseError
from grammar.frames import command as g
from grammar.phrases import phrase_parts as ph
from grammar.phrases import token_reader as q
from grammar.phrases.outcome_phrases import Phrases
from grammar.words.phrase_lexer import Token

Children = list[Any]


class Contents(Phrases):
    """Amounts of a liquid, and what is done about them."""

    # --- how much -----------------------------------------------------------------------------

    def volume_part(self, children: Children) -> list[ph.Part]:
        """100 ml; 100 ml of ice tea."""
        said = [child for child in children if isinstance(child, Token)]
        span = self._w.span_of(said)
        if self._w.bound_of(children) != "exact":
            message = f'"{self._w.sentence.words_as_written(span)}" leaves open how much to pour'
            raise ParseError("does_not_apply", message, span, ("100 ml", "half of it"))
        range_ = f"a volume is more than 0 and at most {1e3 * q.MAX_VOLUME:g} l"
        unit = "CUPS" if any(token.type == "CUPS" for token in said) else "VOLUME_UNIT"
        value = self._w.in_unit(children, unit)[0]
        value = self._w.require_possible(said, value, q.MAX_VOLUME, range_)
        return [ph.Volume(span, value), *self._things_of(children)]

    def some_of_part(self, children: Children) -> list[ph.Part]:
        """A little of the ice tea."""
        amount = ph.Amount(self._w.span_of(children[:1]), self._w.value_of(children, "SOME_OF"))
        return [amount, *self._things_of(children)]

    def portion_part(self, children: Children) -> list[ph.Part]:
        """Half of the ice tea."""
        value = self.fraction_value(self._w.value_of(children, "PORTION"))
        share = ph.Share(self._w.span_of(children[:1]), value, of_way=False)
        return [share, *self._things_of(children)]

    def fraction_value(self, text: str) -> float:
        """The number that "2/3" stands for."""
        over, _, under = text.partition("/")
        return float(over) / float(under or 1)

    def _things_of(self, children: Children) -> list[ph.Part]:
        return [child for child in children if isinstance(child, ph.Part)]

    # --- how full -----------------------------------------------------------------------------

    def until_full_part(self, children: Children) -> ph.Full:
        """Until it is half full; so that it is 80 percent full."""
        thing = next(child for child in children if isinstance(child, ph.Thing))
        return ph.Full(self._w.span_of(children), self._fill_level(children, "IS_FULL"), thing)

    def full_part(self, children: Children) -> ph.Full:
        """To the brim; half full; to 80 percent."""
        return ph.Full(self._w.span_of(children), self._fill_level(children, "FILLED"))

    def _fill_level(self, children: Children, terminal: str) -> float:
        if said := self._w.value_of(children, terminal):
            return self.fraction_value(said)
        share = float(self._w.numbers_in(children)[0] / 100)
        range_ = "what is filled is filled up to at most 100 percent"
        return self._w.require_possible(children, share, 1.0, range_)

    def filled_with_part(self, children: Children) -> list[ph.Part]:
        """With ice tea; with half of the ice tea."""
        flat = [p for c in children for p in (c if isinstance(c, list) else [c])]
        thing = next(part for part in flat if isinstance(part, ph.Thing))
        others = [part for part in flat if isinstance(part, ph.Part) and part is not thing]
        return [ph.FilledWith(self._w.span_of(children[:1]), thing), *others]

    # --- where, and how -----------------------------------------------------------------------

    def on_table_part(self, children: Children) -> ph.Table:
        """On the table."""
        return ph.Table(self._w.span_of(children))

    def method_part(self, children: Children) -> ph.Method:
        """By lifting it."""
        value = cast(g.Method, self._w.value_of(children, "METHOD"))
        return ph.Method(self._w.span_of(children), value)

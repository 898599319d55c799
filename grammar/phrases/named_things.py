"""Names of things: what their words say, how many are meant, which of a row."""

from __future__ import annotations

import re
from typing import cast

from grammar.frames import command as g
from grammar.phrases import phrase_parts as ph
from grammar.phrases.token_reader import Children, TokenReader, things_in, tokens_in
from grammar.words.phrase_lexer import Token
from grammar.words.plurals import singular

_NOBODY = ("one", "ones")
_SEVERAL = ("them", "they")
_COUNTS = frozenset({"three", "four", "five", "six"})
_COMPARED = re.compile("(er|est|most)$")


class Names(TokenReader):
    """Builder of the parts that name things."""

    def name_part(self, children: Children) -> ph.Thing:
        """A name, without its article; quotation marks are no part of it."""
        counted = tokens_in(children, "QUANTIFIER")
        words = tokens_in(children, "WORD", "KNOWN", "QUOTED", "IT") or tokens_in(children, "THAT")
        words = words or counted
        start, end = self.span_of([words[0], words[-1]])
        if words[0].type == "QUOTED":
            inner = self.sentence.original[start + 1 : end - 1]
            start, end = end - 1 - len(inner.lstrip()), start + 1 + len(inner.rstrip())
        text = self.sentence.words_as_written((start, end))
        own_contents = words[0].startswith("its ")
        if words[0].type in ("IT", "THAT"):
            more = len(text.split()) > len(words[0].split())
            reworded = more or (len(text) > len(words[0]) and text.isalpha())  # "Heavy?"
            text = "it" if own_contents else str(words[0]) if reworded else text
            several: g.Quantifier | None = "all" if str(words[0]) in _SEVERAL else None
            ref = g.ObjectRef(text=text, spans=((start, end),), pronoun=True, quantifier=several)
        elif numbered := tokens_in(children, "NUMBER", "NUMBER_WORD"):
            _, end = self.span_of([*numbered, *tokens_in(children, "ON_IT")])
            text = f"{text} {self.numbers_in(numbered)[0]:f}"
            ref = g.ObjectRef(text=text, spans=((start, end),))
        elif words[0].isdigit() and tokens_in(children, "NUMBERED"):  # the 2 numbered block
            text = f"{self._written(words[1:])} {words[0]}"
            ref = g.ObjectRef(text=text, spans=((start, end),))
        else:
            reworded = len(text.split()) > len(words) and words[0].type != "QUOTED"
            if reworded and not counted:  # "the one with the lid"
                text = " ".join(words)
            ref = self._described_object(text, (start, end), children)
        if counted:
            value = cast(g.Quantifier, self.value_of(children, "QUANTIFIER"))
            spans = tuple(dict.fromkeys((*ref.spans, self.span_of(counted))))
            ref = ref.model_copy(update={"quantifier": value, "spans": spans})
            count = next((w for w in str(counted[0]).split() if w in _COUNTS), None)
            if count and value == "all" and count not in ref.text.casefold().split():
                ref = ref.model_copy(update={"text": f"{count} {ref.text}"})  # all three boxes
        return ph.Thing((start, end), ref, own_contents or bool(tokens_in(children, "CONTENTS")))

    def exchanged_part(self, children: Children) -> list[ph.Part]:
        """Swap it with the mug: swap both."""
        return [ph.Separator(self.span_of(children[:1]), "and"), *things_in(children)]

    def _described_object(self, text: str, span: g.Span, children: Children) -> g.ObjectRef:
        """A name with what its adjectives say; a quoted name has none."""
        adjectives, words = self.lexicon.adjectives, tokens_in(children, "WORD", "KNOWN")
        several = bool(tokens_in(children, "QUANTIFIER"))
        if parted := self._parted_words(children):
            words, several = parted, True
            text = singular(self._written([w for w in words if w not in _NOBODY]))
        ordinal = self.lexicon.numbers.ordinals.get(words[0]) if len(words) > 1 else None
        if ordinal is not None:
            words, text = words[1:], self._written(words[1:])
        qualities = tuple(adjectives[w] for w in words if w in adjectives)
        if not (qualities or several or ordinal) and not set(words) <= set(_NOBODY):
            return g.ObjectRef(text=text, spans=(span,))
        nouns = [w for w in words if w not in adjectives and w not in self.lexicon.nobodies]
        noun = " ".join(self._written([word]) for word in nouns)
        if several:
            noun = singular(noun)
        return g.ObjectRef(
            text=text, spans=(span,), qualities=qualities, noun=noun, ordinal=ordinal
        )

    def _parted_words(self, children: Children) -> list[Token]:
        """The words of "the taller of the two tins" that say which one; none of another name."""
        words, of = tokens_in(children, "WORD"), tokens_in(children, "OF")
        told = [w for w in words if of and w.end_pos <= of[0].start_pos]
        compared = any(_COMPARED.search(w) or w in _NOBODY for w in told)
        if not compared or not set(told) <= {*self.lexicon.adjectives, *_NOBODY}:
            return []
        whole = [w for w in words[len(told) :] if w not in self.lexicon.numbers.ones]
        return [*told, *whole]

    def _written(self, words: list[Token]) -> str:
        """The words as they were written; words that were put in plainer ones as they are read."""
        written = [self.sentence.words_as_written(self.span_of([word])) for word in words]
        pairs = zip(written, words, strict=True)
        return " ".join(
            str(word) if " " in each and word.type != "QUOTED" else each for each, word in pairs
        )

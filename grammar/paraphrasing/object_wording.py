"""Objects in words that are read back as the same: names, what tells them apart, how many.

The words are the lexicon's own: of the phrases that mean the same the first, or any other that a
caller chooses.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import cache

from grammar.clauses.object_descriptions import SIDES_COUNTED_FROM, side_of_table_in
from grammar.frames import command as g
from grammar.words.lexicon import Lexicon
from grammar.words.phrase_templates import expand_template

Choice = Callable[[Sequence[str]], str]
"""Picks one of several phrases that mean the same."""

_I = re.compile(r"\bi\b")
_NO_NAMES = ("one", "ones", "the", "a", "an", "my", "your", "our", "its")


def no_words(what: str) -> ValueError:
    """The language has no words for something that a frame can say."""
    return ValueError(f"there are no words for {what}")


class Naming:
    """Says objects in the words of a lexicon.

    Of the phrases that mean the same, `choose` picks one; the first by default.
    """

    def __init__(self, lexicon: Lexicon, choose: Choice | None = None) -> None:
        self.lexicon = lexicon
        self._choose = choose or (lambda phrases: phrases[0])

    def phrase_for(
        self, terminal: str, value: str = "", *, ending: str = "", of_object: bool = False
    ) -> str:
        """A phrase of the lexicon with that at its end; `of_object`: no side of the table."""
        phrases = self.lexicon.phrases_for(terminal, value)
        if ending:
            phrases = [phrase for phrase in phrases if phrase.endswith(ending)]
        if of_object:
            phrases = [phrase for phrase in phrases if not side_of_table_in(phrase)]
        if (terminal, value) == ("QUANTIFIER", "all") and not ending.startswith(
            "all the "
        ):  # "all three of the"
            counts = self.lexicon.numbers.ones.keys()
            phrases = [phrase for phrase in phrases if counts.isdisjoint(phrase.split())] or phrases
        if not phrases:
            raise no_words(f"{value} as {terminal}")
        return _I.sub("I", self._choose(phrases))

    # --- names --------------------------------------------------------------------------------

    def object_words(self, ref: g.ObjectRef) -> str:
        """An object, with its article and what tells it apart."""
        words = _name_words(ref.text)
        said = tuple(self.lexicon.adjectives[w] for w in words if w in self.lexicon.adjectives)
        counted, _, rest = ref.text.partition(" ")
        several = rest if ref.quantifier == "all" and counted in self.lexicon.numbers.ones else ""
        plain = self.is_plain(several or ref.text) and said == ref.qualities[: len(said)]
        text = ref.text if ref.pronoun else f"the {ref.text}" if plain else f'"{ref.text}"'
        if not ref.pronoun and (ref.quantifier or ref.ordinal):
            text = self._counted_words(ref, plain)
        told = [text]
        for quality in ref.qualities[len(said) :]:
            if ref.ordinal and quality in SIDES_COUNTED_FROM:
                told.append(self.phrase_for("FROM_SIDE", SIDES_COUNTED_FROM[quality]))
            elif quality == "near" and ref.reference and ref.relation is None:
                told.append(self._relation_words("nearest", ref.reference))
            else:
                told.append(self.phrase_for("SIDE_QUALITY", quality))
        if ref.relation is not None:
            told += [self.phrase_for("THAT_IS"), self._relation_words(ref.relation, ref.reference)]
        if ref.exceptions:
            told.append(self.phrase_for("EXCEPT", ending="except for"))
            told.append(self._joined_names(ref.exceptions))
        return " ".join(told)

    def _counted_words(self, ref: g.ObjectRef, plain: bool) -> str:
        """Words for some of several objects, or for one of a row."""
        if ref.ordinal is not None and plain and not ref.quantifier:
            ordinals = self.lexicon.numbers.ordinals
            return (
                f"the {next(word for word, n in ordinals.items() if n == ref.ordinal)} {ref.text}"
            )
        known = self.lexicon.terminals["QUANTIFIER"]
        if not ref.noun and known.get(ref.text.casefold()) == ref.quantifier:
            return ref.text
        if not plain or ref.ordinal is not None or ref.pronoun:
            raise no_words(f"{ref.quantifier} of {ref.text}")
        counted, _, rest = ref.text.partition(" ")
        if ref.quantifier == "all" and rest and counted in self.lexicon.numbers.ones:
            return f"{self.phrase_for('QUANTIFIER', 'all', ending=f'all the {counted}')} {rest}"
        one = {"all": "every", "any": "any"}.get(ref.quantifier or "")
        ending = one if one and not ref.text.endswith("s") else " the"
        return f"{self.phrase_for('QUANTIFIER', ref.quantifier or '', ending=ending)} {ref.text}"

    def _joined_names(self, refs: Sequence[g.ObjectRef]) -> str:
        return " and ".join(self.object_words(ref) for ref in refs)

    def _relation_words(self, relation: str, reference: Sequence[g.ObjectRef]) -> str:
        between = relation == "between"
        said = self.phrase_for(*(("BETWEEN",) if between else ("RELATION", relation)))
        return f"{said} {self._joined_names(reference)}"

    def needs_no_article(self, name: str) -> bool:
        """Check for a name that is read whole wherever it stands, also behind adjectives.

        One that ends in a number is not: "block 5" may be a block, 5 cm of the way.
        """
        lexicon = self.lexicon
        ends = lexicon.reserved_words | lexicon.first_words
        ends -= lexicon.openers | lexicon.verb_words["VERB"].keys() | lexicon.adjectives.keys()
        words = _name_words(name)
        if words and (words[-1].isdigit() or words[0] in lexicon.hesitating_words):
            return False
        return not any(w in ends and not _is_joining_of(words, i) for i, w in enumerate(words))

    def is_plain(self, name: str) -> bool:
        """Check for a name that is read whole without quotation marks."""
        words = _name_words(name)
        if " ".join(words) in self.lexicon.names:
            return True
        if (
            not words
            or not all(w.isascii() and w.isalnum() for w in words)
            or words[0] in (*_NO_NAMES, *self.lexicon.hesitating_words)
            or f"the {words[0]}" in self.lexicon.terminals["YOU"]
            or self._ends_a_phrase(words)
            or is_said_twice(words)
            or self._holds_filler(words)
        ):
            return False
        return all(self._stays_a_name(words, i) for i in range(len(words)))

    def _ends_a_phrase(self, words: Sequence[str]) -> bool:
        """Check for a name that would end a phrase ("the front", after "against")."""
        ends = (i for i in range(1, len(words) + 1)
                if " ".join(words[:i]) in self.lexicon.definite_endings)  # fmt: skip
        return any(i == len(words) or words[i - 1] not in self.lexicon.adjectives for i in ends)

    def _holds_filler(self, words: Sequence[str]) -> bool:
        """Check for a name of which a part would be left out, or refused: "lol", "once box"."""
        fillers = _fillers(tuple(self.lexicon.asides["fillers"])) | self.lexicon.effects.keys()
        ends = range(1, len(words) + 1)
        return any(" ".join(words[i:end]) in fillers for end in ends for i in range(end))

    def _stays_a_name(self, words: Sequence[str], i: int) -> bool:
        word, lexicon = words[i], self.lexicon
        if i == 0:
            return not word[0].isdigit()
        after_adjectives = all(before in lexicon.adjectives for before in words[:i])
        if after_adjectives and word in lexicon.nobodies:
            return True
        if after_adjectives and word in lexicon.adjectives and i + 1 < len(words):
            return words[i + 1] not in lexicon.ends_names
        known = word in lexicon.openers or word in lexicon.verb_words["VERB"]
        if known or _is_joining_of(words, i):
            return True
        known = word in lexicon.reserved_words or word in lexicon.first_words
        return not (word[0].isdigit() or known)


@cache
def _fillers(templates: tuple[str, ...]) -> frozenset[str]:
    """Words that are left out wherever they stand."""
    return frozenset(p for each in templates for p in expand_template(each) if "," not in p)


def _name_words(name: str) -> list[str]:
    return name.replace("-", " ").casefold().split()


def is_said_twice(words: Sequence[str]) -> bool:
    """Check for words that are read as stammered: "aye aye"."""
    places: dict[str, list[int]] = {}
    for again, word in enumerate(words):
        before = places.setdefault(word, [])
        if any(words[i:again] == words[again : 2 * again - i] for i in before):
            return True
        before.append(again)
    return False


def _is_joining_of(words: Sequence[str], i: int) -> bool:
    """Check for the "of" of "can of soup"."""
    return words[i] == "of" and 0 < i < len(words) - 1 and words[i + 1] not in _NO_NAMES

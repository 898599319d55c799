"""Sentences that tell something, known by their form whatever their words: "my nan is quicker".

A sentence is told of a subject that does or is something: a person, or a thing and a finite verb.
It asks for nothing if nobody in it wishes, means, must or may something, if it holds no word that
says how, how far or until when, and no command behind an "and". An exclamation asks for nothing
either: words of mood ("timber!"), or praise of anything that has no name here ("good seamanship").
"""

from __future__ import annotations

import re
from collections.abc import Collection
from functools import cached_property

from grammar.words.lexicon import Lexicon
from grammar.words.numerals import DIGITS
from grammar.words.phrase_places import WORD, Phrases
from grammar.words.phrase_templates import template_pattern

_HOW = frozenset({"AVOID_DOING", "COMING_WITHIN", "ENSURE", "KEEPS", "LETTING", "MANNER", "NEEDS",
                  "SENSE", "STAYS", "STROKE", "UNTIL", "USING", "WITHOUT"})  # fmt: skip
"""Terminals of which none stands in a sentence that only tells something."""

_FIRST = frozenset({"AGAIN", "DO", "EXCEPT", "KEEP", "MORE", "NO", "NOT", "REPEAT", "REVERSE",
                    "SAME", "STOP", "UNDO", "VERB", "WISH"})  # fmt: skip
"""Terminals with which no part of such a sentence begins."""

_UNITS = frozenset({"ANGLE_UNIT", "FORCE_UNIT", "LENGTH_UNIT", "SPEED_UNIT"})

_PLACES = frozenset({"BESIDE_IT", "DIRECTION", "FACE", "FROM_SIDE", "INTO", "REGION_OF_TABLE",
                     "RELATION", "TOWARD", "TOWARD_REGION"})  # fmt: skip
"""Terminals of where something is, which may also say where it is to go."""

_EVENTS = frozenset({"AVOID", "AVOIDING", "EVENT_INFINITIVE", "TOUCH", "TOUCHING"})
_HAPPENS = frozenset({"EVENT", "TOUCHES"})
_DENIALS = frozenset({"DOES_NOT", "NOT"})
_NEUTRAL = frozenset({"A", "AMOUNT", "CAN", "FILLER", "IS", "ME", "OF", "THERE", "VOCATIVE",
                      "YOU"})  # fmt: skip
"""Terminals that may stand in an exclamation."""

_EMPTY = _NEUTRAL | {"AT", "BOUND", "IN", "IT", "LENGTH_UNIT", "NOT", "OF", "PARTICLE", "RELATION",
                     "SEPARATOR", "THAT", "THE", "WITH"}  # fmt: skip
"""Terminals that may stand in a part of a sentence without a subject: "like a statue"."""

_JOINS = frozenset({"and", "but", "then", "so", "please", "or", ","})
"""Words behind which a verb may be a command."""

_ADDRESSED = frozenset({"i", "we", "you"})
"""Of whom a verb of an action says what is to be done: "you push it", "I would turn it"."""

_ARTICLES = frozenset({"a", "an", "every", "her", "his", "its", "my", "no", "our", "some", "that",
                       "the", "their", "these", "this", "those", "your"})  # fmt: skip
_PRONOUNS = frozenset({"everything", "here", "it", "mine", "nothing", "ours", "something", "that",
                       "there", "these", "they", "this", "those", "what", "which",
                       "yours"})  # fmt: skip
_LONGEST_SUBJECT = 7
_LONGEST_EXCLAMATION = 4
_NO_EXCLAMATION = frozenset({"all", "another", "both", "each", "ignore", "it", "just", "later",
                             "maybe", "never", "perhaps", "soon", "tomorrow", "not", "no", "only",
                             "other", "same", "that", "them", "this"})  # fmt: skip
_ENDINGS = re.compile(r"[a-z]{3,}(?:ed|able|ible|ful|ous|ive|ish|less|some|tastic|ant|ic)")
"""Ends of words that name no thing: "acceptable", "noted"."""

_OF_YOU = frozenset({"deserve", "know", "look", "make", "remind", "say", "see", "seem", "sound",
                     "think", "understand"})  # fmt: skip
_HARMLESS = re.compile(
    r"(?<![^ ])(?:after all|except that|(?:let us|let me|we will|(?:i|we) (?:want|would like) to)"
    " (?:see|find out|know|check|test)(?: (?:whether|if|how|what|why))?)(?= |$)"
)
"""Words with which a sentence that tells something may hold one of a wish."""

_DOES = re.compile("[a-z]{2,}[a-rt-z]s")
_WORDS = re.compile(r"[a-z' ]+")
_CHUNK = re.compile(r"[^,.;!?]+")


class TellingForms:
    """Finds sentences that only tell something, by their form."""

    def __init__(self, lexicon: Lexicon, phrases: Phrases, names: Collection[str] = ()) -> None:
        self._lexicon = lexicon
        self._phrases = phrases
        self._names = frozenset(names)

    def with_names(self, names: Collection[str]) -> TellingForms:
        """The same, where some words are those of the names of objects."""
        return TellingForms(self._lexicon, self._phrases, names)

    def declares(self, text: str, behind: bool = False) -> bool:
        """Check for a text in plain form that says something of a subject, in all its parts.

        Args:
            text: without what opens it, and without its last mark.
            behind: whether it stands behind a command, where a place would be that of the command.
        """
        chunks = [chunk[0].strip() for chunk in _CHUNK.finditer(text)]
        if not chunks or self._wishing.search(_HARMLESS.sub("", text)):
            return False
        begun = [self._begun(chunk) for chunk in chunks if chunk]
        told = [chunk for chunk in begun if self._subject_of(chunk)]
        return bool(told) and all(
            self._only_tells(chunk, not behind) if chunk in told else self._is_empty(chunk)
            for chunk in begun
        )

    def _is_empty(self, text: str) -> bool:
        """Check for a part of a sentence without a subject, none of whose words has an effect."""
        words = text.split()
        kinds = (kinds for _, _, kinds in self._phrases.longest_in(text))
        named = not self._names.isdisjoint(words) or any(
            map(self._lexicon.numbers.is_number, words)
        )
        return not named and all(_EMPTY.issuperset(each) for each in kinds)

    def subject_of(self, text: str) -> str:
        """The thing that a sentence tells something of; "" for a person or a pronoun."""
        begun = self._begun(text.partition(" ,")[0].strip(" .;!"))
        found = self._subject_of(begun)
        named = found and not self._person.match(begun) and begun.split()[0] not in _PRONOUNS
        return found if named else ""

    def exclaims(self, text: str) -> bool:
        """Check for an exclamation in plain form: words of mood, or praise of anything."""
        words = text.split()
        if not 0 < len(words) <= _LONGEST_EXCLAMATION or not _WORDS.fullmatch(text):
            return False
        if not _NO_EXCLAMATION.isdisjoint(words) or not self._names.isdisjoint(words):
            return False
        if not self._lexicon.later_verbs.keys().isdisjoint(words):
            return False
        praises = self._praising.match(text)
        for start, phrase, kinds in self._phrases.longest_in(text):
            if not _NEUTRAL.issuperset(kinds):
                return False
            praised = praises and (start < praises.end() or not self._is_effective(phrase))
            if not (kinds or phrase in self._silent or _ENDINGS.fullmatch(phrase) or praised):
                return False
        return not all(kinds for _, _, kinds in self._phrases.longest_in(text))

    def _is_effective(self, word: str) -> bool:
        """Check for a word that says which, how or how many."""
        return (
            word in self._lexicon.adjectives
            or word.endswith("ly")
            or self._lexicon.numbers.is_number(word)
        )

    @cached_property
    def _praising(self) -> re.Pattern[str]:
        return re.compile(rf"(?:{template_pattern(self._lexicon.courtesy['praising'])}) ")

    def measures(self, text: str) -> bool:
        """Check for a text with an amount and its unit."""
        last = ""
        for _, phrase, kinds in self._phrases.longest_in(text):
            if not _UNITS.isdisjoint(kinds) and self._lexicon.numbers.is_number(last):
                return True
            last = phrase
        return False

    def names_no_thing(self, text: str) -> bool:
        """Check for an exclamation after which "it" is what was spoken of before."""
        return all(_ENDINGS.fullmatch(word) or word in self._silent for word in text.split())

    @cached_property
    def _silent(self) -> frozenset[str]:
        said = self._lexicon.courtesy
        return frozenset(f"{said['idle']} {said['both']} {said['exclaimed']}".split())

    @cached_property
    def _wishing(self) -> re.Pattern[str]:
        """Words with which somebody says what must be done, or what is meant."""
        said = "|".join(map(template_pattern, self._lexicon.statements["denied"]))
        more = template_pattern(self._lexicon.courtesy["wished"])
        return re.compile(rf"(?<![^ ])(?:{said}|{more})(?= |$)")

    @cached_property
    def _person(self) -> re.Pattern[str]:
        said = "|".join(map(template_pattern, self._lexicon.statements["persons"]))
        return re.compile(f"(?:{said}) ")

    @cached_property
    def _adverbs(self) -> re.Pattern[str]:
        said = "|".join(map(template_pattern, self._lexicon.statements["adverbs"]))
        return re.compile(f"(?:(?:{said}) )*")

    @cached_property
    def _finite(self) -> frozenset[str]:
        return frozenset(self._lexicon.courtesy["finite"].split())

    @cached_property
    def _being(self) -> frozenset[str]:
        return frozenset(self._lexicon.courtesy["being"].split())

    @cached_property
    def _degrees(self) -> frozenset[str]:
        return frozenset(self._lexicon.courtesy["degrees"].split())

    @cached_property
    def _before(self) -> re.Pattern[str]:
        return re.compile(
            rf"(?:(?:{template_pattern(self._lexicon.courtesy['before_telling'])}) )*"
        )

    def _begun(self, text: str) -> str:
        """A text without the words with which a sentence may go on."""
        start = self._before.match(text)
        return text[start.end() :] if start else text

    def _subject_of(self, text: str) -> str:
        """The subject of a sentence; "" if it has no form of one that tells something."""
        words = text.split()
        if len(words) < 2:
            return ""
        if person := self._person.match(text):
            after = self._adverbs.match(text, person.end())
            start = after.end() if after else person.end()
            verb = WORD.match(text, start)
            return (
                person[0].strip()
                if verb and self._is_said_of(person[0].strip(), text, start)
                else ""
            )
        if words[0] in _PRONOUNS and self._tells_of_it(text):
            return words[0]
        first = 2 if words[0] in _ARTICLES else 1
        for i in range(first, min(len(words), _LONGEST_SUBJECT)):
            if words[i] in self._finite:
                subject = " ".join(words[:i])
                return subject if first == 2 or self._is_bare(subject) else ""
        does = first == 2 and len(words) > 3 and _DOES.fullmatch(words[2])  # "the edge catches it"
        known = not self._names.isdisjoint(words[:3]) or words[1] in self._lexicon.adjectives
        return " ".join(words[:2]) if does and not known and self._is_bare(words[1]) else ""

    def _is_bare(self, subject: str) -> bool:
        """Check for a subject without an article, of unknown words: "traffic was murder"."""
        return subject.isalpha() and not self._phrases.phrases_at(subject, 0)

    def _tells_of_it(self, text: str) -> bool:
        start = text.index(" ") + 1
        if adverbs := self._adverbs.match(text, start):
            start = adverbs.end()
        verb = WORD.match(text, start)
        if verb is None or verb[0] in self._finite:
            return verb is not None
        happens = self._phrases.has_any_at(_PLACES | _HAPPENS, text, start)
        return verb[0].endswith(("s", "ed")) and not happens

    def _is_said_of(self, person: str, text: str, start: int) -> bool:
        """Check for a verb of a person that asks for nothing here."""
        verb = WORD.match(text, start)
        if verb is None or self._phrases.has_any_at(_PLACES, text, start):
            return False
        if person not in _ADDRESSED:
            return True
        acts = self._phrases.has_terminal_at("VERB", text, start)
        after = WORD.match(text, verb.end() + 1)
        modal = verb[0] in ("can", "could", "may", "might", "would", "will")
        acts = acts or (
            modal
            and after is not None
            and self._phrases.has_terminal_at("VERB", text, after.start())
        )
        if person == "you":
            told = verb[0] in self._finite or verb[0] in _OF_YOU or verb[0].endswith("ed")
            return not acts and not modal and told
        return not acts

    def _only_tells(self, text: str, placed: bool = True) -> bool:
        """Check for a part of a sentence without anything that has an effect."""
        if self.measures(text):
            return False
        place = negated = event = by = False
        last, before = ",", ""
        for start, phrase, kinds in self._phrases.longest_in(text):
            is_so = before in self._being  # "my nan is quicker"
            says_how = not _HOW.isdisjoint(kinds) and not (is_so and "MANNER" in kinds)
            commands = "VERB" in kinds and last in _JOINS and start > 0
            first = start == 0 and not _FIRST.isdisjoint(kinds) and not self._person.match(text)
            by = by or "WITH" in kinds
            if says_how or commands or first or DIGITS.fullmatch(phrase):
                return False
            if by and "TOOL" in kinds:
                return False  # "it smells with one finger"
            place = place or (phrase != "in" and not _PLACES.isdisjoint(kinds))
            negated = negated or not _DENIALS.isdisjoint(kinds)
            event = event or not _EVENTS.isdisjoint(kinds)
            before = phrase if phrase not in self._degrees else before
            last = phrase
        is_there = not self._being.isdisjoint(text.split()) or self._person.match(text)
        is_there = is_there if placed else None
        return not (negated and event and not _PAST.search(text)) and (not place or bool(is_there))


_PAST = re.compile(r"(?<![^ ])(?:did|was|were|had|has|have) not(?= |$)")

"""Sentences that tell something beside a command, which is read without them.

"My sister is coming over and this table is a mess. Push the mug away": the first says nothing of
what is to be done. A statement begins with somebody or something and a verb that is said of it, or
tells what somebody is going to do ("let us tidy up"); one that says what must or may be done here,
what is meant, or how, is none. It may be any sentence of a text, or the beginning or end of one.
Where the command then says "it", the thing that is told of is put before it: "the mug is close to
the edge, push it" is "the mug, push it". All this is tried on a text that is not read as it stands.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property
from itertools import islice

from grammar.frames.command import Span
from grammar.phrases.idle_words import IdleWords
from grammar.phrases.telling_forms import TellingForms
from grammar.phrases.text_stretches import (
    match_end,
    parts_around,
    parts_between,
    splits_at,
    without_ends,
)
from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised
from grammar.words.phrase_places import WORD, Phrases
from grammar.words.phrase_templates import expand_template, template_pattern

_HOW = frozenset({"AVOID_DOING", "COMING_WITHIN", "ENSURE", "EXCEPT", "FORCE_UNIT", "KEEP", "KEEPS",
                  "LETTING", "MANNER", "SPEED_UNIT", "STAYS", "UNTIL", "USING",
                  "WITHOUT"})  # fmt: skip
"""Terminals that say how something is to be done; what tells them is no mere statement."""

_EFFECTOR = frozenset({"WITH", "TOOL"})
"""Terminals that say so together: "with one finger", not "with my children"."""

_TAIL = _HOW | {"ANGLE_UNIT", "DIRECTION", "FACE", "FROM_SIDE", "LENGTH_UNIT", "SENSE", "TOWARD"}
"""These, and those that say where to, which belong to the command before a statement."""

_EVENTS = frozenset({"AVOID", "AVOIDING", "EVENT", "EVENT_INFINITIVE", "TOUCH", "TOUCHES",
                     "TOUCHING"})  # fmt: skip
_NOTS = frozenset({"DOES_NOT", "NOT"})
_THING = frozenset({"IT", "THAT", "THE"})
_WHERE = frozenset({"BESIDE_IT", "INTO", "REGION_OF_TABLE", "RELATION", "TOWARD_REGION"})
"""Terminals of places, where a verb that is not known to tell something may ask for something."""

_ASKED = frozenset({"IT", "STROKE", "THAT"})
"""Terminals with which a wish of somebody tells what is to be done here."""

_NAMING = _THING | {"A", "QUANTIFIER", "VERB"}
"""Terminals of which none stands in what only says how or where to."""

_DOING = frozenset({"he", "i", "never", "not", "she", "they", "to", "we", "who", "you"})
"""Words behind which a verb says what somebody does, and is no command."""

_SHAPES = {
    "openings": "(?>(?:{0}) (?:, )?)*+",  # atomic, since "oh no" may be one opening or two
    "about_it": "(?:{0}) ",
    "persons": "(?:{0}) ",
    "adverbs": "(?:(?:{0}) )*",
    "verbs": "(?:{0})(?= |$)",
    "whole": "{0}",
    "plans": "(?:{0}) ",
    "denied": "(?<![^ ])(?:{0})(?= |$)",
    "taken_back": "(?<![^ ])(?:{0})(?= |$)",
}
"""Where the words of each kind stand."""

_AMOUNT = (
    r"(?:(?:about|just|only) )?(?:\d|a|an|half|[a-z]+teen|[a-z]+ty|one|two|three|four|five|six|"
    "seven|eight|nine|ten|twelve)(?= |$|[^a-z])"
)
_POINTS = re.compile(
    rf"(?<![^ ])(?<!do )(?!(?<=make )it {_AMOUNT})(?:its?|them|they|this|these|those|that)(?= |$)"
)
_NAMED = re.compile(
    r"(?<![^ ])(?:the|my|your|our|an?|every|both|all)(?= )(?! (?:way|left|right)(?: |$))"
)
_SEVERAL = re.compile(
    r"(?<![^ ])(?<!first of )(?:all|both|each|every|everything|rest|others?|two|three)(?= |$)"
)
_SEVERAL_BUT = re.compile(r"(?<![^ ])(?:all|any|both|each|every(?:thing|body|one)?)$")
_JOINT = re.compile(r"(?:(?:so|and|then|but|now|well|please|ok|okay)(?: ,)? )+|[,.;!?] ")
_SENTENCE_END = re.compile(r" [.;!?](?= )")
_END = re.compile(r" [,.;!?](?= )")
_PAUSE = re.compile(r" ,(?= )|(?<=[^ ,.;])(?= (?:so|but) (?!that |far |much |, ))")
_MARK = re.compile(r" [,.;!?](?= |$)")
_AND = re.compile(r" (?:and|but|while)(?= )")
_ARTICLES = frozenset({"a", "an", "her", "his", "my", "our", "that", "the", "their", "these",
                       "this", "those", "your"})  # fmt: skip
_LONGEST = 8
"""Words up to the verb of the longest subject."""

_NO_THING = frozenset({"corner", "day", "edge", "end", "idea", "middle", "moment", "place", "point",
                       "room", "same", "side", "table", "time", "view", "way"})  # fmt: skip
"""Nouns that name nothing that is moved."""

_MOST_PAUSES = 8
"""Pauses in what stands before a command, and behind it, so that no text takes long."""

_SHORTEST = 3
"""Words of the shortest statement that ends in a comma, as a name with its article has two."""


class Statements:
    """Leaves out what only tells something, by the words of a lexicon."""

    def __init__(self, lexicon: Lexicon, phrases: Phrases) -> None:
        self._phrases = phrases
        self._ends_names = lexicon.ends_names
        self._stops = frozenset(lexicon.phrases_of("STOP"))
        self._statements = lexicon.statements
        self._thanks = frozenset(lexicon.courtesy["thanking"].split())
        self._idle = IdleWords(lexicon, phrases)
        self._forms = TellingForms(lexicon, phrases)

    def with_names(self, names: Collection[str]) -> Statements:
        """The same, where some words are those of the names of objects."""
        statements = copy(self)
        statements._idle = self._idle.with_names(names)
        statements._forms = self._forms.with_names(names)
        return statements

    @cached_property
    def _told(self) -> dict[str, re.Pattern[str]]:
        """The patterns of the words of each kind, made for the first text that needs them."""
        said = {k: "|".join(map(template_pattern, t)) for k, t in self._statements.items()}
        openings = {each for t in self._statements["openings"] for each in expand_template(t)}
        said["openings"] = "|".join(map(re.escape, sorted(openings, key=len, reverse=True)))
        return {kind: re.compile(shape.format(said[kind])) for kind, shape in _SHAPES.items()}

    def readings(self, said: Normalised) -> Iterator[tuple[Normalised, Normalised | None]]:
        """Yield a text without statements, and the thing they tell of that it then means by "it".

        Args:
            said: a text that is not read as it stands.
        """
        text = said.text
        sentences = parts_between(text, (0, len(text)), _SENTENCE_END)
        asked = sentences[-1] if said.question else None
        told = [
            span
            for span in sentences
            if self._all_tell(text, span, _HOW, 2) or (span != asked and self._has_form(text, span))
        ]
        if told == sentences:  # "it was worth asking, never mind"
            told = [span for span in sentences if self._tells(text, span)]
        kept = [span for span in sentences if span not in told]
        if kept and told:
            yield from self._without(said, told, kept)
        inner = [self._told_around(text, span) for span in kept]
        for i, (span, (heads, tails)) in enumerate(zip(kept, inner, strict=True)):
            for part in [(start, span[1]) for start in heads] + [(span[0], end) for end in tails]:
                left = [*kept[:i], part, *kept[i + 1 :]]
                yield from self._without(said, [*told, *parts_around(part, span)], left)
        plain = [without_ends(span, *ends) for span, ends in zip(kept, inner, strict=True)]
        around = [
            end for span, part in zip(kept, plain, strict=True) for end in parts_around(part, span)
        ]
        if len(around) > 1:
            yield from self._without(said, [*told, *around], plain)
        if len(kept) == 2 and (way := self._way_in(text, *kept[0])):
            yield from self._without(said, told, [kept[1], way])  # "At the top. Push it."

    def _way_in(self, text: str, start: int, end: int) -> Span | None:
        """The part of a sentence that only says how or where to; None if it says more."""
        start += self._start(text[start:end])
        said = (kinds for _, _, kinds in self._phrases.longest_in(text[start:end]))
        return None if any(not _NAMING.isdisjoint(kinds) for kinds in said) else (start, end)

    def _told_around(self, text: str, span: Span) -> tuple[list[int], list[int]]:
        """Places of a sentence up to which, and from which on, it tells something."""
        splits = [(first[1], last[0]) for first, last in splits_at(text, span, _PAUSE)]
        return (
            [
                start
                for end, start in splits[:_MOST_PAUSES]
                if self._all_tell(text, (span[0], end), _HOW, _SHORTEST)
                or self._has_form(text, (span[0], end))
            ],
            [
                end
                for end, start in splits[-_MOST_PAUSES:]
                if self._all_tell(text, (start, span[1]), _denied_behind(text, start), _SHORTEST)
                or self._has_form(text, (start, span[1]), behind=True)
            ],
        )

    def _all_tell(self, text: str, span: Span, denied: frozenset[str], least: int) -> bool:
        """Check for a part of a text that is a statement, or several ones."""
        if _SEVERAL_BUT.search(text, *span):
            return False  # "all but the mug"
        if self._tells(text, span, least, denied):
            return True
        parts = [
            part for part in parts_between(text, span, _PAUSE) if not self._only_opens(text, part)
        ]
        stops = any(text[slice(*part)].strip(" ,.;!?") in self._stops for part in parts)
        told = (self._tells(text, part, _SHORTEST, denied) for part in parts)
        return bool(parts) and not stops and all(told)

    def _has_form(self, text: str, span: Span, behind: bool = False) -> bool:
        """Check for what tells something by its form; behind a command it says no place."""
        said = text[slice(*span)]
        if said.endswith("?"):
            return False
        said = said.strip(" ,.;!")
        begun = said[self._start(said) :]
        return self._forms.declares(begun, behind) or self._forms.exclaims(begun)

    def _only_opens(self, text: str, span: Span) -> bool:
        return bool(self._told["openings"].fullmatch(text[slice(*span)].strip(" ,.;!?") + " "))

    def _tells(self, text: str, span: Span, least: int = 2, denied: frozenset[str] = _HOW) -> bool:
        """Check for a part of a text that is a statement."""
        text = text[slice(*span)].strip(" ,.;!?")
        if text in self._stops or self._told["taken_back"].search(text):
            return False  # "push it. Never mind"; "that was only an example"
        if self._told["whole"].fullmatch(text):
            return True
        text = text[self._start(text) :]
        if self._is_idle(text):
            return True
        if plan := self._told["plans"].match(text):
            return self._plans_elsewhere(text, plan.end())
        subject = self._end_of_subject(text) if text.count(" ") + 1 >= least else 0
        if not subject or self._told["denied"].search(text):
            return False
        if self._forms.measures(text) and not self._told["persons"].match(text):
            return False  # "it is 5 cm too far"
        known = self._is_told(text, subject) or self._told["persons"].match(text)
        return not self._says_how(text, denied if known else denied | _TAIL | _WHERE)

    def _is_idle(self, text: str) -> bool:
        return bool(self._told["whole"].fullmatch(text)) or self._idle.are_all(text)

    def only_tells(self, said: Normalised) -> bool:
        """Check for thanks of which every part is idle: "not to worry, you have been kind"."""
        text = said.text
        if self._thanks.isdisjoint(text.split()):
            return False
        parts = parts_between(text, (0, len(text)), _END)
        told = [text[slice(*part)].strip(" ,.;!?") for part in parts]
        return (
            not said.question
            and all(
                self._only_opens(each, (0, len(each)))
                or self._told["whole"].fullmatch(each)  # "great show"
                or self._is_idle(each[self._start(each) :])
                or self._has_form(each, (0, len(each)))
                for each in told
            )
        )

    def _plans_elsewhere(self, text: str, start: int) -> bool:
        """Check for what somebody is going to do without any thing or action that is known."""
        things = (word for word in WORD.finditer(text, start) if word[0] in _ARTICLES)
        after = (WORD.match(text, word.end() + 1) for word in things)
        if any(word is None or word[0] not in _NO_THING for word in after):
            return False
        words = WORD.finditer(text, start)
        return not any(self._phrases.has_any_at(_ASKED, text, word.start()) for word in words) and (
            start < len(text) and not self._phrases.has_terminal_at("VERB", text, start)
        )

    def _start(self, text: str) -> int:
        """Place behind the words with which a statement may be opened."""
        opening = self._told["openings"].match(text)
        return opening.end() if opening else 0

    def _end_of_subject(self, text: str) -> int:
        """End of what a text is said of; 0 if it does not tell anything of it."""
        one = self._told["about_it"].match(text)
        if one and self._is_told(text, one.end()):
            return one.end()
        if one := self._told["persons"].match(text):
            verb = WORD.match(text, self._behind_adverbs(text, one.end()))
            acts = verb and self._phrases.has_terminal_at("VERB", text, verb.start())
            never = verb and verb.start() > one.end() and one[0] not in ("we ", "you ")
            acts = acts and not never
            asks = one[0] in ("we ", "you ") and not self._is_told(text, one.end())
            return 0 if verb is None or acts or asks else one.end()
        if text.partition(" ")[0] not in _ARTICLES:
            return 0
        pause = _MARK.search(text)
        words = islice(WORD.finditer(text, 0, pause.start() if pause else len(text)), 2, _LONGEST)
        return next((w.start() for w in words if self._may_be_told(text, w.start())), 0)

    def _is_told(self, text: str, start: int) -> bool:
        """Check for a verb that is said of something."""
        return bool(self._told["verbs"].match(text, self._behind_adverbs(text, start)))

    def _may_be_told(self, text: str, start: int) -> bool:
        """Check for a verb that is said of something, or a word behind an adverb: "still hurts"."""
        after = self._behind_adverbs(text, start)
        return self._is_told(text, start) or start < after < len(text)

    def _behind_adverbs(self, text: str, start: int) -> int:
        adverbs = self._told["adverbs"].match(text, start)
        return adverbs.end() if adverbs else start

    def _says_how(self, text: str, how: frozenset[str]) -> bool:
        """Check for words that restrict what is done, or are a command."""
        negated, last, seen = False, "", set[str]()
        for start, phrase, kinds in self._phrases.longest_in(text):
            seen |= _EFFECTOR.intersection(kinds)
            negated = negated or not _NOTS.isdisjoint(kinds)
            says = phrase != "from" and not how.isdisjoint(kinds)
            if says or seen == _EFFECTOR or (negated and not _EVENTS.isdisjoint(kinds)):
                return True
            commands = "VERB" in kinds and last not in _DOING
            if commands and self._phrases.has_any_at(_THING, text, start + len(phrase) + 1):
                return True
            last = phrase.rpartition(" ")[2]
        return False

    def _without(
        self, said: Normalised, told: Sequence[Span], kept: Sequence[Span]
    ) -> Iterator[tuple[Normalised, Normalised | None]]:
        """Yield a text without what is told in it, unless that leaves open what is meant."""
        cut = {end + 1 for _, end in told}
        begins = ((match_end(_JOINT.match(said.text, s)) if s in cut else s, e) for s, e in kept)
        rest = said.words_in(*((max(b, s), e) for (b, e), (s, _) in zip(begins, kept, strict=True)))
        rest = rest.words_in((match_end(_JOINT.match(rest.text)), len(rest.text.rstrip(" ,.;!?"))))
        asks = rest.question and (not told or max(kept) > max(told))
        rest = replace(rest, question=asks)
        before = [span for span in told if span < min(kept)]
        about = [said.words_in(thing) for span in before for thing in self._things(said.text, span)]
        points = next(filter(self._stands_alone, _POINTS.finditer(rest.text)), None)
        if not rest.text:
            return
        if about and self._phrases.has_terminal_at("STROKE", rest.text, 0):
            return  # "the jar is dirty. A little nudge to the left"
        if points is None or _NAMED.search(rest.text, 0, points.start()):
            if not (about and _SEVERAL.search(rest.text)):
                yield rest, None
        elif len({thing.text for thing in about}) < 2:
            yield rest, about[0] if about else None

    def _stands_alone(self, pointer: re.Match[str]) -> bool:
        """Check for a pronoun, not "that" of "that mug" or "so that it stays upright"."""
        after = WORD.match(pointer.string, pointer.end() + 1)
        pronoun = pointer[0] in ("it", "its", "them", "they")
        return pronoun or after is None or after[0] in self._ends_names

    def _things(self, text: str, span: Span) -> Iterator[Span]:
        """Yield the things that a statement is about, or those it names, if about a person."""
        for first, end in parts_between(text, span, _AND):
            start = first + self._start(text[first:end])
            said = text[start:end]
            if self._is_idle(said.strip(" ,.;!?")):
                continue
            one = self._told["about_it"].match(said)
            if one and self._is_told(said, one.end()):
                continue
            bare = said.strip(" ,.;!?")
            if self._forms.exclaims(bare):
                if "!" not in said and not self._forms.names_no_thing(bare):
                    yield start, start + len(bare)  # "Sprocket. Push it"
                continue
            subject = self._end_of_subject(said)
            if not subject and (named := self._forms.subject_of(said)):
                start += said.index(named)
                yield start, start + len(named)
                continue
            if subject and not self._told["persons"].match(said):
                yield start, start + len(said[:subject].rstrip())
                continue
            for word in WORD.finditer(text, start + subject, end):
                if word[0] in _ARTICLES and (after := self._end_of_name(text, word.end(), end)):
                    yield word.start(), after

    def _end_of_name(self, text: str, start: int, stop: int) -> int:
        """End of the name behind an article; 0 if there is none, or it is no thing's."""
        end = 0
        for word in WORD.finditer(text, start, stop):
            if word[0] in self._ends_names or word[0] in _NO_THING or not word[0].isalnum():
                break
            end = word.end()
        return end


def _denied_behind(text: str, start: int) -> frozenset[str]:
    """Terminals of none of what is told behind a command: "push it so the jar is on its left"."""
    follows = text[start:].lstrip(" ,").startswith("so ")
    return _TAIL | _WHERE if follows else _TAIL

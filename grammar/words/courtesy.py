"""Words of courtesy around a command, told by what they are made of instead of by their phrases.

"I was wondering whether you would be so kind as to push the jar away, if that is not asking too
much" has a run of words before its verb, and one behind it, that say nothing about a thing, a place
or a way of doing it. Such a run is left out if it ends where a command can begin; before a gerund
or a participle it is put as "try" or "I want", which the grammar reads.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import replace
from itertools import pairwise

from grammar.frames.command import Span
from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised
from grammar.words.phrase_places import WORD, Phrases

_ASKS = frozenset({"CAN_YOU", "HOW_HARD", "IF", "POSSIBLE", "THINK", "WHAT_CAN", "WHAT_HAPPENS",
                   "WHAT_IF", "WHERE", "WHICH_CAN", "WHY_DID"})  # fmt: skip
"""Terminals that begin a question or a condition, which is no courtesy."""

_COMMAND = frozenset({"VERB", "MANNER", "MIND"})
_REMARKS = frozenset({"DO", "I_MEANT", "MORE", "NO", "REPEAT", "REVERSE", "SEEN", "STOP", "UNDO",
                      "VERB", "WHAT_DID", "WHY"})  # fmt: skip
"""Terminals that ask for something even beside thanks."""

_THING = frozenset({"THE", "THAT", "IT"})
_ARTICLES = frozenset({"a", "an", "our", "that", "the", "this", "your"})
_CANS = frozenset((article, "can") for article in _ARTICLES - {"that", "this"})
_BEGS = re.compile("(?:please )?(?:can|could|may|might) (?:i|we) (?:please )?(?:get|have|see)")
"""A request, if a thing and a participle follow: "could I have the jar pushed away"."""

_ABOUT_IT = ("IS_IT", "HOW", "HOW_MUCH_DOES", "WHERE_IS", "CAN_YOU")
_IS_TO_GO = re.compile(r"(?:it|that|they|those) (?:should|must|ought to) (?:go|be) ")
_BEHIND_TOPIC = re.compile(r" ([,.;?!]|and)(?: (?:and|then|please|now|(?:could|would) you))* ")
_NEW_THING = re.compile(r"(?:there|here) is an? ")
_BEHIND_NEW_THING = re.compile(
    r"(?: (?:on the table|in front of (?:you|me|us|the robot)|over there|there|here))?"
    + _BEHIND_TOPIC.pattern
)
"""What stands on the table need not be said so: "there is a jar on the table. Push it"."""

_EMPHASIS = re.compile(
    r"it is ((?:the|my|your|our) [^,.;]+?) (?:that|which) "
    r"|what ((?:the|my|your|our) [^,.;]+? needs) is "
)
"""What is said with emphasis: "it is the jar that should go", "what the jar needs is a push"."""

_READ = frozenset({"FILLER", "NEXT", "VOCATIVE"})
_SAYS = frozenset({"AMOUNT", "DIRECTION", "FACE", "FROM_SIDE", "MANNER", "REGION",
                   "REGION_OF_TABLE", "SENSE", "SIDE_QUALITY", "WAY", "LENGTH_UNIT",
                   "ANGLE_UNIT", "FORCE_UNIT", "SPEED_UNIT", "TOOL"})  # fmt: skip
_SAYS_WHERE = _SAYS | {"BETWEEN", "FROM", "IN", "INTO", "NEEDS", "NO", "RELATION", "REVERSE",
                       "SAME", "TO_BE", "TOWARD", "VERB_ED", "VERB_ING"}  # fmt: skip
_ONE_THING = re.compile(r"(?:the|my|your|our|that) [a-z ]+(?: (?:, )?please)?")
_SAYS_OR_ASKS = _SAYS | {"SEEN", "UNDO", "WHAT_DID"}
_JOINING = ("and", "but", "so", "then")
_OUTCOME = re.compile(
    "(?:what|who|which|where|when|how|why) (?:is|are|was|will|would|could|should) "
)
"""The beginning of a question for what becomes of something: "what would be pushing it"."""

_FORBIDDEN = frozenset({"must", "nothing"})
"""What must not be is no courtesy, whatever its words: "nothing must happen to it"."""

_WAITS = re.compile("(?:only )?(?:when|once|until|till) (?:i|we) ")
"""The beginning of what says when to begin, which is no courtesy: "when I say so"."""

_PAUSES = frozenset(",.;!?")
_LONGEST_REQUEST = 20
"""Words of the longest request before a verb, so that no text takes long."""

_LONGEST_CLOSING = 8
"""Words of the longest courtesy behind a command without a pause before it."""


class Courtesy:
    """Finds runs of courtesy, by the words of a lexicon."""

    def __init__(self, lexicon: Lexicon, phrases: Phrases) -> None:
        self._phrases = phrases
        self._words = {kind: frozenset(said.split()) for kind, said in lexicon.courtesy.items()}
        self._topics = re.compile(rf"(?:{lexicon.courtesy['topics']}) ")
        self._opening = self._words["both"] | self._words["before"]
        self._closing = self._words["both"] | self._words["after"]
        known = self._opening | self._closing | self._words["beside_thanks"]
        self._beside_closing = known - self._words["greeting"]
        self._stops = frozenset(lexicon.phrases_of("STOP"))

    def is_closing(self, said: Normalised) -> bool:
        """Check for words of courtesy alone, with which somebody thanks or leaves."""
        if said.text.rstrip(" .") in self._stops:
            return False
        words = said.text.replace(" ,", "").replace(" .", "").split()
        closes = not self._words["closing"].isdisjoint(words)
        if said.question or not closes or not self._beside_closing.issuperset(words):
            return False
        asking = (m for m in WORD.finditer(said.text) if m[0] not in self._words["closing"])
        starts = (word.start() for word in asking)
        return not any(self._has_kind(_REMARKS, said.text, start) for start in starts)

    def is_remark(self, text: str) -> bool:
        """Check for a text that is "do it" and nothing else, in any of its words: "go on then"."""
        found = self._phrases.phrases_at(text, 0)
        return bool(found) and found[0][0] == text and "DO" in found[0][1]

    def put_plainly(self, said: Normalised) -> Normalised:
        """The sentence without the courtesy before its command and behind it."""
        said = self._without_emphasis(self._without_topic(self.without_greeting(said)))
        said = self._without_request(said)
        return self._without_closing(said)

    def without_greeting(self, said: Normalised) -> Normalised:
        """The sentence without courtesy up to a first pause, as often as it comes."""
        words = said.text.split()
        while (end := self._pause(words)) and self._is_courtesy(words[:end], self._opening):
            said, words = _from_word(said, end + 1), words[end + 1 :]
        return said

    def _pause(self, words: list[str]) -> int:
        """Place of the first pause with something behind it; 0 if there is none."""
        pauses = (i for i, word in enumerate(words[:-1]) if word in _PAUSES)
        return next(pauses, 0)

    def _is_courtesy(self, words: list[str], known: frozenset[str]) -> bool:
        """Check for words of courtesy that do not just point at something."""
        if not known.issuperset(words) or self._words["pointing"].issuperset(words):
            return False
        if self._names_a_thing(words) or _goes_ahead(words):
            return False
        if _FORBIDDEN.issubset(words) or _WAITS.match(" ".join(words)):
            return False
        return not self._is_read(words) and not self._says_something(" ".join(words))

    def _names_a_thing(self, words: list[str]) -> bool:
        """Check for words up to a pause that may be a thing's name: "the computer, push it"."""
        if any(pair in _CANS for pair in pairwise(words)):
            return True
        words = words[words[0] in ("and", "or") :]
        words = words[: next((i for i, word in enumerate(words) if word in _PAUSES), len(words))]
        named = bool(words) and words[-1] in self._words["things"]
        return named and (words[0] in _ARTICLES or words[:-1] == ["my"])

    def _says_something(self, text: str) -> bool:
        """Check for a phrase of several words about where, how or how far: "to the right"."""
        return any(
            " " in phrase and not _SAYS_OR_ASKS.isdisjoint(kinds)
            for word in WORD.finditer(text)
            for phrase, kinds in self._phrases.phrases_at(text, word.start())
        )

    def _is_read(self, words: list[str]) -> bool:
        """Check for words that the grammar reads itself."""
        text = " ".join(words).rstrip(" ,.;")
        found = self._phrases.phrases_at(text, 0)
        whole = bool(found) and found[0][0] == text and not _READ.isdisjoint(found[0][1])
        return whole or any(
            "DO" in kinds and word.start() + len(phrase) == len(text)
            for word in WORD.finditer(text)
            for phrase, kinds in self._phrases.phrases_at(text, word.start())
        )

    def _asks(self, words: list[str]) -> bool:
        """Check for the beginning of a question or a condition."""
        if "please" in words:
            return False
        while words and words[0] in _JOINING:
            words = words[1:]
        found = self._phrases.phrases_at(" ".join(words), 0)
        return bool(found) and not _ASKS.isdisjoint(found[0][1])

    def _without_request(self, said: Normalised) -> Normalised:
        """The sentence without the request before its verb, or with a plain one in its place."""
        places = list(WORD.finditer(said.text))
        run = next((i for i, m in enumerate(places) if m[0] not in self._opening), len(places))
        if self._phrases.has_terminal_at("VERB", said.text, 0):
            return said
        for i in range(min(run, len(places) - 1, _LONGEST_REQUEST), 0, -1):
            words, start = [m[0] for m in places[:i]], places[i].start()
            found = self._phrases.phrases_at(said.text, start)
            kinds = {kind for _, kinds in found for kind in kinds}
            instead = self._instead(words, kinds, said.text[start:])
            begs = _BEGS.fullmatch(" ".join(words)) is not None
            asked = self._asks(words[_last_pause(words) :]) and not begs
            asked = asked or any(self._reaches(said.text, m.start(), start) for m in places[:i])
            asked = asked or self._says_something(" ".join(words)) or self._names_a_thing(words)
            asked = asked or _goes_ahead(words)
            asked = asked or (words != ["so"] and self._is_read(words))
            if instead is not None and not asked:
                return _begun_with(instead, said, start)
        return said

    def begins_command(self, text: str) -> bool:
        """Check for words with which a command begins: "then", "push"."""
        return self._has_kind({"NEXT", "VERB"}, text, 0)

    def _without_topic(self, said: Normalised) -> Normalised:
        """The sentence that begins with its thing: "as for the jar, push it" is "the jar, …"."""
        topic = self._topics.match(said.text)
        new = _NEW_THING.match(said.text)
        if topic is None or not (new or self._has_kind(_THING, said.text, topic.end())):
            return said
        start = new.end() if new else topic.end()
        behind = _BEHIND_NEW_THING if new else _BEHIND_TOPIC
        for pause in behind.finditer(said.text, start):
            told = topic[0] == "now " and _IS_TO_GO.match(said.text, pause.end())
            if told or self._has_kind({"VERB", *_ABOUT_IT}, said.text, pause.end()):
                text = f"{said.text[: pause.start()]} , {said.text[pause.end() :]}"
                columns = said.columns[: pause.start()], said.columns[pause.end() :]
                comma = said.columns[pause.start(1)][0], said.columns[pause.end(1) - 1][1]
                whole = replace(said, text=text, columns=(*columns[0], *[comma] * 3, *columns[1]))
                asked = said.question and "you" not in pause[0].split()
                return replace(_begun_with("the " * bool(new), whole, start), question=asked)
        return said

    def _without_emphasis(self, said: Normalised) -> Normalised:
        """The sentence that plainly says what it says with emphasis."""
        found = _EMPHASIS.match(said.text)
        kinds = ("TO_BE",) if found and found[1] else ("STROKE",)
        if found is None or not self._has_kind(kinds, said.text, found.end()):
            return said
        return said.words_in(found.span(found.lastindex or 0), (found.end(), len(said.text)))

    def _has_kind(self, kinds: Collection[str], text: str, start: int) -> bool:
        return any(self._phrases.has_terminal_at(kind, text, start) for kind in kinds)

    def _reaches(self, text: str, start: int, end: int) -> bool:
        """Check for a phrase of the language from one place to beyond another."""
        return any(start + len(phrase) > end for phrase, _ in self._phrases.phrases_at(text, start))

    def _instead(self, words: list[str], kinds: set[str], rest: str) -> str | None:
        """Words to say in place of a run; None if no command can begin behind it."""
        last = words[-1]
        gerund = "VERB_ING" in kinds and "THE_PROPERTY_OF" not in kinds  # "standing in the box"
        if gerund and _OUTCOME.match(" ".join((*words, ""))):
            return None
        if gerund and last in self._words["before_gerund"]:
            return "try "
        if kinds & _COMMAND and self._asks_for(words):
            return ""
        wishes = not self._words["wishing"].isdisjoint(words) or _BEGS.fullmatch(" ".join(words))
        if not (kinds & _THING and wishes and last in self._words["before_thing"]):
            return None
        passive = any(self._has_kind({"VERB_ED"}, rest, m.start()) for m in WORD.finditer(rest))
        if passive:
            return "i want "
        return "give me " if last in ("have", "get") and self._only_names(rest) else None

    def _only_names(self, text: str) -> bool:
        """Check for a thing and nothing besides: of "could I have it closer" no more is known."""
        ends = [word.start() for word in WORD.finditer(text)]
        says = any(self._has_kind(_SAYS_WHERE, text, start) for start in ends)
        return not says and _ONE_THING.fullmatch(text) is not None

    def _asks_for(self, words: list[str]) -> bool:
        """Check for a run behind which a verb is asked for: "… you could", not "do you"."""
        if words[-1] in self._words["behind_you"]:
            return words[-2:-1] in (["you"], ["we"], ["robot"])
        own = words[-2:] in (["do", "you"], ["let", "me"])
        statement = own or words == ["you"] or words[0] == "did"
        return words[-1] in self._words["before_verb"] and not statement

    def pause_in(self, text: str) -> Span | None:
        """Courtesy between two commas, with no comma; None if there is none."""
        commas = [m.start() for m in re.finditer(r"(?<![^ ]),(?= )", text)]
        for start, end in pairwise(commas):
            words = text[start + 1 : end].split()
            named = words in (["robot"], ["please"])
            if words and (named or self._is_courtesy(words, self._closing)):
                return start + 2, end - 1
        return None

    def _without_closing(self, said: Normalised) -> Normalised:
        """The sentence without courtesy behind its last pauses."""
        words = said.text.split()
        while pauses := [i for i, word in enumerate(words) if i and word in _PAUSES]:
            tail = words[pauses[-1] + 1 :]
            if tail and not self._is_courtesy(tail, self._closing):
                break
            end = list(WORD.finditer(said.text))[pauses[-1] - 1].end()
            said = replace(said, text=said.text[:end], columns=said.columns[:end],
                           question=said.question and not tail)  # fmt: skip
            words = words[: pauses[-1]]
        for i in range(len(words) - 1, max(2, len(words) - _LONGEST_CLOSING), -1):
            if words[i] in self._words["ending"] and self._is_courtesy(words[i:], self._closing):
                end = list(WORD.finditer(said.text))[i - 1].end()
                if self.is_said(said.text[:end]):
                    return replace(said, text=said.text[:end], columns=said.columns[:end])
        return said

    def is_said(self, text: str) -> bool:
        """Check for a text that ends in a whole phrase about where, how or how far."""
        starts = [m.start() for m in WORD.finditer(text)][-_LONGEST_CLOSING:]
        return any(
            start + len(phrase) == len(text) and not _SAYS.isdisjoint(kinds)
            for start in starts
            for phrase, kinds in self._phrases.phrases_at(text, start)
        )


def _goes_ahead(words: list[str]) -> bool:
    """Check for "ahead" as a direction, which it is not in "go right ahead"."""
    return "ahead" in words and "go" not in words


def _last_pause(words: list[str]) -> int:
    """Place behind the last pause of some words."""
    return max((i + 1 for i, word in enumerate(words) if word in _PAUSES), default=0)


def _from_word(said: Normalised, i: int) -> Normalised:
    start = list(WORD.finditer(said.text))[i].start()
    return replace(said, text=said.text[start:], columns=said.columns[start:])


def _begun_with(words: str, said: Normalised, start: int) -> Normalised:
    """A sentence from a place on, with other words before that."""
    over: Span = (said.columns[0][0], said.columns[start - 1][1])
    return replace(
        said,
        text=words + said.text[start:],
        columns=(*((over,) * len(words)), *said.columns[start:]),
        question=said.question
        and not words
        and {"you", "we"}.isdisjoint(said.text[:start].split()),
    )

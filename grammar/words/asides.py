"""Words around a command that change nothing, and words that are taken back.

"Uh, could you push the tin, no wait, the jar away, because it is in the way? Thanks!" means "push
the jar away": politeness, fillers, reasons and doubled words are left out, and what is corrected is
replaced by what corrects it. A correction takes the place of the last group of words of its own
kind (a thing, a number, a direction, a verb); where none stands before it, nothing is taken back.
"""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cached_property
from typing import NamedTuple

from grammar.frames.command import Span
from grammar.words.courtesy import Courtesy
from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised
from grammar.words.numerals import DIGITS
from grammar.words.phrase_places import WORD, Phrases
from grammar.words.reasons import Reasons

_ALONE = frozenset({"AMOUNT", "DIRECTION", "MANNER", "SENSE", "SEPARATOR", "VERB"})
"""Terminals that are a group of words by themselves."""

_LEAD = _ALONE | {"AT", "BETWEEN", "BY", "FACE", "FROM_SIDE", "IN", "INTO", "NEXT", "NOT", "REGION",
                  "REGION_OF_TABLE", "RELATION", "SO", "TOWARD", "UNTIL", "WITH",
                  "WITHOUT"}  # fmt: skip
"""Terminals that begin a group; what follows belongs to it."""

_BEGIN = _LEAD | {"NUMBER", "THING", "IT"}
"""Kinds that begin a group where no other is open."""

_RESTATED = frozenset({"NUMBER", "THING", "DIRECTION"})
"""Kinds of groups of which a second one behind a pause can only correct the first."""

_OPEN = frozenset({"A", "AND_WITH", "AT", "BETWEEN", "BY", "FILLED_WITH", "FROM", "GAP", "IN",
                   "INTO", "NEXT", "OF", "PART_OF", "RANGE", "RELATION", "THE", "TO_DO", "TO_LEVEL",
                   "TOWARD", "UNTIL", "WITH", "WITHOUT"})  # fmt: skip
"""Terminals that say nothing by themselves, so that one said twice is stammered."""

_SHAPES = {
    "fillers": r"(?<![^ ])(?!(?<=you )like ,|(?<=do )you know|(?<=not )see ,)"
    r"(?:{0})(?:(?: ,)? (?:{0}))*(?= |$)",
    "corrections": r"(?:(?<= )[.,;] )??(?<![^ ])(?:{0})(?:(?: ,)? (?:{0}))*(?: ,)?(?= )",
    "reasons": r"(?:^(?!so (?!that ))|(?<= ))(?:{0})(?= |$)",
    "statements": r"(?<=[^ ] )(?:{0})(?: [^,.;]+)?(?= [,.;] )",
    "restarts": r"(?:^|(?<=[.;] )|(?<=^no )(?:, )?)(?:{0})(?= )",
    "after": r"(?<![^ ])(?<!the )(?:{0})(?=$| [.;])",
    "before": r"(?:^|(?<=[.;] ))(?:{0})(?= |$)",
}
"""Where each kind of aside stands, in the order in which they are left out.

"Like," is a filler, but not in "as fast as you like, then".
"""

_OPENING = re.compile(r"(?:^|(?<=[.;] ))[^ ]+")
_BEGINNING = re.compile(r"[(\[]")
_OPTION = re.compile(r" \[([^\[\]]*)\]|\[([^\[\]]*)\] ")
_DOUBLED = re.compile(r"(?<![^ ])((?:[a-z]+ ){0,2}[a-z]+|\d+(?: [a-z]+)?)(?: ,)?(?= \1(?: |$))")
_TOPIC = re.compile(
    r"(?:[a-z]+ ){1,3}((?:the|my|your|our)(?: [a-z0-9]+){1,5}) "
    r"(?:is|are|was|stands|blocks|has|gets|might|could|will) [^,]* (?:, )?(?:[a-z]+ ){1,3}it(?= |$)"
)
"""A reason about a thing, which "it" means then: "since the mug is dirty, push it away"."""

_NO_REASON_BEHIND = re.compile(r"(?<![^ ])(?:as [a-z]+|is|are) $")
"""Words with which what looks like a reason is none: "as soon as it is", "what is for dinner"."""

_STRAY = re.compile(
    r"(?<= the) ,(?= )|(?<=^the) ,(?= )|"
    r"^[,.;](?= |$)|(?<= )[,.;]$|(?<= ),(?= [,.;] )|(?<=[.;] )[,.;](?= )"
)


class _Group(NamedTuple):
    """Words that say one thing, and the kinds of things that it may be."""

    start: int
    end: int
    kinds: frozenset[str]


class Asides:
    """Leaves out what changes nothing, by the words of a lexicon."""

    def __init__(self, lexicon: Lexicon, phrases: Phrases) -> None:
        self._lexicon = lexicon
        self._phrases = phrases
        self._courtesy = Courtesy(lexicon, phrases)
        self._reasons = Reasons(lexicon, phrases)
        self._patterns: dict[str, re.Pattern[str]] = {}

    def left_out(self, sentence: Normalised) -> Normalised:
        """The sentence without its asides, empty if it says nothing else."""
        said = sentence
        spoken = sentence.text.split()
        words = set(spoken)
        if self._courtesy.is_closing(sentence):
            said = replace(sentence, text="", columns=())
        said = self._courtesy.without_greeting(said)
        for kind in _SHAPES:
            if kind == "before":
                said = self._courtesy.put_plainly(said)
            near = _OPENING.findall(said.text) if kind == "before" else words
            if not self._first_words[kind].isdisjoint(near):
                said = self._without_all(said, kind, self._pattern_of(kind))
        if len(words) < len(spoken):
            said = self._without_all(said, "doubled", _DOUBLED)
        if not words.isdisjoint(",.;"):
            said = self._without_all(said, "stray", _STRAY)
        if said is sentence:
            return sentence
        kept = {column for span in said.columns for column in range(*span)}
        return replace(said, asides=_gaps(kept, sentence))

    @cached_property
    def _first_words(self) -> dict[str, frozenset[str]]:
        """Words without one of which there is no aside of a kind."""
        return {
            kind: frozenset(word for template in templates for word in _first_words(template))
            for kind, templates in self._lexicon.asides.items()
        }

    def _pattern_of(self, kind: str) -> re.Pattern[str]:
        """The pattern of the asides of a kind, made when it is needed first."""
        if kind not in self._patterns:
            templates = sorted(self._lexicon.asides[kind], key=len, reverse=True)
            said = "|".join(map(_pattern_of, templates))
            self._patterns[kind] = re.compile(_SHAPES[kind].format(said))
        return self._patterns[kind]

    def _without_all(self, said: Normalised, kind: str, pattern: re.Pattern[str]) -> Normalised:
        start = 0
        while match := pattern.search(said.text, start):
            shorter = None
            if not self._is_named(said.text, match):
                shorter = self._without(said, kind, match)
            if shorter is None:
                start = match.end() if match.end() > start else start + 1
            else:
                said, start = shorter, 0 if kind in ("before", "after", "stray") else match.start()
        return said

    def _is_named(self, text: str, match: re.Match[str]) -> bool:
        """Check for words within a quotation or a name."""
        spans = (named.span() for named in self._named.finditer(text))
        return any(start < match.end() and match.start() < end for start, end in spans)

    @cached_property
    def _named(self) -> re.Pattern[str]:
        names = "".join(f"|(?<![^ ]){re.escape(n)}(?= |$)" for n in sorted(self._lexicon.names))
        return re.compile(f'"[^"]*"{names}')

    def _without(self, said: Normalised, kind: str, match: re.Match[str]) -> Normalised | None:
        """The sentence without a match, changed as its kind asks; None if it has to stay."""
        start, end = match.span()
        if kind == "reasons":
            return self._without_reason(said, start, end)
        if kind == "corrections":
            return self._corrected(said, start, end)
        if kind == "fillers" and (corrected := self._corrected(said, start, end, _RESTATED)):
            return corrected
        if kind == "doubled":
            first = match[1].split()[0]
            known = self._lexicon.reserved_words | self._lexicon.first_words
            if first not in known and not first.isdigit() and " " not in match[1]:
                return None
            if first in self._lexicon.terminals["IT"]:
                return None  # "push it it" may lack a word between them
            if self._goes_on(said.text, match):
                return None
        before, comma, _ = said.text[:start].rpartition(" ,")
        if kind == "fillers" and comma and self._is_open(before.rpartition(" ")[2]):
            start, end = len(before), end + 2 * said.text.startswith(" ,", end)  # "the, uh, mug"
        elif kind == "fillers" and self._is_open(said.text[:start].rstrip().rpartition(" ")[2]):
            end += 2 * said.text.startswith(" ,", end)  # "to uh, the left"
        left = _joined(said, (0, start), (end, len(said.text)))
        if self._says_too_little(kind, left):
            return None
        polite = kind in ("before", "after") and re.search(r"\b(?:you|we|please)\b", match[0])
        tagged = kind in ("after", "fillers") and start > 0 and end == len(said.text)
        tagged = tagged and match[0] != "then"
        return replace(left, question=said.question and not (polite or tagged))

    def _without_reason(self, said: Normalised, start: int, opened: int) -> Normalised | None:
        if _NO_REASON_BEHIND.search(said.text, 0, start):
            return None
        end = self._reasons.end_of(said.text, start, opened)
        if end is None:
            return None
        if start == 0 and (topic := _TOPIC.match(said.text)):
            if said.text[end] != ",":
                return None  # "as the mug is dirty push it away"
            return _joined(said, topic.span(1), (end, len(said.text)))
        return _joined(said, (0, start), (end, len(said.text)))

    def _is_open(self, words: str) -> bool:
        """Check for the beginning of a phrase, which says nothing by itself."""
        found = self._phrases.phrases_at(words, 0) if words else []
        kinds = [kinds for phrase, kinds in found if phrase == words]
        return bool(kinds) and all(map(_OPEN.issuperset, kinds))

    def _says_too_little(self, kind: str, left: Normalised) -> bool:
        """Check for a rest that needs what is left out: "to the right now", "no, right"."""
        if kind == "restarts":
            return self._courtesy.is_closing(left)  # "hold on, thanks"
        if kind != "after" or not left.text:
            return kind == "after" and left.question  # "can you?"
        marks = {*self._lexicon.terminals["NO"], *self._lexicon.terminals["I_MEANT"], ",", "not"}
        words = left.text.split()
        return self._is_open(words[-1]) or marks.issuperset(words)

    def _goes_on(self, text: str, doubled: re.Match[str]) -> bool:
        """Check for words that say more the second time: "at the top at the top face"."""
        words, phrases = doubled[1], self._phrases.phrases_at
        start = text.index(words, doubled.end())
        if self._is_open(words) and not self._phrases.has_terminal_at("BOUND", text, start):
            return False
        for word in WORD.finditer(text, doubled.start(), doubled.start() + len(words)):
            longest = next((phrase for phrase, _ in phrases(text, word.start())), "")
            if word.start() + len(longest) > doubled.start() + len(words):
                return True
        if self._phrases.has_terminal_at("VERB", text, start) and self._ends_phrase(text, doubled):
            return True
        again = [phrase for phrase, _ in phrases(text, start)]
        more = self._phrases.has_terminal_at("BOUND", text, start + len(words) + 1)
        return more or (words in again and words != again[0])

    def _ends_phrase(self, text: str, doubled: re.Match[str]) -> bool:
        """Check for words that end a phrase the first time: "with a gentle hand hand it over"."""
        starts = (word.start() for word in WORD.finditer(text, 0, doubled.start()))
        return any(
            start + len(phrase) == doubled.end(1)
            for start in starts
            for phrase, _ in self._phrases.phrases_at(text, start)
        )

    # --- corrections --------------------------------------------------------------------------

    def _corrected(
        self, said: Normalised, start: int, end: int, only: frozenset[str] = frozenset()
    ) -> Normalised | None:
        """The sentence with what follows a mark of correction in the place of what it corrects."""
        if self._goes_beyond(said.text, start, end):
            return None  # "left, no nearer than 5 cm"
        paused = said.text[start] in ",.;" or said.text[:end].endswith(",")
        start = len(said.text[:start].rstrip(" ,"))
        end = len(said.text) - len(said.text[end:].lstrip(" ,"))
        if not paused and not self._begins_a_group(said.text, end):
            return None  # "push it left no matter what"
        before, after = self._groups(said.text, 0, start), self._groups(said.text, end)
        if not before or not after or (only and not only & after[0].kinds & before[-1].kinds):
            return None
        for i in reversed(range(len(before))):
            wrong, between = before[i], before[i + 1 :]
            if not wrong.kinds & after[0].kinds - {"WORD"}:
                continue
            rest = (after[0].end, len(said.text))
            if said.text[rest[0] :].startswith(" ,"):
                rest = (rest[0] + 2, rest[1])
            if between and len(after) > 1 and not between[0].kinds & after[1].kinds:
                return None
            kept = [(wrong.end, start)] if between and len(after) == 1 else []
            return _joined(said, (0, wrong.start), after[0][:2], *kept, rest)
        return None

    def _goes_beyond(self, text: str, start: int, end: int) -> bool:
        """Check for a mark of correction that is the beginning of a phrase."""
        mark = text[start:end].strip(" ,.;")
        start = text.index(mark, start)
        phrases = self._phrases.phrases_at(text, start)
        return any(phrase.startswith(f"{mark} ") for phrase, _ in phrases)

    def _begins_a_group(self, text: str, start: int) -> bool:
        """Check for a phrase of the language or a number, and not for any word."""
        number = self._lexicon.numbers.pattern.match(text, start) or DIGITS.match(text, start)
        return bool(number or self._phrases.phrases_at(text, start))

    def _groups(self, text: str, start: int, end: int | None = None) -> list[_Group]:
        """The groups of words of a part of a text."""
        text, groups = text[:end], list[_Group]()
        while match := WORD.search(text, start):
            start, kinds = self._phrase_at(text, match)
            own = _LEAD if groups and groups[-1].kinds & _LEAD - _ALONE else _BEGIN
            if groups and not kinds & own:
                groups[-1] = groups[-1]._replace(end=start)
            else:
                groups.append(_Group(match.start(), start, kinds))
        return groups

    def _phrase_at(self, text: str, match: re.Match[str]) -> tuple[int, frozenset[str]]:
        """End and kinds of the phrase that a word begins."""
        start, lexicon = match.start(), self._lexicon
        number = lexicon.numbers.pattern.match(text, start) or DIGITS.match(text, start)
        if number and number[0] not in ("a", "an"):
            return number.end(), frozenset({"NUMBER"})
        found = self._phrases.phrases_at(text, start)
        kinds = frozenset(found[0][1]) if found else frozenset({"WORD"})
        if not kinds & {"THE", "A", "THAT", "WORD"}:
            return start + len(found[0][0]), kinds
        end = match.end()
        for word in WORD.finditer(text, end):
            ends = word[0] in lexicon.ends_names and word[0] not in lexicon.adjectives
            if not word[0][0].isalpha() or (ends and end > match.end()):
                break
            end = word.end()
        return end, frozenset({"THING"})


def _joined(said: Normalised, *ranges: tuple[int, int]) -> Normalised:
    """The words of some ranges of a sentence, one space apart."""
    text, columns = "", list[Span]()
    for start, end in ranges:
        piece = said.text[start:end]
        left = start + len(piece) - len(piece.lstrip(" "))
        right = start + len(piece.rstrip(" "))
        if left >= right:
            continue
        if text:
            text, columns = f"{text} ", [*columns, (said.columns[left][0],) * 2]
        text, columns = text + said.text[left:right], [*columns, *said.columns[left:right]]
    return replace(said, text=text, columns=tuple(columns))


def _gaps(kept: set[int], sentence: Normalised) -> tuple[Span, ...]:
    """The runs of words of a sentence of which no column was kept."""
    marks = "".join(c if c.isalnum() and i not in kept else " " if i not in kept else "\n"
                    for i, c in enumerate(sentence.original))  # fmt: skip
    return tuple(run.span() for run in re.finditer(r"[^\s](?:[^\n]*[^\s])?", marks))


def _first_words(template: str) -> set[str]:
    """The words and marks that the phrases of a template may begin with."""
    group = _BEGINNING.match(template)
    if group is None:
        word = template.split(maxsplit=1)[0]
        return set(".;!?") if word == "." else {word}
    depth, end, start, choices = 0, 0, 1, list[str]()
    for end, char in enumerate(template):
        depth += (char in "([") - (char in ")]")
        if depth == 0 or (depth == 1 and char == "|"):
            choices.append(template[start:end])
            start = end + 1
        if depth == 0:
            break
    rest = template[end + 1 :].strip()
    if group[0] == "[" and rest:
        choices.append(rest)
    return set().union(*map(_first_words, filter(None, choices)))


def _pattern_of(template: str) -> str:
    """The regular expression of a template.

    `(a|b)` is a choice, `[c]` may be left out, and `_` is any word, or the beginning of one.
    """
    pattern = template.replace("(", "(?:")
    while option := _OPTION.search(pattern):
        last, first = option.groups()
        either = f"(?:(?:{first}) )?" if last is None else f"(?: (?:{last}))?"
        pattern = pattern[: option.start()] + either + pattern[option.end() :]
    return re.sub(r"(?<![a-z])_(?=[a-z ')|]|$)", "[a-z']+", pattern.replace(".", "[.;!?]"))

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
from typing import NamedTuple, cast

from grammar.frames.command import Span
from grammar.words.courtesy import Courtesy
from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised
from grammar.words.numerals import DIGITS
from grammar.words.phrase_places import WORD, Phrases
from grammar.words.reasons import Reasons
from grammar.words.repeats import Repeats

_ALONE = frozenset({"AMOUNT", "DIRECTION", "MANNER", "SENSE", "SEPARATOR", "VERB"})
"""Terminals that are a group of words by themselves."""

_LEAD = _ALONE | {"AT", "BETWEEN", "BY", "FACE", "FROM_SIDE", "IN", "INTO", "NEXT", "NOT", "REGION",
                  "REGION_OF_TABLE", "RELATION", "SO", "TOWARD", "UNTIL", "WITH",
                  "WITHOUT"}  # fmt: skip
"""Terminals that begin a group; what follows belongs to it."""

_WHERE = frozenset({"DIRECTION", "INTO", "REGION_OF_TABLE", "RELATION", "TOWARD"})
"""Terminals of where something is brought, any of which corrects any other."""

_BEGIN = _LEAD | {"NUMBER", "THING", "IT"}
"""Kinds that begin a group where no other is open."""

_RESTATED = frozenset({"NUMBER", "THING", "WHERE"})
"""Kinds of groups of which a second one behind a pause can only correct the first."""

_UNITS = frozenset({"ANGLE_UNIT", "FORCE_UNIT", "LENGTH_UNIT", "SPEED_UNIT", "TIME_UNIT"})
_HESITATING = frozenset({",", "ah", "eh", "ehm", "er", "erm", "err", "oh", "uh", "uhh", "uhm", "um",
                         "umm", "well"})  # fmt: skip
"""Marks that may be nothing but a pause."""

_SHAPES = {
    "corrections": r"(?:(?<= )[.,;] )??(?<![^ ])(?:{0})(?:(?: ,)? (?:{0}))*(?: ,)?(?= )",
    "fillers": r"(?<![^ ])(?!(?<=you )like ,|(?<=do )you know|(?<=not )see ,)"
    r"(?:{0})(?:(?: ,)? (?:{0}))*(?= |$)",
    "reasons": r"(?:^(?!so (?!that ))|(?<= ))(?:{0})(?= |$)",
    "statements": r"(?<=[^ ] )(?:{0})(?: [^,.;]+)?(?= [,.;] )",
    "restarts": r"(?:^|(?<=[.;] )|(?<=^no )(?:, )?)(?:{0})(?= )",
    "after": r"(?<![^ ])(?<!the )(?:{0})(?=$| [.;])",
    "before": r"(?:^|(?<=[.;] ))(?:{0})(?= |$)",
}
"""Where each kind of aside stands, in the order in which they are left out.

"Like," is a filler, but not in "as fast as you like, then".
"""

_MOST_REPEATS = 4
"""Repeats that are left out of one sentence, so that no text takes long."""

_OPENING = re.compile(r"(?:^|(?<=[.;] ))[^ ]+")
_BEGINNING = re.compile(r"[(\[]")
_OPTION = re.compile(r" \[([^\[\]]*)\]|\[([^\[\]]*)\] ")
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
        self._repeats = Repeats(lexicon, phrases)
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
        if spoken.count(",") > 1:
            said = self._without_courtesy(said)
        if len(words) < len(spoken):
            said = self._without_repeats(said)
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
            if not self._is_named(said.text, *match.span()):
                shorter = self._without(said, kind, match)
            if shorter is None:
                start = match.end() if match.end() > start else start + 1
            else:
                said, start = shorter, 0 if kind in ("before", "after", "stray") else match.start()
        return said

    def _is_named(self, text: str, start: int, end: int) -> bool:
        """Check for words within a quotation or a name."""
        spans = (named.span() for named in self._named.finditer(text))
        return any(first < end and start < last for first, last in spans)

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
            hesitates = _HESITATING.issuperset(match[0].split())
            return self._corrected(said, start, end, _RESTATED if hesitates else frozenset())
        restates = kind == "fillers" and "please" not in match[0]
        if restates and (corrected := self._corrected(said, start, end, _RESTATED)):
            return corrected
        if kind == "fillers":
            start, end = self._with_pauses(said.text, start, end)
        left = _joined(said, (0, start), (end, len(said.text)))
        if self._says_too_little(kind, left):
            return None
        polite = kind in ("before", "after") and re.search(r"\b(?:you|we|please)\b", match[0])
        tagged = kind in ("after", "fillers") and start > 0 and end == len(said.text)
        tagged = tagged and match[0] != "then"
        return replace(left, question=said.question and not (polite or tagged))

    def _with_pauses(self, text: str, start: int, end: int) -> Span:
        """A filler with the pauses around it that stand within a phrase, or within a name."""
        before, comma, _ = text[:start].rpartition(" ,")
        paused = 2 * text.startswith(" ,", end)
        if (
            comma
            and not text[len(before) + 2 : start].strip()
            and self._goes_on(before, text[end:])
        ):
            return len(before), end + paused  # "the, uh, mug"
        if self._repeats.ends_open(text[:start].rstrip()):
            return start, end + paused  # "to uh, the left"
        return start, end

    def _without_courtesy(self, said: Normalised) -> Normalised:
        """The sentence without courtesy between commas: "the, mate, tin"."""
        while span := self._courtesy.pause_in(said.text):
            start, end = self._with_pauses(said.text, *span)
            if (start, end) == span:
                end += 2  # one of both commas
            said = _joined(said, (0, start), (end, len(said.text)))
        return said

    def _without_repeats(self, said: Normalised) -> Normalised:
        marks = self._pattern_of("corrections")
        for _ in range(_MOST_REPEATS):
            repeat = self._repeats.repeat_in(said.text, marks)
            if repeat is None or self._is_named(said.text, *repeat):
                break
            said = _joined(said, (0, repeat[0]), (repeat[1], len(said.text)))
        return said

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

    def _says_too_little(self, kind: str, left: Normalised) -> bool:
        """Check for a rest that needs what is left out: "to the right now", "no, right"."""
        if kind == "restarts":
            return self._courtesy.is_closing(left)  # "hold on, thanks"
        if kind != "after" or not left.text:
            return kind == "after" and left.question  # "can you?"
        marks = {*self._lexicon.terminals["NO"], *self._lexicon.terminals["I_MEANT"], ",", "not"}
        words = left.text.split()
        return self._repeats.ends_open(left.text) or marks.issuperset(words)

    def _goes_on(self, before: str, after: str) -> bool:
        """Check for a pause within a phrase, or within a name: "the, uh, mug", "ice, uh, tea"."""
        last, after = before.rpartition(" ")[2], after.lstrip(" ,")
        within = not (self._begins_a_group(last, 0) or self._begins_a_group(after, 0))
        return self._repeats.ends_open(before) or within

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
        if (only or not paused) and not self._begins_a_group(said.text, end):
            return None  # "push it left no matter what"
        before, after = self._groups(said.text, 0, start), self._groups(said.text, end)
        if self._repeats.ends_open(said.text[:start]):
            return None  # "in front of, hold on, the jar"
        if not before or not after:
            return None
        inner = self._within(said.text, before[-1], after[0].kinds)
        if only and not only & after[0].kinds & (only if inner else before[-1].kinds):
            return None
        if inner and (len(after) == 1 or not _are_alike(after[1].kinds, before[-1].kinds)):
            return _joined(said, (0, inner), after[0][:2], (after[0].end, len(said.text)))
        for i in reversed(range(len(before))):
            wrong, between = before[i], before[i + 1 :]
            if not _are_alike(wrong.kinds, after[0].kinds):
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

    def _within(self, text: str, group: _Group, kinds: frozenset[str]) -> int:
        """Place of a thing or a number within a group, as in "left of the tin"; 0 if none is."""
        if not kinds & {"THING", "NUMBER"} or not group.kinds & _LEAD:
            return 0
        places = WORD.finditer(text, group.start, group.end)
        return next(
            (m.start() for m in places if _are_alike(self._phrase_at(text, m)[1], kinds)), 0
        )

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
            units = self._phrases.phrases_at(text, number.end() + 1)
            kinds = frozenset(units[0][1]) if units else frozenset()
            return number.end(), (kinds & _UNITS) | {"NUMBER"}
        found = self._phrases.phrases_at(text, start)
        kinds = frozenset(found[0][1]) if found else frozenset({"WORD"})
        measure = start + len(found[0][0]) + 1 if "BOUND" in kinds else len(text)
        if lexicon.numbers.pattern.match(text, measure) or DIGITS.match(text, measure):
            return self._phrase_at(text, cast("re.Match[str]", WORD.match(text, measure)))
        if not kinds & {"THE", "A", "THAT", "WORD"}:
            kinds |= {"WHERE"} if kinds & _WHERE else set()
            return start + len(found[0][0]), kinds
        end = match.end()
        for word in WORD.finditer(text, end):
            ends = word[0] in lexicon.ends_names and word[0] not in lexicon.adjectives
            phrase, leads = next(iter(self._phrases.phrases_at(text, word.start())), ("", ()))
            ends = ends or (" " in phrase and not _LEAD.isdisjoint(leads))  # "left of"
            if not word[0][0].isalpha() or (ends and end > match.end()):
                break
            end = word.end()
        return end, frozenset({"THING"})


def _are_alike(one: frozenset[str], other: frozenset[str]) -> bool:
    """Check for kinds of groups of which one can correct the other; not 2 cm and 5 N."""
    common = one & other - {"WORD"}
    return bool(common) and not (common == {"NUMBER"} and min(len(one), len(other)) > 1)


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

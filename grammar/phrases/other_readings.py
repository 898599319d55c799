"""Other words for a sentence that is not read as it stands.

"Is it safe?" is put as "is it possible?", "the jar, how heavy?" as "how heavy is the jar?"; a
number without its unit gets the one that was said last: "make it 8", after centimetres. None of
this is tried on a sentence that is read, so that no word changes what another means.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache, cached_property, lru_cache
from itertools import islice, pairwise

from grammar.frames.command import Span
from grammar.phrases.ordered_rows import row_in_order
from grammar.phrases.plain_questions import PlainQuestions
from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised
from grammar.words.numerals import DIGITS
from grammar.words.phrase_places import WORD, Phrases
from grammar.words.phrase_templates import needed_words, template_pattern

_CARRIED = frozenset({"LENGTH_UNIT", "ANGLE_UNIT", "VOLUME_UNIT"})
_UNITS = _CARRIED | {"FORCE_UNIT", "SPEED_UNIT", "TIME_UNIT", "TOOL"}
_BEHIND_NUMBER = frozenset({"DIRECTION", "I_MEANT", "MORE", "NEXT", "OR_MORE", "REVERSE", "SENSE",
                            "SEPARATOR", "TOWARD"})  # fmt: skip
"""Terminals that may stand behind a number whose unit is left out."""

_NO_NAME = frozenset({"BE", "CAN", "DO", "I_MEANT", "IF", "IS", "IT", "MORE", "NO", "NOT", "OR",
                      "REPEAT", "SAME", "STOP", "TO_BE", "UNDO", "VERB", "VERB_ED", "VERB_ING",
                      "WHICH", "WILL"})  # fmt: skip
"""Terminals of which none stands in the name of what is to go somewhere."""

_OPENING = re.compile("(?:(?:and|but|first|next|now|please|so|then) (?:, )?)*")
_NAMED = re.compile("(?:the|my|your|our|all|both|every[a-z]*)(?: |$)")

_OTHER = frozenset({"CAN_YOU", "FIND_OUT", "HOW", "HOW_HARD", "POSSIBLE", "REPEAT",
                    "SAME", "STOP", "SUPERLATIVE", "THAN", "UNDO", "WHAT_CAN", "WHAT_DID",
                    "WHAT_HAPPENS", "WHAT_IF", "WHAT_IS", "WHERE", "WHICH_CAN", "WHICH_IS",
                    "WHY_DID"})  # fmt: skip
"""Terminals with which something else is asked, which no words for a question may swallow."""

_JOINED = re.compile(r"(?<![^ ])(?:(?:and|but|so|then|please|[,.;]) )+")
_MOST_STAGES = 4
"""Stages of rewording that are tried, the last first, so that no text takes long."""

_MOST_SENTENCES = 6
"""Sentences of a text that are reworded each by itself."""

_SENTENCE_END = re.compile(r" [.;!?](?: |$)")

_PAUSES = frozenset(",.;")
_THINGS = frozenset({"one", "a", "an", "both"})
"""Number words that rather stand for a thing."""

_BEFORE = "actually|and|finally|lastly|no|now|oh|ok|please|sorry|so|then|well"
_ASKING = re.compile(
    rf"(?:(?:{_BEFORE}) (?:, )?)*"
    "(?:(?:can|could|would|will|might) you|(?:i|we) (?:want|need|would like) you to|try to|let us) "
    "(?:(?:also|just|kindly|maybe|now|perhaps|please|possibly|then) )*(?!mind )"
)
_BEHIND = "(?: (?:, )?please)?"
_INSTEAD = re.compile(r" ?(?:(?:,|\.|but|, but|instead) )*")
_SHARES = re.compile("half|third|quarter|fifth|tenth")
_DENIED = re.compile(r"(?: ,)? (?:and )?(?:not|instead of|rather than) (?:by )?")
_ANY_WORDS = r"([^ ,.;!?](?:.*?[^ ,.;!?])?)"
_WORDS_OF_CLAUSE = r"([^ ,.;!?](?:(?:(?! [,.;!?] ).)*?[^ ,.;!?])?)"
_PIECES = re.compile(r"([^{]*)({\d?}|$)")
_PIECE = re.compile(r"\d+(?:\.\d+)?|[a-z°]+|[.,;]")


class OtherReadings:
    """Puts sentences in other words, by a lexicon."""

    def __init__(self, lexicon: Lexicon, phrases: Phrases) -> None:
        self._phrases = phrases
        self._numbers = lexicon.numbers.pattern
        self._phrases_of = {kind: lexicon.words_of(kind) for kind in _CARRIED}
        self._rewordings = lexicon.rewordings
        self._questions = PlainQuestions(lexicon)

    def only_asks(self, said: Normalised) -> bool:
        """Check for a text that can only be meant as a question, whatever it names."""
        return self._questions.only_supposes(said)

    def readings(self, said: Normalised, before: Sequence[str] | None) -> Iterator[Normalised]:
        """Yield the sentence in other words, and with a unit, where it can be put so.

        Args:
            said: a sentence that is not read as it stands.
            before: what was said before, the last first; None outside of a conversation.
        """
        if (row := row_in_order(said.text)) is not None and not said.question:
            yield _with_words(said, *row)
        asked = [*self._questions.readings(said)]
        first = self._questions.is_opened(said)  # "for our readers: what do you see?"
        for each in [*asked, said] if first else [said, *asked]:
            if each is not said:
                yield each
            yield from self._stages(each, before)
        if (told := self._with_verb(said)) is not None:
            yield told

    def _stages(self, said: Normalised, before: Sequence[str] | None) -> Iterator[Normalised]:
        """Yield the sentence in plainer words, the plainest first, and with a unit."""
        for stage in [*islice(reversed([*self._reworded(said)]), _MOST_STAGES), said]:
            reworded = self._without_denied(stage)
            if reworded is not said:
                yield reworded
            if before is not None:
                measured = self._with_units(reworded, before)
                if measured is not reworded:
                    yield measured

    def by_sentences(self, said: Normalised) -> Iterator[Normalised]:
        """Yield a text of several sentences with some of them in other words."""
        if len(_sentences(said.text)) > 1:
            stages = [*self._reworded(said, by_sentences=True)]
            yield from islice(reversed(stages), _MOST_STAGES)

    def _with_verb(self, said: Normalised) -> Normalised | None:
        """The sentence of a thing and how far it goes, with a verb: "the mug, 5 cm left"."""
        start = _end(_OPENING.match(said.text))
        ends = (w.start() for w in WORD.finditer(said.text, start + 1))
        end = next((end for end in ends if self._is_length(said.text, end)), None)
        name = said.text[start:end].rstrip(" ,.;")
        if end is None or said.question or not name or "." in name:
            return None
        found = (self._phrases.phrases_at(name, word.start()) for word in WORD.finditer(name))
        kinds = [{kind for _, each in phrases for kind in each} for phrases in found]
        if any(not _NO_NAME.isdisjoint(each) for each in kinds):
            return None
        named = _NAMED.match(name)
        if not named and any(kinds):
            return None
        words = f"move {'' if named else 'the '}{name} "
        over = said.original_span(start, start + len(name))
        return replace(
            said,
            text=words + said.text[end:],
            columns=(*((over,) * len(words)), *said.columns[end:]),
        )

    def _is_length(self, text: str, start: int) -> bool:
        """Check for a number with a unit of length."""
        number = DIGITS.match(text, start) or self._numbers.match(text, start)
        unit = number.end() + text.startswith(" ", number.end()) if number else 0
        return bool(unit) and self._phrases.has_terminal_at("LENGTH_UNIT", text, unit)

    def _reworded(self, said: Normalised, *, by_sentences: bool = False) -> Iterator[Normalised]:
        """Yield the sentence with more and more plainer words in the place of those that have some.

        Words that are put in plain ones may hold others that look like some: all stages count.
        """
        words = set(said.text.split())
        tried, at = self._fitting(words), -1
        while (at := min((each for each in tried if each > at), default=-1)) >= 0:
            means = self._meanings[at]
            asked = means.partition(" ")[0] in self._phrases.verbs
            found = _found(tried[at], said.text, asked=asked, by_sentences=by_sentences)
            if found := [each for each in found if not self._swallows(each, means)]:
                said = _with_words(said, min(found, key=_rank), means)
                if new := set(said.text.split()) - words:
                    words |= new
                    tried = self._fitting(words)
                yield said

    def _swallows(self, match: re.Match[str], means: str) -> bool:
        """Check for words that are not in what is meant, and ask or command something else."""
        return any(self._asks_or_commands(match[i]) for i in _unused_groups(match, means))

    def _asks_or_commands(self, text: str) -> bool:
        starts = [word.start() for word in WORD.finditer(text)]
        asks = any(self._phrases.has_any_at(_OTHER, text, start) for start in starts)
        begun = [joint.end() for joint in _JOINED.finditer(text)]
        return asks or any(self._phrases.has_terminal_at("VERB", text, at) for at in begun)

    def _fitting(self, words: set[str]) -> dict[int, list[str]]:
        """Of each meaning, by its place, the templates that may stand in a text of these words."""
        fitting = dict[int, list[str]]()
        for word in words:
            for place, template, needed in self._templates.get(word, ()):
                if not any(some.isdisjoint(words) for some in needed):
                    fitting.setdefault(place, []).append(template)
        return fitting

    @cached_property
    def _meanings(self) -> list[str]:
        return [*self._rewordings]

    @cached_property
    def _templates(self) -> dict[str, list[tuple[int, str, list[frozenset[str]]]]]:
        """Word → templates of which it is the rarest that they need.

        Each with the place of the meaning, and the words that it needs.
        """
        every = [
            (place, each, needed_words(each.removesuffix("$")))
            for place, templates in enumerate(self._rewordings.values())
            for each in templates
        ]
        often = Counter(word for *_, needed in every for some in needed for word in some)
        found = dict[str, list[tuple[int, str, list[frozenset[str]]]]]()
        for place, template, needed in every:
            rarest = min(needed, key=lambda some: sum(often[word] for word in some))
            for word in rarest:
                found.setdefault(word, []).append((place, template, needed))
        return found

    def _with_units(self, said: Normalised, before: Sequence[str]) -> Normalised:
        """The sentence with the unit said before behind each number that has none."""
        lacking, unit = list[tuple[re.Match[str], str]](), ""
        for number, own in self._amounts(said.text):
            share = _SHARES.search(number[0])
            counts = not own and not share and number[0] not in _THINGS
            if counts and self._may_end(said.text, number.end() + 1):
                unit = unit or self._unit_before(before)
                lacking.append((number, unit))
            unit = own or unit
        for number, each in reversed(lacking if unit else []):
            said = _with_words(said, number, f"{number[0]} {each}")
        return said

    def _without_denied(self, said: Normalised) -> Normalised:
        """The sentence without an amount that is not meant: "5 cm, not 8", "not 8, 5 cm"."""
        if (told := self._without_denied_first(said)) is not None:
            return told
        denied = {mark.end(): mark.start() for mark in _DENIED.finditer(said.text)}
        for (_, unit), (number, own) in pairwise(self._amounts(said.text) if denied else ()):
            end = said.text.index(own, number.end()) + len(own)
            ends = not said.text[end:] or said.text[end : end + 2].strip() in _PAUSES
            if unit and own in ("", unit) and ends and number.start() in denied:
                meant = said.words_in((0, denied[number.start()]), (end, len(said.text)))
                return meant.taken_back_from(said)
        return said

    def _without_denied_first(self, said: Normalised) -> Normalised | None:
        """The sentence of what is meant in place of an amount denied before it: "not 8, 5 cm"."""
        start = _end(_OPENING.match(said.text))
        if not said.text.startswith("not ", start):
            return None
        amounts = [*self._amounts(said.text)][:2]
        if len(amounts) < 2 or amounts[0][0].start() != start + len("not "):
            return None
        (wrong, unit), (meant, own) = amounts
        after = wrong.end() + (len(unit) + 1 if unit else 0)
        if (unit not in ("", own) and own) or not _INSTEAD.fullmatch(
            said.text, after, meant.start()
        ):
            return None
        words = f"no , {meant[0]} {unit}" if unit and not own else f"no , {meant[0]}"
        until = re.compile(re.escape(said.text[start : meant.end()])).match(said.text, start)
        return _with_words(said, until, words) if until else None

    def _unit_before(self, before: Sequence[str]) -> str:
        """The unit of the last sentence that has one; "" if there is none, or it has several.

        After "5 cm with one finger" it is not clear of what "I meant 2" are two.
        """
        for text in before:
            if units := {unit for _, unit in self._amounts(_spaced(text)) if unit}:
                unit = units.pop()
                carried = any(unit in self._phrases_of[kind] for kind in _CARRIED)
                return unit if carried and not units else ""
        return ""

    def _amounts(self, text: str) -> Iterator[tuple[re.Match[str], str]]:
        """The numbers of a text, each with its unit; "" if it has none."""
        start = 0
        while word := WORD.search(text, start):
            start = word.end()
            number = DIGITS.match(text, word.start()) or self._numbers.match(text, word.start())
            if number is None:
                continue
            start = number.end()
            found = self._phrases.phrases_at(text, start + text.startswith(" ", start))  # "3°"
            yield number, next((each for each, kinds in found if not _UNITS.isdisjoint(kinds)), "")

    def _may_end(self, text: str, after: int) -> bool:
        """Check for a place at which an amount may end."""
        if after >= len(text) or text[after] in _PAUSES:
            return True
        found = self._phrases.phrases_at(text, after)
        return bool(found) and not _BEHIND_NUMBER.isdisjoint(found[0][1])


def _end(match: re.Match[str] | None) -> int:
    return match.end() if match else 0


def _spaced(text: str) -> str:
    """A text in which numbers, words and marks stand apart."""
    return " ".join(_PIECE.findall(text.casefold()))


@cache
def _pattern_of(template: str) -> re.Pattern[str]:
    """The pattern of a template.

    In it "{}" is any words up to an end, "{~}" any without a pause. One that holds either is the
    whole text, one with "$" at its end a whole sentence.
    """
    said = template_pattern(template.removesuffix("$"))
    said = said.replace("{}", _ANY_WORDS).replace("{~}", _WORDS_OF_CLAUSE)
    if template.endswith("$"):
        start = rf"(?:^(?:(?:{_BEFORE}) (?:, )?){{0,3}}|(?<=[.;!?] ))"
        return re.compile(rf"{start}(?:{said}){_BEHIND}$")
    if "{" in template:
        return re.compile(rf"(?:(?:{_BEFORE}) (?:, )?){{0,3}}(?:{said}){_BEHIND}$")
    return re.compile(rf"(?<![^ ])(?:{said})(?= |$)")


def _found(
    templates: Sequence[str], text: str, *, asked: bool, by_sentences: bool
) -> list[re.Match[str]]:
    """The places of some templates in a text.

    What has any words in it is the whole text, but for "can you" before what is asked for, or else
    one of its sentences if these count.
    """
    found, whole = list[re.Match[str] | None](), list[re.Pattern[str]]()
    asks = _ASKING.match(text) if asked else None
    for template in templates:
        pattern = _pattern_of(template)
        if "{" in template and not template.endswith("$"):
            whole.append(pattern)
            found.append(pattern.match(text) or (asks and pattern.match(text, asks.end())))
        else:
            found.append(pattern.search(text))
    if by_sentences and not any(found):
        found = [each.match(text, *span) for each in whole for span in _sentences(text)]
    return list(filter(None, found))


@lru_cache(maxsize=64)
def _sentences(text: str) -> tuple[tuple[int, int], ...]:
    """The places of the first sentences of a text of several."""
    spans, start = list[tuple[int, int]](), 0
    for end in _SENTENCE_END.finditer(text):
        spans.append((start, end.start()))
        start = end.end()
    spans.append((start, len(text)))
    return tuple(each for each in spans if each[0] < each[1])[:_MOST_SENTENCES]


def _rank(match: re.Match[str]) -> tuple[int, int, int]:
    """The first comes first, then the longest, then the one with the fewest words for "{}"."""
    return match.start(), -match.end(), len(match[match.lastindex or 0])


def _with_words(said: Normalised, match: re.Match[str], means: str) -> Normalised:
    """The sentence with other words in the place of some of it.

    In them each "{}" are the words of the next group of the match, "{2}" those of the second.
    """
    over: Span = said.original_span(*match.span())
    places = [span for span in match.regs[1:] if span[0] >= 0]
    unsaid = {said.original_span(*match.span(i)) for i in _unused_groups(match, means)}
    following = iter(places)
    text, columns = "", list[Span]()
    for words, number in _PIECES.findall(means):
        text += words
        columns += (over,) * len(words)
        if number:
            told = number.strip("{}")
            start, end = places[int(told) - 1] if told else next(following)
            text += said.text[start:end]
            columns += said.columns[start:end]
    if not re.search("[a-z]", _PIECES.sub(r"\1", means)):  # no word of its own is for all of it
        columns[0], columns[-1] = (over[0], columns[0][1]), (columns[-1][0], over[1])
    return replace(
        said,
        text=said.text[: match.start()] + text + said.text[match.end() :],
        columns=(*said.columns[: match.start()], *columns, *said.columns[match.end() :]),
        asides=tuple(sorted({*said.asides, *unsaid})),
    )


def _unused_groups(match: re.Match[str], means: str) -> list[int]:
    """The groups of any words of which none are in what is meant."""
    numbers = [told.strip("{}") for _, told in _PIECES.findall(means) if told]
    used = {int(number or i) for i, number in enumerate(numbers, 1)}
    return [i for i in range(1, match.re.groups + 1) if i not in used and match[i]]

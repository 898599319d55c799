"""Words around a command that change nothing, and words that are taken back.

"Uh, could you push the tin, no wait, the jar away? Thanks!" means "push the jar away": politeness,
fillers and doubled words, which a closed list holds, are left out, and what is corrected is
replaced by what corrects it. A correction takes the place of the last group of words of its own
kind (a thing, a number, a direction, a verb); where none stands before it, nothing is taken back.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property, partial

from grammar.frames.command import Span
from grammar.words.corrections import RENAMED, RESTATED, Corrections
from grammar.words.emphasis import Emphasis
from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised
from grammar.words.phrase_places import WORD, Phrases
from grammar.words.phrase_templates import first_words, template_pattern
from grammar.words.repeats import Repeats

_Search = Callable[[str, int], re.Match[str] | None]

_HESITATING = frozenset({",", "ah", "eh", "ehm", "er", "erm", "err", "hm", "hmm", "hmmm", "mm",
                         "mmm", "oh", "uh", "uhh", "uhm", "um", "umm", "well"})  # fmt: skip
"""Marks that may be nothing but a pause."""

_SHAPES = {
    "corrections": r"(?:(?<= )[.,;] )??(?<![^ ])(?:(?:(?: ,)? )?(?<![^ ])(?:{0}))+(?: ,)?(?= )",
    "hesitations": r"(?:(?<=^the )|(?<= the )|(?<= a )|(?<= an ))(?:{0})(?: ,)?(?= [a-z])",
    "fillers": r"(?<![^ ])(?!(?<=you )(?:like|please) ,|(?<=as )well|(?<=do )you know"
    r"|(?:, )?you know why|(?<=not )see ,)"
    r"(?:(?:(?: ,)? )?(?<![^ ])(?:{0}))+(?= |$)",
    "shares": r"(?<=[^ ] )(?:{0})(?=$| )",
    "after": r"(?<![^ ])(?<!the )(?:{0})(?=$| [.;])",
    "before": r"(?:^|(?<=[.;] ))(?:{0})(?= (?!not |never )|$)",
}
"""Where each kind of aside stands, in the order in which they are left out.

"Like," is a filler, but not in "as fast as you like, then".
"""

_BY_FIRST_WORD = frozenset({"after", "before"})
"""Kinds that begin with their first word, and have so many templates that only those that begin
with a word of the text are made patterns of."""

_WHEN = frozenset({"afterwards", "later", "now", "then", "today"})
"""Words behind which a question is still one: "would you be able to close it again later?"."""

_MOST_REPEATS = 4
"""Repeats that are left out of one sentence, so that no text takes long."""

_MANY_WORDS = 120
"""Words and marks of a text of whose repeats only one is left out, for the same reason."""

_PAUSE = re.compile(" ,(?= )")
_OPENING = re.compile(r"(?:^|(?<=[.;] ))[^ ]+")
_MOST_TRIED = 6
"""Marks of a correction of which one text may have as many, so that none takes long."""

_MEANT_BEFORE = re.compile(
    r"(?<= ), (the(?: [a-z0-9]+){1,4}?|(?:to the )?(?:left|right)|away|[0-9.]+ [a-z]+) (?:, )?"
    r"(i (?:mean|meant))(?= [,.;]|$)"
)
"""What is meant and the mark of it: "the mug, the jar I mean", "left - right, I mean"."""

_SEVERAL = re.compile(r"(?<![^ ])(?:and|them|they|these|those|both|all|two|three|four)(?= )")

_SOMEWHERE = frozenset({"AWAY_FROM_REGION", "BETWEEN", "DIRECTION", "FACE", "FROM_SIDE", "INTO",
                        "MUTUAL", "REGION", "REGION_OF_TABLE", "RELATION", "SENSE", "TOWARD",
                        "TOWARD_REGION"})  # fmt: skip
"""Terminals of where something is to go."""

_WHERE = ("DIRECTION", "TOWARD", "REGION_OF_TABLE")

_STRAY = re.compile(
    r"(?<= the) ,(?= )|(?<=^the) ,(?= )|"
    r"^[,.;](?= |$)|(?<= )[,.;]$|(?<= ),(?= [,.;] )|(?<=[.;] )[,.;](?= )"
)


class Asides:
    """Leaves out what changes nothing, by the words of a lexicon."""

    def __init__(self, lexicon: Lexicon, phrases: Phrases) -> None:
        self._lexicon = lexicon
        self._phrases = phrases
        self._emphasis = Emphasis(lexicon, phrases)
        self._repeats = Repeats(lexicon, phrases)
        self._corrections = Corrections(lexicon, phrases, self._repeats)
        self._patterns: dict[tuple[str, str], re.Pattern[str]] = {}

    def left_out(self, sentence: Normalised) -> Normalised:
        """The sentence without its asides, empty if it says nothing else."""
        if self._phrases.is_remark(sentence.text):
            return sentence
        said = self._without_all_of("before", _with_mark_first(sentence))
        spoken = sentence.text.split()
        words = set(spoken)
        for kind in _SHAPES:
            if kind == "after":
                said = self._without_all_of("before", said)
                if self._phrases.is_remark(said.text):
                    break  # "fine, go ahead"
            if kind == "before":
                said = self._emphasis.put_plainly(said)
            said = self._without_all_of(kind, said)
        if len(words) < len(spoken):
            said = self._without_repeats(said)
        if not words.isdisjoint(",.;"):
            said = self._without_all(said, "stray", _STRAY.search)
        if said is sentence:
            return sentence
        return said.with_gaps_aside()

    def _without_all_of(self, kind: str, said: Normalised) -> Normalised:
        near = _OPENING.findall(said.text) if kind == "before" else said.text.split()
        if self._templates[kind].keys().isdisjoint(near):
            return said
        return self._without_all(said, kind, partial(self._aside_in, kind))

    def are_closing(self, sentence: Normalised) -> bool:
        """Check for thanks or leave in a sentence that is all courtesy, which a greeting is not."""
        return not set(self._lexicon.asides["closing"]).isdisjoint(sentence.text.split())

    def without_hesitations(self, sentence: Normalised) -> Normalised | None:
        """A sentence that is not read as it stands, without words and pauses that may hesitate."""
        said = sentence
        if not self._templates["hesitations"].keys().isdisjoint(sentence.text.split()):
            said = self._without_all(sentence, "anywhere", self._hesitating.search)
        for pause in reversed(list(_PAUSE.finditer(said.text))):
            if self._repeats.pauses_within(said.text, *pause.span()):
                said = said.words_in((0, pause.start()), (pause.end(), len(said.text)))
        if said is sentence or not said.text:
            return None
        suggests = sentence.text.startswith(("maybe ", "perhaps "))  # "maybe push it?"
        asks = said.question and not suggests
        return replace(said, question=asks).with_gaps_aside()

    @cached_property
    def _hesitating(self) -> re.Pattern[str]:
        said = "|".join(map(template_pattern, self._lexicon.asides["hesitations"]))
        return re.compile(rf"(?:(?<= ), )?(?<![^ ])(?<!not )(?:{said})(?: ,)?(?= [^,.;])")

    @cached_property
    def _templates(self) -> dict[str, dict[str, list[str]]]:
        """Of each kind the words that an aside may begin with, and those that do, longest first."""
        found: dict[str, dict[str, list[str]]] = {}
        for kind, templates in self._lexicon.asides.items():
            first = found.setdefault(kind, {})
            for template in sorted(templates, key=len, reverse=True):
                for word in first_words(template):
                    first.setdefault(word, []).append(template)
        return found

    def _pattern_of(self, kind: str, word: str = "") -> re.Pattern[str]:
        """The pattern of the asides of a kind, or those with a first word, made when needed."""
        if (kind, word) not in self._patterns:
            every = sorted(self._lexicon.asides[kind], key=len, reverse=True)
            said = "|".join(map(template_pattern, self._templates[kind][word] if word else every))
            self._patterns[kind, word] = re.compile(_SHAPES[kind].format(said))
        return self._patterns[kind, word]

    def _aside_in(self, kind: str, text: str, start: int) -> re.Match[str] | None:
        """The first aside of a kind from a place in a text on."""
        if kind not in _BY_FIRST_WORD:
            return self._pattern_of(kind).search(text, start)
        words = (m for m in WORD.finditer(text, start) if m[0] in self._templates[kind])
        asides = (self._pattern_of(kind, m[0]).match(text, m.start()) for m in words)
        return next(filter(None, asides), None)

    def _without_all(self, said: Normalised, kind: str, aside_in: _Search) -> Normalised:
        start = tried = 0
        while tried < _MOST_TRIED and (match := aside_in(said.text, start)):
            tried += kind == "corrections"
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
        if kind == "shares" and not self._is_shared(said.text, match):
            return None
        if kind == "hesitations" and self._corrections.begins_a_group(said.text, end + 1):
            return None  # "push the like away"
        if kind == "corrections":
            hesitates = _HESITATING.issuperset(match[0].split()) and "uh uh" not in match[0]
            only = RESTATED if hesitates else frozenset[str]()
            if match[0].strip(" ,") == "that is":
                if match[0] != "that is":
                    return None  # ", that is the plan"
                only = RENAMED
            return self._corrected(said, start, end, only)
        often = said.text.count(match[0]) > _MOST_TRIED
        restates = kind == "fillers" and "please" not in match[0] and not often
        if restates and (corrected := self._corrected(said, start, end, RESTATED)):
            return corrected
        if kind == "fillers":
            start, end = self._with_pauses(said.text, start, end)
        left = said.words_in((0, start), (end, len(said.text)))
        asks = said.question and self._phrases.has_terminal_at("POSSIBLE", said.text, start)
        if self._says_too_little(kind, match, left) or (kind == "before" and asks):
            return None
        polite = kind in ("before", "after") and re.search(
            r"\b(?:you|we|please|maybe|perhaps)\b", match[0]
        )
        tagged = kind in ("after", "fillers") and start > 0 and end == len(said.text)
        tagged = tagged and match[0].rpartition(" ")[2] not in _WHEN
        return replace(left, question=said.question and not (polite or tagged))

    def _corrected(
        self, said: Normalised, start: int, end: int, only: frozenset[str]
    ) -> Normalised | None:
        corrected = self._corrections.correction(said, start, end, only)
        return corrected and corrected.taken_back_from(said)

    def _is_shared(self, text: str, match: re.Match[str]) -> bool:
        """Check for "each" of what is done to several things, not "push each to the left"."""
        said, before = match[0].lstrip(", "), text[: match.start()].rstrip(" ,")
        each = said.startswith(("each", "apiece"))
        several = _SEVERAL.search(before) is not None
        if match.end() == len(text) or text[match.end() + 1] in ".;":
            return (each or several) and (
                self._emphasis.is_said(before) or said.startswith(("in", "one", "turn"))
            )
        goes_on = self._phrases.has_any_at(_WHERE, text, match.end() + 1)
        measured = text[match.end() + 1 :].startswith("by ") or text[match.end() + 1].isdigit()
        measured = measured or said.startswith(("in", "one", "turn"))
        if each and goes_on and match[0] == said:
            return self._emphasis.is_said(before)  # "5 cm each to the left"
        return several and (measured or goes_on) and not self._emphasis.is_said(before)

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

    def _without_repeats(self, said: Normalised) -> Normalised:
        marked = not self._templates["corrections"].keys().isdisjoint(said.text.split())
        marks = self._pattern_of("corrections") if marked else None
        many = said.text.count(" ") >= _MANY_WORDS
        for _ in range(1 if many else _MOST_REPEATS):
            repeat = self._repeats.repeat_in(said.text, marks)
            if repeat is None or self._is_named(said.text, *repeat):
                break
            once = said.words_in((0, repeat[0]), (repeat[1], len(said.text)))
            said = once.taken_back_from(said)
        return said

    def _says_too_little(self, kind: str, match: re.Match[str], left: Normalised) -> bool:
        """Check for a rest that needs what is left out: "to the right now", "no, right"."""
        after = match.string[match.end() :].lstrip(" .")
        tag = kind == "after" and left.question and match[0].startswith(",")
        needed = match[0].strip(" .,") in ("over", "right", "straight away") and not tag
        if needed and match.start():
            starts = (word.start() for word in WORD.finditer(left.text))
            if not any(self._phrases.has_any_at(_SOMEWHERE, left.text, at) for at in starts):
                return True  # "push it 5 cm, right"; "push it, over"; "push it straight away"
            if match.string[match.start()] == "." and after:
                return not self._emphasis.begins_command(after)  # "left. Right. Slowly"
        if kind != "after" or not left.text:
            return kind == "after" and (left.question or match[0].startswith("and"))  # "can you?"
        marks = {*self._lexicon.terminals["NO"], *self._lexicon.terminals["I_MEANT"], ",", "not"}
        words = left.text.split()
        return self._repeats.ends_open(left.text) or marks.issuperset(words)

    def _goes_on(self, before: str, after: str) -> bool:
        """Check for a pause within a phrase, or within a name: "the, uh, mug", "ice, uh, tea"."""
        last, after = before.rpartition(" ")[2], after.lstrip(" ,")
        within = not (
            self._corrections.begins_a_group(last, 0) or self._corrections.begins_a_group(after, 0)
        )
        return self._repeats.ends_open(before) or within


def _with_mark_first(said: Normalised) -> Normalised:
    """The sentence with "I mean" before what it is said of."""
    found = _MEANT_BEFORE.search(said.text)
    if found is None:
        return said
    before, after = (0, found.start() + 1), (found.end(), len(said.text))
    return said.words_in(before, found.span(2), found.span(1), after)

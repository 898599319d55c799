"""The law of effect: no reading leaves out a word that has an effect.

Every word of a sentence that is read sets something in the frames, or belongs to a closed list of
courtesy. A word of effect says whether, when, by whom or to how many things something is done
("if", "tonight", "never", "she said"). It is neither left out nor taken for a part of a name,
unless something on the table has that name. Each reading is held against this, whatever it came by.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator
from functools import cached_property
from itertools import chain

from grammar.errors import ParseError
from grammar.frames.command import Frame, ObjectRef, Span, references_in
from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised, normalise
from grammar.words.phrase_places import Phrases
from grammar.words.phrase_templates import first_words, template_pattern

COURTESY = ("before", "after", "shares", "fillers", "hesitations", "topics", "emphasis")
"""Kinds of asides that are left out as courtesy."""

_MARKS = re.compile(r"[\[(][,.;|]+[\])]|(?<![^ (\[|])[,.;](?![^ )\]|])")
_WORD = re.compile(r"[^ ,.;!?]+")
_DENIES = "(?:and )?(?:not|instead of|rather than) "
_PAUSE = re.compile(r"(?<= )[,.;!?](?= )")
_PLAIN_WORD = re.compile(r"[^ ]+")
_QUOTES = frozenset("\"'“”‘’„«»`")
_MOST = 2
"""Stretches of a kind without which a sentence is tried, so that no text takes long."""

_TOLD = {
    "condition": "is a condition, and nothing waits for one",
    "time": "says when or for how long, and nothing is done later",
    "veto": "forbids or denies something, and it is not clear what",
    "asking": "asks to be asked; a plan can be looked at before it is carried out",
    "exception": "takes something out, and it is not clear what",
    "report": "reports or supposes something, and commands nothing",
    "other": "is said of somebody else",
    "reason": "gives a reason, which is not read",
    "retraction": "takes something back, and it is not clear what",
}
"""What words of each kind do, in a message."""

_REST = {"condition": "when it is to be done, say", "time": "when it is to be done, say",
         "reason": "this would do", "": "this would do"}  # fmt: skip
"""Kinds without which the rest may be said by itself, and how that is suggested."""

_LIMITS = ("BEFORE", "BOUND", "DOES_NOT", "EXCEPT", "LETTING", "NOT", "UNTIL", "WITHOUT")
"""Terminals with which a limit begins."""

_HINT = "say only what is to be done, when it is to be done"


class LawOfEffect:
    """Finds words that a reading leaves out although they have an effect, by a lexicon."""

    def __init__(self, lexicon: Lexicon, phrases: Phrases) -> None:
        self._lexicon = lexicon
        self._phrases = phrases

    def require_bound(
        self, said: Normalised, frames: Iterable[Frame], names: Collection[str] = ()
    ) -> None:
        """Refuses a reading that leaves out, or has in a name, what has an effect.

        Args:
            said: what is read, with the places of its words in the sentence as given.
            frames: what it is read as.
            names: words that are in the names of objects on the table.

        Raises:
            ParseError: `unbound_words`.
        """
        frames = tuple(frames)
        asked = all(frame.query for frame in frames)
        for span in said.left_out():
            words = self._plain(said.original[slice(*span)])
            harmless = asked and not self._effect.search(words)
            if not (harmless or self._is_courtesy(words, asked=asked)):
                raise self.error(said, span)
        for span in said.runs_of(said.taken_back):
            words = self._marks_of_correction.sub("", self._plain(said.original[slice(*span)]))
            if not all(effect in said.text for effect in self._effect.findall(words)):
                raise self.error(said, span)  # taken back is only what is said anew, or denied
        for ref in chain.from_iterable(map(references_in, frames)):
            named = self._effect_in_name(ref, said.original, names)
            if named is not None:
                raise self.error(said, named)

    def has_effect(self, text: str) -> bool:
        """Check for a word of effect, other than of a reason, in a part of a sentence as given."""
        found = (self._lexicon.effects[each] for each in self._effect.findall(self._plain(text)))
        return any(kind != "reason" for kind in found)

    def stretches(self, said: Normalised, at: Span | None) -> Iterator[Span]:
        """Yield stretches with a word of effect without which a sentence may be read.

        An error behind the beginning of a limit ("without topling it") is about what follows, not
        about a word of effect.

        Args:
            said: the whole sentence.
            at: where it is not understood.
        """
        text, end = said.text, len(said.text)
        effects = list(self._effect.finditer(text))
        if not effects:
            return
        unread = [effect.start() for effect in effects if not self._begins_limit(effect)]
        pauses = [pause.start() for pause in _PAUSE.finditer(text)]
        verbs = [w.start() for w in _PLAIN_WORD.finditer(text) if w[0] in self._verbs]
        error = (_place_of(said, at[0]), _place_of(said, at[1])) if at else (end, end)
        tried = list(self._without_number(effects, error))
        ends = (*pauses[:_MOST], *verbs[:_MOST])
        tried += [(0, last) for last in ends if effects[0].start() < last]
        starts = (*reversed(pauses[-_MOST:]), effects[0].start(), *unread[:1], error[0])
        tried += [(first, end) for first in starts if any(first <= each for each in unread)]
        for first, last in dict.fromkeys(tried):
            words = text[first:last]
            left = first + len(words) - len(words.lstrip(" ,.;!?"))
            right = first + len(words.rstrip(" ,.;!?"))
            if left < right and right - left < end:
                yield said.original_span(left, right)

    def error(self, said: Normalised, span: Span, rest: str = "") -> ParseError:
        """The refusal of a sentence of which some words set nothing.

        Args:
            said: the sentence.
            span: where these words stand in it.
            rest: what it would say without them, if that is read.
        """
        effects = self._effect.findall(self._plain(said.original[slice(*span)]))
        kinds = [self._lexicon.effects[each] for each in effects] or [""]
        kind = next((each for each in kinds if each != "exception"), kinds[0])  # "but ask me"
        message = _TOLD.get(kind, "would be left out, and is no courtesy")
        hint = f'{_REST[kind]}: "{rest}"' if rest and kind in _REST else _HINT
        return said.error_at(span, "unbound_words", message, hint)

    def _begins_limit(self, effect: re.Match[str]) -> bool:
        return self._phrases.has_any_at(_LIMITS, effect.string, effect.start())

    def _without_number(self, effects: Iterable[re.Match[str]], error: Span) -> Iterator[Span]:
        """Yield "but two" of "all but two", where a number up to an error lacks its unit."""
        for effect in effects:
            between = effect.string[effect.end() : error[0]].split()
            if self._lexicon.effects[effect[0]] == "exception" and len(between) == 1:
                yield effect.start(), error[0]

    def _is_courtesy(self, plain: str, *, asked: bool) -> bool:
        """Check for words that are rows of courtesy, one after another."""
        words = " ".join(_WORD.findall(plain))
        ends = {0}
        for start in (0, *(space.end() for space in re.finditer(" ", words))):
            if start in ends:
                ends |= set(self._ends_of_rows(words, start, asked=asked))
        return len(words) in ends

    def _ends_of_rows(self, words: str, start: int, *, asked: bool) -> Iterator[int]:
        """Yield the places behind each row of courtesy that stands at the start of a word."""
        first = words[start:].partition(" ")[0]
        asking = self._asking_rows.get(first, ()) if asked else ()
        for template in (*self._rows.get(first, ()), *asking):
            if row := self._pattern_of(template).match(words, start):
                yield row.end() + (row.end() < len(words))

    def _effect_in_name(self, ref: ObjectRef, text: str, names: Collection[str]) -> Span | None:
        """The place of a name that has a word of effect which nothing on the table is called."""
        if ref.pronoun or ref.quantifier or not ref.spans:
            return None
        words = " ".join(w for w in self._plain(ref.text).split() if w not in names)
        start, end = ref.spans[0]
        quoted = not _QUOTES.isdisjoint(
            text[max(start - 1, 0) : start + 1] + text[end - 1 : end + 1]
        )
        return None if quoted or not self._effect.search(words) else (start, end)

    def _plain(self, text: str) -> str:
        """Some words in plain form, or as they are where they have none."""
        try:
            return normalise(text, self._lexicon.contractions).text
        except ParseError:
            return text.casefold()

    @cached_property
    def _effect(self) -> re.Pattern[str]:
        phrases = sorted(self._lexicon.effects, key=len, reverse=True)
        return re.compile(rf"(?<![^ ])(?:{'|'.join(map(re.escape, phrases))})(?= |$)")

    @cached_property
    def _marks_of_correction(self) -> re.Pattern[str]:
        rows = map(template_pattern, map(without_marks, self._lexicon.asides["corrections"]))
        return re.compile(rf"^{_DENIES}|(?<![^ ])(?:{'|'.join(rows)})(?= |$)")

    @cached_property
    def _rows(self) -> dict[str, list[str]]:
        return _by_first_word(chain.from_iterable(self._lexicon.asides[k] for k in COURTESY))

    @cached_property
    def _asking_rows(self) -> dict[str, list[str]]:
        """Rows that ask nothing, around a question."""
        return _by_first_word([*chain.from_iterable(self._lexicon.asking.values()), "whether"])

    @cached_property
    def _verbs(self) -> frozenset[str]:
        return frozenset(self._lexicon.verb_words["VERB"])

    @cached_property
    def _patterns(self) -> dict[str, re.Pattern[str]]:
        """The patterns of the rows that were tried."""
        return {}

    def _pattern_of(self, template: str) -> re.Pattern[str]:
        if template not in self._patterns:
            self._patterns[template] = re.compile(f"(?:{template_pattern(template)})(?= |$)")
        return self._patterns[template]


def _place_of(said: Normalised, column: int) -> int:
    """Place in the plain form of a column of the sentence as given."""
    places = (i for i, (start, _) in enumerate(said.columns) if start >= column)
    return next(places, len(said.columns))


def _by_first_word(templates: Iterable[str]) -> dict[str, list[str]]:
    """First word → the rows, without their marks, that may begin with it."""
    rows: dict[str, list[str]] = {}
    for row in map(without_marks, templates):
        for word in first_words(row):
            rows.setdefault(word, []).append(row)
    return rows


def without_marks(template: str) -> str:
    """A template without its marks of punctuation: "[,|.] (,|.|and) that is all" → "[and] …"."""
    template = re.sub(r"[\[(](?:[,.;]\|)+([^\[\]()]+)[\])]", r"[\1]", template)
    template = " ".join(_MARKS.sub("", template).split())
    return re.sub(r" (?=[|)\]])|(?<=[(\[|]) ", "", template)

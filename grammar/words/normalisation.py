"""The sentence in a plain form, with a map back to the columns of the sentence as given.

In the plain form letters are lower case, digits are ASCII, words stand one space apart, commas
stand alone, hyphens inside words are spaces, contractions are spelled out, and the mark that ends
the sentence is gone. Columns are code points.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace

from grammar.errors import ParseError
from grammar.frames.command import Span

MAX_LENGTH = 500
"""Longest sentence that is read [code points]."""

_SAME = str.maketrans("‘’´`“”„«»−‐‑‒–—:…", '\'\'\'\'"""""-----,,.')
_PLAIN = frozenset(" ,.'-\"")
_PUNCTUATION = frozenset(".,!?'\"-/°&_+%;")
_SPACED = frozenset(",.!?'\"-;")
_ALIKE = frozenset({"CYRILLIC", "GREEK", "ARMENIAN", "CHEROKEE"})
_WORD = re.compile(r"[^ ]+")
_READY = re.compile(r"[A-Za-z0-9 ,.'\"-]*")
_MINUS = re.compile(r"(?<![^ ])-(?=[.\d])|(?<=\de)-(?=\d)")
_ELLIPSIS = re.compile(r"\.(?:[ .]*\.)+")
_DASH = re.compile(r"(?<= )-+(?= )")
_RUN = re.compile(r"[^\s](?:[^\n]*[^\s])?")
_RANGE = re.compile(r"(?<=\d)-(?=[.\d])")


_SHORT = re.compile(r"([a-z]+?)(n't|'(?:ll|ve|re|d|s))(?= |$)(?: +([^ ]+))?")
_ASKING = frozenset({"how", "what", "when", "where", "which", "who", "why"})
_PRONOUNS = frozenset({"he", "here", "it", "one", "she", "that", "there", "this",
                       "anything", "everything", "nothing", "something"})  # fmt: skip
_BEHIND_IS = re.compile(
    r"a|already|always|an|as|at|been|better|by|going|gone|got|gotten|gonna|in|just|like|no|not|now|of|on|"
    r"quite|rather|really|so|still|such|the|there|too|very|way|[a-z]{2,}ing|mine|yours|ours|hers|"
    r"theirs|ready|done|full|empty|open|closed|shut|dirty|down|broken|fallen|stuck|over|away|here|gone"
)
"""Words before which "'s" is "is" or "has"."""

_MEANS = {"n't": "not", "'ll": "will", "'ve": "have", "'re": "are", "'d": "would"}


_Letter = tuple[str, int, int]
"""A character of the plain form, and the start and end of the columns it came from."""


@dataclass(frozen=True)
class Normalised:
    """A sentence in plain form.

    Attributes:
        original: the sentence as given.
        text: the plain form.
        columns: for each character of `text` the span in `original` that it came from.
        question: whether the sentence ended in a question mark.
        asides: where words stand that change nothing and were left out.
        taken_back: where words stand that the speaker took back or said twice, or in whose place
            others stand.
        asks: whether it was put so that it can only be meant as a question.
    """

    original: str
    text: str
    columns: tuple[Span, ...]
    question: bool
    asides: tuple[Span, ...] = ()
    taken_back: tuple[Span, ...] = ()
    asks: bool = False

    def original_span(self, start: int, end: int) -> Span:
        """Maps `[start, end)` of the plain form to the sentence as given.

        Where a correction has changed the order of words, that is all from the first to the last.
        """
        places = self.columns[start:end]
        return min(first for first, _ in places), max(last for _, last in places)

    def words_in(self, *ranges: Span) -> Normalised:
        """The words of some ranges of the plain form, one space apart."""
        text, columns = "", list[Span]()
        for start, end in ranges:
            piece = self.text[start:end]
            left = start + len(piece) - len(piece.lstrip(" "))
            right = start + len(piece.rstrip(" "))
            if left >= right:
                continue
            if text:
                text, columns = f"{text} ", [*columns, (self.columns[left][0],) * 2]
            text, columns = text + self.text[left:right], [*columns, *self.columns[left:right]]
        return replace(self, text=text, columns=tuple(columns))

    def left_out(self) -> tuple[Span, ...]:
        """The places of words that are neither in `text` nor taken back, as they were given."""
        apart = {c for span in (*self.columns, *self.taken_back) for c in range(*span)}
        aside = {c for span in self.asides for c in range(*span)}
        unsaid = aside - {c for span in self.taken_back for c in range(*span)}
        return self._runs((set(range(len(self.original))) - apart) | unsaid)

    def runs_of(self, spans: Iterable[Span]) -> tuple[Span, ...]:
        """Stretches of the words of some spans."""
        return self._runs({column for span in spans for column in range(*span)})

    def with_gaps_aside(self) -> Normalised:
        """The same, where all words of the sentence as given that are not in `text` are asides."""
        kept = {column for span in self.columns for column in range(*span)}
        return replace(self, asides=self._runs(set(range(len(self.original))) - kept))

    def _runs(self, columns: Collection[int]) -> tuple[Span, ...]:
        """Stretches of words in some columns, with what is no word between them."""
        if not any(self.original[column].isalnum() for column in columns):
            return ()
        marks = "".join(
            " " if not char.isalnum() else char if i in columns else "\n"
            for i, char in enumerate(self.original)
        )
        return tuple(run.span() for run in _RUN.finditer(marks))

    def taken_back_from(self, said: Normalised) -> Normalised:
        """The same, where all words of a longer form that are not in it were taken back."""
        kept = set(self.columns)
        gone = tuple(span for span in said.columns if span not in kept and span[0] < span[1])
        return replace(self, taken_back=(*self.taken_back, *gone))

    def words_as_written(self, span: Span) -> str:
        """The words of a span as they were written, one space apart, asides left out."""
        start, pieces = span[0], list[str]()
        for aside in self.asides:
            if start < aside[0] and aside[1] < span[1]:
                pieces.append(self.original[start : aside[0]].strip(" ,.;-"))
                start = aside[1]
        last = self.original[start : span[1]]
        return " ".join(" ".join([*pieces, last.lstrip(" ,.;-") if pieces else last]).split())

    def error_at(self, span: Span, code: str, message: str, hint: str, *more: str) -> ParseError:
        """The error about the words of a span, with which its message begins."""
        about = f'"{self.words_as_written(span)}" {message}'
        return ParseError(code, about, span, (hint, *more))


def normalise(text: str, contractions: Mapping[str, str]) -> Normalised:
    """Brings a sentence into its plain form.

    Contractions are given with the words they stand for, both in plain form.

    Raises:
        ParseError: `empty`, `too_long`, `control_character`, `unexpected_character` or
            `unbalanced_quote`.
    """
    if len(text) > MAX_LENGTH:
        raise ParseError(
            "too_long",
            f"the sentence has {len(text)} characters; at most {MAX_LENGTH} are read",
            (MAX_LENGTH, len(text)),
            ("say it in one short sentence",),
        )
    letters = _letters_of(text)
    question = _text_of(letters).rstrip(" .!").endswith("?")
    while letters and letters[-1][0] in " .!?,;":
        letters.pop()
    letters = _spell_out(_space_out(letters), contractions)
    _require_one_script(letters)
    if not letters:
        raise ParseError(
            "empty", "the sentence is empty", None, ('say, for example, "push the box away"',)
        )
    quotes = [(start, end) for char, start, end in letters if char == '"']
    if len(quotes) % 2:
        raise ParseError(
            "unbalanced_quote",
            "a quotation mark has no partner",
            quotes[-1],
            ("close the quotation, or leave the mark out",),
        )
    return Normalised(
        original=text,
        text=_text_of(letters),
        columns=tuple([(start, end) for _, start, end in letters]),
        question=question,
    )


def _text_of(letters: list[_Letter]) -> str:
    return "".join([char for char, _, _ in letters])


def _letters_of(text: str) -> list[_Letter]:
    """The characters of the plain form, one space or mark still as good as another."""
    if _READY.fullmatch(text):
        return list(zip(text.lower(), range(len(text)), range(1, len(text) + 1), strict=True))
    return [(c, i, i + 1) for i, char in enumerate(text) for c in _plain_letters(char, i)]


def _require_one_script(letters: list[_Letter]) -> None:
    """Refuses words of Latin and other letters that look alike, since names would differ unseen."""
    text = _text_of(letters)
    if text.isascii():
        return
    for match in _WORD.finditer(text):
        word = letters[match.start() : match.end()]
        scripts = {unicodedata.name(c, "").partition(" ")[0] for c in match[0] if c.isalpha()}
        if "LATIN" in scripts and scripts & _ALIKE:
            raise ParseError(
                "unexpected_character",
                "a word mixes letters of two alphabets",
                (word[0][1], word[-1][2]),
                ("write the word in Latin letters",),
            )


def _plain_letters(char: str, column: int) -> str:
    """One character of the sentence as characters of the plain form."""
    if char.isascii() and (char.isalnum() or char in _PLAIN):
        return char.lower()
    if char.isspace():
        return " "
    category = unicodedata.category(char)
    if category.startswith("C"):
        raise ParseError(
            "control_character",
            f"the sentence holds U+{ord(char):04X}, which is not a character of writing",
            (column, column + 1),
            ("type the sentence again in plain letters",),
        )
    same = char.translate(_SAME)
    if same == char and category == "Nd":
        same = str(unicodedata.digit(char))
    elif same == char and char.isalpha():
        same = unicodedata.normalize("NFKC", char).casefold()
    elif category == "No" and "FRACTION" in unicodedata.name(char, ""):
        same = f" {unicodedata.normalize('NFKC', char).replace(chr(0x2044), '/')}"
    elif same not in _PUNCTUATION and category != "Mn":
        raise ParseError(
            "unexpected_character",
            f"the character U+{ord(char):04X} does not belong in a command",
            (column, column + 1),
            ("use letters, digits and plain punctuation",),
        )
    return same


def _space_out(letters: list[_Letter]) -> list[_Letter]:
    """Sets punctuation apart, opens hyphens, and turns single quotes around words into double."""
    plain = _text_of(letters)
    if _SPACED.isdisjoint(plain):
        return letters
    pauses = {i for p in (_ELLIPSIS, _DASH) for m in p.finditer(plain) for i in range(*m.span())}
    out: list[_Letter] = []
    minus = {m.start() for m in _MINUS.finditer(plain)}
    ranges = {m.start() for m in _RANGE.finditer(plain)} - minus
    quoted = within = False
    for i, letter in enumerate(letters):
        char, start, end = letter
        if char not in _SPACED:
            out.append(letter)
            continue
        before = plain[i - 1] if i else " "
        after = plain[i + 1] if i + 1 < len(letters) else " "
        within ^= char == '"'
        if i in pauses:
            out += [(c, start, end) for c in " , "] if i - 1 not in pauses else []
        elif i in ranges:
            out += [(c, start, end) for c in " to "]
        elif char == "-" and i not in minus:
            out.append((" ", start, end))
        elif char == "'" and not within and (before == " " or (quoted and not after.isalnum())):
            quoted = not quoted
            out.append(('"', start, end))
        elif char in ",;!?" or (char == "." and not after.isdigit()):
            out += [(c, start, end) for c in (" ", char, " ")]
        else:
            out.append(letter)
    return out


def _spell_out(letters: list[_Letter], contractions: Mapping[str, str]) -> list[_Letter]:
    """Spells out contractions and leaves one space between words."""
    out: list[_Letter] = []
    text = _text_of(letters)
    for match in _WORD.finditer(text):
        word = letters[match.start() : match.end()]
        start, end = word[0][1], word[-1][2]
        if out:
            out.append((" ", start, start))
        if match.group() in contractions:
            word = [(char, start, end) for char in contractions[match.group()]]
        elif (said := _SHORT.match(text, match.start())) and _is_short(said):
            over = (word[said.start(2) - match.start()][1], end)
            word = word[: said.end(1) - match.start()]
            word += [(char, *over) for char in f" {_meant_by(said)}"]
        out += word
    return out


def _meant_by(said: re.Match[str]) -> str:
    """The word that the end of a word stands for."""
    if said[1] in _ASKING and said[2] == "'d":
        return "did"
    return _MEANS.get(said[2], "is")


def _is_short(said: re.Match[str]) -> bool:
    """Check for a contraction: "the mug's too close", not "the mug's handle"."""
    short = said[2] != "'s" or said[1] in _ASKING | _PRONOUNS
    return short or _BEHIND_IS.fullmatch(said[3] or "") is not None

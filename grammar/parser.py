"""From a sentence to a command: normalise, parse (LALR), transform, put together.

The parser is built with the first sentence and kept.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from copy import copy
from dataclasses import replace
from functools import cache, lru_cache
from itertools import chain, pairwise

from grammar.clauses.frame_builder import frames_of
from grammar.errors import ParseError
from grammar.frames.command import Command, Frame, Span
from grammar.paraphrasing.clause_wording import Phrasing
from grammar.paraphrasing.command_wording import paraphrase
from grammar.phrases.lalr_parser import LalrParser, UnexpectedTokenError, parse_table
from grammar.phrases.other_readings import OtherReadings
from grammar.phrases.phrase_parts import Filler
from grammar.phrases.tree_transform import parts_of
from grammar.syntax_diagnosis import EXAMPLE, diagnose, require_clear
from grammar.unbound_words import LawOfEffect
from grammar.words.asides import Asides
from grammar.words.known_names import KnownNames
from grammar.words.lexicon import Lexicon
from grammar.words.lexicon_plugins import installed_lexicon
from grammar.words.normalisation import Normalised, normalise
from grammar.words.phrase_lexer import PhraseLexer

_OF_WORDS = ("unexpected_words", "does_not_apply", "several_objects", "missing_unit", "said_twice")
"""Errors about some words, before which there may be a whole sentence."""

_OF_UNREAD_WORDS = frozenset({"unexpected_words", "unknown_verb", "no_verb", "no_object",
                              "several_objects", "several_commands", "does_not_apply",
                              "missing_unit", "unsupported_verb", "said_twice", "incomplete",
                              "unbound_words"})  # fmt: skip
"""Errors of sentences that may be read without a part that has an effect."""

_LONGEST_TRIED = 150
"""Characters beyond which a text is long, and not read again with each quantity that is offered,
nor its beginning for what would be understood of it."""

_MOST_ASKED = 4
"""Ends of the sentences that may ask the same, and one."""

_SENTENCE_END = re.compile(r" [.;!?](?= )")
_OFFERED = re.compile(r'^(?:to have it done|to ask|this would do): "(.+)"$')


class Parser:
    """Reads commands with the words of a lexicon.

    Attributes:
        lexicon: the words.
    """

    def __init__(self, lexicon: Lexicon) -> None:
        self.lexicon = lexicon
        lexer = PhraseLexer(lexicon)
        self._asides = Asides(lexicon, lexer.phrases)
        self._lalr = LalrParser(parse_table(), lexer)
        self._others = OtherReadings(lexicon, lexer.phrases)
        self._law = LawOfEffect(lexicon, lexer.phrases)
        self._names: KnownNames | None = None

    def with_names(self, names: Iterable[str]) -> Parser:
        """A parser with the same words that knows the names of some objects."""
        parser = copy(self)
        parser._names = KnownNames(names, self.lexicon)
        return parser

    def has_effect(self, words: str) -> bool:
        """Check for words that no reading, and no offer of one, may leave out."""
        return self._law.has_effect(words)

    def knows_names_of(self, command: Command) -> bool:
        """Check for a command whose names are, as far as this parser knows, of some objects."""
        return self._names is None or self._names.are_borne(command.frames)

    def parse(self, text: str, before: Sequence[str] | None = None) -> Command:
        """Reads one or several English commands, a question, or a remark on what was done.

        Args:
            text: as it was said.
            before: in a conversation, what was said before, the last first; an amount without a
                unit has theirs.

        Returns:
            The command, with the spans of the words in `text`.

        Raises:
            ParseError: if the sentence, or a part of it, is not understood.
        """
        try:
            return self._command(text, before)
        except ParseError as error:
            cause = self._cause_of(error, text)
            raise self._unbound(cause, text) or self._with_what_is_read(cause, text) from None

    def _unbound(self, error: ParseError, text: str) -> ParseError | None:
        """The refusal of a sentence that would be read without words that have an effect."""
        if error.code not in _OF_UNREAD_WORDS or len(text) > _LONGEST_TRIED:
            return None
        said = normalise(text, self.lexicon.contractions)
        for span in self._law.stretches(said, error.span):
            rest = f"{text[: span[0]]} {text[span[1] :]}".strip(" ,.;:-")
            command = self.command_if_read(rest) if rest else None
            if command is not None and all(f.action and not f.dialogue for f in command.frames):
                return self._law.error(said, span, command.paraphrase)
        return None

    def _cause_of(self, error: ParseError, text: str) -> ParseError:
        """The error; of an unclear question, what is wrong with it as a command too."""
        try:
            if error.code == "unsupported_question":
                self._command(text.rstrip(" ?"))
        except ParseError as cause:
            return cause
        return error

    def _with_what_is_read(self, error: ParseError, text: str) -> ParseError:
        """The error, of whose sentences and quantities only those are offered that are read."""
        if error.code == "missing_unit" and error.span is not None:
            few = error.suggestions if len(text) <= _LONGEST_TRIED else ()
            tried = {s: _with_quantity(text, s, error.span) for s in few}
        else:
            tried = {s: said[1] for s in error.suggestions if (said := _OFFERED.search(s))}
        unread = {s for s, sentence in tried.items() if self.command_if_read(sentence) is None}
        left = tuple(s for s in error.suggestions if s not in unread)
        better = tuple(s for s in left if s != EXAMPLE)
        error.suggestions = better or left or error.suggestions
        return self._with_what_was_understood(error, text)

    def command_if_read(self, text: str, before: Sequence[str] | None = None) -> Command | None:
        """The command of a text as `parse` reads it; None if it is not understood."""
        try:
            return self._command(text, before)
        except ParseError:
            return None

    def _with_what_was_understood(self, error: ParseError, text: str) -> ParseError:
        """The error, and as a suggestion the sentence up to it, where that alone would do."""
        if error.code in _OF_WORDS and error.span and error.span[0] <= _LONGEST_TRIED:
            with suppress(ParseError):
                understood = self._command(text[: error.span[0]])
                if understood.frames[0].dialogue != "thank":
                    error.suggestions += (f'this much is understood: "{understood.paraphrase}"',)
        return error

    def _command(self, text: str, before: Sequence[str] | None = None) -> Command:
        whole = normalise(text, self.lexicon.contractions)
        whole = replace(whole, asks=self._others.only_asks(whole))
        sentence = self._asides.left_out(whole)
        if not sentence.text and self._asides.are_closing(whole):
            return _thanks(text, sentence.asides)
        if not sentence.text:
            sentence = whole
        try:
            command = self._command_of(sentence)
        except (ParseError, UnexpectedTokenError) as raised:
            other = self._first_read(self._other_readings(sentence, whole, before))
            if other is not None:
                return other
            if (asked := self._asked_again(whole, before)) is not None:
                return asked
            if isinstance(raised, UnexpectedTokenError):
                raise diagnose(raised, sentence, self.lexicon) from None
            raise
        return self._with_known_names(command, sentence, whole, before)

    def _first_read(self, readings: Iterable[Normalised]) -> Command | None:
        """The command of the first of some readings that is one."""
        tried = set[tuple[str, bool, bool]]()
        for said in readings:
            key = (said.text, said.question, said.asks)
            if key not in tried:
                tried.add(key)
                with suppress(ParseError, UnexpectedTokenError):
                    return self._command_of(said)
        return None

    def _asked_again(self, said: Normalised, before: Sequence[str] | None) -> Command | None:
        """The question of sentences that all ask the same: "did it move? By how much?"."""
        ends = [0, *(mark.end() for mark in _SENTENCE_END.finditer(said.text)), len(said.text)]
        if not 2 < len(ends) <= _MOST_ASKED or not said.question:
            return None
        asked = list[Command]()
        for start, end in pairwise(ends):
            text = said.text[start:end]
            part = said.words_in((start, start + len(text.rstrip(" .;!?"))))
            command = self._first_read(chain([part], self._reworded(part, before)))
            if command is None:
                return None
            asked.append(command)
        kinds = {(len(c.frames), c.frames[0].query, c.frames[0].action) for c in asked}
        return asked[0] if kinds in ({(1, "did", None)}, {(1, "why", None)}) else None

    def _with_known_names(
        self,
        command: Command,
        sentence: Normalised,
        whole: Normalised,
        before: Sequence[str] | None,
    ) -> Command:
        """The command, or that without what was taken for a name: "the mug can break. Push it".

        A name that nothing has is none if the text is read otherwise: "push it near the cap".
        """
        if self._names is None or self.knows_names_of(command):
            return command
        # "Push the mug, no dawdling" takes nothing back.
        uncut = self._others.readings(whole, before) if sentence.text != whole.text else ()
        plain = map(self._asides.left_out, uncut)
        every = chain(self._others.readings(sentence, before), plain)
        for said in filter(_is_said, every):
            for each in (said, *self._names.readings(said)):
                with suppress(ParseError, UnexpectedTokenError):
                    other = self._command_of(each)
                    if self._names.are_borne(other.frames):
                        return other
        return command

    def _other_readings(
        self, sentence: Normalised, whole: Normalised, before: Sequence[str] | None
    ) -> Iterator[Normalised]:
        """Other readings of a sentence that is not read as it stands, nor without its asides."""
        yield from self._reworded(sentence, before)
        if sentence.text != whole.text:  # "I said left, but I meant right"
            for said in self._others.readings(whole, before):
                if (plain := self._asides.left_out(said)).text:
                    yield plain
        yield from self._others.by_sentences(sentence)

    def _reworded(self, sentence: Normalised, before: Sequence[str] | None) -> Iterator[Normalised]:
        """A sentence with known names, in other words, and without hesitations."""
        if self._names:
            yield from self._names.readings(sentence)
        for said in self._others.readings(sentence, before):
            yield said
            if self._names:
                yield from self._names.readings(said)
        fluent = self._asides.without_hesitations(sentence)
        if fluent is not None:
            yield fluent

    def _command_of(self, sentence: Normalised) -> Command:
        """The command of a sentence in plain form, without its asides."""
        require_clear(sentence, self.lexicon)
        parts = parts_of(self._lalr.parse(sentence.text), self.lexicon, sentence)
        frames = frames_of(parts, self.lexicon, sentence)
        if sentence.asks and any(frame.query is None for frame in frames):
            raise ParseError(
                "unsupported_question", "this asks for nothing that is known", None, ()
            )
        self._law.require_bound(sentence, frames, self._names.words if self._names else ())
        try:
            words = paraphrase(frames, self.lexicon)
        except ValueError as raised:
            message = "these words together make no sentence"
            hints = ("say it in two sentences", "leave something out")
            raise ParseError("does_not_apply", message, None, hints) from raised
        fillers = (part.span for part in parts if isinstance(part, Filler))
        asides = sentence.runs_of((*sentence.asides, *fillers))
        return Command(text=sentence.original, frames=frames, paraphrase=words, asides=asides)


def _is_said(sentence: Normalised) -> bool:
    return bool(sentence.text)


def _thanks(text: str, asides: tuple[Span, ...]) -> Command:
    """The command of a text that asks for nothing."""
    thanks = Frame(dialogue="thank", spans=asides)
    return Command(text=text, frames=(thanks,), paraphrase="thank you")


def _with_quantity(text: str, quantity: str, span: Span) -> str:
    """A text with a quantity in the place of its number, the last one up to a span."""
    number = quantity.partition(" ")[0]
    start = max(text.rfind(number, 0, span[1]), 0)
    return text[:start] + quantity + text[start + len(number) :]


def parser_for(names: Iterable[str]) -> Parser:
    """The parser for the installed language in which objects have these names.

    A name that would be read as something else ("hard drive") becomes a word of the language.
    """
    lexicon, _ = installed_lexicon()
    phrasing = Phrasing(lexicon)
    known = frozenset(names)
    unread = sorted(name for name in known if not phrasing.needs_no_article(name))
    parser = _parser_with(tuple(unread)) if unread else default_parser()
    return parser.with_names(known)


@lru_cache(maxsize=8)
def _parser_with(names: tuple[str, ...]) -> Parser:
    lexicon, _ = installed_lexicon()
    return Parser(lexicon.with_words(names=names))


@cache
def default_parser() -> Parser:
    """The parser for the language that is installed: nlcontrol's own and its plug-ins'."""
    lexicon, _ = installed_lexicon()
    return Parser(lexicon)


def parse(text: str) -> Command:
    """Reads a sentence in the language that is installed; see `Parser.parse`."""
    return default_parser().parse(text)

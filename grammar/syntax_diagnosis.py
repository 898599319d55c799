"""Errors of sentences that cannot be parsed, from what the parser could have gone on with."""

from __future__ import annotations

import re
from collections.abc import Sequence, Set
from functools import lru_cache

from grammar.errors import ParseError
from grammar.frames.command import Span
from grammar.phrases.lalr_parser import END, UnexpectedTokenError
from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised

EXAMPLE = 'say, for example, "push the box away"'

_TIE = 5.0
"""Likenesses nearer to the best than this are as good as it."""

_SHORT = 2
"""Words of so few letters are like too many others."""

_UNITS = {"LENGTH_UNIT": "cm", "ANGLE_UNIT": "degrees", "FORCE_UNIT": "N", "SPEED_UNIT": "cm/s",
          "TIME_UNIT": "seconds", "VOLUME_UNIT": "ml"}  # fmt: skip
_JOINING = frozenset({"of", "to", "in", "on", "at", "from", "with", "by", "for", "into", "onto"})
"""Words that say nothing by themselves; an error is about the phrase that they begin."""

_WORD = re.compile(r"[^ ]+")
_TAKEN_BY = re.compile(r"\bby (?:its|the) [^ ]+")


_DENIED = re.compile("(?: not| never| without)(?: [^ ,.;]+)*$")


def require_clear(sentence: Normalised, lexicon: Lexicon) -> None:
    """Refuses phrases of no clear meaning, whatever their words may be read as.

    Raises:
        ParseError: `unexpected_words`.
    """
    text = f" {sentence.text} "
    for phrase in lexicon.vague:
        if " " not in phrase or f" {phrase} " not in text or '"' in text:
            continue
        start = text.find(f" {phrase} ")
        if _DENIED.search(text, 0, start):
            continue  # "not too fast"
        end = start + len(phrase)
        after = _word_at(sentence, end)[1]
        if after in ("", ",", ".", ";", "by") or (
            after != "of" and after in lexicon.reserved_words
        ):
            raise _vague_error(phrase, sentence.original_span(start, end), lexicon)


def _vague_error(phrase: str, span: Span, lexicon: Lexicon) -> ParseError:
    instead = tuple(f'say "{known}"' for known in lexicon.vague[phrase])
    return ParseError("unexpected_words", f'"{phrase}" may mean several things', span, instead)


def diagnose(error: UnexpectedTokenError, sentence: Normalised, lexicon: Lexicon) -> ParseError:
    """Return the error of a sentence in terms of the language, from where the parser stopped."""
    at_end, accepts = error.token.type == END, error.accepts
    start, word = _word_at(sentence, len(sentence.text) if at_end else error.token.start_pos)
    said, last = _word_at(sentence, sentence.text.rfind(" ") + 1) if at_end else (start, word)
    span = sentence.original_span(said, said + len(last))
    if word.startswith('"'):
        return _no_object_error(span)
    if not at_end and word in lexicon.vague:
        return _vague_error(word, span, lexicon)
    if "VERB" in accepts and not at_end:
        missing = _missing_verb_error(start, word, span, sentence, lexicon)
        if missing is not None:
            return missing
    taken = [m for m in _TAKEN_BY.finditer(sentence.text) if m.start() <= start < m.end()]
    if taken and "VERB" not in accepts:
        return _taken_by_error(sentence.original_span(*taken[0].span()), sentence)
    if "SIDE_OF_OBJECT" in accepts and not accepts & {*_UNITS, "VERB"}:
        return _no_unit_error(start, sentence, lexicon)
    if "WORD" in accepts and "$END" not in accepts and "VERB" not in accepts:
        before = sentence.text[:start].split()[-1:]
        if not any(name in accepts for name in _UNITS) or before in (["a"], ["an"]):
            return _no_object_error(span)
    if units := [_UNITS[name] for name in _UNITS if name in accepts and "VERB" not in accepts]:
        number = last if at_end else sentence.text[:start].split()[-1]
        wanted = _nearest_words(word, _words_of_terminals(accepts, lexicon))
        suggestions = (*wanted, *(f"{number} {unit}" for unit in units))
        return ParseError("missing_unit", f'"{number}" lacks its unit', span, suggestions)
    if at_end:
        return _incomplete_error(accepts, span, lexicon)
    if not at_end:
        span = _span_of_phrase(start, sentence, lexicon)
    out = (f'leave out "{sentence.words_as_written(span)}"',)
    instead = out if "VERB" in accepts else _could_stand_here(accepts, lexicon)
    close = _nearest_words(word, _words_of_terminals(accepts, lexicon))
    return sentence.error_at(span, "unexpected_words", "is not understood here", *close, *instead)


def _word_at(sentence: Normalised, position: int) -> tuple[int, str]:
    """The word at a position of the plain form, and where it starts."""
    match = _WORD.search(sentence.text, position)
    return (match.start(), match.group()) if match else (len(sentence.text), "")


def _span_of_phrase(start: int, sentence: Normalised, lexicon: Lexicon) -> Span:
    """The word that starts here; of "the bowl", "in the bowl" all words, not the first alone."""
    joining = _JOINING | lexicon.terminals["THE"].keys() | lexicon.terminals["A"].keys()
    words = list(_WORD.finditer(sentence.text, start))
    end = next((m.end() for m in words if m.group() not in joining), None)
    if words[0].group() not in joining or end is None:
        return sentence.original_span(words[0].start(), words[0].end())
    before = sentence.text[:start].split()[-1:]
    if before and before[0] in _JOINING:
        start -= len(before[0]) + 1
    return sentence.original_span(start, end)


def _missing_verb_error(
    start: int, word: str, span: Span, sentence: Normalised, lexicon: Lexicon
) -> ParseError | None:
    """The error for a word where a command should begin; None if one has begun."""
    before = sentence.text[:start].split()
    first = set(before) <= lexicon.silent_words
    if not (first or before[-1] in lexicon.joints):
        return None
    if word in lexicon.later_verbs:
        said = sentence.original
        instead = (said[: span[0]] + like + said[span[1] :] for like in lexicon.later_verbs[word])
        message = f'the verb "{word}" is not understood yet'
        offers = (f'this would do: "{" ".join(text.split())}"' for text in instead)
        return ParseError("unsupported_verb", message, span, (*offers, EXAMPLE))
    if not word.isalpha() or word in lexicon.reserved_words | lexicon.first_words:
        return None
    close = _nearest_words(word, sorted(lexicon.verb_words["VERB"]), close=67.0)
    if not (first or close):
        return None
    return ParseError("unknown_verb", f'"{word}" is no known verb', span, close or (EXAMPLE,))


def _taken_by_error(span: Span, sentence: Normalised) -> ParseError:
    """The error for a part by which something is to be held: "by its handle"."""
    written = sentence.words_as_written(span)
    message = f'where to take hold is up to the robot: "{written}" is not understood'
    return ParseError("unexpected_words", message, span, (f'leave out "{written}"',))


def _no_unit_error(end: int, sentence: Normalised, lexicon: Lexicon) -> ParseError:
    """The error for a word behind a number that is no unit: "10 blorps"."""
    start = sentence.text[:end].rstrip().rfind(" ") + 1
    span = sentence.original_span(start, len(sentence.text[:end].rstrip()))
    written = sentence.words_as_written(span)
    close = _nearest_words(written.casefold(), _words_of_terminals(frozenset(_UNITS), lexicon))
    if written.endswith("s") and not close and written.casefold() not in lexicon.reserved_words:
        message, hint = "are not counted out", f'say "all the {written}", or name each of them'
        return sentence.error_at(span, "several_objects", message, hint)
    suggestions = close or ("cm", "degrees", "N")
    return sentence.error_at(span, "missing_unit", "is no unit", *suggestions)


def _no_object_error(span: Span) -> ParseError:
    return ParseError("no_object", "the name of an object is missing", span, (EXAMPLE,))


def _incomplete_error(expected: Set[str], span: Span, lexicon: Lexicon) -> ParseError:
    if "THE" in expected and not expected & {"AVOIDING", "TOOL", "VERB"}:
        return _no_object_error(span)
    suggestions = _could_stand_here(expected, lexicon)
    return ParseError("incomplete", "the sentence ends too early", span, suggestions)


def _could_stand_here(expected: Set[str], lexicon: Lexicon) -> tuple[str, ...]:
    labels = [label for name, label in lexicon.labels.items() if name in expected]
    return (f"could stand here: {', '.join(labels)}",) if labels else (EXAMPLE,)


@lru_cache(maxsize=256)
def _words_of_terminals(expected: frozenset[str], lexicon: Lexicon) -> tuple[str, ...]:
    """Every word of the terminals that could have stood here, in alphabetical order."""
    known = [n for n in expected if n in lexicon.terminals or n in lexicon.verb_words]
    said = {w for name in known for p in lexicon.phrases_of(name) for w in p.split()}
    return tuple(sorted(word for word in said if len(word) > 3))


def words_like(word: str, lexicon: Lexicon) -> tuple[str, ...]:
    """Suggestions for a word that is no word of the language."""
    known = _words_of_terminals(frozenset(lexicon.terminals), lexicon)
    return _nearest_words(word.casefold(), known)


def _nearest_words(word: str, known: Sequence[str], close: float = 75.0) -> tuple[str, ...]:
    """The known words nearest to a word; of near ties all, since none is a better guess."""
    from rapidfuzz import fuzz, process

    if len(word) <= _SHORT:
        return ()
    likest = process.extract(word, known, scorer=fuzz.ratio, score_cutoff=close, limit=4)
    found = [each for each in likest if each[0] != word][:3]
    near = [name for name, likeness, _ in found if found[0][1] - likeness < _TIE]
    return (f"did you mean {' or '.join(repr(name) for name in near)}?",) if near else ()

"""Why a sentence cannot be read, from what the parser could have gone on with."""

from __future__ import annotations

import re
from collections.abc import Iterable, Set

from lark.exceptions import UnexpectedInput, UnexpectedToken

from grammar.errors import ParseError
from grammar.frames import Span
from grammar.lexicon import Lexicon
from grammar.normalise import Normalised

EXAMPLE = 'say, for example, "push the box away"'

_TIE = 5.0
"""Likenesses nearer to the best than this are as good as it."""

_UNITS = {"LENGTH_UNIT": "cm", "ANGLE_UNIT": "degrees", "FORCE_UNIT": "N"}
_WORD = re.compile(r"[^ ]+")
_NOT_FIRST = re.compile(r"[ ,]*(?:(?:robot|please|hey|ok|okay|now|hello)(?: |$)[ ,]*)*")


def question(sentence: Normalised, lexicon: Lexicon) -> ParseError | None:
    """The error for a question, unless it is a polite request."""
    start = _NOT_FIRST.match(sentence.text)
    text = sentence.text[start.end() if start else 0 :] + " "
    asks = text.startswith(tuple(f"{word} " for word in lexicon.question_words))
    requests = text.startswith(tuple(f"{word} " for word in lexicon.requests))
    if not asks and (not sentence.question or requests):
        return None
    return ParseError(
        "unsupported_question",
        "questions are not understood, only commands",
        None,
        ("say it as a command, without a question mark",),
    )


def diagnose(
    error: UnexpectedInput, accepts: Set[str], sentence: Normalised, lexicon: Lexicon
) -> ParseError:
    """Says in terms of the language why lark could not go on.

    Args:
        error: where it stopped.
        accepts: terminals with which it could have gone on.
        sentence: the sentence.
        lexicon: the words of the language.
    """
    token = error.token.type if isinstance(error, UnexpectedToken) else ""
    at_end = token == "$END"
    start, word = _word(sentence, len(sentence.text) if at_end else error.pos_in_stream or 0)
    span = None if at_end else sentence.span(start, start + len(word))
    if "VERB" in accepts:
        return _no_verb(word, token, span, lexicon)
    if more := _more_than_one(start, word, span, accepts, sentence, lexicon):
        return more
    if "WORD" in accepts and "$END" not in accepts and token != "WORD":
        return _no_object(span)
    if units := [_UNITS[name] for name in _UNITS if name in accepts]:
        number = sentence.text[:start].split()[-1]
        return ParseError(
            "missing_unit",
            f'"{number}" lacks its unit',
            span,
            tuple(f"{number} {unit}" for unit in units),
        )
    if at_end:
        return _incomplete(accepts, lexicon)
    return ParseError(
        "unexpected_words",
        f'"{word}" is not understood here',
        span,
        (*_did_you_mean(word, _words(accepts, lexicon)), *_could_stand_here(accepts, lexicon)),
    )


def _more_than_one(
    start: int,
    word: str,
    span: Span | None,
    accepts: Set[str],
    sentence: Normalised,
    lexicon: Lexicon,
) -> ParseError | None:
    """The error for a second command or a second object, if the stop is at one."""
    before = sentence.text[:start].split()[-1:]
    joined = bool(before) and before[0] in lexicon.terminals["SEPARATOR"]
    ended = "$END" in accepts or joined
    if ended and (word in ("then", ".", ";", "!", "?") or word in lexicon.verb_words()):
        return ParseError(
            "several_commands",
            f'"{word}" begins a second command; one at a time is understood',
            span,
            ("say one command after the other",),
        )
    if joined and word in (*lexicon.terminals["THE"], *lexicon.terminals["A"]):
        return ParseError(
            "several_objects",
            f'"{sentence.text[start:]}" names a second object; one at a time is understood',
            sentence.span(start, len(sentence.text)),
            ("say one command for each object",),
        )
    return None


def _word(sentence: Normalised, position: int) -> tuple[int, str]:
    """The word at a position of the plain form, and where it starts."""
    match = _WORD.search(sentence.text, position)
    return (match.start(), match.group()) if match else (len(sentence.text), "")


def _no_verb(word: str, token: str, span: Span | None, lexicon: Lexicon) -> ParseError:
    if word in lexicon.later_verbs:
        return ParseError(
            "unsupported_verb",
            f'the verb "{word}" is not understood yet',
            span,
            (f"understood are {', '.join(sorted(lexicon.verb_words()))}",),
        )
    if token == "WORD":
        close = _did_you_mean(word, lexicon.verb_words(), close=65.0)
        return ParseError("unknown_verb", f'"{word}" is no known verb', span, close or (EXAMPLE,))
    return ParseError("no_verb", "the sentence does not say what to do", span, (EXAMPLE,))


def _no_object(span: Span | None) -> ParseError:
    return ParseError(
        "no_object",
        "the name of an object is missing",
        span,
        (EXAMPLE,),
    )


def _incomplete(expected: Set[str], lexicon: Lexicon) -> ParseError:
    if "THE" in expected and not expected & {"AVOIDING", "TOOL"}:
        return _no_object(None)
    return ParseError(
        "incomplete",
        "the sentence ends too early",
        None,
        _could_stand_here(expected, lexicon),
    )


def _could_stand_here(expected: Set[str], lexicon: Lexicon) -> tuple[str, ...]:
    labels = [label for name, label in lexicon.labels.items() if name in expected]
    return (f"could stand here: {', '.join(labels)}",) if labels else ()


def _words(expected: Set[str], lexicon: Lexicon) -> set[str]:
    """Every word of the terminals that could have stood here."""
    known = [name for name in expected if name in lexicon.terminals or name == "VERB"]
    return {w for name in known for p in lexicon.phrases(name) for w in p.split() if len(w) > 3}


def _did_you_mean(word: str, known: Iterable[str], close: float = 75.0) -> tuple[str, ...]:
    """The known words nearest to a word; of near ties all, since none is a better guess."""
    from rapidfuzz import fuzz, process

    others = sorted(set(known) - {word})
    found = process.extract(word, others, scorer=fuzz.ratio, score_cutoff=close, limit=3)
    near = [name for name, likeness, _ in found if found[0][1] - likeness < _TIE]
    return (f"did you mean {' or '.join(repr(name) for name in near)}?",) if near else ()

"""Properties of the parser over sampled frames and sentences, and over arbitrary text."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import groupby
from random import Random
from typing import Any

from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from grammar import Command, Frame, ParseError, paraphrase, parse
from grammar.frames import Displace, ObjectRef, Place, Span
from grammar.lexicon import default_lexicon
from grammar.normalise import normalise
from grammar.sampling import Sampler

LEXICON = default_lexicon()

SILENT = {
    "FILLER": "politeness",
    "VOCATIVE": "who is spoken to",
    "CAN_YOU": "politeness, where no question mark follows",
    "MIND": "politeness before a verb in -ing",
    "SEPARATOR": "joins what it stands between",
    "OR": "joins what is to be avoided",
    "NEXT": "separates clauses, whose order the frames have",
    "THE": "an article; the name behind it is covered",
    "A": "an article",
    "THAT": "an article",
    "YOU": "the robot, which does all that is asked",
    "IF": "opens the clause that a question is about, whose frame it is",
    "CONTENTS": "what is poured, which the goal says already",
    "DIAGONALLY": "announces two directions, which are covered",
    "THAT_IS": "joins an object and its place, which is covered",
    "THERE": "repeats the place of the push that is asked about",
}
"""Terminals whose words say nothing that a frame could carry, each with why."""

_SAID = sorted((p for name in SILENT for p in LEXICON.phrases(name)), key=len, reverse=True)
_ONLY_SILENT = re.compile(rf"(?:(?:{'|'.join(map(re.escape, _SAID))})(?: |$))*")

# Names that need quotation marks, or whose words mean something elsewhere.
NAMES = st.one_of(
    st.sampled_from(["Ice-Tea box", "hard drive", "box 2", "the odd one", "dog's bowl", "away"]),
    st.sampled_from(["7up can", "it", "tea, green", "café", "left", "can", "box without lid"]),
    st.from_regex(r"[a-z]{1,8}( [a-z]{1,8}){0,2}", fullmatch=True),
)
# Drawn randomness shrinks to simple frames, but favours few of them; seeds spread over all.
SAMPLERS = st.one_of(st.randoms(use_true_random=False), st.integers(0).map(Random)).map(Sampler)
SAMPLED = settings(max_examples=250, deadline=None, suppress_health_check=[HealthCheck.too_slow])


def meaning(frames: Sequence[Frame]) -> list[Any]:
    """Frames as JSON without spans, in lower case, since names are kept as they were written."""
    return [_bare(frame.model_dump(mode="json")) for frame in frames]


def _bare(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _bare(part) for key, part in value.items() if key != "spans"}
    if isinstance(value, list):
        return [_bare(part) for part in value]
    return value.casefold() if isinstance(value, str) else value


def all_spans(value: Any) -> list[Span]:
    """Every span in a frame's JSON."""
    spans: list[Span] = []
    if isinstance(value, dict):
        spans += value.get("spans", [])
        value = [part for key, part in value.items() if key != "spans"]
    if isinstance(value, list):
        spans += [span for part in value for span in all_spans(part)]
    return spans


def dropped(command: Command) -> list[str]:
    """The stretches of a sentence that no span covers and that are not silent."""
    covered: set[int] = set()
    for start, end in all_spans([frame.model_dump(mode="json") for frame in command.frames]):
        assert 0 <= start < end <= len(command.text)
        covered |= set(range(start, end))
    sentence = normalise(command.text, LEXICON.contractions)
    words = []
    for match in re.finditer(r"[^ ]+", sentence.text):
        columns = [i for i in range(*match.span()) if sentence.text[i] != '"']
        told = covered.issuperset(sentence.columns[i][0] for i in columns)
        words.append((told, match.group().replace('"', "")))
    runs = [
        " ".join(word for _, word in run if word)
        for told, run in groupby(words, key=lambda word: word[0])
        if not told
    ]
    return [run for run in runs if not _ONLY_SILENT.fullmatch(run)]


def restyled(text: str, rng: Random) -> str:
    """The same sentence in other cases and with other spaces."""
    cased = (rng.choice((str.upper, str.lower, str))(char) for char in text)
    return "".join(rng.choice((" ", "  ", "\t", " \n ")) if c == " " else c for c in cased)


def read(text: str) -> Command | None:
    """The command; None if the text is refused, with an error that is about the text."""
    try:
        return parse(text)
    except ParseError as refusal:
        error = refusal
    assert error.code
    assert error.message
    for start, end in (error.span or (0, 0), *error.spans):
        assert 0 <= start <= end <= len(text)
    return None


@SAMPLED
@given(SAMPLERS)
def test_paraphrase_is_read_back_as_the_same_frames(sampler: Sampler) -> None:
    frames = sampler.sample().frames
    assert meaning(parse(paraphrase(frames)).frames) == meaning(frames)


@SAMPLED
@given(SAMPLERS)
def test_any_phrases_of_the_same_meaning_are_read_as_the_same_frames(sampler: Sampler) -> None:
    text, frames = sampler.sample()
    assert meaning(parse(text).frames) == meaning(frames)


@SAMPLED
@given(SAMPLERS, st.randoms(use_true_random=False))
def test_spans_cover_what_is_said(sampler: Sampler, rng: Random) -> None:
    text, frames = sampler.sample()
    command = parse(restyled(text, rng))
    assert meaning(command.frames) == meaning(frames)
    assert not dropped(command)
    for frame in command.frames:
        assert frame.spans
        assert all(constraint.spans for constraint in frame.constraints)
        if frame.object is not None and frame.object.spans and frame.object.text != "its":
            start, end = frame.object.spans[0]
            assert " ".join(command.text[start:end].split()) == frame.object.text


@SAMPLED
@given(NAMES, NAMES)
def test_any_name_is_read_back(name: str, other: str) -> None:
    frame = Frame(
        action="push",
        object=ObjectRef(text=name),
        goal=Place(relation="next_to", reference=(ObjectRef(text=other),)),
    )
    (again,) = parse(paraphrase(frame)).frames
    assert again.object is not None
    assert isinstance(again.goal, Place)
    assert isinstance(again.goal.reference, tuple)
    assert (again.object.text, again.goal.reference[0].text) == (name, other)


@SAMPLED
@given(st.floats(1e-6, 10.0), st.sampled_from(["exact", "at_least", "at_most"]))
def test_any_distance_is_read_back_to_the_last_digit(distance: float, bound: Any) -> None:
    goal = Displace(direction="left", distance=distance, bound=bound)
    said = paraphrase(Frame(action="push", object=ObjectRef(text="box"), goal=goal))
    (again,) = parse(said).frames
    assert again.goal.model_copy(update={"spans": ()}) == goal


@settings(max_examples=400, deadline=None)
@given(st.text(max_size=60))
@example("push the box " + "9" * 400 + " m")
@example("push the box 1e99999999999999999999 m")
@example("push the box 1/0 m")
@example("\ud800")
@example("\U00017000")
@example('"' * 500)
@example("push " + "the box " * 60)
@example("½" * 500)
def test_any_text_is_read_or_refused(text: str) -> None:
    command = read(text)
    assert command is None or not dropped(command)


PHRASES = sorted(
    {p for name in ("VERB", "VERB_ED", "VERB_ING", *LEXICON.terminals)
     for p in LEXICON.phrases(name)}
    | set(LEXICON.adjectives)
    | set(LEXICON.numbers.phrases)
    | LEXICON.later_words
    | {"box", "mug", "10", "0.5", "-1", "½", '"', ".", "?", "bananas", "sideways", "-", "'"}
)  # fmt: skip
OPENINGS = st.sampled_from(["", "push the box", "will it topple if you push it", "no,", "put it"])


@settings(max_examples=1500, deadline=None)
@given(OPENINGS, st.lists(st.sampled_from(PHRASES), max_size=8))
def test_no_word_is_silently_dropped(opening: str, phrases: list[str]) -> None:
    command = read(" ".join([opening, *phrases]))
    assert command is None or not dropped(command)


TERMINALS = sorted({"VERB", *LEXICON.terminals})
SEEDS = st.integers(0, 2**32)


@settings(max_examples=1500, deadline=None)
@given(OPENINGS, st.lists(st.sampled_from(TERMINALS), max_size=6), SEEDS)
def test_no_terminal_is_silently_dropped(opening: str, kinds: list[str], seed: int) -> None:
    """Terminals that have few phrases are tried as often as those that have many."""
    rng = Random(seed)
    phrases = [rng.choice(LEXICON.phrases(kind)) for kind in kinds]
    command = read(" ".join([opening, *phrases]))
    assert command is None or not dropped(command)

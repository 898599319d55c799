"""Properties of the parser over sampled frames and sentences, and over arbitrary text."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from itertools import groupby
from random import Random
from typing import Any

from hypothesis import example, given, settings
from hypothesis import strategies as st

from grammar import Command, Frame, ParseError, paraphrase, parse
from grammar.frames.command import Displace, ObjectRef, Place, Span
from grammar.paraphrasing.sentence_sampler import Sampler
from grammar.parser import Parser
from grammar.words.lexicon import NAME_TERMINALS, default_lexicon
from grammar.words.normalisation import normalise
from tests.sizes import examples

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

_SAID = sorted((p for name in SILENT for p in LEXICON.phrases_of(name)), key=len, reverse=True)
_ONLY_SILENT = re.compile(rf"(?:(?:{'|'.join(map(re.escape, _SAID))})(?: |$))*")

# Names that need quotation marks, or whose words mean something elsewhere.
NAMES = st.one_of(
    st.sampled_from(["Ice-Tea box", "hard drive", "box 2", "the odd one", "dog's bowl", "away"]),
    st.sampled_from(["robot", "rest", "front", "table leg", "top edge", "ahh", "simply box"]),
    st.sampled_from(["7up can", "it", "tea, green", "café", "left", "can", "box without lid"]),
    st.from_regex(r"[a-z]{1,8}( [a-z]{1,8}){0,2}", fullmatch=True),
)
# Drawn randomness shrinks to simple frames, but favours few of them; seeds spread over all.
SEEDS = st.integers(0, 2**32)
SAMPLERS = st.one_of(st.randoms(use_true_random=False), SEEDS.map(Random)).map(Sampler)
SAMPLED = settings(max_examples=examples(250), deadline=None)


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
    """The stretches of a sentence that no span covers and that are neither silent nor asides."""
    covered: set[int] = set()
    for start, end in all_spans([frame.model_dump(mode="json") for frame in command.frames]):
        assert 0 <= start < end <= len(command.text)
        covered |= set(range(start, end))
    for start, end in command.asides:
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


def read(text: str, parse: Callable[[str], Command] = parse) -> Command | None:
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
    frames = sampler.draw_sentence().frames
    assert meaning(parse(paraphrase(frames)).frames) == meaning(frames)


@SAMPLED
@given(SAMPLERS)
def test_any_phrases_of_the_same_meaning_are_read_as_the_same_frames(sampler: Sampler) -> None:
    text, frames = sampler.draw_sentence()
    assert meaning(parse(text).frames) == meaning(frames)


@SAMPLED
@given(SAMPLERS, st.randoms(use_true_random=False))
def test_spans_cover_what_is_said(sampler: Sampler, rng: Random) -> None:
    text, frames = sampler.draw_sentence()
    command = parse(restyled(text, rng))
    assert meaning(command.frames) == meaning(frames)
    assert not dropped(command)
    for frame in command.frames:
        assert frame.spans
        assert all(constraint.spans for constraint in frame.constraints)
        if frame.object is not None and frame.object.spans and frame.object.text != "its":
            start, end = frame.object.spans[0]
            said, name = " ".join(command.text[start:end].split()), frame.object.text
            assert said == name or (frame.object.ordinal and said.endswith(f" {name}"))


@SAMPLED
@given(NAMES, NAMES, st.sampled_from(["next_to", "touching", "behind"]))
def test_any_name_is_read_back(name: str, other: str, relation: Any) -> None:
    frame = Frame(
        action="push",
        object=ObjectRef(text=name),
        goal=Place(relation=relation, reference=(ObjectRef(text=other),)),
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


@settings(max_examples=examples(400), deadline=None)
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


OPENINGS = st.sampled_from(["", "push the box", "will it topple if you push it", "no,", "put it"])
THINGS = ("the box", "it", "mug", "10 cm", "30 degrees", "5 N", "2 cm/s", "3 s", "½", "-1")
OTHERS = ('"', ".", "?", "-", "'", "bananas", *LEXICON.later_words, *LEXICON.vague)
KINDS: dict[str, Sequence[str]] = {
    **{name: LEXICON.phrases_of(name) for name in (*NAME_TERMINALS, *LEXICON.terminals)},
    "things": THINGS,
    "adjectives": sorted(LEXICON.adjectives),
    "numbers": sorted(LEXICON.numbers.phrases),
    "others": sorted(OTHERS),
}
"""What sentences are made of; each kind is tried as often, however many phrases it has."""

PHRASES = st.sampled_from(sorted(KINDS)).flatmap(lambda kind: st.sampled_from(KINDS[kind]))


@settings(max_examples=examples(2000), deadline=None)
@given(OPENINGS, st.lists(PHRASES, max_size=6))
@example("will it topple if you push it", ["the box"])
@example("will it topple if you push it", ["again"])
def test_no_phrase_is_silently_dropped(opening: str, phrases: list[str]) -> None:
    command = read(" ".join([opening, *phrases]))
    assert command is None or not dropped(command)


NAMED = Parser(LEXICON).with_names(("ice tea box", "mug", "tea tin", "free bottle"))


@settings(max_examples=examples(500), deadline=None)
@given(OPENINGS, st.lists(PHRASES, max_size=6))
@example("and our show, thanks, buddy", [])
def test_any_phrases_are_read_or_refused_where_names_are_known(
    opening: str, phrases: list[str]
) -> None:
    command = read(" ".join([opening, *phrases]), NAMED.parse)
    assert command is None or command.frames


@settings(max_examples=examples(1000), deadline=None)
@given(SEEDS, st.integers(0, 9), PHRASES)
def test_no_word_of_a_damaged_sentence_is_silently_dropped(
    seed: int, damage: int, phrase: str
) -> None:
    command = read(damaged_sentence(Random(seed), damage, phrase))
    assert command is None or not dropped(command)


def damaged_sentence(rng: Random, damage: int, phrase: str) -> str:
    """A sentence that is nearly right, which is read more often than phrases in any order."""
    sampler = Sampler(rng)
    words, others = sampler.draw_sentence().text.split(), sampler.draw_sentence().text.split()
    cut = rng.randint(0, len(words))
    match damage:
        case 0 | 1 | 2:
            words = words[:cut] + words[cut + rng.randint(1, 2) :]
        case 3 | 4 | 5:
            words = words[:cut] + others[rng.randint(0, len(others)) :]
        case 6:
            words = [phrase, *words]
        case 7:
            words = [*words, phrase]
        case _:
            words = [*words[:cut], phrase, *words[cut:]]
    return " ".join(words)

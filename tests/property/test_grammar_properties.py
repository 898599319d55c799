"""Properties of the parser over sampled frames and over arbitrary text."""

from __future__ import annotations

import re
from typing import Any

from hypothesis import example, given, settings
from hypothesis import strategies as st

from grammar import ParseError, parse
from grammar.frames import (
    Close,
    ContactHeight,
    ContactRegion,
    Displace,
    Effector,
    Fast,
    Force,
    Frame,
    Gentle,
    Hard,
    Lift,
    MaxForce,
    MinForce,
    NoSpill,
    NoTopple,
    NoTouch,
    ObjectRef,
    Open,
    Parameters,
    Pour,
    Rotate,
    Slow,
    Span,
    Tilt,
    Topple,
)
from grammar.lexicon import default_lexicon
from grammar.wording import paraphrase

LEXICON = default_lexicon()
SILENT = {
    word
    for name in ("FILLER", "TAIL", "VOCATIVE", "SEPARATOR", "THE", "A", "CONTENTS")
    for phrase in LEXICON.phrases(name)
    for word in phrase.split()
} | {"i'd"}
"""Words that carry no meaning of their own."""

SINGLE = st.sampled_from(["away", "toward", "left", "right"])
PAIR = st.tuples(st.sampled_from(["away", "toward"]), st.sampled_from(["left", "right"]))
NAMES = st.one_of(
    st.sampled_from(["box", "ice tea box", "Ice-Tea box", "left box", "big hard drive", "box 2"]),
    st.sampled_from(["the odd one", "dog's bowl", "away", "7up can", "it", "tea, green", "café"]),
    st.from_regex(r"[a-z]{1,8}( [a-z]{1,8}){0,2}", fullmatch=True),
)
OBJECTS = NAMES.map(lambda name: ObjectRef(text=name))
NAMED = OBJECTS.filter(lambda ref: ref.text != "it")
LENGTHS = st.floats(1e-4, 10.0)
ANGLES = st.one_of(st.floats(1e-3, 60.0), st.integers(1, 360).map(lambda d: d * 3.14159 / 180))
FORCES = st.floats(1e-2, 1000.0)
AMOUNTS = st.sampled_from([None, "little", "lot"])


@st.composite
def displacements(draw: st.DrawFn) -> Displace:
    toward = draw(st.none() | NAMED)
    direction: Any = draw(st.none() | SINGLE | PAIR) if toward is None else None
    distance = draw(st.none() | LENGTHS)
    bound: Any = "exact"
    if distance is not None:
        bound = draw(st.sampled_from(["exact", "at_least", "at_most"]))
    return Displace(
        direction=direction,
        toward=toward,
        distance=distance,
        bound=bound,
        amount=draw(AMOUNTS) if distance is None else None,
    )


GOALS: dict[str, st.SearchStrategy[Any]] = {
    "push": displacements(),
    "pull": displacements(),
    "move": displacements(),
    "slide": displacements(),
    "topple": st.builds(Topple, direction=st.none() | SINGLE),
    "tilt": st.builds(Tilt, angle=st.none() | ANGLES, direction=st.none() | SINGLE),
    "turn": st.builds(Rotate, angle=st.none() | ANGLES, sense=st.sampled_from([None, "cw", "ccw"])),
    "lift": st.builds(Lift, height=st.none() | LENGTHS),
    "open": st.just(Open()),
    "close": st.just(Close()),
    "pour": st.builds(Pour, into=st.none() | NAMED, amount=AMOUNTS),
    "explore": st.just(Parameters()),
}
CONTACTS = st.builds(
    ContactRegion,
    face=st.sampled_from(["front", "back", "left", "right", "top"]),
    region=st.sampled_from([None, "top", "middle", "bottom"]),
    height=st.none()
    | st.builds(ContactHeight, value=LENGTHS, origin=st.sampled_from(["table", "top"])),
)
EFFECTORS = st.builds(
    Effector,
    tool=st.sampled_from(["finger", "hand", "arm"]),
    count=st.none() | st.integers(1, 10),
    side=st.sampled_from([None, "left", "right"]),
)
# One of each class, so that none repeats; those that contradict an action are tried elsewhere.
CONSTRAINTS: list[st.SearchStrategy[Any]] = [
    *(st.just(kind()) for kind in (NoSpill, Gentle, Hard, Slow, Fast)),
    *(st.builds(kind, value=FORCES) for kind in (MaxForce, MinForce, Force)),
    st.builds(NoTouch, object=NAMED),
    CONTACTS,
    EFFECTORS,
]


@st.composite
def frames(draw: st.DrawFn) -> Frame:
    action: Any = draw(st.sampled_from(sorted(GOALS)))
    constraints = [draw(c) for c in draw(st.permutations(CONSTRAINTS))[: draw(st.integers(0, 4))]]
    if action not in ("topple", "tilt") and draw(st.booleans()):
        constraints.append(NoTopple())
    return Frame(
        action=action,
        object=draw(OBJECTS),
        goal=draw(GOALS[action]),
        constraints=tuple(constraints),
    )


def without_spans(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: without_spans(part) for key, part in value.items() if key != "spans"}
    return [without_spans(part) for part in value] if isinstance(value, list) else value


def all_spans(value: Any) -> list[Span]:
    """Every span in a frame's JSON."""
    spans: list[Span] = []
    if isinstance(value, dict):
        spans += value.get("spans", [])
        value = [part for key, part in value.items() if key != "spans"]
    if isinstance(value, list):
        spans += [span for part in value for span in all_spans(part)]
    return spans


def uncovered(text: str, frame: Frame) -> set[str]:
    """The words of a sentence that no span covers."""
    covered = list(text)
    for start, end in all_spans(frame.model_dump(mode="json")):
        assert 0 <= start < end <= len(text)
        covered[start:end] = " " * (end - start)
    return set(re.findall(r"[\w°'’]+", "".join(covered).casefold()))


def refusal(text: str) -> ParseError | None:
    try:
        parse(text)
    except ParseError as error:
        return error
    return None


@settings(max_examples=400, deadline=None)
@given(frames())
def test_paraphrase_is_read_back_as_the_same_frame(frame: Frame) -> None:
    (again,) = parse(paraphrase(frame)).frames
    assert without_spans(again.model_dump(mode="json")) == without_spans(
        frame.model_dump(mode="json")
    )


@settings(max_examples=200, deadline=None)
@given(frames(), st.sampled_from(["  ", "\t", " \n "]), st.booleans())
def test_spans_lie_in_the_sentence_and_cover_its_words(
    frame: Frame, space: str, upper: bool
) -> None:
    text = space + paraphrase(frame).replace(" ", space) + " ."
    text = text.upper() if upper else text
    (read,) = parse(text).frames
    assert uncovered(text, read) <= SILENT
    assert read.object is not None
    (span,) = read.object.spans
    assert " ".join(text[slice(*span)].split()) == read.object.text
    assert read.spans
    assert all(constraint.spans for constraint in read.constraints)


@settings(max_examples=400, deadline=None)
@given(st.text(max_size=60))
@example("push the box " + "9" * 400 + " m")
@example("push the box 1e99999999999999999999 m")
@example("\ud800")
@example('"' * 500)
@example("push " + "the box " * 60)
def test_any_text_is_read_or_refused(text: str) -> None:
    error = refusal(text)
    if error is not None:
        start, end = error.span or (0, 0)
        assert error.code
        assert error.message
        assert 0 <= start <= end <= len(text)


WORDS = sorted(
    {p for name in ("VERB", *LEXICON.terminals) for p in LEXICON.phrases(name)}
    | LEXICON.later_words
    | {"box", "mug", "10", "0.5", "-1", '"', ".", "?", "bananas", "sideways", "-", "'"}
)


@settings(max_examples=1500, deadline=None)
@given(st.lists(st.sampled_from(WORDS), max_size=8), st.booleans())
def test_no_word_is_silently_dropped(words: list[str], start: bool) -> None:
    text = " ".join(["push the box", *words] if start else words)
    try:
        command = parse(text)
    except ParseError:
        return
    assert uncovered(text, command.frames[0]) <= SILENT

"""Properties of frames as input: a sentence's are taken back, others end in a code."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Iterator
from contextlib import suppress
from random import Random
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from grammar import parse
from grammar.paraphrasing.sentence_sampler import Sampler
from grammar.parser import default_parser
from nlcontrol.errors import CODES, FAMILIES, ControlError
from nlcontrol.session.frame_documents import command_of, frames_of_json
from tests.sizes import examples

SEEDS = st.integers(0, 2**32)
JUNK: list[Any] = [
    None, True, 0, -1, 1, 7, 0.5, 1e9, 1e-9, 10**400, float("nan"), float("-inf"), "", "x", "it",
    "box", "a\"b", "\x00", "\ud800", "½", "left", "word " * 200, [], [[]], {}, {"kind": "none"},
    {"": 0}, {"text": "mug"}, {"x": 0.5, "y": 1e300}, {"value": 2.0, "of": {"text": "box"}},
]  # fmt: skip
KEYS = ["kind", "spans", "id", "dialogue", "query", "negated", "colour", "noun", "object", "7"]

Place = list[str | int]


def places(value: Any, place: Place) -> Iterator[Place]:
    inner: Any = value.items() if isinstance(value, dict) else enumerate(value)
    for key, part in inner:
        yield [*place, key]
        if isinstance(part, dict | list):
            yield from places(part, [*place, key])


def at(value: Any, place: Place) -> Any:
    for key in place:
        value = value[key]
    return value


def spoilt(document: Any, rng: Random, other: Any) -> Any:
    """The document with one thing left out, put in, replaced or doubled."""
    document = copy.deepcopy(document)
    place: Any = rng.choice(list(places(document, [])))
    *outer, last = place
    part: Any = at(document, outer)
    same = [place for place in places(other, []) if place[-1] == last]
    match rng.randrange(8):
        case 0:
            del part[last]
        case 1 | 2:
            part[last] = rng.choice(JUNK)
        case 3 | 4 | 5 if same:
            part[last] = copy.deepcopy(at(other, rng.choice(same)))
        case 6 if isinstance(part, list):
            part.append(part[last])
        case _ if isinstance(part, dict):
            part[rng.choice(KEYS)] = part.pop(last)
    return document


def drawn_document(rng: Random) -> Any:
    text = Sampler(rng).draw_sentence().text
    return json.loads(parse(text).model_dump_json())


@settings(max_examples=examples(160), deadline=None)
@given(SEEDS)
def test_what_a_sentence_gave_is_taken_back(seed: int) -> None:
    command = parse(Sampler(Random(seed)).draw_sentence().text)
    document = json.loads(command.model_dump_json())
    assert command_of(document, default_parser()) == command
    bare = command_of(document["frames"], default_parser())
    assert bare.text == bare.paraphrase == command.paraphrase


@settings(max_examples=examples(400), deadline=None)
@given(SEEDS, st.integers(1, 3))
def test_any_document_is_taken_or_refused_with_its_place(seed: int, times: int) -> None:
    rng = Random(seed)
    document = drawn_document(rng)
    for _ in range(times):
        document = spoilt(document, rng, drawn_document(rng)) if document else document
    try:
        command = command_of(document, default_parser())
    except ControlError as raised:
        info = raised.info
    else:
        assert parse(command.paraphrase).paraphrase == command.paraphrase
        return
    assert info.code in CODES or info.family in FAMILIES
    assert info.path
    assert info.suggestions
    if cure := re.fullmatch(r"leave out (.*)", info.suggestions[0]):
        first = int(info.path.removeprefix("frames[").partition("]")[0])
        *outer, last = [int(key) if key.isdigit() else key for key in re.findall(r"\w+", cure[1])]
        del at(document, outer)[last]
        rest = {"frames": document["frames"][max(0, first - 1) : first + 1]}
        command_of(rest, default_parser())


@settings(max_examples=examples(200), deadline=None)
@given(st.one_of(st.text(), st.binary(), st.just("[" * 100_000), st.just("1" * 5000)))
def test_any_text_is_json_or_refused(text: str | bytes) -> None:
    with suppress(ControlError):
        frames_of_json(text)

"""A paraphrase takes other words where its usual ones would mean something else together."""

from __future__ import annotations

from random import Random

import pytest

from grammar import parse
from grammar.paraphrasing.command_wording import is_misread
from grammar.paraphrasing.sentence_sampler import Sampler
from grammar.words.lexicon import default_lexicon
from tests.property.test_grammar_properties import meaning


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ("close the second jar from the rear at the back side of the soup can",
         "close the second jar from the back that is behind the soup can"),
        ("lift the first mug from the right which is right of the jar",
         "lift the first mug from the right side that is right of the jar"),
        ("move the first mug from the left to the left of the tin",
         "move the first mug from the left side left of the tin"),
        ("push the can which is left of the block to the left of the block",
         "push the can that is left of the block to the left of the block"),
        ("push the box onto the box at the top face", "push the box onto the box on the top face"),
        ("set the mug down low down at the front",
         "set the mug down right at the bottom on the front side"),
    ],
)  # fmt: skip
def test_no_words_are_said_twice_or_join_others(said: str, words: str) -> None:
    command = parse(said)
    assert command.paraphrase == words
    assert meaning(parse(words).frames) == meaning(command.frames)


def test_sampled_words_mean_what_they_say() -> None:
    for seed in range(300):
        text, frames = Sampler(Random(seed)).draw_sentence()
        assert not is_misread(text, frames, default_lexicon())

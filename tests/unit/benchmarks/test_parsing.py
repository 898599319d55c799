"""The benchmark of parsing: it compares what all its parsers read."""

import pytest

from benchmarks.parsing import compared
from grammar.parser import default_parser
from grammar.words.lexicon import default_lexicon


@pytest.mark.slow
def test_every_parser_reads_the_sentences_that_are_compared() -> None:
    rows = compared(default_parser(), default_lexicon(), runs=1, sample=3)
    assert len(rows) == 4
    assert all(len(row.times) == len(rows[0].times) >= 3 for row in rows)

"""How fast sentences of the test set are read, and how fast refused ones are refused.

    python -m benchmarks.parsing [--runs 5]

From a sentence to its frames counts everything: the plain form, the parse, the meaning, the
paraphrase. Every sentence is timed several times, one after the other, and its best time counts, so
that a busy machine slows none of them.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from time import perf_counter

import numpy as np

from benchmarks.sentences import refused, understood
from grammar import ParseError
from grammar.parser import Parser
from grammar.words.lexicon import default_lexicon


def timed(run: Callable[[], object]) -> float:
    """The time that a call takes [s]; a refusal ends it."""
    start = perf_counter()
    with suppress(ParseError):
        run()
    return perf_counter() - start


def best_times(parser: Parser, sentences: Sequence[str], runs: int) -> list[float]:
    """The best time of each sentence [s]."""
    rounds = [[timed(partial(parser.parse, text)) for text in sentences] for _ in range(runs)]
    return [min(each) for each in zip(*rounds, strict=True)]


def main() -> None:
    options = argparse.ArgumentParser(description="How fast sentences are read.")
    options.add_argument("--runs", type=int, default=5)
    runs: int = options.parse_args().runs
    lexicon = default_lexicon()
    built = min(timed(partial(Parser, lexicon)) for _ in range(runs))
    print(f"parser built in {built:.3f} s (best of {runs})")
    parser = Parser(lexicon)
    for what, sentences in (("to frames", understood()), ("refused", refused())):
        times = best_times(parser, sentences, runs)
        middle, last = (1e3 * float(np.quantile(times, q)) for q in (0.5, 0.99))
        count = f"({len(sentences)} sentences)"
        print(f"{what}: median {middle:.2f} ms, 99th percentile {last:.2f} ms {count}")


if __name__ == "__main__":
    main()

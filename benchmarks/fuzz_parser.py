"""Coverage-guided fuzzing of the parser: any text is read or refused, and within a bounded time.

    python -m benchmarks.fuzz_parser --minutes 10 --seed 0

The corpus is the test set's sentences and some long, repetitive ones; inputs are bytes read as
UTF-8. A quarter of the mutations are libFuzzer's, with the lexicon's phrases as its dictionary; the
others work on words: they drop, double, repeat and replace them, and put in phrases or pieces of
other sentences. Only `ParseError` may come out, its span must lie within the text, and no text may
take longer than `--limit`: one that does is timed again, and its best time counts, since the
machine may be busy. Times are of processor time, with the instrumentation for coverage, which makes
the parser about twice as slow. Every finding is printed once, and the exit status is 1 if there is
any. Needs atheris (`pip install atheris`), which brings libFuzzer.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import sys
import tempfile
import time
import traceback
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

from benchmarks.sentences import refused, understood

REPEATED = (
    "the box ", "push the box and ", "and ", "without toppling it or ", "1", "1 ", '" ', '"a" ',
    "a ", "the ", "twenty ", "one hundred and ", "ice ", "of the box ", "no higher than ", "'", "-",
    "½", "1/2 ", "next to the ", "not ",
)  # fmt: skip
"""Beginnings of texts that might take longer than their length warrants."""

AGAIN = 5
"""How often a slow text is timed again."""


class Findings:
    """What is wrong with the parser, one text of each kind, and its slowest text.

    Args:
        parse: the parser.
        limit: longest time that a text may take [s].
        refusal: the one error that may come out.
    """

    def __init__(
        self, parse: Callable[[str], object], limit: float, refusal: type[Exception]
    ) -> None:
        self.kinds: dict[str, str] = {}
        self.texts = self.read = 0
        self.slowest = (0.0, "")
        self._parse, self._limit, self._refusal = parse, limit, refusal

    def check(self, text: str) -> None:
        """Parses a text and takes note of what is wrong."""
        self.texts += 1
        took = self._time(text)
        if took > self.slowest[0]:
            took = min(took, *(self._time(text) for _ in range(AGAIN)))
            self.slowest = max(self.slowest, (took, text))
            if took > self._limit:
                self._note(f"slow: {1e3 * took:.0f} ms", text)

    def _time(self, text: str) -> float:
        start = time.process_time()
        try:
            self._parse(text)
            self.read += 1
        except self._refusal as error:
            first, last = getattr(error, "span", None) or (0, 0)
            if not 0 <= first <= last <= len(text):
                self._note(f"span {first}, {last} lies outside of the text", text)
        except Exception as error:
            # One kind for each line that raises, else one fault drowns the others.
            at = traceback.extract_tb(error.__traceback__)[-1]
            self._note(f"{type(error).__name__} at {Path(at.filename).name}:{at.lineno}", text)
        return time.process_time() - start

    def _note(self, kind: str, text: str) -> None:
        if kind not in self.kinds:
            print(f"{kind}: {text!r}", flush=True)
        self.kinds[kind] = min(self.kinds.get(kind, text), text, key=len)

    def report(self) -> None:
        """Prints the shortest text of each kind, and the slowest of all."""
        took, text = self.slowest
        print(f"{self.texts} texts, {self.read} of them understood; {len(self.kinds)} findings")
        print(f"slowest: {1e3 * took:.1f} ms for {len(text)} characters: {text!r}")
        for kind, shortest in self.kinds.items():
            print(f"{kind}: {shortest!r}")
        sys.stdout.flush()


def mutated(text: str, phrases: list[str], others: list[str], rng: random.Random) -> str:
    """A text with one to four pieces dropped, repeated, replaced or put in."""
    words = text.split(" ")
    for _ in range(rng.randint(1, 4)):
        i = rng.randrange(len(words) + 1)
        other = rng.choice(others).split(" ")
        cut = rng.randrange(len(other))
        j = min(len(words), i + rng.randint(1, 3))
        match rng.randrange(6):
            case 0:
                del words[i:j]
            case 1:
                words[i:j] = words[i:j] * rng.choice((2, 3, 20))
            case 2:
                words[i:i] = rng.choice(phrases).split(" ")
            case 3:
                words[i:j] = rng.choice(phrases).split(" ")
            case 4:
                words[i:] = other[cut:]
            case _:
                words[i:i] = other[cut : cut + 4]
    return " ".join(words)


def decoded(data: bytes) -> str:
    """Bytes as a text; those that are no UTF-8 become lone surrogates."""
    return data.decode("utf-8", "surrogateescape")


def fuzz(atheris: Any, seconds: float, seed: int, limit: float) -> None:
    """Fuzzes for a time and ends the process: libFuzzer does not return."""
    folder = Path(tempfile.mkdtemp())
    with atheris.instrument_imports(include=["grammar"]):
        from grammar import ParseError
        from grammar.parser import parse
        from grammar.words.lexicon import default_lexicon
        from grammar.words.normalisation import MAX_LENGTH
    lexicon = default_lexicon()
    names = {*lexicon.terminals, *lexicon.verb_words}
    phrases = sorted(
        {p for name in names for p in lexicon.phrases_of(name)} | lexicon.reserved_words
    )
    sentences = understood() + refused()
    findings = Findings(parse, limit, ParseError)
    parse("push the box")  # the parser is built with the first sentence
    deadline = time.monotonic() + seconds

    def one(data: bytes) -> None:
        findings.check(decoded(data))
        if time.monotonic() > deadline:
            findings.report()
            shutil.rmtree(folder)
            os._exit(1 if findings.kinds else 0)

    def mutate(data: bytes, size: int, number: int) -> bytes:
        rng = random.Random(number)
        if rng.random() < 0.25:
            changed: bytes = atheris.Mutate(data, size)
            return changed
        text = mutated(decoded(data), phrases, sentences, rng)
        return text.encode("utf-8", "surrogateescape")[:size]

    corpus, words = folder / "corpus", folder / "words"
    corpus.mkdir()
    long = [(text * MAX_LENGTH)[:MAX_LENGTH] for text in REPEATED]
    long += [f"push {text}"[:MAX_LENGTH] for text in long]
    for i, text in enumerate((*sentences, *long)):
        (corpus / str(i)).write_text(text, encoding="utf-8")
    words.write_text("\n".join(f'"{p}"' for p in phrases if p.isascii() and '"' not in p))
    # A seed of 0 means to libFuzzer that it may choose one.
    options = [f"-seed={seed + 1}", f"-dict={words}", "-max_len=2000", "-verbosity=0"]
    atheris.Setup([sys.argv[0], str(corpus), *options], one, custom_mutator=mutate)
    atheris.Fuzz()


def main() -> None:
    parser = argparse.ArgumentParser(description="Coverage-guided fuzzing of the parser.")
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--limit", type=float, default=50.0, help="longest time of a text [ms]")
    options = parser.parse_args()
    try:
        atheris = import_module("atheris")
    except ImportError:
        raise SystemExit("the fuzzer needs atheris: pip install atheris") from None
    fuzz(atheris, 60.0 * options.minutes, options.seed, options.limit / 1e3)


if __name__ == "__main__":
    main()

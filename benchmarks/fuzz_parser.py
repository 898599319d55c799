"""Fuzzing of the parser: any text is read or refused, and within a bounded time.

    python -m benchmarks.fuzz_parser --minutes 10 --texts 1000000 --seed 0

The first part, of some minutes, is guided by coverage: atheris (`pip install atheris`, it brings
libFuzzer) starts from the test set's sentences and some long, repetitive ones, and keeps each text
that goes a new way through the parser. Inputs are bytes read as UTF-8. A quarter of its mutations
are libFuzzer's, with the lexicon's phrases as its dictionary; the others work on words: they drop,
double, repeat and replace them, and put in phrases or pieces of other sentences. The second part
goes on from what the first one kept, until so many texts were tried in both, and is several times
as fast, since it measures no coverage: a quarter of its mutations are of characters, the others of
words. Texts of even length are read as if the names of some objects were known. Only `ParseError`
may come out, its span must lie within the text, and no text may take longer than `--limit`: one
that does is timed again, and its best time counts, since the machine may be busy. Times are of
processor time; measuring coverage makes the parser about twice as slow. Every finding is printed
once, and the exit status is 1 if there is any.
"""

from __future__ import annotations

import argparse
import os
import random
import subprocess
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

NAMES = ("ice tea box", "mug", "tea tin", "free bottle")
"""Objects that are known in every other text."""

MARKS = " .,;!?'\"-0123456789½°%\n\t\u200b\u0301éßİ"
"""Characters that are put in more often than others."""

LONGEST = 2000
"""Longest text [bytes, without coverage code points]; from 500 code points on none is read."""

PROGRESS = 50_000
"""After so many texts it is told how many there were."""

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
        self.report_progress()
        print(f"slowest: {1e3 * took:.1f} ms for {len(text)} characters: {text!r}")
        for kind, shortest in self.kinds.items():
            print(f"{kind}: {shortest!r}")
        sys.stdout.flush()

    def report_progress(self) -> None:
        """Prints how many texts were tried."""
        found = len(self.kinds)
        print(f"{self.texts} texts, {self.read} of them understood; {found} findings", flush=True)


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


def misspelt(text: str, rng: random.Random) -> str:
    """A text with one to four characters dropped, doubled, exchanged or put in."""
    letters = [*text]
    for _ in range(rng.randint(1, 4)):
        i = rng.randrange(len(letters) + 1)
        match rng.randrange(4):
            case 0:
                del letters[i : i + rng.randint(1, 3)]
            case 1:
                letters[i:i] = letters[i : i + 1] * rng.choice((1, 2, 30))
            case 2:
                letters[i : i + 2] = letters[i : i + 2][::-1]
            case _:
                letters[i:i] = rng.choice(MARKS) if rng.random() < 0.7 else chr(_code(rng))
    return "".join(letters)


def _code(rng: random.Random) -> int:
    """Any code point, the lower ones more often; lone surrogates are among them."""
    return rng.randrange(2 ** rng.randint(5, 16))


def decoded(data: bytes) -> str:
    """Bytes as a text; those that are no UTF-8 become lone surrogates."""
    return data.decode("utf-8", "surrogateescape")


def known_phrases() -> list[str]:
    """The phrases of the language."""
    from grammar.words.lexicon import default_lexicon

    lexicon = default_lexicon()
    names = {*lexicon.terminals, *lexicon.verb_words}
    return sorted({p for name in names for p in lexicon.phrases_of(name)} | lexicon.reserved_words)


def parse_by_length() -> Callable[[str], object]:
    """The parser of texts of odd length, and that of the others, which knows names of objects."""
    from grammar.parser import parse, parser_for

    known = parser_for(NAMES)
    return lambda text: parse(text) if len(text) % 2 else known.parse(text)


def fuzz_guided(atheris: Any, folder: Path, seconds: float, seed: int, limit: float) -> None:
    """Fuzzes for a time, guided by coverage, and ends the process: libFuzzer does not return.

    Args:
        atheris: the package.
        folder: gets the corpus, the dictionary, and the number of texts.
        seconds: how long.
        seed: of libFuzzer.
        limit: longest time that a text may take [s].
    """
    with atheris.instrument_imports(include=["grammar"]):
        from grammar import ParseError
        from grammar.words.normalisation import MAX_LENGTH

        parse = parse_by_length()
    phrases, sentences = known_phrases(), understood() + refused()
    findings = Findings(parse, limit, ParseError)
    parse("push the box")  # the parser is built with the first sentence
    deadline = time.monotonic() + seconds

    def one(data: bytes) -> None:
        findings.check(decoded(data))
        if time.monotonic() > deadline:
            findings.report()
            (folder / "texts").write_text(str(findings.texts))
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
    options = [f"-seed={seed + 1}", f"-dict={words}", f"-max_len={LONGEST}", "-verbosity=0"]
    atheris.Setup([sys.argv[0], str(corpus), *options], one, custom_mutator=mutate)
    atheris.Fuzz()


def fuzz_fast(corpus: list[str], texts: int, seed: int, limit: float) -> bool:
    """Tries mutations of texts without measuring coverage; whether nothing was found.

    Args:
        corpus: the texts.
        texts: how many mutations.
        seed: of the choice of them.
        limit: longest time that a text may take [s].
    """
    from grammar import ParseError

    parse = parse_by_length()
    phrases, rng = known_phrases(), random.Random(seed)
    findings = Findings(parse, limit, ParseError)
    parse("push the box")
    while findings.texts < texts:
        text = rng.choice(corpus)
        changed = rng.random() < 0.25
        text = misspelt(text, rng) if changed else mutated(text, phrases, corpus, rng)
        findings.check(text[:LONGEST])
        if findings.texts % PROGRESS == 0:
            findings.report_progress()
    findings.report()
    return not findings.kinds


def main() -> None:
    parser = argparse.ArgumentParser(description="Fuzzing of the parser, in two parts.")
    parser.add_argument("--minutes", type=float, default=10.0, help="of the part with coverage")
    parser.add_argument("--texts", type=int, default=0, help="number of texts in both parts")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--limit", type=float, default=50.0, help="longest time of a text [ms]")
    parser.add_argument("--guided", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    limit = options.limit / 1e3
    if options.guided:
        try:
            atheris = import_module("atheris")
        except ImportError:
            raise SystemExit("the guided part needs atheris: pip install atheris") from None
        fuzz_guided(atheris, options.guided, 60.0 * options.minutes, options.seed, limit)
    corpus, tried, sound = understood() + refused(), 0, True
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if options.minutes > 0.0:
            guided = (*sys.orig_argv, "--guided", name)
            sound = subprocess.run(guided, check=False).returncode == 0
            if not (folder / "texts").exists():
                raise SystemExit(1)
            tried = int((folder / "texts").read_text())
            corpus = [decoded(path.read_bytes()) for path in sorted((folder / "corpus").iterdir())]
            print(f"{len(corpus)} texts were kept", flush=True)
    if tried < options.texts:
        sound = fuzz_fast(corpus, options.texts - tried, options.seed, limit) and sound
    raise SystemExit(not sound)


if __name__ == "__main__":
    main()

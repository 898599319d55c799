"""How many paraphrases of a command are read as the command itself.

    python -m benchmarks.paraphrases --seed 0              # the words it was made with
    python -m benchmarks.paraphrases second --seed 0       # words that judged it once
    python -m benchmarks.paraphrases third --seed 0        # the same, of another hand

Commands are said in other ways by the kinds of paraphrase that make vision-language models stumble:
other words, another structure, politeness, disfluency, another order, typing errors. A paraphrase
is read as the same, refused, or read as something else. Of typing errors one that is refused where
it stands counts as read, since nothing is guessed. A name that is none of those on the table is
refused when it is looked up, so it counts as refused.
"""

from __future__ import annotations

import argparse
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from random import Random
from typing import Literal

from benchmarks.paraphrases.speaker import MOVING, NAMES, OTHERS, Speaker
from benchmarks.sentences import without_spans
from grammar import ParseError, parse
from grammar.frames.command import Frame
from grammar.words.lexicon import default_lexicon

Reading = Literal["same", "refused", "differently"]

KINDS = ("lexical", "structural", "politeness", "disfluency", "order", "typing")


def known_words() -> frozenset[str]:
    """Words of the language, and of the names of objects; no typing error makes one of them."""
    lexicon = default_lexicon()
    terminals = [*lexicon.terminals, *lexicon.verb_words]
    known = {w for t in terminals for phrase in lexicon.phrases_of(t) for w in phrase.split()}
    return frozenset(known | lexicon.reserved_words | set(" ".join((*NAMES, *OTHERS)).split()))


def reading(text: str, plain: str, kind: str) -> Reading:
    """What a paraphrase is read as, beside the plain words of the command.

    Args:
        text: the paraphrase.
        plain: the command in plain words, which are read as it is meant.
        kind: of the paraphrase.
    """
    meant = parse(plain).frames
    try:
        frames = parse(text).frames
    except ParseError as error:
        start, end = error.span or (0, len(text))
        wrong = set(re.findall(r"[a-z]+", text)) - set(re.findall(r"[a-z]+", plain))
        located = any(word in text[max(0, start - 20) : end + 20] for word in wrong)
        return "same" if kind == "typing" and located else "refused"
    said = _meaning(frames)
    if said == _meaning(meant):
        return "same"
    if set(re.findall(r"'text': [\"'](.+?)[\"'][,}]", said)) <= {*NAMES, *OTHERS, "it", "its"}:
        return "differently"
    return "same" if kind == "typing" else "refused"


def _meaning(frames: Sequence[Frame]) -> str:
    """Frames without the places of their words; constraints in any order, moving in any way.

    All things stand on the table, so that "8 cm above the table" is as high as "8 cm".
    """
    plain = []
    for frame in frames:
        dumped = without_spans(frame.model_dump(exclude_defaults=True))
        dumped["constraints"] = sorted(map(repr, dumped.get("constraints", ())))
        if frame.goal.kind == "lift" and frame.goal.above == "table":
            del dumped["goal"]["above"]
        if dumped.get("action") in MOVING and frame.goal.kind != "none":
            dumped["action"] = "move"
        plain.append(dumped)
    return repr(plain)


def paraphrases(words: str, seed: int, count: int) -> Iterator[tuple[str, str, Reading]]:
    """For each paraphrase its kind, its text, and what it is read as."""
    speaker = Speaker(words, Random(seed), known_words())
    for i in range(count):
        kind, said = KINDS[i % len(KINDS)], speaker.command()
        text = speaker.paraphrase_of(said, kind)
        yield kind, text, reading(text, speaker.plain(said), kind)


def main() -> None:
    options = argparse.ArgumentParser(description="How paraphrases of a command are read.")
    lists = ("developing", "second", "third")
    options.add_argument("words", nargs="?", choices=lists, default="developing")
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--count", type=int, default=4200)
    options.add_argument("--show", type=int, default=0, help="failures of each kind to print")
    chosen = options.parse_args()
    table: Counter[tuple[str, str]] = Counter()
    for kind, text, came in paraphrases(chosen.words, chosen.seed, chosen.count):
        table[kind, came] += 1
        if came != "same" and table[kind, came] <= chosen.show:
            print(f"{kind}, {came}: {text}")
    print(f"{chosen.count} paraphrases, seed {chosen.seed}, words {chosen.words}")
    for kind in (*KINDS, "all"):
        row = [
            sum(n for (k, came), n in table.items() if came == column and kind in (k, "all"))
            for column in ("same", "refused", "differently")
        ]
        print(f"{kind:11} same {row[0]:5}  refused {row[1]:5}  differently {row[2]:5}")


if __name__ == "__main__":
    main()

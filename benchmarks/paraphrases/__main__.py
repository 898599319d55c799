"""How many paraphrases of a command are read as the command itself.

    python -m benchmarks.paraphrases --seed 0              # the words it was made with
    python -m benchmarks.paraphrases second --seed 0       # words that judged it once
    python -m benchmarks.paraphrases third --seed 0        # the same, of another hand

Commands are said in other ways by the kinds of paraphrase that make vision-language models stumble:
other words, another structure, politeness, disfluency, another order, typing errors. A paraphrase
is read as the same, refused, or read as something else.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterator
from random import Random

from benchmarks.paraphrases import developing_speaker as developing
from benchmarks.paraphrases import judging_speaker as judging
from benchmarks.paraphrases.readings import Reading, reading
from grammar.words.lexicon import default_lexicon

KINDS = ("lexical", "structural", "politeness", "disfluency", "order", "typing")


def known_words() -> frozenset[str]:
    """Words of the language, and of the names of objects; no typing error makes one of them."""
    lexicon = default_lexicon()
    terminals = [*lexicon.terminals, *lexicon.verb_words]
    known = {w for t in terminals for phrase in lexicon.phrases_of(t) for w in phrase.split()}
    names = (*developing.NAMES, *developing.OTHERS, *judging.NAMES, *judging.OTHERS)
    return frozenset(known | lexicon.reserved_words | {w for n in names for w in n.split()})


def paraphrases(words: str, seed: int, count: int) -> Iterator[tuple[str, str, Reading]]:
    """For each paraphrase its kind, its text, and what it is read as."""
    rng, known = Random(seed), known_words()
    for i in range(count):
        kind = KINDS[i % len(KINDS)]
        if words != "developing":
            said = judging.drawn_phrases(rng)
            speaker = judging.JudgingSpeaker(rng, known, f"{words}_developing")
            text, plain = speaker.paraphrase_of(said, kind), speaker.plain(said)
            names = {*judging.NAMES, *judging.OTHERS}
        else:
            case, by = developing.drawn_case(rng), developing.DevelopingSpeaker(rng, known)
            text, plain = by.paraphrase_of(case, kind), by.plain(case)
            names = {*developing.NAMES, *developing.OTHERS}
        yield kind, text, reading(text, plain, kind, names)


def main() -> None:
    options = argparse.ArgumentParser(description="How paraphrases of a command are read.")
    options.add_argument("words", nargs="?", choices=("developing", "second", "third"),
                         default="developing")  # fmt: skip
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

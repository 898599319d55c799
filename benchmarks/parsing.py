"""How fast sentences are read, beside the same grammar under lark's Earley parser in the same run.

    python -m benchmarks.parsing [--runs 5] [--sample 200]

The sentences are those of the test set that are understood. From a sentence to its frames counts
everything: the plain form, the parse, the meaning, the paraphrase. Trees begin with the plain form
and stop at the parse tree, for a sample of the sentences (every so-manieth), since Earley takes
long; nothing else is left out. Earley reads the rules of grammar/phrases/nlcontrol.lark twice: with
the tokens that the LALR parser was given (its lexer cannot be asked without an LALR state; the time
to find them is not counted), and with lark's dynamic lexer, for which the lexicon's phrases are
made into regular expressions. Every sentence is timed several times by one parser after the other,
and its best time counts, so that a busy machine slows none of them; a ratio is the median of the
sentences' own ratios.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
from lark import Lark, Token
from lark.lexer import Lexer

from benchmarks.sentences import understood
from grammar.parser import Parser
from grammar.phrases.lalr_parser import RULES, LalrParser, Tree, UnexpectedTokenError, parse_table
from grammar.words.lexicon import NAME_TERMINALS, Lexicon, default_lexicon
from grammar.words.normalisation import normalise
from grammar.words.numerals import DIGITS
from grammar.words.phrase_lexer import PhraseLexer

_QUOTED = r'"[^"]*[^" ][^"]*"'
_WORD = r'[^\W_][^ "]*'


class Tokens(Lexer):
    """Hands on tokens that were found before."""

    def __init__(self, _: object) -> None:
        pass

    def lex(self, tokens: Any) -> Iterator[Token]:  # type: ignore[override]
        """The tokens."""
        return iter(tokens)


@dataclass(frozen=True)
class Row:
    """One parser's speed over some sentences.

    Attributes:
        what: what was timed.
        times: best time of each sentence [s].
    """

    what: str
    times: list[float]

    def __str__(self) -> str:
        middle, last = (1e3 * float(np.quantile(self.times, q)) for q in (0.5, 0.99))
        count = f"({len(self.times)} sentences)"
        return f"{self.what}: median {middle:.2f} ms, 99th percentile {last:.2f} ms {count}"


def lalr(lexicon: Lexicon) -> LalrParser:
    """The parser of `grammar.parser`, as far as the tree."""
    return LalrParser(parse_table(), PhraseLexer(lexicon))


def tokens_of(tree: Tree) -> list[Token]:
    """The tokens of a tree as those of lark."""
    return [Token(t.type, str(t), t.start_pos, end_pos=t.end_pos) for t in tree.leaves()]


def earley(lexicon: Lexicon) -> Lark:
    """The same rules under Earley, for tokens that are found."""
    return _lark(lexicon.declarations(), parser="earley", lexer=Tokens)


def earley_dynamic(lexicon: Lexicon) -> Lark:
    """The same rules under Earley with its own lexer."""
    terminals = {
        "QUOTED": _QUOTED,
        "WORD": _WORD,
        "KNOWN": "|".join(map(re.escape, lexicon.names)) or r"\x00",  # no text has that
        "NUMBER": DIGITS.pattern,
        "NUMBER_WORD": lexicon.numbers.pattern.pattern,
    }
    for name in (*NAME_TERMINALS, *lexicon.terminals):
        terminals[name] = "|".join(re.escape(phrase) for phrase in lexicon.phrases_of(name))
    # A number may have its unit glued to it; all else ends where a word does.
    ends = {name: "" if name == "NUMBER" else "(?= |$)" for name in terminals}
    patterns = {name: text.replace("/", r"\/") for name, text in terminals.items()}
    made = [f"{name}: /(?:{pattern}){ends[name]}/" for name, pattern in patterns.items()]
    return _lark("\n".join([*made, '%ignore " "']), parser="earley", lexer="dynamic")


def _lark(terminals: str, **options: Any) -> Lark:
    rules = RULES.read_text(encoding="utf-8")
    return Lark(f"{rules}\n{terminals}", maybe_placeholders=False, **options)


def is_plain(sentence: str, table: LalrParser, lexicon: Lexicon) -> bool:
    """Check for a sentence that the bare rules read: they know no asides and no other words."""
    try:
        table.parse(normalise(sentence, lexicon.contractions).text)
    except UnexpectedTokenError:
        return False
    return True


def timed(run: Callable[[], object]) -> float:
    """The time that a call takes [s]."""
    start = perf_counter()
    run()
    return perf_counter() - start


def to_frames(parser: Parser, runs: int) -> Row:
    """From a sentence to its frames, for the whole test set."""
    ways = [partial(parser.parse, sentence) for sentence in understood()]
    times = [[timed(way) for way in ways] for _ in range(runs)]
    return Row("to frames", [min(each) for each in zip(*times, strict=True)])


def compared(parser: Parser, lexicon: Lexicon, runs: int, sample: int) -> list[Row]:
    """To frames, and to a tree by LALR, by Earley with its tokens, by Earley with its own lexer."""
    table, chart, dynamic = lalr(lexicon), earley(lexicon), earley_dynamic(lexicon)
    sentences = [sentence for sentence in understood() if is_plain(sentence, table, lexicon)]
    best: list[list[float]] = []
    for sentence in sentences[:: max(1, len(sentences) // sample)]:
        text = normalise(sentence, lexicon.contractions).text
        tokens: Any = tokens_of(table.parse(text))
        ways: list[Callable[[], object]] = [
            partial(parser.parse, sentence),
            partial(table.parse, text),
            partial(chart.parse, tokens),
            partial(dynamic.parse, text),
        ]
        best.append([min(timed(way) for _ in range(runs)) for way in ways])
    names = ("to frames", "LALR tree", "Earley tree, the same tokens", "Earley tree, dynamic lexer")
    return [Row(*row) for row in zip(names, map(list, zip(*best, strict=True)), strict=True)]


def main() -> None:
    options = argparse.ArgumentParser(description="How fast sentences are read.")
    options.add_argument("--runs", type=int, default=5)
    options.add_argument("--sample", type=int, default=200, help="sentences that Earley reads")
    runs, sample = vars(options.parse_args()).values()
    lexicon = default_lexicon()
    parser = Parser(lexicon)
    built = min(timed(partial(Parser, lexicon)) for _ in range(runs))
    print(f"parser built in {built:.3f} s (best of {runs})")
    print(to_frames(parser, runs))
    frames, table, *charts = compared(parser, lexicon, runs, sample)
    print(f"{frames}\n{table}")
    for chart in charts:
        tree, all_ = (
            median(b / a for a, b in zip(ours.times, chart.times, strict=True))
            for ours in (table, frames)
        )
        print(f"{chart}; {tree:.0f} times the LALR tree, {all_:.0f} times all the way to frames")


if __name__ == "__main__":
    main()

"""Whether anything is done although words that forbid, postpone or restrict it are not read.

    python -m benchmarks.words_of_effect developing --seed 0
    python -m benchmarks.words_of_effect judging --seed 0      # clauses of another hand

A clause that has an effect (a condition, a time, a veto, a report, another addressee, an exception,
a retraction) is said before, into, or behind a command of the test set or of the sampler. Such a
sentence may be refused, it may ask, or its words may set something in the frames, where the clause
happens to be one that the language has. What must not be is a command of whose clause nothing is
left: the same frames as without it, or frames in which the word stands in no part. Those are
counted as acts against the words. Every sentence is read twice, by itself and as if the names of
its objects stood on the table; a name that nothing there has is refused at the table.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from random import Random
from typing import NamedTuple

import yaml
from pydantic import BaseModel

from benchmarks.sentences import understood, without_spans
from grammar.errors import ParseError
from grammar.frames.command import Command, ObjectRef, Span, references_in
from grammar.paraphrasing.sentence_sampler import random_sentences
from grammar.parser import Parser, default_parser, parser_for

FOLDER = Path(__file__).parent
CLAUSES = ("developing", "opened", "judging")
SILENT = frozenset({"stop", "thank"})
"""Remarks upon which nothing moves."""


class Clause(NamedTuple):
    """Words with an effect.

    Attributes:
        kind: what they do to a command.
        place: `before` it, `into` it behind its object, or `after` it.
        words: the words, with the marks around them.
        effect: those that have the effect.
    """

    kind: str
    place: str
    words: str
    effect: str


class Case(NamedTuple):
    """A sentence with a clause that has an effect.

    Attributes:
        text: the whole sentence.
        clause: what was said with the command.
        effect: where its effective words stand in the text.
        command: what the sentence without it is read as.
    """

    text: str
    clause: Clause
    effect: Span
    command: Command


def clauses(name: str) -> list[Clause]:
    """The clauses of a list."""
    rows = yaml.safe_load((FOLDER / f"{name}_clauses.yaml").read_text(encoding="utf-8"))
    return [Clause(**row) for row in rows]


def commands(seed: int) -> list[Command]:
    """Plain commands that move something, of the test set and as many of the sampler."""
    parser = default_parser()
    listed = [c for text in understood() if (c := parser.command_if_read(text)) and _moves(c)]
    drawn = (sample.text for sample in random_sentences(seed))
    read = (c for text in drawn if (c := parser.command_if_read(text)) and _moves(c))
    return [*listed, *islice(read, len(listed))]


def cases(name: str, seed: int) -> Iterator[Case]:
    """Sentences with the clauses of a list, without end, each clause as often as any other."""
    rng, every, said = Random(seed), commands(seed), clauses(name)
    while True:
        rng.shuffle(said)
        for clause in said:
            command = rng.choice(every)
            if (text := _said_together(command, clause)) is not None:
                start = text.index(clause.words.strip()) + clause.words.strip().index(clause.effect)
                yield Case(text, clause, (start, start + len(clause.effect)), command)


def acts_against_words(read: Command, case: Case) -> bool:
    """Check for a command of which the effective words of a case have set nothing."""
    meant, frames = (without_spans(c.model_dump()["frames"]) for c in (case.command, read))
    if frames == meant:
        return True
    setting = (span for frame in read.frames for span in _spans_that_set(frame))
    return not any(start < case.effect[1] and case.effect[0] < end for start, end in setting)


def outcome_of(parser: Parser, case: Case, names: set[str]) -> tuple[str, Command | None]:
    """What becomes of a case, and what it is read as: refused, asks, sets something, or acts.

    Args:
        parser: what reads it.
        case: a sentence.
        names: of what stands on the table.
    """
    try:
        read = parser.parse(case.text)
    except ParseError:
        return "refused", None
    if not parser_for(names).knows_names_of(read):
        return "refused at the table", read
    if not _moves(read):
        return "asks", read
    return "acts" if acts_against_words(read, case) else "sets something", read


def _said_together(command: Command, clause: Clause) -> str | None:
    """The sentence of a command and a clause; None if the command has no place for it."""
    text = command.text.rstrip(" .!")
    if clause.place == "before":
        return f"{clause.words} {text}"
    if clause.place == "after":
        return f"{text}{clause.words}"
    named = command.frames[0].object
    end = max((last for _, last in named.spans), default=len(text)) if named else len(text)
    rest = text[end:].lstrip(" ,")
    return f"{text[:end]}, {clause.words}, {rest}" if rest else None


def _moves(command: Command) -> bool:
    return any(f.query is None and f.dialogue not in SILENT for f in command.frames)


def _spans_that_set(part: BaseModel) -> Iterator[Span]:
    """The places of the words of a frame, but those that only name its objects."""
    if isinstance(part, ObjectRef):
        return
    yield from getattr(part, "spans", ())
    for value in vars(part).values():
        for inner in value if isinstance(value, tuple) else (value,):
            if isinstance(inner, BaseModel):
                yield from _spans_that_set(inner)


def main() -> None:
    options = argparse.ArgumentParser(description="What is done against words that are said.")
    options.add_argument("clauses", choices=CLAUSES)
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--count", type=int, default=3000)
    options.add_argument("--show", type=int, default=0, help="acts and other readings to print")
    chosen = options.parse_args()
    counts, by_kind, shown = Counter[str](), Counter[str](), Counter[str]()
    for case in islice(cases(chosen.clauses, chosen.seed), chosen.count):
        names = {ref.text for frame in case.command.frames for ref in references_in(frame)}
        for parser in (default_parser(), parser_for(names)):
            outcome, read = outcome_of(parser, case, names)
            counts[outcome] += 1
            by_kind[case.clause.kind] += outcome == "acts"
            if outcome in ("acts", "sets something") and shown[outcome] < chosen.show:
                shown[outcome] += 1
                print(f"{outcome}: {case.text!r} -> {read and read.paraphrase!r}")
    print(", ".join(f"{outcome} {count}" for outcome, count in sorted(counts.items())))
    print("acts by kind: " + (", ".join(f"{k} {n}" for k, n in by_kind.items() if n) or "none"))
    raise SystemExit(counts["acts"] > 0)


if __name__ == "__main__":
    main()

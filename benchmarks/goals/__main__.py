"""Draws cases of a suite, runs them in worker processes, and prints what came of them.

    python -m benchmarks.goals --cases 200 --record goals.jsonl --confirm 30
    python -m benchmarks.goals --cases 20 --kinds rotate,tilt --no-run
    python -m benchmarks.goals hard --cases 40 --execute-every 2 --record hard.jsonl --confirm 10
    python -m benchmarks.goals several --kinds "swap,out of" --cases 6 --plan-only
    python -m benchmarks.goals talks --seed 501 --cases 20 --confirm 1 --record talks.jsonl
    python -m benchmarks.goals hands --kinds open --seeds 20

A case depends on its suite, seed and number alone: the options choose among them. With `--record`
results are kept as they come, and a broken run goes on where it was.
"""

from __future__ import annotations

import argparse
import itertools
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import Any, NamedTuple, get_args

import numpy as np

from benchmarks.goals import cases, fixed, tables, talks
from benchmarks.goals.drawn_worlds import SETTINGS
from benchmarks.goals.refusal_judge import confirmed
from benchmarks.goals.sentences import KINDS, Job, Kind, kind_of, said
from benchmarks.goals.wishes import WISHED
from benchmarks.record import Kept, carried_out


class Suite(NamedTuple):
    """Cases that are drawn, run and counted in one way.

    Attributes:
        jobs: those that the options choose.
        run: carries one out.
        result: class of what comes of it.
        report: tells of all.
        line: tells of one.
        seeds, cases: how many if nobody says it.
        kinds: that may be chosen.
    """

    jobs: Callable[[argparse.Namespace], Sequence[Any]]
    run: Callable[[Any], Any]
    result: type[Kept[Any]]
    report: Callable[[Sequence[Any]], str]
    line: Callable[[Any], str]
    seeds: int
    cases: int
    kinds: Sequence[str]


def chosen(options: argparse.Namespace) -> list[Job]:
    """The first cases of each seed that the options choose."""
    seeds = range(options.seed, options.seed + options.seeds)
    fitting = (_fitting(seed, options) for seed in seeds)
    return [job for each in fitting for job in itertools.islice(each, options.cases)]


def _fitting(seed: int, options: argparse.Namespace) -> Iterator[Job]:
    for number in itertools.count(options.first):
        executed = not options.plan_only and _is_executed(seed, number, options)
        job = Job(seed, number, options.suite, executed)
        if not options.kinds or kind_of(job) in options.kinds:
            yield job


def _is_executed(seed: int, number: int, options: argparse.Namespace) -> bool:
    """Whether a case is among those, one of so many, that are carried out."""
    every: int = options.execute_every
    if options.suite == "several":
        return number // len(WISHED) % every == 0
    return bool(np.random.default_rng((seed, number, 1)).random() * every < 1.0)


def _line(done: cases.Done) -> str:
    return f"{done.job} {done.kind} {done.status}: {done.text}: {done.message}".rstrip(": ")


def _drawn(number: int, kinds: Sequence[str]) -> Suite:
    return Suite(chosen, cases.run, cases.Done, tables.report, _line, 1, number, kinds)


def _fixed(suite: fixed.Suite, seeds: int) -> Suite:
    kinds = tuple(fixed.SENTENCES[suite])
    return Suite(fixed.jobs, fixed.run, fixed.Done, fixed.report, fixed.line, seeds, 1, kinds)


SUITES = {
    "roomy": _drawn(len(KINDS), KINDS),
    "hard": _drawn(len(KINDS), get_args(Kind)),
    "several": _drawn(len(WISHED), WISHED),
    "talks": Suite(
        talks.jobs, talks.talk, talks.Talk, talks.report, talks.line, 1, len(SETTINGS), ()
    ),
    "hands": _fixed("hands", 20),
    "paper": _fixed("paper", 20),
    "ten": _fixed("ten", 10),
    "wrong_beliefs": _fixed("wrong_beliefs", 20),
}


def parsed(arguments: Sequence[str] | None = None) -> argparse.Namespace:
    """Options, with what the suite takes if they do not say it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("suite", choices=SUITES, nargs="?", default="roomy")
    parser.add_argument("--seed", type=int, default=0, help="the first one")
    parser.add_argument("--seeds", type=int, help="how many")
    parser.add_argument("--cases", type=int, help="of each seed")
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--kinds", help="of goals, or names of fixed sentences, with commas")
    parser.add_argument("--plan-only", action="store_true", help="carry nothing out")
    parser.add_argument(
        "--execute-every", type=int, default=1, metavar="N", help="carry one of N out, by seed"
    )
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--record", type=Path, help="file of JSON lines")
    parser.add_argument("--no-run", action="store_true", help="list the sentences only")
    parser.add_argument(
        "--confirm", type=int, default=0, metavar="N", help="look for N of the refused"
    )
    parser.add_argument("--tries", type=int, default=30, help="roll-outs of a round of that search")
    options = parser.parse_args(arguments)
    suite = SUITES[options.suite]
    options.seeds = suite.seeds if options.seeds is None else options.seeds
    options.cases = suite.cases if options.cases is None else options.cases
    options.kinds = [kind.strip() for kind in options.kinds.split(",")] if options.kinds else []
    if set(options.kinds) - set(suite.kinds):
        parser.error(f"kinds are {', '.join(suite.kinds)}")
    if options.no_run and suite.result is not cases.Done:
        parser.error("sentences are listed of roomy, hard and several")
    return options


def main(executor: Executor | None = None) -> int:
    """Runs what the options choose and prints the tables; 1 if a fixed sentence fails."""
    options = parsed()
    suite = SUITES[options.suite]
    jobs = suite.jobs(options)
    if options.no_run:
        for job in jobs:
            scene, sentence = said(job)
            label = "" if sentence.sensible else " (blind)"
            print(f"{job} {sentence.kind}{label} ({len(scene.objects)} objects): {sentence.text}")
        return 0
    where: dict[str, Any] = {
        "executor": executor,
        "workers": options.workers,
        "record": options.record,
    }
    done = carried_out(
        suite.run,
        jobs,
        suite.result,
        told=lambda one: print(suite.line(one), file=sys.stderr, flush=True),
        **where,
    )
    results: list[Any] = list(done.values())
    print(suite.report(results), flush=True)
    if options.confirm and suite.result is cases.Done:
        print("\n" + confirmed(results, options.confirm, tries=options.tries, **where))
    return int(any(isinstance(one, fixed.Done) and one.status != "done" for one in results))


if __name__ == "__main__":
    sys.exit(main())

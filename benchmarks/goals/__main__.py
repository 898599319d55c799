"""Draws cases, runs them in worker processes, and prints what came of them.

    python -m benchmarks.goals --cases 200 --record goals.jsonl
    python -m benchmarks.goals --cases 200 --record goals.jsonl --confirm 30
    python -m benchmarks.goals --cases 20 --kinds rotate,tilt --no-run
    python -m benchmarks.goals --hard --cases 40 --execute-every 2 --record hard.jsonl --confirm 10

A case depends on its seed and number alone: the options choose among them. With `--record` results
are kept as they come, and a broken run goes on where it was.
"""

from __future__ import annotations

import argparse
import itertools
import sys
from collections.abc import Iterator
from concurrent.futures import Executor
from pathlib import Path
from typing import get_args

import numpy as np

from benchmarks.goals.cases import Done, run
from benchmarks.goals.confirm import confirmed
from benchmarks.goals.sentences import KINDS, Kind, kind_of, said
from benchmarks.goals.tables import report
from benchmarks.goals.worlds import Job
from benchmarks.record import carried_out


def chosen(options: argparse.Namespace) -> list[Job]:
    """The first cases of each seed that the options choose."""
    seeds = range(options.seed, options.seed + options.seeds)
    fitting = (_fitting(s, options) for s in seeds)
    return [job for each in fitting for job in itertools.islice(each, options.cases)]


def _fitting(seed: int, options: argparse.Namespace) -> Iterator[Job]:
    for number in itertools.count(options.first):
        executed = not options.plan_only and _is_drawn(seed, number, options.execute_every)
        job = Job(seed, number, options.hard, executed)
        if kind_of(job) in options.kinds:
            yield job


def _is_drawn(seed: int, number: int, every: int) -> bool:
    """Whether a case is among those, one of so many, that are carried out."""
    return bool(np.random.default_rng((seed, number, 1)).random() * every < 1.0)


def _listed(text: str) -> list[str]:
    return [part.strip() for part in text.split(",")]


def _kinds(text: str) -> list[str]:
    if set(_listed(text)) - set(get_args(Kind)):
        raise argparse.ArgumentTypeError(f"kinds are {', '.join(get_args(Kind))}")
    return _listed(text)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seed", type=int, default=0, help="the first one")
    parser.add_argument("--seeds", type=int, default=1, help="how many")
    parser.add_argument("--hard", action="store_true", help="narrow, fallen, many, wide worlds")
    parser.add_argument("--plan-only", action="store_true", help="carry nothing out")
    parser.add_argument(
        "--execute-every", type=int, default=1, metavar="N", help="carry one of N out, by seed"
    )
    parser.add_argument("--cases", type=int, default=len(KINDS), help="of each seed")
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument(
        "--kinds", type=_kinds, default=get_args(Kind), help="of goals, with commas"
    )
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--record", type=Path, help="file of JSON lines")
    parser.add_argument("--no-run", action="store_true", help="list the sentences only")
    parser.add_argument(
        "--confirm", type=int, default=0, metavar="N", help="look for N of the refused"
    )
    parser.add_argument("--tries", type=int, default=30, help="roll-outs of a round of that search")
    return parser.parse_args()


def main(executor: Executor | None = None) -> int:
    """Runs what the options choose and prints the tables."""
    options = _options()
    jobs = chosen(options)
    if options.no_run:
        for job in jobs:
            scene, sentence = said(job)
            print(f"{job.seed}-{job.number} ({len(scene.objects)} objects): {sentence.text}")
        return 0
    record, workers = options.record, options.workers
    done = carried_out(
        run,
        jobs,
        Done,
        executor=executor,
        workers=workers,
        record=record,
        told=_told,
    )
    results = list(done.values())
    print(report(results), flush=True)
    if options.confirm:
        found = confirmed(
            results,
            options.confirm,
            executor=executor,
            workers=workers,
            record=record,
            tries=options.tries,
        )
        print("\n" + found)
    return 0


def _told(done: Done) -> None:
    print(f"{done.job.seed}-{done.job.number} {done.status}: {done.text}", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())

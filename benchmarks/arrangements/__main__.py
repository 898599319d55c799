"""Draws cases, runs them in worker processes, and prints what came of them.

    python -m benchmarks.arrangements --seed 0 --seeds 3 --cases 80 --execute-every 2 --record F
    python -m benchmarks.arrangements --cases 60 --plan-only
    python -m benchmarks.arrangements --kinds "swap,out of" --cases 6 --no-run

Kinds take turns; a case depends on its seed, kind and number alone. With `--record` results are
kept as they come, and a broken run goes on where it was. Times are of the processor, so that they
hold on a busy machine.
"""

from __future__ import annotations

import argparse
import itertools
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from benchmarks.arrangements.arranged_cases import KINDS, Done, Job, draw_case, run
from benchmarks.record import carried_out

_GOOD = ("done", "answered")


def report(results: Sequence[Done]) -> str:
    """Tables of what was accepted and satisfied, times, and everything that went amiss."""
    lines = [f"{'kind':9} {'cases':>5} {'sensible':>8} {'accepted':>8} {'executed':>8} "
             f"{'satisfied':>9} {'false':>5} {'harm':>4}"]  # fmt: skip
    for kind in (*KINDS, None):
        some = [done for done in results if kind in (done.job.kind, None)]
        lines += [_row(kind or "all", some)] if some else []
    times = [done.planning for done in results]
    middle, high = np.percentile(times, [50, 95])
    lines.append(f"planning: median {middle:.2f} s, 95 % {high:.2f} s, at most {max(times):.2f} s")
    return "\n".join([*lines, *filter(None, map(_amiss, results))])


def _row(name: str, results: Sequence[Done]) -> str:
    sensible = [done for done in results if done.sensible]
    executed = [done for done in results if done.met is not None]
    good = sum(done.status in _GOOD and bool(done.met) for done in executed)
    return (
        f"{name:9} {len(results):>5} {len(sensible):>8} {sum(d.accepted for d in sensible):>8} "
        f"{len(executed):>8} {good:>9} {sum(d.falsely_done for d in results):>5} "
        f"{sum(bool(d.harmed) for d in results):>4}"
    )


def _amiss(done: Done) -> str:
    """A line on a case that went otherwise than it should."""
    harmed = f"; harmed {', '.join(done.harmed)}" if done.harmed else ""
    label = "" if done.sensible else " (blind)"
    if done.falsely_done or (done.met and done.status not in _GOOD):
        what = f"{done.status}, truly {'met' if done.met else 'missed'}"
    elif done.status in (*_GOOD, "planned") and not harmed:
        return ""
    else:
        what = f"{done.status} {done.reason}"
    said = f"{done.job}{label} “{done.text}”"
    return f"{said}: {what}{harmed}: {done.message.strip()}"


def _kinds(text: str) -> list[str]:
    kinds = [part.strip() for part in text.split(",")]
    if set(kinds) - set(KINDS):
        raise argparse.ArgumentTypeError(f"kinds are {', '.join(KINDS)}")
    return kinds


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seed", type=int, default=0, help="the first one")
    parser.add_argument("--seeds", type=int, default=1, help="how many")
    parser.add_argument("--cases", type=int, default=len(KINDS), help="of each seed")
    parser.add_argument("--first", type=int, default=0, help="number of the first case of a kind")
    parser.add_argument("--kinds", type=_kinds, default=list(KINDS), help="with commas")
    parser.add_argument("--execute-every", type=int, default=1, metavar="N",
                        help="carry every Nth case of each kind out, plan the others")  # fmt: skip
    parser.add_argument("--plan-only", action="store_true", help="carry nothing out")
    parser.add_argument("--no-run", action="store_true", help="list the sentences only")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--record", type=Path, help="file of JSON lines")
    return parser.parse_args()


def chosen(options: argparse.Namespace) -> list[Job]:
    """The first cases of each seed, of all kinds in turn."""
    kinds = [kind for kind in KINDS if kind in options.kinds]
    numbers = itertools.count(options.first)
    turns = list(itertools.islice(((n, kind) for n in numbers for kind in kinds), options.cases))
    every = 0 if options.plan_only else options.execute_every
    return [
        Job(seed, kind, number, executed=bool(every) and number % every == 0)
        for seed in range(options.seed, options.seed + options.seeds)
        for number, kind in turns
    ]


def _tell(done: Done) -> None:
    print(f"{done.job} {done.planned} {done.status} {done.planning:.1f} s: {done.text}",
          file=sys.stderr, flush=True)  # fmt: skip


def main() -> int:
    """Runs what the options choose and prints the tables."""
    options = _options()
    jobs = chosen(options)
    if options.no_run:
        for job in jobs:
            asked = draw_case(job)
            label = "" if asked.sensible else " (blind)"
            print(f"{job}{label} ({len(asked.scene.objects)} objects): {asked.text}")
        return 0
    done = carried_out(run, jobs, Done, workers=options.workers, record=options.record, told=_tell)
    print(report(list(done.values())))
    return 0


if __name__ == "__main__":
    sys.exit(main())

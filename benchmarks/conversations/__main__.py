"""Holds conversations in hard worlds, and prints what came of their turns.

    python -m benchmarks.conversations --seed 501 --talks 20 --record talks.jsonl
    python -m benchmarks.conversations --seed 501 --first 4 --talks 1 --confirm

A conversation depends on its seed and number, and on what the robot does. With `--record` results
are kept as they come, and a broken run goes on with the conversation that it lacks.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import get_args

from benchmarks.conversations.drawn_turns import Job
from benchmarks.conversations.talks import Said, Talk, Verdict, talk
from benchmarks.goals.hard_worlds import SETTINGS
from benchmarks.goals.refusal_judge import Verdict as RefusalVerdict
from benchmarks.record import carried_out

GOOD = ("satisfied", "rightly refused")


def report(talks: Sequence[Talk]) -> str:
    """Tables of verdicts by setting and kind, every turn that went amiss or was judged."""
    verdicts = get_args(Verdict)
    heads = (*verdicts, "good", "stranded", "untold")
    lines = ["".join([f"{'':12}", *(f"{head:>16}" for head in heads)])]
    for setting in SETTINGS:
        turns = [turn for each in talks if each.job.setting == setting for turn in each.turns]
        lines += [_row(setting, turns)] if turns else []
    every = [turn for each in talks for turn in each.turns]
    for kind in dict.fromkeys(turn.kind for turn in every):
        lines.append(_row(kind, [turn for turn in every if turn.kind == kind]))
    return "\n".join([*lines, _row("all", every), *_tally(every), *_amiss(talks)])


def _row(name: str, turns: Sequence[Said]) -> str:
    counts = Counter(turn.verdict for turn in turns)
    good = sum(counts[verdict] for verdict in get_args(Verdict) if verdict in GOOD)
    cells = [str(counts[verdict]) for verdict in get_args(Verdict)]
    cells.append(f"{good} of {len(turns)} {good / len(turns):5.1%}")
    cells += [str(sum(len(names) for names in (getattr(turn, key) for turn in turns)))
              for key in ("stranded", "untold")]  # fmt: skip
    return "".join([f"{name:12}", *(f"{cell:>16}" for cell in cells)])


def _tally(turns: Sequence[Said]) -> Iterator[str]:
    """How many refusals were judged, and how; nothing if none was."""
    counts = Counter(turn.judged for turn in turns if turn.judged)
    if counts:
        told = ", ".join(f"{counts[verdict]} {verdict}" for verdict in get_args(RefusalVerdict))
        yield f"refusals judged: {told}"


def _amiss(talks: Sequence[Talk]) -> Iterator[str]:
    for each in talks:
        for index, turn in enumerate(each.turns):
            if turn.verdict in GOOD and not turn.stranded and not turn.judged:
                continue
            broken = f"; broken {', '.join(turn.broken)}" if turn.broken else ""
            left = f"; stranded {', '.join(turn.stranded)}" if turn.stranded else ""
            left += f", untold {', '.join(turn.untold)}" if turn.untold else ""
            yield (
                f"{each.job.seed}-{each.job.number}.{index} {turn.verdict} “{turn.text}”"
                f"{broken}{left}: {turn.reason} {turn.message} {'; '.join(turn.told)}".rstrip()
            )
            if turn.judged:
                yield f"  {turn.judged}: {turn.found}"


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--talks", type=int, default=len(SETTINGS), help="how many")
    parser.add_argument("--first", type=int, default=0, help="number of the first one")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--record", type=Path, help="file of JSON lines")
    parser.add_argument("--confirm", action="store_true", help="judge each refusal at once")
    parser.add_argument("--tries", type=int, default=30, help="roll-outs of a round of that search")
    return parser.parse_args()


def main() -> int:
    """Holds the conversations that the options choose and prints the tables."""
    options = _options()
    tries = options.tries if options.confirm else 0
    jobs = [Job(options.seed, options.first + k, tries) for k in range(options.talks)]
    done = carried_out(talk, jobs, Talk, workers=options.workers, record=options.record)
    print(report(list(done.values())))
    return 0


if __name__ == "__main__":
    sys.exit(main())

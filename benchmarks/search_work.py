"""Prints what plans in the worlds of `benchmarks.goals` cost: work, and time of a core.

    python -m benchmarks.search_work --cases 60

A quiet core does about four units of work (`most_work`) in a millisecond. Nothing is carried out.
"""

from __future__ import annotations

import argparse
import sys
import time
from typing import Any

from benchmarks.goals.drawn_worlds import believed
from benchmarks.goals.sentences import Job, said
from nlcontrol import Controller
from planner import plan
from planner.problem.planning_problem import SearchBudget

_SLOW = 0.5  # plans that take less are not listed [s]


def _cost(job: Job, most_work: int) -> tuple[int, float, str]:
    """Work, time of the core [s] and answer of the plans of a case."""
    scene, sentence = said(job)
    work, spent, answers = 0, 0.0, []

    def planned(*args: Any, **settings: Any) -> Any:
        nonlocal work, spent
        budget, start = SearchBudget(most_work), time.process_time()
        made = plan(*args, **settings, budget=budget)
        work, spent = work + budget.done, spent + time.process_time() - start
        answers.append(getattr(made, "code", made.status))
        return made

    controller = Controller(scene, registry=believed(), seed=job.seed, planner=planned)
    controller.say(sentence.text, plan_only=True)
    return work, spent, f"{', '.join(answers)}: {sentence.text}"


def main() -> int:
    """Plans the cases and prints the slow ones."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--most-work", type=int, default=1_000_000)
    options = parser.parse_args()
    total, whole = 0, 0.0
    for number in range(options.first, options.first + options.cases):
        work, spent, text = _cost(Job(options.seed, number), options.most_work)
        total, whole = total + work, whole + spent
        if spent >= _SLOW:
            print(f"{options.seed}-{number}: {work} units, {spent:.1f} s ({text})", flush=True)
    print(f"{total} units in {whole:.1f} s: {1e3 * whole / max(total, 1):.2f} ms each")
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""Random cases that are predicted and rolled out in an engine, by kinds.

    python -m benchmarks.engines [pushes] [--cases 500] [--seed 0] [--band 0.05] [--verbose]

It prints how often the class is as predicted outside of the band about the limit, how far off
predicted figures are, and which classes were wrong. `--verbose` lists the five that agree least.
MuJoCo is optional; without it its rows are left out.
"""

from __future__ import annotations

import argparse
import sys
from functools import partial
from time import perf_counter

from benchmarks.engines.agreement import (
    Suite,
    class_table,
    error_table,
    margin_table,
    run_cases,
    worst,
)
from benchmarks.engines.hand_work import grasps, lid_cases, pours
from benchmarks.engines.pressed_things import overhanging, pressed, stacks
from benchmarks.engines.single_pushes import (
    HAS_MUJOCO,
    WITHOUT_MUJOCO,
    described,
    faces,
    pushes,
    silence_drake,
)

SUITES = {
    "pushes": Suite(pushes, 500, rolls_close=True, begin=silence_drake),
    "descriptions": Suite(described, 200, rolls_close=True, begin=silence_drake),
    "descriptions-weighted": Suite(
        partial(described, stands="weighted"), 200, rolls_close=True, begin=silence_drake
    ),
    "descriptions-evenly": Suite(
        partial(described, stands="evenly"), 24, rolls_close=True, begin=silence_drake
    ),
    "faces": Suite(faces, 10_000, rolls_close=True),
    "pressing": Suite(pressed),
    "edges": Suite(overhanging),
    "stacks": Suite(stacks),
    "lids": Suite(lid_cases, 200, 0.10, rolls_close=True),
    "grasps": Suite(grasps, 120, 0.10, True, (0.0, 0.7, 0.9, 1.0, 1.1, 1.4, float("inf"))),
    "pours": Suite(pours, 120),
}
"""Kinds of cases. Those of `faces` are contacts of each object; they depend on no seed."""


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("suite", choices=SUITES, nargs="?", default="pushes")
    parser.add_argument("--cases", type=int)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--band", type=float, help="share of the limit")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--verbose", action="store_true", help="list the five that agree least")
    options = parser.parse_args()
    suite, start = SUITES[options.suite], perf_counter()
    silence_drake()
    cases = suite.draw(options.cases or suite.cases, options.seed)
    band = suite.band if options.band is None else options.band
    trials = []
    for trial in run_cases(suite, cases, band, options.workers):
        trials.append(trial)
        if len(trials) % 50 == 0 or len(trials) == len(cases):
            seconds = perf_counter() - start
            print(f"{len(trials)} of {len(cases)} in {seconds:.0f} s", file=sys.stderr, flush=True)
    print(class_table(trials))
    if errors := error_table(trials):
        print(f"\n{errors}")
    if suite.edges:
        print(f"\n{margin_table(trials, suite.edges)}")
    for number, trial in enumerate(trials):
        if trial.counts and not trial.is_right:
            print(f"case {number}, {trial}")
    if options.verbose:
        print(f"\n{worst(trials)}")
    if options.suite == "pushes" and not HAS_MUJOCO:
        print(f"\n{WITHOUT_MUJOCO}")


if __name__ == "__main__":
    main()

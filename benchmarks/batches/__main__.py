"""Proves, compares or watches batches.

python -m benchmarks.batches proof --rows 200
python -m benchmarks.batches rates --rows 250 --executions 12
python -m benchmarks.batches memory --rows 20000
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from benchmarks.batches.drawn_rows import execution_rows, plan_rows
from benchmarks.batches.memory import memory_growth
from benchmarks.batches.proof import compare_ways
from benchmarks.batches.rates import measured_rates, rate_table


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("what", choices=["proof", "rates", "memory"])
    parser.add_argument("--rows", type=int, default=200, help="that are planned")
    parser.add_argument("--executions", type=int, default=4, help="rows that are carried out")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--workers", type=int, default=2)
    return parser.parse_args()


def _rows_of_round(
    rows_from: Callable[[int, int], list[dict[str, Any]]], number: int, which: int
) -> list[dict[str, Any]]:
    return rows_from(number, which * number)


def main() -> int:
    """Does what is asked; 1 if a way of carrying rows out differs."""
    asked = _options()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if asked.what == "proof":
            planned = asked.rows - asked.executions
            wrong = compare_ways(plan_rows(planned) + execution_rows(asked.executions), folder)
            print(f"{asked.rows} rows, {asked.executions} carried out: {wrong or 'equal digests'}")
            return int(bool(wrong))
        if asked.what == "rates":
            for what, rows_from, number in (
                ("plans", plan_rows, asked.rows),
                ("executions", execution_rows, asked.executions),
            ):
                if number:
                    rates = measured_rates(partial(_rows_of_round, rows_from, number), asked.rounds)
                    print(rate_table(what, rates), flush=True)
            return 0
        growths, rate = memory_growth(asked.rows, asked.workers, folder / "results.jsonl")
        for each, (settled, most, end) in growths.items():
            print(f"{each}: {settled:.0f} MB, at most {most - settled:+.1f}, in the end {end:.0f}")
        print(f"{asked.rows} rows, {rate:.3g} a second with {asked.workers} workers")
        return 0


if __name__ == "__main__":
    sys.exit(main())

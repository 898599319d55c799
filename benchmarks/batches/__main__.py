"""Proves, compares or watches batches.

python -m benchmarks.batches proof --rows 200
python -m benchmarks.batches rates --rows 250 --executions 12
python -m benchmarks.batches memory --rows 20000
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from benchmarks.batches.measures import (
    execution_rows,
    measured_rates,
    plan_rows,
    rate_table,
    watch_memory,
)
from benchmarks.batches.proof import compare_ways


def main() -> int:
    """Does what is asked; 1 if a way of carrying rows out differs."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("what", choices=["proof", "rates", "memory"])
    parser.add_argument("--rows", type=int, default=200, help="that are planned")
    parser.add_argument("--executions", type=int, default=4, help="rows that are carried out")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--workers", type=int, default=2)
    asked = parser.parse_args()
    if asked.what == "rates":
        kinds = ("plans", plan_rows, asked.rows), ("executions", execution_rows, asked.executions)
        for what, rows_from, number in kinds:
            if number:
                rates = measured_rates(rows_from, number, asked.rounds)
                print(rate_table(what, rates), flush=True)
        return 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if asked.what == "memory":
            watch_memory(asked.rows, asked.workers, folder / "results.jsonl")
            return 0
        planned = plan_rows(asked.rows - asked.executions)
        wrong = compare_ways(planned + execution_rows(asked.executions), folder)
    print(f"{asked.rows} rows, {asked.executions} carried out: {wrong or 'equal digests'}")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())

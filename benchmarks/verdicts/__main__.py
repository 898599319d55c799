"""How far the robot's own verdicts are right, by cases that are carried out.

    python -m benchmarks.verdicts agree --cases 150 --record rows.jsonl

The truth is that of the observer, clause by clause, and of a judge that reads nothing but true
poses (`benchmarks.goals.judge`). `docs/benchmarks.md` says what is asked of each suite.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path

from benchmarks.record import carried_out
from benchmarks.verdicts.cases import CAMERAS, SUITES, Job
from benchmarks.verdicts.judged_cases import Clause, Row, run


def table(rows: Sequence[Row]) -> str:
    """Rows in figures."""
    statuses = Counter(row.status for row in rows)
    lines = [f"{len(rows)} cases: " + ", ".join(f"{n} {s}" for s, n in statuses.most_common())]
    executed = [row for row in rows if row.checks]
    if not executed:
        return lines[0]
    true = [all(c.ok for c in row.checks) for row in executed]
    own = [_own(row.checks) for row in executed]
    wrong = [row for row in executed if row.status == "done" and _is_false(row)]
    same = sum(mine == ok for mine, ok in zip(own, true, strict=True))
    lines.append(
        f"{len(executed)} executed: own and observer's verdict agree in {same} "
        f"({100.0 * same / len(executed):.1f} %), {own.count(None)} undecided, "
        f"{len(wrong)} false done"
    )
    clauses = [(row, c) for row in executed for c in row.checks if c.ok is not None]
    told = Counter((c.verdict, c.ok) for _, c in clauses)
    lines.append(
        f"{len(clauses)} clauses: "
        + ", ".join(
            f"{v} where truth {'held' if ok else 'did not'}: {n}"
            for (v, ok), n in sorted(told.items())
        )
    )
    spans = [
        c.low - 1e-4 <= float(c.true or 0.0) <= c.high + 1e-4
        for _, c in clauses
        if c.low is not None and c.high is not None
    ]
    if spans:
        share = 100.0 * sum(spans) / len(spans)
        lines.append(f"the truth lies in [low, high] in {share:.1f} % of them")
    unknown = Counter(c.quantity for _, c in clauses if c.verdict == "unknown")
    lines += [f"  unknown {n:3d}  {quantity}" for quantity, n in unknown.most_common(8)]
    lines += [f"  FALSE DONE {row.job.number}: {row.sentence} ({row.trouble})" for row in wrong]
    lines += [
        f"  wrong {c.verdict} {row.job.number} {row.sentence}: {c.quantity} own {c.own} "
        f"true {c.true} asked {c.expected}"
        for row, c in clauses
        if (c.verdict == "held") != c.ok and c.verdict != "unknown"
    ]
    return "\n".join(lines)


def _own(clauses: Iterable[Clause]) -> bool | None:
    """Whether all clauses held by the robot's own verdict; None if that cannot be told."""
    told = {c.verdict for c in clauses}
    return False if "not_held" in told else None if "unknown" in told else True


def _is_false(row: Row) -> bool:
    """Whether an observer or the judge of true poses says otherwise."""
    return row.met is False or bool(row.broken) or not all(c.ok for c in row.checks)


def _with_redrawn(rows: Iterable[Row], camera: str) -> list[Row]:
    """Rows with the verdicts on frames that were drawn anew, one for each time."""
    statuses = {True: "done", False: "failed", None: "undecided"}
    return [
        row.model_copy(update={"status": statuses[_own(checks)], "checks": checks})
        for row in rows
        for checks in row.redrawn.get(camera, ())
    ]


def _moved_table(moved: Sequence[tuple[str, bool]]) -> str:
    """Verdicts on limits near the truth in figures."""
    told = Counter(moved)
    found = {
        "held wrongly": told["held", False],
        "not held wrongly": told["not_held", True],
        "unknown": told["unknown", True] + told["unknown", False],
    }
    shares = [f"{100.0 * n / max(len(moved), 1):.2f} % {name}" for name, n in found.items()]
    return f"{len(moved)} limits near the truth: {', '.join(shares)}"


def main() -> int:
    """Runs a suite, and prints its figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("suite", choices=SUITES)
    parser.add_argument("--cases", type=int, default=150)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--redrawn", type=int, default=0)
    parser.add_argument("--record", type=Path, help="file of JSON lines")
    parser.add_argument("--workers", type=int, default=1)
    options = parser.parse_args()
    numbers = range(options.first, options.first + options.cases)
    jobs = [Job(options.suite, number, options.redrawn) for number in numbers]
    done = carried_out(run, jobs, Row, workers=options.workers, record=options.record)
    rows = list(done.values())
    print(table(rows))
    for camera in CAMERAS if options.redrawn else ():
        print(f"\nframes drawn anew, {camera} camera")
        print(table(_with_redrawn(rows, camera)))
        print(_moved_table([each for row in rows for each in row.moved.get(camera, ())]))
    return 0


if __name__ == "__main__":
    sys.exit(main())

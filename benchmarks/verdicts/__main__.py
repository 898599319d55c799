"""How far the robot's own verdicts are right, by cases that are carried out.

    python -m benchmarks.verdicts agree --cases 150 --camera standard --rows rows.jsonl

Each case is a line of the file of rows; those that are there already are not run again. The truth
is that of the observer, clause by clause, and of a judge that reads nothing but true poses
(`benchmarks.goals.judge`). `docs/benchmarks.md` says what is asked of each suite.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from pathlib import Path

from benchmarks.verdicts.cases import CAMERAS, SUITES, case
from benchmarks.verdicts.judged_cases import Row, run
from nlcontrol.parallel_tasks import run_all


def table(rows: Sequence[Row]) -> str:
    """Rows in figures."""
    statuses = Counter(row["status"] for row in rows)
    lines = [f"{len(rows)} cases: " + ", ".join(f"{n} {s}" for s, n in statuses.most_common())]
    executed = [row for row in rows if row.get("checks")]
    if not executed:
        return lines[0]
    true = [all(c["ok"] for c in row["checks"]) for row in executed]
    own = [_own(row) for row in executed]
    wrong = [row for row in executed if row["status"] == "done" and _is_false(row)]
    same = sum(mine == ok for mine, ok in zip(own, true, strict=True))
    lines.append(
        f"{len(executed)} executed: own and observer's verdict agree in {same} "
        f"({100.0 * same / len(executed):.1f} %), {own.count(None)} undecided, "
        f"{len(wrong)} false done"
    )
    clauses = [(row, c) for row in executed for c in row["checks"] if c["ok"] is not None]
    told = Counter((c["verdict"], c["ok"]) for _, c in clauses)
    lines.append(
        f"{len(clauses)} clauses: "
        + ", ".join(f"{v} where truth {'held' if ok else 'did not'}: {n}"
                    for (v, ok), n in sorted(told.items()))
    )  # fmt: skip
    spans = [c for _, c in clauses if c["low"] is not None]
    within = sum(c["low"] - 1e-4 <= c["true"] <= c["high"] + 1e-4 for c in spans)
    if spans:
        lines.append(
            f"the truth lies in [low, high] in {100.0 * within / len(spans):.1f} % of them"
        )
    unknown = Counter(c["quantity"] for _, c in clauses if c["verdict"] == "unknown")
    lines += [f"  unknown {n:3d}  {quantity}" for quantity, n in unknown.most_common(8)]
    lines += [
        f"  FALSE DONE {row['number']}: {row['sentence']} ({row['trouble']})" for row in wrong
    ]
    for row, c in clauses:
        if (c["verdict"] == "held") != c["ok"] and c["verdict"] != "unknown":
            lines.append(
                f"  wrong {c['verdict']} {row['number']} {row['sentence']}: {c['quantity']} "
                f"own {c['own']} true {c['true']} asked {c['expected']}"
            )
    return "\n".join(lines)


def _with_redrawn(rows: Iterable[Row], camera: str) -> Iterator[Row]:
    """Rows with the verdicts on frames that were drawn anew, one for each time."""
    for row in rows:
        for checks in row.get("redrawn", {}).get(camera, ()):
            told = {c["verdict"] for c in checks}
            status = (
                "failed" if "not_held" in told else "undecided" if "unknown" in told else "done"
            )
            yield {**row, "status": status, "checks": checks}


def _moved_table(moved: Sequence[Row]) -> str:
    """Verdicts on limits near the truth in figures."""
    told = Counter((row["verdict"], row["ok"]) for row in moved)
    found = {
        "held wrongly": told["held", False],
        "not held wrongly": told["not_held", True],
        "unknown": told["unknown", True] + told["unknown", False],
    }
    shares = [f"{100.0 * n / max(len(moved), 1):.2f} % {name}" for name, n in found.items()]
    return f"{len(moved)} limits near the truth: {', '.join(shares)}"


def _is_false(row: Row) -> bool:
    """Told as done, though an observer or the judge of true poses says otherwise."""
    return row["met"] is False or bool(row["broken"]) or not all(c["ok"] for c in row["checks"])


def _own(row: Row) -> bool | None:
    """Whether all clauses held by the robot's own verdict; None if that cannot be told."""
    told = {c["verdict"] for c in row["checks"]}
    return False if "not_held" in told else None if "unknown" in told else True


def main(arguments: Iterable[str] | None = None) -> int:
    """Runs a suite, and prints its figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("suite", choices=SUITES)
    parser.add_argument("--cases", type=int, default=150)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--camera", choices=CAMERAS, default="standard")
    parser.add_argument("--redrawn", type=int, default=0)
    parser.add_argument("--rows", type=Path, required=True)
    parser.add_argument("--workers", type=int, default=1)
    options = parser.parse_args(None if arguments is None else list(arguments))
    numbers = range(options.first, options.first + options.cases)
    kept = {}
    if options.rows.exists():
        lines = options.rows.read_text(encoding="utf-8").splitlines()
        kept = {(r["suite"], r["camera"], r["number"]): r for r in map(json.loads, lines)}
    left = [case(options.suite, n) for n in numbers
            if (options.suite, options.camera, n) not in kept]  # fmt: skip
    with options.rows.open("a", encoding="utf-8") as file:
        one = partial(run, camera=options.camera, redrawn=options.redrawn)
        for row in run_all(one, left, workers=options.workers):
            kept[row["suite"], row["camera"], row["number"]] = row
            file.write(json.dumps(row) + "\n")
            file.flush()
    rows = [kept[options.suite, options.camera, n] for n in numbers]
    print(table(rows))
    for camera in CAMERAS if options.redrawn else ():
        print(f"\nframes drawn anew, {camera} camera")
        print(table(list(_with_redrawn(rows, camera))))
        print(_moved_table([each for row in rows for each in row.get("moved", {}).get(camera, ())]))
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""The service, its page and its commands outlive kills, signals and faults.

    python -m benchmarks.kills service [--count 30] [--seed 0]
    python -m benchmarks.kills commands [--count 100] [--seed 0] [--workers N]
    python -m benchmarks.kills saves [--count 100] [--seed 0]
    python -m benchmarks.kills sessions [--count 500] [--seed 0]
    python -m benchmarks.kills stops [--count 200] [--seed 0]
    python -m benchmarks.kills restarts [--count 30] [--seed 0]
    python -m benchmarks.kills pairs [--count 2000] [--seed 0]

`service` is killed at random moments, or one of its processes: what had ended is there.
`commands` get Control-C and SIGTERM at random moments, and end as documented.
`saves` of models are killed, and five times as many are made by many processes at once.
`sessions` are opened, used and closed in every way under `ulimit -n 256`: descriptors, processes
and temporary folders stay as many, and none fails.
`stops` of a robot that moves, while other sessions plan for long and are stopped in a loop, are
answered within 0.3 s more than a bare endpoint is; the robot lets go within 0.2 s of its own time.
`restarts` kill the service in the midst of runs with a page open in Chromium, which goes on by
itself: a banner, a new session, the sentence as it was, the run settled, its plan offered again.
`pairs` of a fault and a call, of all documented operations: no run is told to be under way that
none carries out, no end is lost, and no answer is other than the document says.

Each prints its figures in a line, and ends with 1 if what it is to prove does not hold.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping
from functools import partial

from benchmarks.kills.fault_pairs import prove_faults_pass
from benchmarks.kills.interruptions import prove_commands_end
from benchmarks.kills.killed_service import prove_ends_kept
from benchmarks.kills.opened_sessions import prove_sessions_flat
from benchmarks.kills.page_restarts import prove_page_goes_on
from benchmarks.kills.saves import prove_saves_whole
from benchmarks.kills.timed_stops import prove_stops_quick

PROOFS: Mapping[str, tuple[Callable[[int, int], bool], int]] = {
    "service": (prove_ends_kept, 30),
    "commands": (prove_commands_end, 100),
    "saves": (prove_saves_whole, 100),
    "sessions": (prove_sessions_flat, 500),
    "stops": (prove_stops_quick, 200),
    "restarts": (prove_page_goes_on, 30),
    "pairs": (prove_faults_pass, 2000),
}
"""Each proof, and how many of what it is named for it takes."""


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    proofs = parser.add_subparsers(dest="proof", required=True)
    for name, (_, count) in PROOFS.items():
        one = proofs.add_parser(name)
        one.add_argument("--count", type=int, default=count)
        one.add_argument("--seed", type=int, default=0)
        if name == "commands":
            one.add_argument("--workers", type=int, help="commands at once")
    wanted = parser.parse_args()
    prove, _ = PROOFS[wanted.proof]
    if wanted.proof == "commands":
        prove = partial(prove_commands_end, workers=wanted.workers)
    return int(not prove(wanted.count, wanted.seed))


if __name__ == "__main__":
    sys.exit(main())

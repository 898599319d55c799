"""The service and its page outlive their users: four proofs, each with its figures in a line.

    python -m benchmarks.service_faults sessions [--sessions 500] [--seed 0]
    python -m benchmarks.service_faults stops [--stops 200] [--seed 0]
    python -m benchmarks.service_faults restarts [--restarts 30] [--seed 0]
    python -m benchmarks.service_faults pairs [--pairs 2000] [--seed 0]

`sessions` are opened, used and closed in every way under `ulimit -n 256`: descriptors, processes
and temporary folders stay as many, and none fails.
`stops` of a robot that moves, while other sessions plan for long and are stopped in a loop, are
answered within 0.3 s more than a bare endpoint is; the robot lets go within 0.2 s of its own time.
`restarts` kill the service in the midst of runs with a page open in Chromium, which goes on by
itself: a banner, a new session, the sentence as it was, the run settled, its plan offered again.
`pairs` of a fault and a call, of all documented operations: no run is told to be under way that
none carries out, no end is lost, and no answer is other than the document says.

Each ends with 1 if what it is to prove does not hold.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping

from benchmarks.service_faults.fault_pairs import prove_faults_pass
from benchmarks.service_faults.opened_sessions import prove_sessions_flat
from benchmarks.service_faults.page_restarts import prove_page_goes_on
from benchmarks.service_faults.timed_stops import prove_stops_quick

PROOFS: Mapping[str, tuple[Callable[[int, int], bool], int]] = {
    "sessions": (prove_sessions_flat, 500),
    "stops": (prove_stops_quick, 200),
    "restarts": (prove_page_goes_on, 30),
    "pairs": (prove_faults_pass, 2000),
}
"""Each proof, and how many of what it is named for it takes."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    proofs = parser.add_subparsers(dest="proof", required=True)
    for name, (_, count) in PROOFS.items():
        one = proofs.add_parser(name)
        one.add_argument(f"--{name}", dest="count", type=int, default=count)
        one.add_argument("--seed", type=int, default=0)
    wanted = parser.parse_args()
    prove, _ = PROOFS[wanted.proof]
    return int(not prove(wanted.count, wanted.seed))


if __name__ == "__main__":
    sys.exit(main())

"""The service and its page outlive their users: four proofs, each with its figures in a line.

    python -m benchmarks.service_faults sessions [--sessions 500] [--seed 0]

`sessions` are opened, used and closed in every way under `ulimit -n 256`: descriptors, processes
and temporary folders stay as many, and none fails.

Each ends with 1 if what it is to prove does not hold.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping

from benchmarks.service_faults.opened_sessions import prove_sessions_flat

PROOFS: Mapping[str, tuple[Callable[[int, int], bool], int]] = {
    "sessions": (prove_sessions_flat, 500),
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

"""Cold start of `nlcontrol plan`, as a multiple of importing what any such program imports.

    python benchmarks/cold_start.py [--runs 9]

Both commands run in fresh processes, in turn, so that a busy machine slows both alike; the medians
of their processor times are compared. Byte code is written by a first run, as in any installation.
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import subprocess
import sys

SENTENCE = "push the ice tea box away without toppling it"
PEER = [sys.executable, "-c", "import numpy, lark, pydantic, click"]
PLAN = [sys.executable, "-m", "nlcontrol", "plan", SENTENCE, "--json"]


def processor_time(command: list[str]) -> float:
    """User and system time of a command [s]."""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=environment)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--runs", type=int, default=9)
    runs = parser.parse_args().runs
    for command in (PEER, PLAN):
        processor_time(command)  # once for the file cache and the byte code
    times = [(processor_time(PEER), processor_time(PLAN)) for _ in range(runs)]
    peer, plan = (statistics.median(column) for column in zip(*times, strict=True))
    ratio = statistics.median(b / a for a, b in times)
    print(f"import numpy, lark, pydantic, click: {peer:.3f} s (median of {runs})")
    print(f"nlcontrol plan:                      {plan:.3f} s")
    print(f"cold start: {ratio:.2f} times the imports")


if __name__ == "__main__":
    main()

"""Hostile calls to a real server and to the tools of agents; motions are counted.

    python -m benchmarks.attacks service [--sequences 6000] [--seed 0]
    python -m benchmarks.attacks tools [--sequences 4000] [--seed 0]
    python -m benchmarks.attacks schema [--requests 2000] [--seed 0]

A sequence is a few attacks in a row, drawn by the seed, in a session in which only approved plans
may be carried out; some approve a plan in order, so that there is something to repeat. After each
the motions and the records of runs are compared with the plans that were approved. Tables say what
was tried and how it was answered. It ends with 1 if anything moved without a fresh plan, if an
answer was not documented, or not the refusal that is due, or of status 5xx.

`schema` draws requests from the OpenAPI document. It ends with 1 if a check of schemathesis fails
(an answer of status 5xx, of a status, type or form that the document does not have, or none; what
does not fit taken, or what fits refused for its form; a wrong `Allow`, what was deleted still
there, and so on), or if fewer requests were sent than asked for.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.attacks.hostility import Tally
from benchmarks.attacks.service_attacks import attacker_of_service
from benchmarks.attacks.tool_attacks import attack_tools
from tests.fakes.counted_executor import motions_in


def attack_service(folder: Path, sequences: int, seed: int) -> Tally:
    with attacker_of_service(folder, seed) as attacker:
        attacker.attack(sequences)
    return attacker.tally


def fuzz_schema(requests: int, seed: int) -> bool:
    """Draws requests and prints what came of it; False if something was found."""
    from benchmarks.attacks.schema_fuzzing import fuzz

    found = fuzz(requests, seed)
    print(found.report)
    print(f"{found.requests} requests, {'nothing found' if found.passed else 'something found'}")
    return found.passed


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    attacked = parser.add_subparsers(dest="attacked", required=True)
    for name, each, count in (
        ("service", "sequences", 6000),
        ("tools", "sequences", 4000),
        ("schema", "requests", 2000),
    ):
        one = attacked.add_parser(name)
        one.add_argument(f"--{each}", dest="count", type=int, default=count)
        one.add_argument("--seed", type=int, default=0)
    wanted = parser.parse_args()
    if wanted.attacked == "schema":
        return int(not fuzz_schema(wanted.count, wanted.seed))
    attack = attack_service if wanted.attacked == "service" else attack_tools
    with tempfile.TemporaryDirectory() as folder:
        begun = time.monotonic()
        tally = attack(Path(folder), wanted.count, wanted.seed)
        seconds, motions = time.monotonic() - begun, motions_in(Path(folder))
    calls = sum(answers.total() for answers in tally.answers.values())
    print(tally.table())
    print(f"\n{wanted.count} sequences, {calls} attacks, {motions} motions, {seconds:.0f} s")
    print(f"faults: {dict(tally.faults) or 'none'}")
    for example in tally.examples:
        print(f"  {example}")
    return int(tally.faults.total() > 0)


if __name__ == "__main__":
    sys.exit(main())

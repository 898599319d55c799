"""Hostile sequences of calls to a real server and to the tools of agents; motions are counted.

    python -m benchmarks.service_attacks [--sequences 6000] [--tool-sequences 4000] [--seed 0]

Each sequence is a few attacks in a row, drawn by the seed, in a session in which only approved
plans may be carried out; some approve a plan in order, so that there is something to repeat. After
each the motions and the records of runs are compared with the plans that were approved. It prints
tables of what was tried and how it was answered, and ends with 1 if anything moved without a fresh
plan, if an answer was not documented, or not the refusal that is due, or of status 5xx.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from benchmarks.service_attacks import door_attacks as door
from benchmarks.service_attacks import plan_attacks as plans
from benchmarks.service_attacks.attack_tally import Tally
from benchmarks.service_attacks.attacked_server import attacked_server
from benchmarks.service_attacks.attacker import Attacker
from benchmarks.service_attacks.tool_attacks import attack_tools
from tests.fakes.counted_executor import motions_in

WEIGHTS: dict[Callable[[Attacker], None], float] = {
    plans.try_forged_plan: 8,
    plans.try_used_plan: 2,
    plans.try_stale_plan: 4,
    plans.try_other_sentence: 4,
    plans.try_foreign_plan: 4,
    plans.try_dropped_plan: 3,
    plans.try_to_say: 6,
    plans.try_question_that_moves: 3,
    plans.try_key_again: 1,
    plans.try_two_at_once: 1,
    plans.try_to_vanish: 1,
    plans.try_other_methods: 4,
    door.try_wrong_host: 4,
    door.try_wrong_origin: 4,
    door.try_form_of_a_page: 3,
    door.try_bad_token: 4,
    door.try_traversal: 12,
    door.try_bad_body: 10,
    door.try_odd_text: 8,
    door.try_odd_values: 10,
    door.try_unknown_names: 8,
    door.try_bad_numbers: 4,
    door.try_wrong_method: 4,
    door.try_no_http: 4,
    door.try_vanishing_listener: 2,
    door.try_many_sessions: 1,
    door.try_flood: 0.05,
    door.try_many_listeners: 0.05,
}
"""The attacks, by how often they are tried."""

LONGEST, SEQUENCES_OF_A_SESSION = 4, 400


def attack(attacker: Attacker, sequences: int) -> None:
    """Tries sequences of attacks, in one session after the other."""
    rng = attacker.rng
    for number in range(sequences):
        if number % SEQUENCES_OF_A_SESSION == 0:
            attacker.open_session()
        tries = rng.choices(list(WEIGHTS), list(WEIGHTS.values()), k=rng.randint(1, LONGEST))
        for attempt in tries:
            attempt(attacker)
        attacker.settle(", ".join(attempt.__name__ for attempt in tries))


def told(tally: Tally, sequences: int, motions: int, seconds: float) -> None:
    """Prints what came of some sequences."""
    calls = sum(answers.total() for answers in tally.answers.values())
    print(tally.table())
    print(f"\n{sequences} sequences, {calls} attacks, {motions} motions, {seconds:.0f} s")
    print(f"faults: {dict(tally.faults) or 'none'}")
    for example in tally.examples:
        print(f"  {example}")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--sequences", type=int, default=6_000, help="over HTTP")
    parser.add_argument("--tool-sequences", type=int, default=4_000, help="to tools of agents")
    parser.add_argument("--seed", type=int, default=0)
    wanted = parser.parse_args()
    faults = 0
    if wanted.sequences:
        with tempfile.TemporaryDirectory() as folder, attacked_server(Path(folder)) as server:
            begun = time.monotonic()
            tally = Tally(server.openapi())
            attack(Attacker(server, tally, wanted.seed), wanted.sequences)
            motions = server.motions()
        told(tally, wanted.sequences, motions, time.monotonic() - begun)
        faults += tally.faults.total()
    if wanted.tool_sequences:
        with tempfile.TemporaryDirectory() as folder:
            begun = time.monotonic()
            tally = attack_tools(Path(folder), wanted.tool_sequences, wanted.seed)
            motions = motions_in(Path(folder))
        told(tally, wanted.tool_sequences, motions, time.monotonic() - begun)
        faults += tally.faults.total()
    return int(faults > 0)


if __name__ == "__main__":
    sys.exit(main())

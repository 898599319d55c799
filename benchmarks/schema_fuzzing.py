"""Requests drawn from the OpenAPI document of a real server, answers compared with it.

    python -m benchmarks.schema_fuzzing [--requests 2000] [--seed 0]

schemathesis sends examples, values at the limits of each field, drawn ones, and sequences of calls,
such that fit the document and such that do not. It ends with 1 if one of its checks fails (an
answer of status 5xx, of a status, type or form that the document does not have, or none; what does
not fit taken, or what fits refused for its form; a wrong `Allow`, what was deleted still there, and
so on), or if fewer requests were sent than asked for. The endless stream of poses is left out.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

from benchmarks.service_attacks.attacked_server import TOKEN, attacked_server
from tests.patience import PATIENCE
from tests.service_process import ROOT

SLOW = ("affordances", "session_affordances", "map", "session_map")
"""Operations that plan for seconds; their bodies are those of others, or nearly so."""

LEFT_OUT_CHECKS = "positive_data_acceptance"  # see benchmarks.fuzzing_checks, which has its part

CHECKS = "benchmarks.fuzzing_checks"
PHASES = "examples,coverage,fuzzing,stateful"
ENDLESS = "session_live"

MORE = 1.5
"""Requests of an operation beside an even share: those without parameters take but a few."""

ANSWER_TIME = PATIENCE + 30.0
"""Longest time for an answer, more than the service takes itself [s]."""


class Fuzzing(NamedTuple):
    """What came of it.

    Attributes:
        requests: that were sent.
        passed: nothing was found.
        report: in words.
    """

    requests: int
    passed: bool
    report: str


def fuzz(requests: int, seed: int, *, briefly: bool = False) -> Fuzzing:
    """Sends so many requests or more, in a session in which plans have to be approved.

    Args:
        requests: that are drawn, beside the examples and the values at the limits.
        seed: of the draws.
        briefly: operations that take seconds are left out.
    """
    with tempfile.TemporaryDirectory() as name, attacked_server(Path(name)) as server:
        folder = Path(name)
        operations = sum(
            len(methods.keys() & {"get", "post", "delete", "put"})
            for methods in server.openapi()["paths"].values()
        )
        opened = server.http.post("/v1/sessions", json={}).raise_for_status().json()
        config = f'[parameters]\n"path.session_id" = "{opened["session_id"]}"\n'
        (folder / "schemathesis.toml").write_text(config)
        each = math.ceil(MORE * requests / operations)
        done = subprocess.run(
            [
                *(sys.executable, "-m", "schemathesis.cli", "--config-file", "schemathesis.toml"),
                *("run", f"{server.url}/v1/openapi.json", "--seed", str(seed)),
                *("--max-examples", str(each), "--phases", PHASES),
                *("--header", f"Authorization: Bearer {TOKEN}", "--checks", "all"),
                *("--exclude-checks", LEFT_OUT_CHECKS, "--no-shrink", "--continue-on-failure"),
                *(
                    f"--exclude-operation-id={name}"
                    for name in (ENDLESS, *(SLOW if briefly else ()))
                ),
                *("--request-timeout", str(ANSWER_TIME), "--max-response-time", str(ANSWER_TIME)),
                *("--suppress-health-check", "all", "--warnings", "off"),
                *("--report", "har", "--report-har-path", "requests.har"),
            ],
            cwd=folder,
            env=os.environ | {"PYTHONPATH": str(ROOT), "SCHEMATHESIS_HOOKS": CHECKS},
            capture_output=True,
            text=True,
            check=False,
        )
        sent = len(json.loads((folder / "requests.har").read_text("utf-8"))["log"]["entries"])
    return Fuzzing(sent, done.returncode == 0 and sent >= requests, done.stdout + done.stderr)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--requests", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=0)
    wanted = parser.parse_args()
    found = fuzz(wanted.requests, wanted.seed)
    print(found.report)
    print(f"{found.requests} requests, {'nothing found' if found.passed else 'something found'}")
    return int(not found.passed)


if __name__ == "__main__":
    sys.exit(main())

"""Requests drawn from the OpenAPI document of a real server, answers compared with it.

    python -m benchmarks.schema_fuzzing [--requests 2000] [--seed 0]

schemathesis draws them, such that fit the document and such that do not. It ends with 1 if a
request had an answer of status 5xx, of a status, type or form that the document does not have, or
none, or if fewer requests were sent than asked for. The endless stream of poses is left out.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

from benchmarks.service_attacks.attacked_server import TOKEN, attacked_server
from tests.patience import PATIENCE

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


def fuzz(requests: int, seed: int) -> Fuzzing:
    """Sends so many requests or more, in a session in which plans have to be approved."""
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
                *("--exclude-operation-id", ENDLESS, "--no-shrink", "--continue-on-failure"),
                *("--request-timeout", str(ANSWER_TIME)),
                *("--suppress-health-check", "all", "--warnings", "off"),
                *("--report", "har", "--report-har-path", "requests.har"),
            ],
            cwd=folder,
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

"""Requests drawn from the OpenAPI document of a real server, answers compared with it.

schemathesis sends examples, values at the limits of each field, drawn ones, and sequences of calls,
such that fit the document and such that do not. The endless stream of poses is left out.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, NamedTuple

import schemathesis

from benchmarks.attacks.service_attacks import TOKEN, attacker_of_service
from tests.patience import PATIENCE
from tests.service_process import ROOT

SLOW = ("affordances", "session_affordances", "map", "session_map")
"""Operations that plan for seconds; their bodies are those of others, or nearly so."""

PHASES = "examples,coverage,fuzzing,stateful"
ENDLESS = "session_live"

FORM = {"bad_request", "bad_json", "wrong_media_type"}
"""Codes of refusals for which the form of the request is the reason."""

MORE = 1.5
"""Requests of an operation beside an even share: those without parameters take but a few."""

ANSWER_TIME = str(PATIENCE + 30.0)
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


@schemathesis.check
def form_acceptance(
    ctx: schemathesis.CheckContext, response: schemathesis.Response, case: schemathesis.Case[Any]
) -> None:
    """Raises an AssertionError where a request fits the document and is refused for its form.

    It stands in the place of `positive_data_acceptance`, for which any refusal of such a request is
    a fault. Here many are in order: a request may name a scene, an object, a cursor or a default
    that is not there, which no document can know.
    """
    fits = case.meta is not None and case.meta.generation.mode.is_positive
    media_type = response.headers.get("content-type", [""])[0]
    if fits and media_type == "application/problem+json":
        problem = response.json()
        assert problem["code"] not in FORM, f"it fits the document, and is refused: {problem}"


def fuzz(requests: int, seed: int, *, briefly: bool = False) -> Fuzzing:
    """Sends so many requests or more, in a session in which plans have to be approved.

    Args:
        requests: that are drawn, beside the examples and the values at the limits.
        seed: of the draws.
        briefly: operations that take seconds are left out.
    """
    with tempfile.TemporaryDirectory() as name, attacker_of_service(Path(name)) as attacker:
        folder = Path(name)
        session = attacker.call("POST", "/v1/sessions", json={})["session_id"]
        config = f'[parameters]\n"path.session_id" = "{session}"\n'
        (folder / "schemathesis.toml").write_text(config)
        paths = attacker.call("GET", "/v1/openapi.json")["paths"].values()
        operations = sum(
            len(methods.keys() & {"get", "post", "delete", "put"}) for methods in paths
        )
        left_out = (ENDLESS, *(SLOW if briefly else ()))
        done = subprocess.run(
            [
                *(sys.executable, "-m", "schemathesis.cli", "--config-file", "schemathesis.toml"),
                *("run", f"{attacker.url}/v1/openapi.json", "--seed", str(seed)),
                *("--max-examples", str(math.ceil(MORE * requests / operations))),
                *("--phases", PHASES, "--header", f"Authorization: Bearer {TOKEN}"),
                *("--checks", "all", "--exclude-checks", "positive_data_acceptance"),
                *("--no-shrink", "--continue-on-failure"),
                *(f"--exclude-operation-id={name}" for name in left_out),
                *("--request-timeout", ANSWER_TIME, "--max-response-time", ANSWER_TIME),
                *("--suppress-health-check", "all", "--warnings", "off"),
                *("--report", "har", "--report-har-path", "requests.har"),
            ],
            cwd=folder,
            env=os.environ | {"PYTHONPATH": str(ROOT), "SCHEMATHESIS_HOOKS": __name__},
            capture_output=True,
            text=True,
            check=False,
        )
        sent = len(json.loads((folder / "requests.har").read_text("utf-8"))["log"]["entries"])
    return Fuzzing(sent, done.returncode == 0 and sent >= requests, done.stdout + done.stderr)

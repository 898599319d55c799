"""A client that a generator makes from the OpenAPI document, and nobody has written."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import httpx
import pytest

from tests.patience import PATIENCE
from tests.service_process import ServerProcess

# No formatter runs over what is generated, and files are bytes whatever they hold.
CONFIG = {
    "post_hooks": [],
    "content_type_overrides": {"application/zip": "application/octet-stream"},
}

GENERATE = "from openapi_python_client.cli import app; app()"

PROGRAM = """
import sys

from generated import Client
from generated.api.planning import parse, plan
from generated.api.sessions import (
    close_session, list_sessions, open_session, session_look, session_plan, session_execute,
)
from generated.models import PlanIdBody, Problem, SaidBody, SessionSpec, TableExplainedBody

client = Client(base_url=sys.argv[1], timeout=None)
text = "push the mug 3 cm to the left"

read = parse.sync(client=client, body=TableExplainedBody(text=text))
assert read.ok and read.frames[0].action == "push", read
unread = parse.sync(client=client, body=TableExplainedBody(text="frobnicate the mug"))
assert not unread.ok and unread.error.code == "unknown_verb", unread

planned = plan.sync(client=client, body=TableExplainedBody(text=text)).result
assert planned.status == "planned", planned
push = planned.plan.actions[0]
assert push.kind == "push" and push.prediction.outcome == "slide", push
assert planned.frames[0].goal.kind == "displace", planned.frames
refused = plan.sync(client=client, body=TableExplainedBody(text="push the mug 3 m away")).result
assert refused.status == "refused" and refused.error.suggestions, refused

session = open_session.sync(client=client, body=SessionSpec(scene="kitchen", seed=1))
assert session.spec.seed == 1, session
objects = session_look.sync(session_id=session.session_id, client=client).objects
assert "mug" in [each.name for each in objects], objects
offer = session_plan.sync(session_id=session.session_id, client=client, body=SaidBody(text=text))
assert offer.plan_id and offer.result.plan.object_ == "mug", offer
problem = session_execute.sync(
    session_id=session.session_id, client=client, body=PlanIdBody(plan_id="plan-0")
)
assert isinstance(problem, Problem) and problem.code == "unknown_plan", problem
listed = list_sessions.sync(client=client).sessions
assert session.session_id in [each.session_id for each in listed], listed
assert close_session.sync_detailed(session_id=session.session_id, client=client).status_code == 204
"""


@pytest.mark.slow
def test_a_generated_client_parses_plans_and_opens_a_session(
    server: ServerProcess, tmp_path: Path
) -> None:
    pytest.importorskip("openapi_python_client", reason="the extra dev has the generator")
    document = httpx.get(f"{server.url}/v1/openapi.json", trust_env=False, timeout=PATIENCE).json()
    files = {"openapi.json": document, "config.json": CONFIG}
    for name, content in files.items():
        (tmp_path / name).write_text(json.dumps(content))
    paths = ("--path", "openapi.json", "--config", "config.json", "--output-path", "generated")
    made = subprocess.run(
        [sys.executable, "-c", GENERATE, "generate", *paths, "--meta", "none"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE,
    )
    assert made.returncode == 0, made.stdout
    assert "WARNING" not in made.stdout, made.stdout
    assert "Unable" not in made.stdout, made.stdout
    used = subprocess.run(
        [sys.executable, "-c", PROGRAM, server.url],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE,
    )
    assert used.returncode == 0, used.stderr

"""The page of errors: a section for each code, whose example ends in that error.

Where there is no example, since it would need a broken machine or several programs at once, another
test has the error.
"""

from __future__ import annotations

import asyncio
import contextlib
import errno
import io
import json
import os
import re
import shlex
import subprocess
from pathlib import Path
from typing import Any

import pytest
from starlette.types import Message

from nlcontrol.cli import run
from nlcontrol.errors import CODES, exception_info, known_error
from nlcontrol.service.http.guard.request_guard import RequestGuard
from nlcontrol.service.http.http_settings import HttpSettings
from tests.service_process import serving

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "errors.md").read_text(encoding="utf-8")
SECTIONS = dict(re.findall(r"^### `(\w+)`\n\n(.*?)(?=^##|\Z)", PAGE, re.M | re.S))
EXAMPLES = {
    code: (language, example.strip())
    for code, section in SECTIONS.items()
    for language, example in re.findall(r"^```(\w+)\n(.*?)^```$", section, re.M | re.S)
}

SERVICE = "tests/unit/nlcontrol/service"
MODEL_CHECKS = "tests/unit/objectmodels/registry/test_model_checks.py"
ELSEWHERE = {
    "not_explorable": "tests/unit/nlcontrol/session/test_exploration_commands.py",
    "wrong_frame": MODEL_CHECKS,
    "not_finite": MODEL_CHECKS,
    "out_of_bounds": MODEL_CHECKS,
    "not_balanced": MODEL_CHECKS,
    "not_calibrated": MODEL_CHECKS,
    "too_slow": MODEL_CHECKS,
    "not_picklable": MODEL_CHECKS,
    "not_saved": MODEL_CHECKS,
    "missing_extra": "tests/unit/objectmodels/registry/test_mesh_import.py",
    "no_pictures": "tests/unit/sim/worlds/drake/test_world.py",
    "worker_lost": "tests/unit/nlcontrol/batches/test_batch.py",
    "versions_differ": "tests/unit/nlcontrol/batches/test_batch.py",
    "used_plan": f"{SERVICE}/test_session.py",
    "stale_plan": f"{SERVICE}/test_session.py",
    "busy": f"{SERVICE}/test_session.py",
    "no_reset": f"{SERVICE}/test_session.py",
    "clause_not_held": "tests/unit/nlcontrol/session/test_frame_execution.py",
    "session_lost": f"{SERVICE}/test_planning_service.py",
    "too_many_sessions": f"{SERVICE}/test_planning_service.py",
    "queue_full": f"{SERVICE}/test_planner_pool.py",
    "bad_executor": f"{SERVICE}/test_driven_robot.py",
    "no_file": f"{SERVICE}/client/test_lost_connections.py",
    "run_under_way": f"{SERVICE}/test_run_store.py",
    "key_reused": f"{SERVICE}/test_run_store.py",
    "aborted": f"{SERVICE}/test_service_runs.py",
    "cut_off": f"{SERVICE}/test_run_store.py",
    "store_in_use": f"{SERVICE}/test_run_store.py",
    "run_differs": f"{SERVICE}/test_run_bundle.py",
    "bad_answer": f"{SERVICE}/client/test_lost_connections.py",
    "wrong_token": f"{SERVICE}/http/test_browser_login.py",
    "too_many_requests": f"{SERVICE}/http/test_event_streams.py",
    "unknown_tool": "tests/unit/nlcontrol/mcp/test_agent_tools.py",
    "cannot_import": "tests/unit/nlcontrol/test_shadowing.py",
    "slow_request": "tests/docs/test_errors.py",
    "system_error": "tests/docs/test_errors.py",
    "internal": "tests/docs/test_errors.py",
}


def _examples(language: str) -> list[Any]:
    return [
        pytest.param(code, example, id=code)
        for code, (spoken, example) in EXAMPLES.items()
        if spoken == language
    ]


def test_every_code_has_a_section_with_its_status_and_a_cure() -> None:
    assert list(SECTIONS) == list(dict.fromkeys(SECTIONS))
    assert set(SECTIONS) == set(CODES)
    for code, section in SECTIONS.items():
        assert section.startswith(f"Exit {CODES[code].exit}, HTTP {CODES[code].http}. "), code
        assert "\nCure: " in section, code


def test_every_code_is_provoked_here_or_elsewhere() -> None:
    assert set(EXAMPLES) | set(ELSEWHERE) == set(CODES)
    assert set(EXAMPLES) & set(ELSEWHERE) == set()
    for code, test in ELSEWHERE.items():
        assert f'"{code}"' in (ROOT / test).read_text(encoding="utf-8"), code


@pytest.mark.parametrize(("code", "example"), _examples("console"))
def test_a_command_ends_in_the_error(
    code: str, example: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    args = shlex.split(example.removeprefix("$ "))[1:]
    with_document = args if args[0] == "serve" else [*args, "--json"]
    assert run(with_document) == CODES[code].exit
    printed = capsys.readouterr()
    if args[0] == "serve":
        assert f"({code})" in printed.err
    else:
        assert json.loads(printed.out)["error"]["code"] == code


@pytest.mark.parametrize(("code", "example"), _examples("python"))
def test_a_program_ends_in_the_error(
    code: str, example: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    printed = io.StringIO()
    try:
        with contextlib.redirect_stdout(printed):
            exec(compile(example, code, "exec"), {})
    except Exception as raised:
        known = known_error(raised)
        if known is None:
            raise
        assert known.code == code
    else:
        assert printed.getvalue().strip() == code


@pytest.mark.slow
def test_requests_end_in_their_errors() -> None:
    with serving("--workers", "1", "--planners", "1") as server:
        for code, (language, example) in EXAMPLES.items():
            if language != "sh":
                continue
            done = subprocess.run(
                ["bash", "-euc", example],
                env=os.environ | {"URL": server.url},
                capture_output=True,
                text=True,
                timeout=60,
                check=False,
            )
            assert json.loads(done.stdout)["code"] == code, example


def test_a_body_that_does_not_arrive_is_given_up() -> None:
    sent: list[Message] = []

    async def answer() -> None:
        async def receive() -> Message:
            await asyncio.sleep(60.0)
            raise AssertionError

        async def send(message: Message) -> None:
            sent.append(message)

        async def app(*_: object) -> None:
            raise AssertionError

        guard = RequestGuard(app, HttpSettings(body_time=0.01), body_bytes=1000)
        headers = [(b"host", b"127.0.0.1"), (b"content-type", b"application/json")]
        scope = {"type": "http", "method": "POST", "path": "/v1/plan", "headers": headers}
        await guard(scope | {"query_string": b""}, receive, send)

    asyncio.run(answer())
    assert (sent[0]["status"], json.loads(sent[1]["body"])["code"]) == (408, "slow_request")


def test_what_nobody_has_foreseen_has_a_code() -> None:
    assert exception_info(OSError(errno.ENOSPC, "no room")).code == "system_error"
    try:
        raise ZeroDivisionError
    except ZeroDivisionError as raised:
        assert exception_info(raised).code == "internal"  # noqa: PT017

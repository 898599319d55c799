"""The guide to the service: examples run, every route has one, tables are those of the code."""

from __future__ import annotations

import json
import os
import re
import subprocess
from pathlib import Path

import pytest

from nlcontrol.json_document import docstring_parts
from nlcontrol.service.http.responses import HttpSettings
from nlcontrol.service.http.service_app import routes_app
from nlcontrol.service.service_settings import ServiceSettings
from tests.docs.guide_blocks import code_blocks
from tests.patience import PATIENCE
from tests.service_process import serving

PAGE = (Path(__file__).parents[2] / "docs" / "service.md").read_text(encoding="utf-8")
EXAMPLES = [
    example
    for block in code_blocks(PAGE, "sh")
    for example in re.split(r"\n(?=curl )", block.strip())
]
IDS = {"SESSION": "session_id", "PLAN": "plan_id", "RUN": "run_id"}
OUTLASTED = 28  # curl's exit code after -m


def test_the_tables_of_settings_are_those_of_the_code() -> None:
    rows = []
    for settings in (ServiceSettings, HttpSettings):
        _, said = docstring_parts(settings.__doc__ or "")
        for name, field in settings.model_fields.items():
            value = "–" if field.default in (None, ()) else field.default
            rows.append(
                f"| `{name}` | {'cores − 1' if name == 'workers' else value} | {said[name]} |"
            )
    assert re.findall(r"^\| `.*$", PAGE, re.M) == rows


@pytest.mark.slow
def test_every_example_runs_and_every_route_has_one(tmp_path: Path) -> None:
    (tmp_path / ".curlrc").write_text("fail-with-body\nsilent\nshow-error\n")
    environment = os.environ | {"CURL_HOME": str(tmp_path), "SESSION": "", "PLAN": "", "RUN": ""}
    with serving("--workers", "1", "--planners", "1") as server:
        environment["URL"] = server.url
        for example in EXAMPLES:
            ran = subprocess.run(
                ["bash", "-euc", example],
                env=environment,
                cwd=tmp_path,
                capture_output=True,
                text=True,
                timeout=PATIENCE,
                check=False,
            )
            assert ran.returncode in (0, OUTLASTED if " -m " in example else 0), (example, ran)
            if ran.stdout.startswith("{"):
                answer = json.loads(ran.stdout)
                environment |= {key: answer[name] for key, name in IDS.items() if answer.get(name)}
        server.process.terminate()
        server.process.wait(PATIENCE)  # what an answer was is logged after it is sent
        lines = map(json.loads, server.log.read_text().splitlines())
        called = {(line["method"], line["path"]) for line in lines if "path" in line}
    for path, operations in routes_app().openapi()["paths"].items():
        form = re.compile(re.sub(r"\{\w+\}", "[^/]+", path))
        for method in map(str.upper, operations):
            assert any(m == method and form.fullmatch(p) for m, p in called), (method, path)
    assert ("GET", "/v1/openapi.json") in called
    for name in ("trace.npz", "replay.html", "bundle.zip"):
        assert (tmp_path / name).stat().st_size > 1000

"""The programs of `examples/programs` run as they stand there."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.patience import PATIENCE
from tests.service_process import ServerProcess, serving

PROGRAMS = sorted(Path(__file__).parents[2].glob("examples/programs/*.py"))
AT_A_SERVER = {"at_a_server", "two_at_once"}


@pytest.fixture(scope="module")
def server() -> Iterator[ServerProcess]:
    with serving() as process:
        yield process


@pytest.mark.slow
@pytest.mark.parametrize("program", PROGRAMS, ids=lambda path: path.stem)
def test_a_program_runs(program: Path, server: ServerProcess) -> None:
    where = [server.url] if program.stem in AT_A_SERVER else []
    command = [sys.executable, str(program), *where]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip()

"""What a command answers to `--json`."""

from __future__ import annotations

import json
from typing import Any

import pytest

from nlcontrol.cli import run


def json_answer(capsys: pytest.CaptureFixture[str], *args: str) -> tuple[int, Any]:
    """Exit status of a command, and its document."""
    return told_answer(capsys, *args)[:2]


def told_answer(capsys: pytest.CaptureFixture[str], *args: str) -> tuple[int, Any, str]:
    """Exit status of a command, its document, and what it told on standard error."""
    capsys.readouterr()
    status = run([*args, "--json"])
    printed = capsys.readouterr()
    return status, json.loads(printed.out), printed.err

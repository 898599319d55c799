"""The line about the tests in a browser, as it stands above pytest's closing line."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.browser_tests import NO_BROWSER, browser_account
from tests.patience import PATIENCE

ROOT = Path(__file__).parents[2]


def report(nodeid: str, outcome: str, reason: str = "") -> pytest.TestReport:
    told = ("conftest.py", 1, f"Skipped: {reason}") if reason else None
    return pytest.TestReport(nodeid, ("", 0, ""), {}, outcome, told, "call")  # type: ignore[arg-type]


def test_tests_that_were_tried_and_skipped_are_counted() -> None:
    tried = report("tests/browser/test_a.py::test_b", "passed")
    other = report("tests/unit/test_a.py::test_b", "passed")
    left_out = report("tests/browser/test_a.py::test_c", "skipped", f"{NO_BROWSER}: none")
    for_another_reason = report("tests/unit/test_a.py::test_d", "skipped", "no atheris")
    assert browser_account({"passed": [other], "skipped": [for_another_reason]}) is None
    assert browser_account({"passed": [tried, other]}) == (
        "1 tests were tried in a browser, none was skipped"
    )
    assert browser_account({"passed": [tried], "skipped": [left_out, for_another_reason]}) == (
        f"{NO_BROWSER}: 1 tests in a browser were skipped, as there is none here"
    )


def test_the_line_stands_above_the_closing_line() -> None:
    found = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider",
         "tests/browser/test_docs_page.py", "tests/architecture/test_patience.py"],
        env=os.environ | {"PATH": str(Path(sys.executable).parent)},
        cwd=ROOT, capture_output=True, text=True, timeout=PATIENCE, check=False,
    )  # fmt: skip
    *_, account, closing = found.stdout.splitlines()
    assert account == f"{NO_BROWSER}: 2 tests in a browser were skipped, as there is none here"
    assert " passed, 2 skipped in " in closing
    assert found.returncode == 0

"""The account of the tests that need a browser: how many had one, and how many were skipped."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import pytest

NO_BROWSER = "NO BROWSER"
"""Beginning of the reason why a test is skipped where there is none."""


def browser_account(reports: Mapping[str, Iterable[object]]) -> str | None:
    """The account in one line; None if no such test was asked for.

    Args:
        reports: of the tests, by what came of them.
    """

    def counted(outcome: str) -> int:
        told = (each for each in reports.get(outcome, ()) if isinstance(each, pytest.TestReport))
        return sum(_needs_browser(each) for each in told)

    skipped, ran = counted("skipped"), counted("passed") + counted("failed")
    if skipped:
        return f"{NO_BROWSER}: {skipped} tests in a browser were skipped, as there is none here"
    return f"{ran} tests were tried in a browser, none was skipped" if ran else None


def _needs_browser(report: pytest.TestReport) -> bool:
    if report.skipped:
        return NO_BROWSER in str(report.longrepr)
    return report.nodeid.startswith("tests/browser/") and report.when == "call"

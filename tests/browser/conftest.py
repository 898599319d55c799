"""A browser without a display, that draws in software; tests are left out where there is none."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest

from tests.browser.open_page import FLAGS, NAMES, found_browser
from tests.browser_tests import NO_BROWSER
from tests.service_process import ServerProcess, serving

if TYPE_CHECKING:
    from playwright.sync_api import Browser


@pytest.fixture(scope="session")
def browser_path() -> str:
    path = found_browser()
    if path is None:
        pytest.skip(f"{NO_BROWSER}: none of {', '.join(NAMES)} is installed, the page is not tried")
    return path


# Not for the whole session: Playwright has a loop in its thread, beside which asyncio starts none.
@pytest.fixture(scope="module")
def browser(browser_path: str) -> Iterator[Browser]:
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=browser_path, args=FLAGS)
        yield started
        started.close()


@pytest.fixture(scope="module")
def server(browser_path: str) -> Iterator[ServerProcess]:
    """A server of the service, whose runs are those of one module."""
    with serving() as started:
        yield started

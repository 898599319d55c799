"""The page of the OpenAPI document: drawn from this service alone, also where there is a token."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import httpx
import pytest

from tests.browser.open_page import OpenPage
from tests.patience import PATIENCE
from tests.service_process import ServerProcess, serving

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.slow

TOKEN = "a-token-of-this-test-alone"
OPERATIONS = "document.querySelectorAll('.opblock').length"


@pytest.fixture(scope="module")
def closed_server(browser_path: str) -> Iterator[ServerProcess]:
    """A server that asks for a token."""
    with serving(environment={"NLCONTROL_TOKEN": TOKEN}) as started:
        yield started


def operations_of(document: dict[str, dict[str, dict[str, object]]]) -> int:
    return sum(len(methods) for methods in document["paths"].values())


def test_every_operation_is_drawn_from_this_service_alone(
    browser: Browser, server: ServerProcess
) -> None:
    opened = OpenPage.opened(browser, server.url)
    opened.page.click("text=HTTP interface")
    opened.wait(f"{OPERATIONS} > 0")
    document = httpx.get(f"{server.url}/v1/openapi.json", timeout=PATIENCE).json()
    assert opened.ask(OPERATIONS) == operations_of(document)
    opened.page.click("#operations-planning-parse .opblock-summary-control")
    opened.page.click(".try-out__btn")
    opened.page.click(".execute")
    status = ".live-responses-table tbody .response-col_status"
    opened.wait(f"document.querySelector('{status}') !== null")
    assert opened.page.inner_text(status).startswith("200")
    assert all(asked.startswith((server.url, "data:")) for asked in opened.requests)
    assert opened.complaints == []
    opened.page.close()


def test_the_token_is_asked_for_where_there_is_one(
    browser: Browser, closed_server: ServerProcess
) -> None:
    opened = OpenPage.opened(browser, f"{closed_server.url}/docs")
    assert opened.ask(OPERATIONS) == 0
    opened.page.fill("#login input", TOKEN)
    opened.page.click("#login button")
    opened.page.locator(".opblock").nth(30).wait_for()  # the page is loaded anew meanwhile
    assert all(asked.startswith((closed_server.url, "data:")) for asked in opened.requests)
    opened.page.close()

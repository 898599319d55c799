"""Objects and scenes to look at on the page of the service."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from objectmodels import Registry
from tests.browser.open_page import OpenPage
from tests.service_process import ServerProcess

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def opened(browser: Browser, server: ServerProcess) -> OpenPage:
    address = f"{server.url}/?scene=workbench"
    found = OpenPage.opened(browser, address, viewport={"width": 1280, "height": 800})
    found.wait("page.state.get('table') !== null && page.view.viewer !== null")
    found.page.click("#library summary")
    return found


def look_at(opened: OpenPage, name: str) -> None:
    """Looks at an object of the library."""
    opened.page.click(f"#library .chips button:text-is('{name}')")
    opened.wait(f"document.querySelector('#looked-at h3')?.textContent === '{name}'")


def test_all_objects_are_there_and_those_on_the_table_come_first(opened: OpenPage) -> None:
    names = opened.page.locator("#library [aria-label=Objects] button").all_inner_texts()
    seen = opened.ask("page.state.get('table').objects.map(({ name }) => name)")
    assert names[: len(seen)] == seen
    models = set(opened.ask("page.state.get('table').objects.map(({ model }) => model)"))
    assert set(names[len(seen) :]) == {model.name for model in Registry.default()} - models


def test_an_object_is_seen_with_its_figures_and_their_uncertainty(opened: OpenPage) -> None:
    look_at(opened, "book")
    model = Registry.default().find_one("book")
    told = opened.page.inner_text("#looked-at .figures")
    assert f"{model.mass:.3f} ± {model.mass_sd:#.2g} kg" in told
    assert opened.page.locator("#looked-at .belief").count() == 3
    opened.wait("document.querySelector('#looked-at canvas')?.clientHeight > 100")


def test_what_can_be_done_is_worked_out_and_can_be_said(opened: OpenPage) -> None:
    look_at(opened, "tea tin")
    opened.page.click("#looked-at details summary")
    opened.wait("document.querySelectorAll('.affordances .mark').length > 4")
    assert opened.violations() == []
    offered = opened.page.locator(".affordances [data-ok=true] button").first
    text = offered.inner_text()
    offered.click()
    assert opened.page.input_value("#say") == text
    opened.wait("page.state.get('understanding')?.ok === true")
    assert opened.ask("page.state.get('run')") is None


def test_another_scene_is_opened(opened: OpenPage) -> None:
    opened.page.click("#library .chips button:text-is('breakfast')")
    opened.wait("page.state.get('session')?.spec.scene === 'breakfast'")
    opened.wait("page.state.get('table')?.scene === 'breakfast'")
    assert opened.page.get_attribute("#library [aria-current]", "title") is not None
    assert opened.complaints == []

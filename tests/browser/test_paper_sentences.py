"""The paper's three sentences on the page of the service, each to its verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.browser.open_page import OpenPage
from tests.service_process import ServerProcess

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.slow

SENTENCES = (
    "push the ice tea box away without toppling it",
    "open the ice tea cup",
    "pour the contents of the ice tea into the mug",
)


@pytest.fixture(scope="module")
def opened(browser: Browser, server: ServerProcess) -> OpenPage:
    viewport = {"width": 480, "height": 480}
    found = OpenPage.opened(browser, server.url, few_frames=True, viewport=viewport)
    found.wait("page.view.viewer?.frames > 0")
    found.ask("page.state.set({ mode: 'at_once' })")
    return found


@pytest.mark.parametrize("sentence", SENTENCES)
def test_a_sentence_comes_to_its_verdict(opened: OpenPage, sentence: str) -> None:
    opened.say(sentence)
    # A pour is simulated no faster than the clock, beside a view that is drawn in software.
    opened.wait(f"page.state.get('result')?.text === {sentence!r}")
    opened.wait("document.querySelectorAll('#run li').length > 0")
    checks = opened.ask("page.state.get('result').checks")
    verdicts = "[...document.querySelectorAll('#run li')].map((e) => e.dataset.verdict)"
    assert opened.ask(verdicts) == ["held"] * len(checks)
    assert opened.page.inner_text("#run .badge") == "done"

"""The sentence on the page: it lights up, goes on, is marked, corrected, answered, shared."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING
from urllib.parse import urlencode

import httpx
import pytest

from tests.browser.open_page import OpenPage
from tests.patience import PATIENCE
from tests.service_process import ServerProcess

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.slow

AWAY = "push the ice tea box away without toppling it"
STATE = "page.state.get"
LIT = "[...document.querySelectorAll('#lights [data-part]')]"
LIGHTS = f"{LIT}.map((each) => [each.textContent, each.dataset.part])"


@pytest.fixture(scope="module")
def opened(browser: Browser, server: ServerProcess) -> Iterator[OpenPage]:
    found = OpenPage.opened(browser, server.url, viewport={"width": 1000, "height": 700})
    found.wait(f"{STATE}('table') !== null")
    yield found
    found.page.close()


def type_text(opened: OpenPage, text: str) -> None:
    """Types a sentence as a person does, with the keyboard alone."""
    opened.page.focus("#say")
    opened.page.keyboard.press("Control+a")
    opened.page.keyboard.type(text)


def say(opened: OpenPage, text: str) -> None:
    type_text(opened, text)
    opened.page.keyboard.press("Enter")
    opened.wait(f"!{STATE}('asking') && {STATE}('understanding')?.status !== undefined")


def test_words_light_up_in_the_colours_of_their_parts(opened: OpenPage) -> None:
    type_text(opened, AWAY)
    opened.wait(f"{STATE}('understanding')?.text === '{AWAY}'")
    assert opened.ask(LIGHTS) == [
        ["push", "controller"],
        ["ice tea box", "object model"],
        ["away", "wanted outcome"],
        ["without toppling it", "constraint"],
    ]
    colours = opened.ask(f"{LIT}.map((each) => getComputedStyle(each).color)")
    assert len(set(colours)) == 4
    below = opened.page.inner_text("#parameters")
    assert "displace" in below
    assert "no_topple" in below


def test_what_is_begun_goes_on_with_names_and_words(opened: OpenPage) -> None:
    type_text(opened, "push the cer")
    options = opened.page.locator("#completions li")
    assert options.first.inner_text() == "cereal box"
    opened.page.keyboard.press("ArrowDown")
    assert opened.page.get_attribute("#say", "aria-activedescendant") == "completion-0"
    opened.page.keyboard.press("Enter")
    assert opened.page.input_value("#say") == "push the cereal box "
    opened.page.keyboard.type("without tur")
    opened.page.keyboard.press("ArrowDown")
    opened.page.keyboard.press("Enter")
    assert opened.page.input_value("#say") == "push the cereal box without turning it "
    opened.page.keyboard.press("Escape")
    assert opened.page.get_attribute("#say", "aria-expanded") == "false"
    assert opened.ask(f"{STATE}('offer')") is None


def test_what_is_not_understood_is_marked_and_a_click_corrects_it(opened: OpenPage) -> None:
    say(opened, "push the ice tea bxo away")
    assert ["ice tea bxo", "problem"] in opened.ask(LIGHTS)
    opened.page.click("#understood .choices button")
    opened.wait(f"{STATE}('offer')?.result.status === 'planned'")
    assert opened.page.input_value("#say") == "push the ice tea box away"


def test_a_refusal_has_its_number_and_a_click_takes_what_would_do(opened: OpenPage) -> None:
    say(opened, "push the ice tea box 2 m away")
    opened.wait(f"{STATE}('offer')?.result.status === 'refused'")
    # From the middle of the box to the end of the table less what has to stay on it.
    room = opened.ask(f"{STATE}('offer').result.error.numbers.room")
    assert 0.6 < room < 0.8
    assert f"{1e3 * room:.0f} mm" in opened.page.inner_text("main")
    opened.page.click("#understood .choices button")
    opened.wait(f"{STATE}('offer')?.result.status === 'planned'")
    assert f"{100 * room:.0f} cm" in opened.page.input_value("#say")
    assert "force limit" in opened.page.inner_text("#parameters")


def test_a_question_is_answered_in_the_same_field(opened: OpenPage) -> None:
    say(opened, "how heavy is the mug?")
    opened.wait(f"{STATE}('answer') !== null")
    assert "0.118 kg" in opened.page.inner_text("#answer")
    assert opened.ask(f"{STATE}('offer')") is None
    assert opened.complaints == []


def test_a_link_fills_in_and_plans_and_moves_nothing(
    browser: Browser, server: ServerProcess
) -> None:
    link = f"{server.url}/?{urlencode({'say': AWAY, 'scene': 'workbench', 'seed': 7})}"
    found = OpenPage.opened(browser, link)
    found.wait(f"{STATE}('offer')?.result.status === 'planned'")
    assert found.page.input_value("#say") == AWAY
    assert found.page.input_value("#scene") == "workbench"
    assert found.page.input_value("#seed") == "7"
    session = found.ask(f"{STATE}('session')")
    assert (session["spec"]["scene"], session["spec"]["seed"]) == ("workbench", 7)
    runs = httpx.get(
        f"{server.url}/v1/runs", params={"session": session["session_id"]}, timeout=PATIENCE
    ).json()
    assert runs["runs"] == []
    found.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    found.page.click("#share")
    found.wait("document.querySelector('#share').textContent === 'Copied'")
    assert found.ask("navigator.clipboard.readText()") == link
    found.page.reload()
    found.wait(f"globalThis.page?.state.get('session')?.session_id === '{session['session_id']}'")
    assert found.complaints == []
    found.page.close()


def test_what_courtesy_leaves_out_is_shown_beside_what_is_understood(opened: OpenPage) -> None:
    type_text(opened, "please push the mug 5 cm to the left, thanks")
    opened.wait(f"({STATE}('understanding')?.left_out ?? []).length === 2")
    shown = opened.page.inner_text("#understood")
    assert "please" in shown
    assert "left out: “please”, “thanks”" in shown
    type_text(opened, "push the mug 5 cm to the left")
    opened.wait(f"{STATE}('understanding')?.left_out?.length === 0")
    assert "left out" not in opened.page.inner_text("#understood")

"""Checks of axe-core on the page in its states, wide and narrow, light and dark; the keyboard."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.browser.open_page import OpenPage

if TYPE_CHECKING:
    from playwright.sync_api import Browser

    from tests.service_process import ServerProcess

pytestmark = pytest.mark.slow

STATE = "page.state.get"
WIDE, NARROW = {"width": 1280, "height": 800}, {"width": 390, "height": 844}


@pytest.mark.parametrize(("size", "scheme"), [(WIDE, "light"), (NARROW, "dark")])
def test_no_rule_is_broken(
    browser: Browser, server: ServerProcess, size: dict[str, int], scheme: str
) -> None:
    opened = OpenPage.opened(browser, server.url, viewport=size, color_scheme=scheme)
    opened.wait(f"{STATE}('table') !== null")
    assert opened.violations() == []
    said = {
        "push the mug without t": f"{STATE}('understanding')?.unfinished",
        "push the ice tea box away": f"{STATE}('offer')?.plan_id",
        "push the ice tea box 2 m away": f"{STATE}('offer')?.result.status === 'refused'",
        "push the ice tea bxo away": f"{STATE}('understanding')?.status === 'not_understood'",
        "how heavy is the mug?": f"{STATE}('answer')",
    }
    for text, state in said.items():
        opened.page.fill("#say", text)
        if not text.endswith(" t"):
            opened.page.press("#say", "Enter")
        opened.wait(state)
        assert opened.violations() == [], text
    wide = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
    assert opened.ask(wide) <= 0
    opened.page.close()


def test_all_is_reached_by_the_keyboard_and_what_has_the_focus_is_seen(
    browser: Browser, server: ServerProcess
) -> None:
    opened = OpenPage.opened(browser, server.url, viewport=WIDE)
    opened.wait(f"{STATE}('table') !== null && page.view.viewer")
    opened.page.fill("#say", "push the ice tea box away")
    opened.page.press("#say", "Enter")
    opened.wait(f"{STATE}('offer')?.plan_id")
    reached = set()
    outlines = []
    for _ in range(60):
        opened.page.keyboard.press("Tab")
        name, outline = opened.ask(
            "[document.activeElement.id || document.activeElement.tagName,"
            " getComputedStyle(document.activeElement).outlineStyle]"
        )
        if name != "BODY":  # behind the last one, and before the first
            reached.add(name)
            outlines.append((name, outline))
    assert reached >= {"scene", "seed", "at-once", "share", "say", "do-it", "CANVAS"}
    assert [name for name, outline in outlines if outline == "none"] == []
    opened.page.close()

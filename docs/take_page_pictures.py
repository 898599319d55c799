"""Takes the pictures of `docs/page.md` and the README's first one from the page as it runs.

    python -m docs.take_page_pictures [FOLDER]

They go where the guides have theirs, or into the folder. It serves, opens the page in Chromium
without a display and says sentences, so a push takes as long as on a real table.
"""

from __future__ import annotations

import shutil
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from tests.browser.open_page import FLAGS, NAMES, OpenPage
from tests.service_process import serving

if TYPE_CHECKING:
    from playwright.sync_api import Browser, ViewportSize

IMAGES = Path(__file__).parent / "images"
DESKTOP: ViewportSize = {"width": 1280, "height": 800}
PHONE: ViewportSize = {"width": 390, "height": 844}
SENTENCE = "push the ice tea box away without toppling it"
REFUSED = "push the ice tea box away at the top without toppling it"


def main(folder: Path = IMAGES) -> None:
    """Takes all pictures."""
    with serving() as server, new_browser() as browser:
        _take_all(browser, server.url, folder)


@contextmanager
def new_browser() -> Iterator[Browser]:
    """Context with a browser that needs no display."""
    from playwright.sync_api import sync_playwright

    path = next((found for name in NAMES if (found := shutil.which(name))), None)
    if path is None:
        sys.exit(f"no browser: none of {', '.join(NAMES)} is installed")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=FLAGS)
        yield browser
        browser.close()


def _take_all(browser: Browser, url: str, folder: Path) -> None:
    opened = OpenPage.opened(browser, url, viewport=DESKTOP)
    opened.wait("page.view.viewer?.frames > 0")
    _take(opened, folder / "page_start.png")
    _say(opened, REFUSED)
    _take(opened, folder / "page_refusal.png")
    _say(opened, SENTENCE)
    _take(opened, folder / "page_plan.png")
    _take(opened, folder / "page_plan_phone.png", scheme="dark", size=PHONE)
    opened.page.click("#do-it")
    opened.wait("page.state.get('events').some(({ event }) => event.phase === 'push')")
    opened.wait(
        "page.state.get('events').at(-1).event.time > page.state.get('events')"
        ".findLast(({ event }) => event.phase === 'push').event.time + 2"
    )
    _take(opened, folder / "page_run.png", settled=False)
    _take(opened, folder / "page_run_dark.png", scheme="dark", settled=False)
    opened.wait("page.state.get('result') && !document.querySelector('#controls').hidden")
    opened.page.locator("#time").fill("9")
    _take(opened, folder / "page_verdict.png")
    _take(opened, folder / "page_verdict_phone.png", size=PHONE)


def _say(opened: OpenPage, text: str) -> None:
    opened.page.fill("#say", text)
    opened.page.press("#say", "Enter")
    opened.wait("page.state.get('offer') && !page.state.get('asking')")


def _take(
    opened: OpenPage,
    path: Path,
    *,
    scheme: Literal["light", "dark"] = "light",
    size: ViewportSize = DESKTOP,
    settled: bool = True,
) -> None:
    """Takes one picture, once what stands still is drawn finely."""
    level = opened.ask("page.view.viewer.quality.level")
    opened.ask("page.view.viewer.quality.level = 0")  # as a graphics card draws
    opened.page.emulate_media(color_scheme=scheme)
    opened.page.set_viewport_size(size)
    opened.ask("scrollTo(0, 0), page.view.viewer.invalidate()")
    time.sleep(0.3)  # in which the page takes its form
    if settled:
        opened.wait("page.view.viewer.holder.dataset.settled === String(page.view.viewer.frames)")
    opened.page.screenshot(path=path)
    opened.ask(f"page.view.viewer.quality.level = {level}")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:2]))

"""A page in a browser, and what it did besides being shown."""

from __future__ import annotations

import shutil
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tests.patience import PATIENCE, wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
AXE = Path(__file__).parent / "vendor" / "axe.min.js"
FEW_FRAMES = """
const soon = globalThis.requestAnimationFrame.bind(globalThis);
globalThis.requestAnimationFrame = (draw) => setTimeout(() => soon(draw), 300);
"""
"""Has a page draw three frames a second at most: in software each takes a tenth of a second."""


def found_browser() -> str | None:
    """Where the machine has a browser; None if it has none."""
    return next((found for name in NAMES if (found := shutil.which(name))), None)


@dataclass
class OpenPage:
    """A page.

    Attributes:
        page: of the browser.
        requests: addresses that it asked.
        complaints: its errors.
    """

    page: Page
    requests: list[str] = field(default_factory=list)
    complaints: list[str] = field(default_factory=list)

    @classmethod
    def opened(
        cls, browser: Browser, address: str, *, few_frames: bool = False, **options: Any
    ) -> OpenPage:
        """A new page at an address, once it is ready; `options` are those of Playwright.

        With few frames the processor is left to the simulation that the page shows.
        """
        page = browser.new_page(**options)
        page.set_default_timeout(1000.0 * PATIENCE)
        if few_frames:
            page.add_init_script(FEW_FRAMES)
        found = cls(page)
        page.on("request", lambda request: found.requests.append(request.url))
        page.on("pageerror", lambda error: found.complaints.append(str(error)))
        page.on(
            "console",
            lambda told: found.complaints.append(told.text) if told.type == "error" else None,
        )
        page.goto(address)
        found.wait("document.documentElement.dataset.ready === 'true'")
        return found

    def say(self, text: str) -> None:
        """Types a sentence and sends it off."""
        self.page.fill("#say", text)
        self.page.press("#say", "Enter")

    def ask(self, expression: str) -> Any:
        """The value of an expression in the page."""
        return self.page.evaluate(expression)

    def wait(self, expression: str) -> None:
        """Waits until an expression is true."""
        # The page's policy forbids what `wait_for_function` does.
        wait_until(lambda: self.ask(expression), f"{expression}, {self.complaints}")

    def violations(self) -> list[tuple[str, list[Any]]]:
        """Rules that the page breaks, and where; all rules of axe count, its best practices too."""
        self.ask(AXE.read_text("utf-8"))
        found = self.ask("axe.run().then(({ violations }) => violations)")
        return [(rule["id"], [node["html"][:200] for node in rule["nodes"]]) for rule in found]
